//! Nodes of eight children.

use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// Eight siblings in 80 bytes, their boxes quantised to a grid (Ylitie, Karras and Laine 2017: CWBVH).
///
/// A box of child `i` lies between `origin + low[i] * step` and `origin + high[i] * step` on each axis.
/// Quantised boxes are wider than their contents by at least [`CwbvhNode::MARGIN`] and [`CwbvhNode::SLACK`] of a
/// step, which cover the rounding of a box test that scales the grid instead of the box; see `traverse::cwbvh`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct CwbvhNode {
    /// The grid's origin; a byte an axis is the biased exponent of 256 steps, x in the lowest; bit
    /// 24 + `i` tells that child `i` is an inner node.
    pub grid: UVec4,
    /// Number of the first inner child, whose siblings follow in the order of their slots; the first
    /// triangle; as many of bits 3 `i` to 3 `i` + 2 as child `i` has triangles, which follow each other in the
    /// order of their bits; unused.
    pub children: UVec4,
    /// Planes of four children a word, see [`CwbvhNode::TURN`]: low x in the first two words, low y in the last two.
    pub low_x_low_y: UVec4,
    /// Low z, high x.
    pub low_z_high_x: UVec4,
    /// High y, high z.
    pub high_y_high_z: UVec4,
}

impl CwbvhNode {
    /// Children of a node.
    pub const ARITY: usize = 8;
    /// The most triangles of a child.
    pub const MAX_LEAF: u32 = 3;
    /// A word of planes is four bytes, that of the first child the lowest, rotated left by so many bits: two of them
    /// lie within the fraction of a single, and the other two if it is rotated by half.
    pub const TURN: u32 = 7;
    /// How much wider than a child its quantised box is at least, on every side.
    pub const MARGIN: f32 = 1.0 / (1 << 19) as f32;
    /// Additional margin, as a share of a step.
    pub const SLACK: f32 = 1.0 / 64.0;
}
