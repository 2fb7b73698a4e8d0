//! What is tried.

use glam::Vec3;

use super::setting::has_tree;
use super::{Axis, Setting};
use eyerays::method::{Layout, Method, TriangleTest};
use eyerays::quality::Bvh;
use eyerays::render::Precision;
use eyerays::scene::{Filter, Integrator, Material, Sampler, Scene, Settings, Transport};

/// Samples along a pixel's edge that are tried unless others are asked for.
const SAMPLES: [u32; 3] = [4, 2, 1];
/// Samples of a pixel where light is sampled: from one value to the next a fourth, which a grid has, too.
const FEWER: u32 = 4;
/// The most samples of a pixel in a hurry.
const HURRIED: u32 = 4;
/// Limits of what light adds to a sample: none, rarely and often met in a picture of a screen's brightness.
const CLAMPS: [f32; 3] = [0.0, 10.0, 1.0];
/// How much more a ray must contribute from one value to the next ...
const STEP: f32 = 4.0;
/// ... and how many values there are.
const CONTRIBUTIONS: usize = 4;
/// The least contribution that is tried above 0.
const LEAST: f32 = 1.0 / 1024.0;

/// The values that are tried of each part of a setting, each once, the most accurate ones first.
#[derive(Debug, Clone, PartialEq)]
pub struct Axes {
    /// Precision with its triangle test.
    pub arithmetic: Vec<(Precision, TriangleTest)>,
    /// How rays are followed.
    pub methods: Vec<Method>,
    /// How the hierarchy and its triangles lie in memory.
    pub layouts: Vec<Layout>,
    /// Qualities of the hierarchy.
    pub bvhs: Vec<Bvh>,
    /// How light is carried, those that leave out least first.
    pub integrators: Vec<Integrator>,
    /// Where in a pixel its samples lie, the most even ones first.
    pub samplers: Vec<Sampler>,
    /// How textures are filtered, those that tell most of a texture first.
    pub filters: Vec<Filter>,
    /// Whether light has wavelengths, where the scene says that it has.
    pub spectral: Vec<Option<bool>>,
    /// Photons for each pixel that tell of caustics, where the scene has some, the most first.
    pub caustics: Vec<Option<f32>>,
    /// Samples along a pixel's edge and of a pixel, as [`Setting`] has them; the most first.
    pub samples: Vec<(u32, u32)>,
    /// Limits of bounces, the highest first.
    pub bounces: Vec<u32>,
    /// Least contributions, the lowest first.
    pub min_contributions: Vec<f32>,
    /// Bounces before Russian roulette, the most first.
    pub roulettes: Vec<u32>,
    /// The most that light adds to a sample, no limit first and then the highest.
    pub clamps: Vec<f32>,
}

impl Axes {
    /// What is tried of a scene with these settings of its own, by these integrators (none: its own). Only where rays are
    /// followed on does it matter how often, only where light is sampled how that is done, and only where there are textures how
    /// they are filtered.
    pub fn of(scene: &Scene, own: &Settings, integrators: &[Integrator]) -> Axes {
        let base = Setting::of(own);
        let fast = [TriangleTest::Watertight, TriangleTest::Moller].map(|test| (Precision::Fast, test));
        let mut axes = Axes {
            arithmetic: [&[(Precision::Exact, TriangleTest::Watertight)], &fast[..]].concat(),
            methods: [&[Method::Auto], &Method::ALL[..]].concat(),
            layouts: vec![Layout::Gathered, Layout::Indexed, Layout::Compact],
            bvhs: vec![Bvh::Medium, Bvh::Fast, Bvh::High],
            integrators: if integrators.is_empty() { vec![base.integrator] } else { integrators.to_vec() },
            samplers: vec![base.sampler],
            filters: vec![base.filter],
            spectral: vec![base.spectral],
            caustics: vec![base.caustics],
            samples: vec![(base.samples, base.spp)],
            bounces: vec![base.bounces],
            min_contributions: vec![base.min_contribution],
            roulettes: vec![base.roulette],
            clamps: vec![base.clamp],
        };
        axes.extend(scene, own);
        axes.sort();
        axes
    }

    /// Leaves what a CPU has a choice of: its fast precision is the exact one.
    pub fn on_cpu(&mut self) {
        self.arithmetic = vec![(Precision::Exact, TriangleTest::Watertight)];
    }

