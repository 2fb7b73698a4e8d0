//! How much effort a build makes.

/// Build time against traversal time.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Quality {
    /// For scenes that are traced once: the tree that splits primitives, as it was grown.
    Fast,
    /// For most scenes: large nodes are moved to where they cost less.
    #[default]
    Medium,
    /// For scenes that are traced many times: every node is tried elsewhere.
    High,
}

impl Quality {
    /// Which share of the nodes of a tree the first pass of reinsertion tries.
    pub(crate) fn reinsertion(self) -> f32 {
        match self {
            Quality::Fast => 0.0,
            Quality::Medium => 0.1,
            Quality::High => 1.0,
        }
    }
}
