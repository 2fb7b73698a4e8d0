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

    /// What is worth building for a picture of so many rays in a scene of so many primitives. Conference and Sibenik (282,801 and 80,054
    /// triangles, two cores) are traced 5 to 10 % sooner by `medium` and built 0.1 s later, which is even at 20 to 70 rays a triangle; on a
    /// GPU (an H200, ten million triangles) at some 750.
    pub fn worth(primitives: u64, rays: u64, on_cpu: bool) -> Bvh {
        let even = if on_cpu { 32 } else { 512 };
        if rays < primitives.saturating_mul(even) { Bvh::Fast } else { Bvh::Medium }
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_of_few_rays_is_not_worth_a_good_hierarchy() {
        assert_eq!(Bvh::worth(10_000_000, 4_000_000, false), Bvh::Fast);
        assert_eq!(Bvh::worth(10_000_000, 6_000_000_000, false), Bvh::Medium);
        assert_eq!([true, false].map(|on_cpu| Bvh::worth(1000, 100_000, on_cpu)), [Bvh::Medium, Bvh::Fast]);
        assert_eq!(Bvh::worth(u64::MAX, 1 << 40, true), Bvh::Fast);
    }
}