    /// Adds what else is tried of a scene by the integrators.
    fn extend(&mut self, scene: &Scene, own: &Settings) {
        let followed = |m: &Material| m.reflection != Vec3::ZERO || m.transmission != Vec3::ZERO;
        let has_specular = scene.materials.iter().any(followed);
        let any = |of: fn(Integrator) -> bool| self.integrators.iter().copied().any(of);
        let (is_path, has_tree) = (any(|i| i == Integrator::Path), has_specular && any(has_tree));
        if is_path || has_tree {
            self.bounces.extend(halvings(own.bounces));
        }
        if has_tree {
            self.min_contributions.extend(contributions(own.min_contribution));
        }
        if is_path {
            self.roulettes.extend([Settings::MOST_BOUNCES, 0]);
        }
        if is_path && own.spectral {
            self.spectral.push(Some(false));
        }
        if is_path && own.caustics > 0.0 {
            self.caustics.push(Some(0.0));
        }
        if any(Integrator::chooses_lights) {
            self.clamps.extend(CLAMPS);
        }
        if scene.materials.iter().any(|material| material.maps.all().next().is_some()) {
            self.filters.extend([Filter::Mipmap, Filter::Bilinear, Filter::Nearest]);
        }
        if any(Integrator::samples) {
            self.samplers.extend([Sampler::Sobol, Sampler::Jittered, Sampler::Random]);
            let fewer = std::iter::successors(Some(own.samples_a_pixel() / FEWER), |spp| Some(spp / FEWER));
            self.samples.extend(fewer.take_while(|&spp| spp > 0).map(|spp| (1, spp)));
        } else {
            self.samples.extend(SAMPLES.map(|edge| (edge, 0)));
        }
    }

    /// Keeps few samples, which take little time: at most 4 of a pixel, and where light is not sampled the scene's own
    /// number, too.
    pub fn hurry(&mut self, own: &Settings) {
        let is_sampled = self.integrators.iter().any(|integrator| integrator.samples());
        let is_own = |samples| !is_sampled && a_pixel(samples) == own.samples_a_pixel();
        self.samples.retain(|&samples| a_pixel(samples) <= HURRIED || is_own(samples));
        if self.samples.is_empty() {
            self.samples.push((1, HURRIED));
        }
    }

    /// Puts what can be ordered into the order of accuracy, each value once.
    pub fn sort(&mut self) {
        let unevenness = |sampler: &Sampler| match sampler {
            Sampler::Sobol => 0,
            Sampler::Jittered => 1,
            Sampler::Regular => 2,
            Sampler::Random => 3,
        };
        let left_out = |integrator: &Integrator| match integrator {
            Integrator::Path => 0,
            Integrator::Distributed => 1,
            Integrator::Whitted => 2,
            Integrator::Ao => 3,
        };
        self.integrators.sort_by_key(left_out);
        self.samplers.sort_by_key(unevenness);
        self.filters.sort_by_key(|&filter| lost(filter));
        self.spectral.sort_by_key(|&is_spectral| is_spectral != Some(true));
        self.caustics.sort_by(|a, b| b.unwrap_or(0.0).total_cmp(&a.unwrap_or(0.0)));
        self.samples.sort_by_key(|&samples| (std::cmp::Reverse(a_pixel(samples)), samples));
        self.bounces.sort_unstable_by(|a, b| b.cmp(a));
        self.min_contributions.sort_unstable_by(f32::total_cmp);
        self.roulettes.sort_unstable_by(|a, b| b.cmp(a));
        self.clamps.sort_unstable_by(|&a, &b| limit(b).total_cmp(&limit(a)));
        self.integrators.dedup();
        self.samplers.dedup();
        self.filters.dedup();
        self.spectral.dedup();
        self.caustics.dedup();
        self.samples.dedup_by_key(|samples| a_pixel(*samples));
        self.bounces.dedup();
        self.min_contributions.dedup();
        self.roulettes.dedup();
        self.clamps.dedup();
    }

