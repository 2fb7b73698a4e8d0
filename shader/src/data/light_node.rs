//! The hierarchy of the lights that have a place, by which one of many is chosen.

use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// A node: a light, or all lights below. That of the first child is the next record.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct LightNode {
    /// The middle of the box around them; the integer is the bits of their intensity, a share of that of all.
    pub middle: UVec4,
    /// Half its size; the integer is the bits of the cosine of the half angle of a cone around all normals.
    pub half: UVec4,
    /// The cone's unit axis; the integer has the flags below, and the number of the second child, or of a leaf's emitter.
    pub axis: UVec4,
}

impl LightNode {
    /// The integer is an emitter's number.
    pub const LEAF: u32 = 1 << 31;
    /// Some emit on both sides.
    pub const TWO_SIDED: u32 = 1 << 30;
    /// Some emit up to a right angle from their normals, and not along them alone.
    pub const SPREAD: u32 = 1 << 29;
    /// The bits of a number.
    pub const NUMBER: u32 = (1 << 29) - 1;
    /// Probabilities are whole steps of one over this, so that decisions compare integers.
    pub const STEPS: u32 = 1 << 23;
    /// The most nodes on a way from the root to a leaf, less one: an emitter's [trail](super::Emitter::trail) is one word.
    pub const MOST_LEVELS: u32 = 32;

    /// Is any of these flags set?
    #[inline(always)]
    pub fn has(&self, flags: u32) -> bool {
        self.axis.w & flags != 0
    }

    /// The second child, or a leaf's emitter.
    #[inline(always)]
    pub fn number(&self) -> u32 {
        self.axis.w & Self::NUMBER
    }
}
