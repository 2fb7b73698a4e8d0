//! Kinds of rays.

use serde::Serialize;

use eyerays::method::Coherence;
use eyerays::stream::Question;

/// What rays are for (thesis 7.2 and 7.3, and the two kinds of today's benchmarks).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, clap::ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Through the pixels' centres
    Primary,
    /// From every hit to each light that it faces
    Shadow,
    /// Mirrored at every hit, as if all were mirrors
    Reflection,
    /// Through every hit, as if all were glass; none where all is reflected
    Refraction,
    /// Ambient occlusion: four short rays from every hit, by the cosine
    Ao,
    /// One ray from every hit, by the cosine, as far as it goes
    Diffuse,
}

impl Kind {
    /// Every kind, in the order of tables and hashes.
    pub const ALL: [Kind; 6] =
        [Kind::Primary, Kind::Shadow, Kind::Reflection, Kind::Refraction, Kind::Ao, Kind::Diffuse];

    /// What these rays are asked.
    pub fn question(self) -> Question {
        match self {
            Kind::Shadow | Kind::Ao => Question::Occlusion,
            Kind::Primary | Kind::Reflection | Kind::Refraction | Kind::Diffuse => Question::Closest,
        }
    }

    /// How alike neighbours are.
    pub fn coherence(self) -> Coherence {
        match self {
            Kind::Primary => Coherence::Primary,
            Kind::Shadow => Coherence::Shadow,
            Kind::Reflection | Kind::Refraction => Coherence::Secondary,
            Kind::Ao | Kind::Diffuse => Coherence::Scattered,
        }
    }

    /// As the command line spells it.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Primary => "primary",
            Kind::Shadow => "shadow",
            Kind::Reflection => "reflection",
            Kind::Refraction => "refraction",
            Kind::Ao => "ao",
            Kind::Diffuse => "diffuse",
        }
    }
}
