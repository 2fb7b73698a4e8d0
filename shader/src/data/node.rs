//! References to nodes, and pairs of them.

use super::pack;
use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

/// A reference to a node: a pair of children, or a run of primitives.
///
/// Bits 0 to 2 count the primitives of a leaf (1 to [`MAX_LEAF`](super::MAX_LEAF)), 0 for an inner node; bits 3 to 31
/// are the index of the child pair or of the first primitive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct NodeRef(pub u32);

impl NodeRef {
    /// The largest index a reference holds.
    pub const MAX_INDEX: u32 = (1 << 29) - 1;
    /// The pair that traversal starts with.
    pub const ROOT: NodeRef = NodeRef(0);
    /// No node. It counts as a leaf, so that loops until a leaf end there.
    pub const NONE: NodeRef = NodeRef(u32::MAX);

    /// The inner node whose children are pair `pair`.
    #[inline(always)]
    pub fn inner(pair: u32) -> Self {
        NodeRef(pair << 3)
    }

    /// The leaf of `count` primitives from `first` on.
    #[inline(always)]
    pub fn leaf(first: u32, count: u32) -> Self {
        NodeRef((first << 3) | count)
    }

    /// Is this a run of primitives?
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & 7 != 0
    }

    /// The child pair, or the first primitive of the run.
    #[inline(always)]
    pub fn index(self) -> u32 {
        self.0 >> 3
    }

    /// How many triangles a leaf has left; 0 for an inner node.
    #[inline(always)]
    pub fn count(self) -> u32 {
        self.0 & 7
    }

    /// The same run without its first triangle; `count() == 0` once it is used up.
    #[inline(always)]
    pub fn rest(self) -> Self {
        NodeRef(self.0.wrapping_add(8 - 1))
    }
}

/// The boxes of two siblings in one 64-byte block (thesis figure 6.1). A leaf's box bounds its
/// triangles' own boxes ([`Primitive::bounds`](super::Primitive::bounds)), an inner node's box bounds its children's.
///
/// A tree of one triangle has one pair, whose right child is [`NodePair::EMPTY`].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct NodePair {
    /// Least corner of the left box, and the left [`NodeRef`].
    pub left_min: UVec4,
    /// Greatest corner of the left box; the integer is 0.
    pub left_max: UVec4,
    /// Least corner of the right box, and the right [`NodeRef`].
    pub right_min: UVec4,
    /// Greatest corner of the right box; the integer is 0.
    pub right_max: UVec4,
}

impl NodePair {
    /// The right child of a tree of one triangle: a point outside the scene. Its reference is the
    /// first triangle, so that a ray that does hit it finds nothing new.
    pub const EMPTY: (Vec3, Vec3, NodeRef) = (Vec3::splat(2.0), Vec3::splat(2.0), NodeRef(1));

    /// A pair of (least corner, greatest corner, reference).
    pub fn new(left: (Vec3, Vec3, NodeRef), right: (Vec3, Vec3, NodeRef)) -> Self {
        NodePair {
            left_min: pack(left.0, left.2.0),
            left_max: pack(left.1, 0),
            right_min: pack(right.0, right.2.0),
            right_max: pack(right.1, 0),
        }
    }

    /// The left child's reference.
    #[inline(always)]
    pub fn left(&self) -> NodeRef {
        NodeRef(self.left_min.w)
    }

    /// The right child's reference.
    #[inline(always)]
    pub fn right(&self) -> NodeRef {
        NodeRef(self.right_min.w)
    }
}

/// The boxes of two siblings as kernels test them: by centre and half their extent, which saves a minimum
/// and a maximum an axis, each as expensive on a GPU as two additions.
///
/// This test rounds differently from that of a triangle's own box, so these boxes are wider than their
/// contents by [`CentredPair::MARGIN`]; see `traverse::step`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct CentredPair {
    /// Centre of the left box, and the left [`NodeRef`].
    pub left_centre: UVec4,
    /// Half the left box's extent; the integer is 0.
    pub left_half: UVec4,
    /// Centre of the right box, and the right [`NodeRef`].
    pub right_centre: UVec4,
    /// Half the right box's extent; the integer is 0.
    pub right_half: UVec4,
}

impl CentredPair {
    /// How much wider than its contents a box is at least, on every side.
    pub const MARGIN: f32 = 1.0 / (1 << 19) as f32;

    /// The left child's reference.
    #[inline(always)]
    pub fn left(&self) -> NodeRef {
        NodeRef(self.left_centre.w)
    }

    /// The right child's reference.
    #[inline(always)]
    pub fn right(&self) -> NodeRef {
        NodeRef(self.right_centre.w)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl From<&NodePair> for CentredPair {
    fn from(pair: &NodePair) -> Self {
        let (left_centre, left_half) = centred(pair.left_min, pair.left_max);
        let (right_centre, right_half) = centred(pair.right_min, pair.right_max);
        CentredPair { left_centre, left_half, right_centre, right_half }
    }
}

/// Centre and half the extent of a box, the latter rounded up, and wider by the margin.
#[cfg(not(target_arch = "spirv"))]
fn centred(least: UVec4, greatest: UVec4) -> (UVec4, UVec4) {
    let (low, high) = (super::numbers(least), super::numbers(greatest));
    let centre = (low + high) * 0.5;
    let half = |low: f32, high: f32, centre: f32| {
        let centre = f64::from(centre);
        let reach = (f64::from(high) - centre).max(centre - f64::from(low)) + f64::from(CentredPair::MARGIN);
        // Adds more than the conversion may round off.
        (reach as f32) * (1.0 + f32::EPSILON)
    };
    let half = Vec3::new(half(low.x, high.x, centre.x), half(low.y, high.y, centre.y), half(low.z, high.z, centre.z));
    (pack(centre, least.w), pack(half, 0))
}
