//! The parts of a setting.

use super::Setting;

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
    /// How light is carried.
    Integrator,
    /// Where in a pixel its samples lie.
    Sampler,
    /// How textures are filtered.
    Filter,
    /// Whether light has wavelengths.
    Spectral,
    /// How many photons tell of caustics.
    Caustics,
    /// The number of samples.
    Samples,
    /// The limit of bounces.
    Bounces,
    /// The least contribution.
    MinContribution,
    /// Bounces before Russian roulette.
    Roulette,
    /// The most that light adds to a sample.
    Clamp,
}

impl Axis {
    /// All of them.
    pub const ALL: [Axis; 14] = [
        Axis::Arithmetic,
        Axis::Method,
        Axis::Layout,
        Axis::Bvh,
        Axis::Integrator,
        Axis::Sampler,
        Axis::Filter,
        Axis::Spectral,
        Axis::Caustics,
        Axis::Samples,
        Axis::Bounces,
        Axis::MinContribution,
        Axis::Roulette,
        Axis::Clamp,
    ];
    /// Those that leave a picture as it is: the fastest value is the best one.
    pub const FREE: [Axis; 3] = [Axis::Method, Axis::Layout, Axis::Bvh];

    /// Those that trade accuracy for speed.
    pub fn trading() -> impl Iterator<Item = Axis> {
        Axis::ALL.into_iter().filter(|axis| !Axis::FREE.contains(axis))
    }

    /// `setting` with the value that `other` has on this axis.
    pub fn taken(self, setting: Setting, other: &Setting) -> Setting {
        match self {
            Axis::Arithmetic => Setting { precision: other.precision, triangle: other.triangle, ..setting },
            Axis::Method => Setting { method: other.method, ..setting },
            Axis::Layout => Setting { layout: other.layout, ..setting },
            Axis::Bvh => Setting { bvh: other.bvh, ..setting },
            Axis::Integrator => Setting { integrator: other.integrator, ..setting },
            Axis::Sampler => Setting { sampler: other.sampler, ..setting },
            Axis::Filter => Setting { filter: other.filter, ..setting },
            Axis::Spectral => Setting { spectral: other.spectral, ..setting },
            Axis::Caustics => Setting { caustics: other.caustics, ..setting },
            Axis::Samples => Setting { samples: other.samples, spp: other.spp, ..setting },
            Axis::Bounces => Setting { bounces: other.bounces, ..setting },
            Axis::MinContribution => Setting { min_contribution: other.min_contribution, ..setting },
            Axis::Roulette => Setting { roulette: other.roulette, ..setting },
            Axis::Clamp => Setting { clamp: other.clamp, ..setting },
        }
    }
}
