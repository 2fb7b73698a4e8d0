//! What is tried.

use glam::Vec3;

use super::Setting;
use eyerays::method::{Layout, Method, TriangleTest};
use eyerays::quality::Bvh;
use eyerays::render::Precision;
use eyerays::scene::{Material, Scene, Settings};

/// Samples along a pixel's edge that are tried unless others are asked for.
const SAMPLES: [u32; 3] = [4, 2, 1];
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
    /// Samples along a pixel's edge, the most first.
    pub samples: Vec<u32>,
    /// Limits of bounces, the highest first.
    pub bounces: Vec<u32>,
    /// Least contributions, the lowest first.
    pub min_contributions: Vec<f32>,
}

/// A part of a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Precision with its triangle test.
    Arithmetic,
    /// How rays are followed.
    Method,
    /// How the hierarchy and its triangles lie in memory.
    Layout,
    /// Quality of the hierarchy.
    Bvh,
    /// Samples along a pixel's edge.
    Samples,
    /// The limit of bounces.
    Bounces,
    /// The least contribution.
    MinContribution,
}

impl Axis {
    /// All of them.
    pub const ALL: [Axis; 7] =
        [Axis::Arithmetic, Axis::Method, Axis::Layout, Axis::Bvh, Axis::Samples, Axis::Bounces, Axis::MinContribution];
    /// Those that leave a picture as it is: the fastest value is the best one.
    pub const FREE: [Axis; 3] = [Axis::Method, Axis::Layout, Axis::Bvh];
    /// Those that trade accuracy for speed.
    pub const TRADING: [Axis; 4] = [Axis::Arithmetic, Axis::Samples, Axis::Bounces, Axis::MinContribution];

    /// `setting` with the value that `other` has on this axis.
    pub fn taken(self, setting: Setting, other: &Setting) -> Setting {
        match self {
            Axis::Arithmetic => Setting { precision: other.precision, triangle: other.triangle, ..setting },
            Axis::Method => Setting { method: other.method, ..setting },
            Axis::Layout => Setting { layout: other.layout, ..setting },
            Axis::Bvh => Setting { bvh: other.bvh, ..setting },
            Axis::Samples => Setting { samples: other.samples, ..setting },
            Axis::Bounces => Setting { bounces: other.bounces, ..setting },
            Axis::MinContribution => Setting { min_contribution: other.min_contribution, ..setting },
        }
    }
}

impl Axes {
    /// What is tried of a scene with these settings of its own. Only where rays are followed on does it matter
    /// how often.
    pub fn of(scene: &Scene, own: &Settings) -> Axes {
        let followed = |m: &Material| m.reflection != Vec3::ZERO || m.transmission != Vec3::ZERO;
        let fast = [TriangleTest::Watertight, TriangleTest::Moller].map(|test| (Precision::Fast, test));
        let mut axes = Axes {
            arithmetic: [&[(Precision::Exact, TriangleTest::Watertight)], &fast[..]].concat(),
            methods: [&[Method::Auto], &Method::ALL[..]].concat(),
            layouts: vec![Layout::Gathered, Layout::Indexed, Layout::Compact],
            bvhs: vec![Bvh::Medium, Bvh::Fast, Bvh::High],
            samples: [&[own.samples], &SAMPLES[..]].concat(),
            bounces: vec![own.bounces],
            min_contributions: vec![own.min_contribution],
        };
        if scene.materials.iter().any(followed) {
            axes.bounces.extend(halvings(own.bounces));
            axes.min_contributions.extend(contributions(own.min_contribution));
        }
        axes.sort();
        axes
    }

    /// Puts what can be ordered into the order of accuracy, each value once.
    pub fn sort(&mut self) {
        self.samples.sort_unstable_by(|a, b| b.cmp(a));
        self.bounces.sort_unstable_by(|a, b| b.cmp(a));
        self.min_contributions.sort_unstable_by(f32::total_cmp);
        self.samples.dedup();
        self.bounces.dedup();
        self.min_contributions.dedup();
    }

    /// `setting` with every value on an axis.
    pub fn along(&self, axis: Axis, setting: Setting) -> Vec<Setting> {
        match axis {
            Axis::Arithmetic => {
                let with = |&(precision, triangle): &_| Setting { precision, triangle, ..setting };
                self.arithmetic.iter().map(with).collect()
            }
            Axis::Method => self.methods.iter().map(|&method| Setting { method, ..setting }).collect(),
            Axis::Layout => self.layouts.iter().map(|&layout| Setting { layout, ..setting }).collect(),
            Axis::Bvh => self.bvhs.iter().map(|&bvh| Setting { bvh, ..setting }).collect(),
            Axis::Samples => self.samples.iter().map(|&samples| Setting { samples, ..setting }).collect(),
            Axis::Bounces => self.bounces.iter().map(|&bounces| Setting { bounces, ..setting }).collect(),
            Axis::MinContribution => {
                self.min_contributions.iter().map(|&share| Setting { min_contribution: share, ..setting }).collect()
            }
        }
    }

    /// The setting that others are compared with: a scene's own, but where that is not tried the first value.
    pub fn base(&self, own: Setting) -> Setting {
        Axis::ALL.into_iter().fold(own, |base, axis| {
            let all = self.along(axis, base);
            if all.contains(&base) { base } else { all[0] }
        })
    }

    /// What the reference is rendered with: a scene's own settings, but the most samples that are tried, and
    /// no fewer bounces and no higher contribution than is tried.
    pub fn reference(&self, own: Settings) -> Settings {
        Settings {
            samples: self.samples[0],
            bounces: own.bounces.max(self.bounces[0]),
            min_contribution: own.min_contribution.min(self.min_contributions[0]),
            ..own
        }
    }
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
