//! Qualities of a hierarchy, by name.

use eyerays_bvh::Quality;

use crate::choice::choices;

choices! {
    /// Quality of the hierarchy: a better one takes longer to build and is faster to trace.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Bvh {
        /// Soon built, of whole triangles
        Fast = "fast",
        /// Between the two
        #[default]
        Medium = "medium",
        /// Soon traced
        High = "high",
        /// Built by the GPU that renders, soonest of large scenes; slower traced
        Device = "device",
    }
}

impl Bvh {
    /// Those that the host builds.
    pub const OF_HOST: [Bvh; 3] = [Bvh::Fast, Bvh::Medium, Bvh::High];

    /// What is built.
    pub fn quality(self) -> Quality {
        match self {
            Bvh::Fast => Quality::Fast,
            Bvh::Medium => Quality::Medium,
            Bvh::High => Quality::High,
            Bvh::Device => Quality::Linear,
        }
    }
}
