//! How much effort a build makes.

/// Build time against traversal time.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Quality {
    /// For scenes that are large and soon gone: primitives stay whole, in an order that a device sorts by itself, see
    /// [`linear`](crate::linear).
    Linear,
    /// For scenes that are traced once: primitives stay whole, and the tree as it was grown.
    Fast,
    /// For most scenes: triangles are split, and large nodes moved to where they cost less.
    #[default]
    Medium,
    /// For scenes that are traced many times: triangles are split, and three times as many nodes are tried elsewhere.
    High,
}

impl Quality {
    /// How many references [`split`](crate::split) may add for this quality, as a share of the primitives. A hit does not depend on them.
    pub fn split_budget(self) -> f32 {
        match self {
            Quality::Linear | Quality::Fast => 0.0,
            Quality::Medium | Quality::High => 0.3,
        }
    }

    /// Which share of the nodes of a tree the first pass of reinsertion tries. All of them take three times as long as 0.3 for trees that cost
    /// 0.6 % (Conference) and 1.1 % (Sibenik) less.
    pub(crate) fn reinsertion(self) -> f32 {
        match self {
            Quality::Linear | Quality::Fast => 0.0,
            Quality::Medium => 0.1,
            Quality::High => 0.3,
        }
    }
}
