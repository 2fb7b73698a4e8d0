//! One way to render a scene.

use serde::Serialize;

use crate::preset::{Preset, name, named};
use eyerays::method::{Layout, Method, Traversal, TriangleTest};
use eyerays::quality::Bvh;
use eyerays::render::{DeviceWish, Precision};
use eyerays::scene::{Filter, Integrator, Sampler, Settings, Transport};

/// A value on each [`Axis`](super::Axis).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Setting {
    /// How numbers are computed.
    #[serde(serialize_with = "named")]
    pub precision: Precision,
    /// How a ray is tested against a triangle.
    #[serde(serialize_with = "named")]
    pub triangle: TriangleTest,
    /// How rays are followed.
    #[serde(serialize_with = "named")]
    pub method: Method,
    /// How the hierarchy and its triangles lie in memory.
    #[serde(serialize_with = "named")]
    pub layout: Layout,
    /// Quality of the hierarchy.
    #[serde(serialize_with = "named")]
    pub bvh: Bvh,
    /// How light is carried.
    #[serde(serialize_with = "named")]
    pub integrator: Integrator,
    /// Where in a pixel its samples lie.
    #[serde(serialize_with = "named")]
    pub sampler: Sampler,
    /// How textures are filtered.
    #[serde(serialize_with = "named")]
    pub filter: Filter,
    /// Is light of single wavelengths followed, where the scene says so?
    pub spectral: Option<bool>,
    /// Photons for each pixel that tell of caustics, where the scene has some.
    pub caustics: Option<f32>,
    /// Samples along a pixel's edge, 1 where `spp` counts.
    pub samples: u32,
    /// Samples of a pixel; 0 for the square of `samples`.
    pub spp: u32,
    /// The most times a ray is followed on.
    pub bounces: u32,
    /// A ray whose every weight is less is not followed.
    pub min_contribution: f32,
    /// Bounces before Russian roulette may end a path.
    pub roulette: u32,
    /// The most that light adds to a sample which was scattered more than once, 0 for no limit.
    pub clamp: f32,
}

impl Setting {
    /// What `eyerays render` takes for a scene's own settings, where nothing else is asked for.
    pub fn of(own: &Settings) -> Setting {
        Setting {
            precision: Precision::default(),
            triangle: TriangleTest::default(),
            method: Method::default(),
            layout: Layout::default(),
            bvh: Bvh::default(),
            integrator: own.transport.integrator,
            sampler: own.sampler,
            filter: own.filter,
            spectral: own.spectral.then_some(true),
            caustics: (own.caustics > 0.0).then_some(own.caustics),
            samples: if own.spp > 0 { 1 } else { own.samples },
            spp: own.spp,
            bounces: own.bounces,
            min_contribution: own.min_contribution,
            roulette: own.transport.roulette,
            clamp: own.transport.clamp,
        }
    }

    /// How it follows rays, with what else there is to a traversal.
    pub fn traversal(&self, rest: Traversal) -> Traversal {
        Traversal { method: self.method, triangle: self.triangle, layout: self.layout, ..rest }
    }

    /// A scene's own settings with these instead.
    pub fn settings(&self, own: Settings) -> Settings {
        let Setting {
            integrator,
            sampler,
            filter,
            spectral,
            caustics,
            samples,
            spp,
            bounces,
            min_contribution,
            roulette,
            clamp,
            ..
        } = *self;
        let transport = Transport { integrator, roulette, clamp, ..own.transport };
        // Paths alone carry wavelengths.
        let spectral = spectral.unwrap_or(own.spectral) && integrator == Integrator::Path;
        let caustics = if integrator == Integrator::Path { caustics.unwrap_or(own.caustics) } else { 0.0 };
        Settings { samples, spp, sampler, filter, bounces, min_contribution, spectral, caustics, transport, ..own }
    }

    /// Can the sampler place so many samples?
    pub fn is_possible(&self) -> bool {
        self.settings(Settings::default()).grid().is_ok()
    }

    /// With the values of another one where its own make no difference.
    pub fn plain(self, base: &Setting) -> Setting {
        let (integrator, follows) = (self.integrator, self.bounces > 0);
        let is = |matters: bool, own: f32, other: f32| if matters { own } else { other };
        Setting {
            spectral: if integrator == Integrator::Path { self.spectral } else { base.spectral },
            caustics: if follows && integrator == Integrator::Path { self.caustics } else { base.caustics },
            bounces: if integrator == Integrator::Ao { base.bounces } else { self.bounces },
            min_contribution: is(follows && has_tree(integrator), self.min_contribution, base.min_contribution),
            roulette: if follows && integrator == Integrator::Path { self.roulette } else { base.roulette },
            clamp: is(follows && integrator.chooses_lights(), self.clamp, base.clamp),
            ..self
        }
    }

