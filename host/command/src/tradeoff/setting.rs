//! One way to render a scene.

use serde::Serialize;

use crate::preset::{Preset, name, named};
use eyerays::method::{Layout, Method, Traversal, TriangleTest};
use eyerays::quality::Bvh;
use eyerays::render::{DeviceWish, Precision};
use eyerays::scene::Settings;

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
    /// Samples along a pixel's edge.
    pub samples: u32,
    /// The most times a ray is followed on.
    pub bounces: u32,
    /// A ray whose every weight is less is not followed.
    pub min_contribution: f32,
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
            samples: own.samples,
            bounces: own.bounces,
            min_contribution: own.min_contribution,
        }
    }

    /// How it follows rays, with what else there is to a traversal.
    pub fn traversal(&self, rest: Traversal) -> Traversal {
        Traversal { method: self.method, triangle: self.triangle, layout: self.layout, ..rest }
    }

    /// A scene's own settings with these instead.
    pub fn settings(&self, own: Settings) -> Settings {
        Settings { samples: self.samples, bounces: self.bounces, min_contribution: self.min_contribution, ..own }
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
            samples: Some(self.samples),
            bounces: Some(self.bounces),
            min_contribution: Some(self.min_contribution),
        }
    }

    /// Where it differs from another one, in words: `fast, packet, 2x2 samples`; `as it is` if nowhere.
    pub fn beside(&self, other: &Setting) -> String {
        let plural = |n: u32| if n == 1 { "" } else { "s" };
        let words = [
            (self.precision != other.precision, name(self.precision)),
            (self.triangle != other.triangle, name(self.triangle)),
            (self.method != other.method, name(self.method)),
            (self.layout != other.layout, name(self.layout)),
            (self.bvh != other.bvh, format!("BVH {}", name(self.bvh))),
            (self.samples != other.samples, format!("{0}x{0} sample{1}", self.samples, plural(self.samples))),
            (self.bounces != other.bounces, format!("{} bounce{}", self.bounces, plural(self.bounces))),
            (self.min_contribution != other.min_contribution, format!("contribution {}", share(self.min_contribution))),
        ];
        let words: Vec<String> = words.into_iter().filter(|(differs, _)| *differs).map(|(_, word)| word).collect();
        if words.is_empty() { "as it is".to_owned() } else { words.join(", ") }
    }

    /// The options of `eyerays render` that ask for it.
    pub fn options(&self) -> String {
        let words = [
            ("precision", name(self.precision)),
            ("triangle", name(self.triangle)),
            ("method", name(self.method)),
            ("layout", name(self.layout)),
            ("bvh", name(self.bvh)),
            ("samples", self.samples.to_string()),
            ("bounces", self.bounces.to_string()),
            ("min-contribution", self.min_contribution.to_string()),
        ];
        words.map(|(option, word)| format!("--{option} {word}")).join(" ")
    }
}

/// A share of a pixel as a fraction where it is a plain one.
fn share(x: f32) -> String {
    let parts = 1.0 / x;
    if parts.is_finite() && parts > 1.0 && parts.fract() == 0.0 { format!("1/{parts}") } else { x.to_string() }
}
