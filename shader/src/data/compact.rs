//! Pairs of nodes on a grid.

use super::{CentredPair, pack};
use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

/// The boxes of two siblings in 32 bytes: a [`CentredPair`] on a grid of 2^-15 over [-1, 1].
///
/// Each word has six numbers of 16 bits, the lowest first: a centre (x, y, z), counted from -1, and half an
/// extent; then a [`NodeRef`](super::NodeRef). A box on the grid contains the pair's.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct CompactPair {
    /// The left box and its [`NodeRef`](super::NodeRef).
    pub left: UVec4,
    /// The right box and its [`NodeRef`](super::NodeRef).
    pub right: UVec4,
}

impl CompactPair {
    /// A step of the grid.
    pub const STEP: f32 = 1.0 / (1 << 15) as f32;
}

impl From<CompactPair> for CentredPair {
    /// Exact: every number of the grid is a float.
    #[inline(always)]
    fn from(pair: CompactPair) -> Self {
        let (left_centre, left_half) = from_grid(pair.left);
        let (right_centre, right_half) = from_grid(pair.right);
        CentredPair { left_centre, left_half, right_centre, right_half }
    }
}

#[inline(always)]
fn from_grid(q: UVec4) -> (UVec4, UVec4) {
    let low = |word: u32| (word & 0xffff) as f32 * CompactPair::STEP;
    let high = |word: u32| (word >> 16) as f32 * CompactPair::STEP;
    let centre = Vec3::new(low(q.x) - 1.0, high(q.x) - 1.0, low(q.y) - 1.0);
    (pack(centre, q.w), pack(Vec3::new(high(q.y), low(q.z), high(q.z)), 0))
}

#[cfg(not(target_arch = "spirv"))]
impl From<&CentredPair> for CompactPair {
    fn from(pair: &CentredPair) -> Self {
        CompactPair {
            left: to_grid(pair.left_centre, pair.left_half),
            right: to_grid(pair.right_centre, pair.right_half),
        }
    }
}

/// A box on the grid around a box; one beyond the grid is cut off, where no ray is.
#[cfg(not(target_arch = "spirv"))]
fn to_grid(centre: UVec4, half: UVec4) -> UVec4 {
    let (c, h) = (super::numbers(centre).to_array().map(f64::from), super::numbers(half).to_array().map(f64::from));
    let step = f64::from(CompactPair::STEP);
    let place = |i: usize| ((c[i] + 1.0) / step).round().clamp(0.0, 65535.0);
    let reach = |i: usize| {
        let beside = (place(i) * step - 1.0 - c[i]).abs();
        ((h[i] + beside) / step).ceil().clamp(0.0, 65535.0)
    };
    let word = |low: f64, high: f64| low as u32 | (high as u32) << 16;
    UVec4::new(word(place(0), place(1)), word(place(2), reach(0)), word(reach(1), reach(2)), centre.w)
}
