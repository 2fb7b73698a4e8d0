//! How much effort a build makes.

use eyerays_shader::data::MAX_LEAF;
use obvhs::{BvhBuildParams, ploc::SortPrecision};

/// Build time against traversal time.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Quality {
    /// For scenes that are traced once: the tree that splits triangles as it was grown; where none are split, clustering of
    /// direct neighbours and hardly any reinsertion.
    Fast,
    /// For most scenes.
    #[default]
    Medium,
    /// For scenes that are traced many times: every node is a candidate for reinsertion.
    High,
}

impl Quality {
    /// Which share of the nodes of a tree that splits triangles the first pass of reinsertion tries.
    pub(crate) fn reinsertion(self) -> f32 {
        match self {
            Quality::Fast => 0.0,
            Quality::Medium => 0.1,
            Quality::High => 1.0,
        }
    }

    /// The preset of obvhs that comes closest, within the limits of our nodes.
    pub(crate) fn parameters(self) -> BvhBuildParams {
        let preset = match self {
            Quality::Fast => BvhBuildParams::very_fast_build(),
            Quality::Medium => BvhBuildParams::medium_build(),
            Quality::High => BvhBuildParams::very_slow_build(),
        };
        BvhBuildParams {
            pre_split: false,
            // 21 bits an axis resolve the normalised scene down to the padding of its boxes.
            sort_precision: SortPrecision::U64,
            max_prims_per_leaf: MAX_LEAF,
            // As leaves of split triangles are put together.
            collapse_traversal_cost: 1.0,
            ..preset
        }
    }
}
