//! Qualities of a hierarchy, by name.

use eyerays_bvh::Quality;

use crate::choice::choices;

choices! {
    /// Quality of the hierarchy: a better one takes longer to build and is faster to trace.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Bvh {
        /// Soon built
        Fast = "fast",
        /// Between the two
        #[default]
        Medium = "medium",
        /// Soon traced
        High = "high",
    }
}

impl Bvh {
    /// What is built.
    pub fn quality(self) -> Quality {
        match self {
            Bvh::Fast => Quality::Fast,
            Bvh::Medium => Quality::Medium,
            Bvh::High => Quality::High,
        }
    }
}