    /// As a file keeps it.
    pub fn preset(&self, device: DeviceWish) -> Preset {
        Preset {
            device: Some(device),
            precision: Some(self.precision),
            triangle: Some(self.triangle),
            method: Some(self.method),
            layout: Some(self.layout),
            bvh: Some(self.bvh),
            integrator: Some(self.integrator),
            sampler: Some(self.sampler),
            filter: Some(self.filter),
            spectral: self.spectral.filter(|_| self.integrator == Integrator::Path),
            caustics: self.caustics.filter(|_| self.integrator == Integrator::Path),
            // As the scene or the integrator says.
            pixel_filter: None,
            samples: (self.spp == 0).then_some(self.samples),
            spp: (self.spp > 0).then_some(self.spp),
            bounces: Some(self.bounces),
            min_contribution: Some(self.min_contribution),
            roulette: Some(self.roulette),
            clamp: Some(self.clamp),
        }
    }

    /// Where it differs from another one, in words: `fast, packet, 2x2 samples`; `as it is` if nowhere.
    pub fn beside(&self, other: &Setting) -> String {
        let counted = |n: u32, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
        let samples = match self.spp {
            0 => format!("{}x{}", self.samples, counted(self.samples, "sample")),
            spp => counted(spp, "sample"),
        };
        let roulette = match self.roulette {
            Settings::MOST_BOUNCES => "no roulette".to_owned(),
            bounces => format!("roulette after {}", counted(bounces, "bounce")),
        };
        let words = [
            (self.precision != other.precision, name(self.precision)),
            (self.triangle != other.triangle, name(self.triangle)),
            (self.method != other.method, name(self.method)),
            (self.layout != other.layout, name(self.layout)),
            (self.bvh != other.bvh, format!("BVH {}", name(self.bvh))),
            (self.integrator != other.integrator, name(self.integrator)),
            (self.sampler != other.sampler, name(self.sampler)),
            (self.filter != other.filter, name(self.filter)),
            (self.spectral != other.spectral, wavelengths(self.spectral).to_owned()),
            (self.caustics != other.caustics, photons(self.caustics)),
            ((self.samples, self.spp) != (other.samples, other.spp), samples),
            (self.bounces != other.bounces, counted(self.bounces, "bounce")),
            (self.min_contribution != other.min_contribution, format!("contribution {}", share(self.min_contribution))),
            (self.roulette != other.roulette, roulette),
            (self.clamp != other.clamp, clamp(self.clamp)),
        ];
        let words: Vec<String> = words.into_iter().filter(|(differs, _)| *differs).map(|(_, word)| word).collect();
        if words.is_empty() { "as it is".to_owned() } else { words.join(", ") }
    }

    /// The options of `eyerays render` that ask for it, without those that make no difference to its integrator.
    pub fn options(&self) -> String {
        let mut words = vec![
            ("precision", name(self.precision)),
            ("triangle", name(self.triangle)),
            ("method", name(self.method)),
            ("layout", name(self.layout)),
            ("bvh", name(self.bvh)),
            ("integrator", name(self.integrator)),
            ("sampler", name(self.sampler)),
            ("filter", name(self.filter)),
            if self.spp > 0 { ("spp", self.spp.to_string()) } else { ("samples", self.samples.to_string()) },
            ("bounces", self.bounces.to_string()),
        ];
        if has_tree(self.integrator) {
            words.push(("min-contribution", self.min_contribution.to_string()));
        }
        if self.integrator == Integrator::Path {
            words.push(("roulette", self.roulette.to_string()));
        }
        if self.integrator.chooses_lights() {
            words.push(("clamp", self.clamp.to_string()));
        }
        let mut options: Vec<String> = words.iter().map(|(option, word)| format!("--{option} {word}")).collect();
        if let Some(is_spectral) = self.spectral.filter(|_| self.integrator == Integrator::Path) {
            options.push(format!("--spectral={is_spectral}"));
        }
        if let Some(caustics) = self.caustics.filter(|_| self.integrator == Integrator::Path) {
            options.push(format!("--caustics={caustics}"));
        }
        options.join(" ")
    }
}

/// Does it follow mirrored and refracted rays by what they contribute at least?
pub(super) fn has_tree(integrator: Integrator) -> bool {
    matches!(integrator, Integrator::Whitted | Integrator::Distributed)
}

/// What light is followed.
fn wavelengths(spectral: Option<bool>) -> &'static str {
    if spectral == Some(true) { "single wavelengths" } else { "red, green and blue" }
}

/// How many photons, in words.
fn photons(caustics: Option<f32>) -> String {
    match caustics {
        Some(photons) if photons > 0.0 => format!("{photons} photons a pixel"),
        _ => "caustics by chance".to_owned(),
    }
}

/// A clamp in words.
pub(super) fn clamp(most: f32) -> String {
    if most == 0.0 { "no clamp".to_owned() } else { format!("clamp {most}") }
}

/// A share of a pixel as a fraction where it is a plain one.
fn share(x: f32) -> String {
    let parts = 1.0 / x;
    if parts.is_finite() && parts > 1.0 && parts.fract() == 0.0 { format!("1/{parts}") } else { x.to_string() }
}
