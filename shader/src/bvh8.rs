//! The wide hierarchy as a CPU's vectors load it: boxes in full precision and triangles, as structures of arrays, with
//! nothing to decode or to shuffle. The same triangles have the same indices as in the other hierarchies.

use crate::data::Triangle;

/// Eight siblings. A box is wider than the triangles' own boxes below it by [`Bvh8Node::MARGIN`] on every side.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Bvh8Node {
    /// For each axis the lower planes of all children, then the upper ones.
    pub planes: [[[f32; 8]; 2]; 3],
    /// The children, the larger first, see `traverse::bvh8`.
    pub children: [Bvh8Ref; 8],
}

impl Bvh8Node {
    /// How much wider than its contents a box is at least, except for one rounding of the plane.
    pub const MARGIN: f32 = 1.0 / (1 << 19) as f32;
    /// A pair of planes that no ray is between: the box of a missing child.
    pub const NOWHERE: [f32; 2] = [4.0, -4.0];
    /// No child, no triangle.
    pub const EMPTY: Bvh8Node =
        Bvh8Node { planes: [[[Self::NOWHERE[0]; 8], [Self::NOWHERE[1]; 8]]; 3], children: [Bvh8Ref(0); 8] };
}

/// A reference to a node, or to a leaf: up to four triangles.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(transparent)]
pub struct Bvh8Ref(pub u32);

impl Bvh8Ref {
    const LEAF: u32 = 1 << 31;
    /// The node that a traversal starts with.
    pub const ROOT: Bvh8Ref = Bvh8Ref(0);

    /// The node of this number.
    pub fn inner(node: u32) -> Self {
        Bvh8Ref(node)
    }

    /// The leaf of the [`Triangle4`] of this number.
    pub fn leaf(block: u32) -> Self {
        Bvh8Ref(block | Self::LEAF)
    }

    /// Is this a leaf?
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// The number of the node or of the [`Triangle4`].
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }
}

/// Up to four triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(16))]
pub struct Triangle4 {
    /// By vertex and axis a coordinate of each triangle; NaN, which is never hit, where there is none.
    pub vertices: [[[f32; 4]; 3]; 3],
    /// The index of each triangle.
    pub triangle_indices: [u32; 4],
}

impl Triangle4 {
    /// The most triangles.
    pub const TRIANGLES: usize = 4;
    /// No triangle.
    pub const EMPTY: Triangle4 = Triangle4 { vertices: [[[f32::NAN; 4]; 3]; 3], triangle_indices: [0; 4] };

    /// Triangles, each with its index.
    ///
    /// # Panics
    /// If there are more than [`Triangle4::TRIANGLES`].
    pub fn of<'t>(triangles: impl Iterator<Item = (u32, &'t Triangle)>) -> Self {
        let mut block = Triangle4::EMPTY;
        for (lane, (index, triangle)) in triangles.enumerate() {
            for (vertex, place) in triangle.vertices().iter().enumerate() {
                for axis in 0..3 {
                    block.vertices[vertex][axis][lane] = place[axis];
                }
            }
            block.triangle_indices[lane] = index;
        }
        block
    }
}

/// A borrowed hierarchy. Empty unless the traversal method needs it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bvh8View<'a> {
    /// Nodes, the root first.
    pub nodes: &'a [Bvh8Node],
    /// The triangles of leaves.
    pub blocks: &'a [Triangle4],
}
