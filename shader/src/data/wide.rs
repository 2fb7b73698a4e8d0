//! Nodes of eight children.

use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// Eight siblings in 80 bytes, their boxes quantised to a grid (Ylitie, Karras and Laine 2017: CWBVH).
///
/// A box of child `i` lies between `origin + low[i] * 2^e` and `origin + high[i] * 2^e` on each axis.
/// Quantised boxes are wider than what they hold by at least [`WideNode::MARGIN`], which covers the
/// rounding of a box test that scales the grid instead of the box; see `traverse::wide`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct WideNode {
    /// The grid's origin; a byte an axis is the biased exponent of its step 2^e, x in the lowest; bit
    /// 24 + `i` tells that child `i` is an inner node.
    pub grid: UVec4,
    /// Number of the first inner child, whose siblings follow in the order of their slots; the first
    /// triangle; then a byte a child, see [`WideNode::INNER`].
    pub children: UVec4,
    /// A byte a child: low x in the first two words, low y in the last two.
    pub low_x_low_y: UVec4,
    /// Low z, high x.
    pub low_z_high_x: UVec4,
    /// High y, high z.
    pub high_y_high_z: UVec4,
}

impl WideNode {
    /// Children of a node.
    pub const ARITY: usize = 8;
    /// The most triangles of a child.
    pub const MAX_LEAF: u32 = 3;
    /// In a child's byte: 0 for no child; `INNER + 24 + i` for an inner node at slot `i`; else the first
    /// triangle's place behind the node's first in bits 0 to 4, and a bit set from bit 5 on for each of
    /// its triangles.
    pub const INNER: u32 = 1 << 5;
    /// How much wider than a child its quantised box is at least, on every side.
    pub const MARGIN: f32 = 1.0 / (1 << 19) as f32;
}