    /// `setting` with every value on an axis.
    pub fn along(&self, axis: Axis, setting: Setting) -> Vec<Setting> {
        fn each<T: Copy>(values: &[T], with: impl Fn(T) -> Setting) -> Vec<Setting> {
            values.iter().map(|&value| with(value)).collect()
        }
        match axis {
            Axis::Arithmetic => {
                each(&self.arithmetic, |(precision, triangle)| Setting { precision, triangle, ..setting })
            }
            Axis::Method => each(&self.methods, |method| Setting { method, ..setting }),
            Axis::Layout => each(&self.layouts, |layout| Setting { layout, ..setting }),
            Axis::Bvh => each(&self.bvhs, |bvh| Setting { bvh, ..setting }),
            Axis::Integrator => each(&self.integrators, |integrator| Setting { integrator, ..setting }),
            Axis::Sampler => each(&self.samplers, |sampler| Setting { sampler, ..setting }),
            Axis::Filter => each(&self.filters, |filter| Setting { filter, ..setting }),
            Axis::Spectral => each(&self.spectral, |spectral| Setting { spectral, ..setting }),
            Axis::Caustics => each(&self.caustics, |caustics| Setting { caustics, ..setting }),
            Axis::Samples => each(&self.samples, |(samples, spp)| Setting { samples, spp, ..setting }),
            Axis::Bounces => each(&self.bounces, |bounces| Setting { bounces, ..setting }),
            Axis::MinContribution => {
                each(&self.min_contributions, |share| Setting { min_contribution: share, ..setting })
            }
            Axis::Roulette => each(&self.roulettes, |roulette| Setting { roulette, ..setting }),
            Axis::Clamp => each(&self.clamps, |clamp| Setting { clamp, ..setting }),
        }
    }

    /// The setting that others are compared with: a scene's own, but where that is not tried the first value.
    pub fn base(&self, own: Setting) -> Setting {
        Axis::ALL.into_iter().fold(own, |base, axis| {
            let all = self.along(axis, base);
            if all.contains(&base) { base } else { all[0] }
        })
    }

    /// What the reference is rendered with: a scene's own settings, but by the integrator that leaves out least, with
    /// the most samples that are tried, and no fewer bounces, no higher contribution, no lower limits and no coarser filter than
    /// is tried.
    pub fn reference(&self, own: Settings) -> Settings {
        let (samples, spp) = self.samples[0];
        let transport = Transport {
            integrator: self.integrators[0],
            roulette: own.transport.roulette.max(self.roulettes[0]),
            clamp: if limit(own.transport.clamp) > limit(self.clamps[0]) {
                own.transport.clamp
            } else {
                self.clamps[0]
            },
            ..own.transport
        };
        let is_spectral = own.spectral || self.spectral[0] == Some(true);
        Settings {
            samples,
            spp,
            bounces: own.bounces.max(self.bounces[0]),
            min_contribution: own.min_contribution.min(self.min_contributions[0]),
            filter: if lost(own.filter) < lost(self.filters[0]) { own.filter } else { self.filters[0] },
            spectral: is_spectral && transport.integrator == Integrator::Path,
            caustics: if transport.integrator == Integrator::Path {
                own.caustics.max(self.caustics[0].unwrap_or(0.0))
            } else {
                0.0
            },
            transport,
            ..own
        }
    }

    /// The most samples of a pixel.
    pub fn most_samples(&self) -> u32 {
        a_pixel(self.samples[0])
    }
}

/// How many samples that is, of a pixel.
fn a_pixel((edge, spp): (u32, u32)) -> u32 {
    if spp > 0 { spp } else { edge * edge }
}

/// The order of what filters lose of a texture. Many samples of a pixel make up for what bilinear leaves to them.
fn lost(filter: Filter) -> u32 {
    match filter {
        Filter::Mipmap => 0,
        Filter::Bilinear => 1,
        Filter::Nearest => 2,
    }
}

/// What a clamp lets pass.
fn limit(clamp: f32) -> f32 {
    if clamp > 0.0 { clamp } else { f32::INFINITY }
}

/// 0, 1 and further powers of two below a limit.
fn halvings(limit: u32) -> impl Iterator<Item = u32> {
    let powers = std::iter::successors(Some(1u32), |n| n.checked_mul(2));
    std::iter::once(0).chain(powers).take_while(move |&n| n < limit)
}

/// Contributions above the least, up to the whole pixel.
fn contributions(least: f32) -> impl Iterator<Item = f32> {
    let first = if least > 0.0 { least * STEP } else { LEAST };
    std::iter::successors(Some(first), |share| Some(share * STEP)).take(CONTRIBUTIONS - 1).take_while(|&x| x <= 1.0)
}
