//! What a launch is made for.

use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// What a launch renders: one sample of every pixel of a region.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Frame {
    /// Camera position; the integer is the image's width in pixels.
    pub eye: UVec4,
    /// Step to the right for half a sample's width on the image plane; the image's height.
    pub right: UVec4,
    /// Step up for half a sample's height; samples along a pixel's edge.
    pub up: UVec4,
    /// To the centre of the image plane, at distance one; this launch's sample within the pixel.
    pub forward: UVec4,
    /// Background at the horizon and below; the bounce limit.
    pub bottom: UVec4,
    /// Background straight up; how many lights there are.
    pub top: UVec4,
    /// The region's left and top pixel, its width and height.
    pub region: UVec4,
    /// Bits of a sample's share of its pixel, bits of the least contribution that is followed, slots a
    /// launch has room for, the word at which the vertices of indexed triangles start.
    pub limits: UVec4,
}

/// Thresholds of the hybrid methods (thesis 6.2.3) and of persistent subgroups.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Tuning(pub u32);

impl Tuning {
    /// Parts a full stack of `stack_max` nodes, or a child that less than `cut` percent of a packet want.
    pub const fn new(stack_max: u32, cut: u32) -> Self {
        Tuning(stack_max | (cut << 8)).with_busy(Self::BUSY)
    }

    /// The default of [`Tuning::busy`], measured.
    const BUSY: u32 = 40;

    /// Lets the lanes of persistent subgroups take new rays when less than `busy` percent are at work.
    pub const fn with_busy(self, busy: u32) -> Self {
        Tuning((self.0 & 0xffff) | (busy << 16))
    }

    /// Percent of a persistent subgroup below which idle lanes take new rays. (Each time all wait for the
    /// rays' preparation.)
    #[inline(always)]
    pub fn busy(self) -> u32 {
        self.0 >> 16
    }

    /// Nodes that wait when a packet parts.
    #[inline(always)]
    pub fn stack_max(self) -> u32 {
        self.0 & 0xff
    }

    /// Percent of a packet below which rays part.
    #[inline(always)]
    pub fn cut(self) -> u32 {
        (self.0 >> 8) & 0xff
    }
}

impl Default for Tuning {
    fn default() -> Self {
        Tuning::new(8, 25)
    }
}

/// Which effects a scene asks for; a kernel holds no instruction for the others.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Features(pub u32);

impl Features {
    /// Some mesh has vertex normals.
    pub const SMOOTH: u32 = 1 << 0;
    /// Some material is a checker.
    pub const CHECKER: u32 = 1 << 1;
    /// Some material is a mirror or reflects as glass, and bounces are allowed.
    pub const REFLECTION: u32 = 1 << 2;
    /// Some material lets light pass.
    pub const REFRACTION: u32 = 1 << 3;
    /// Some light is a spot.
    pub const SPOT: u32 = 1 << 4;
    /// Some light is directional.
    pub const DIRECTIONAL: u32 = 1 << 5;
    /// Some material has a Phong highlight.
    pub const SPECULAR: u32 = 1 << 6;
    /// Triangles seen from behind are skipped.
    pub const CULLING: u32 = 1 << 7;
    /// The background is a gradient.
    pub const GRADIENT: u32 = 1 << 8;
    /// This launch follows secondary rays: its slots come from a queue.
    pub const SECONDARY: u32 = 1 << 9;
    /// This launch follows rays that lie in memory as [`crate::stage::Segment`]s.
    pub const STREAM: u32 = 1 << 10;
    /// Triangles are given as indices of vertices, see [`crate::scene::Geometry::triangle`].
    pub const INDEXED: u32 = 1 << 11;
    /// Triangles are split: a slot holds a part, whose bounds are given.
    pub const SPLIT: u32 = 1 << 12;
    /// Pixels are taken row by row.
    pub const LINEAR: u32 = 1 << 13;
    /// Pixels are taken along a Morton curve.
    pub const MORTON: u32 = 1 << 14;
    /// Pairs of nodes are [`CompactPair`](super::CompactPair)s.
    pub const COMPACT: u32 = 1 << 15;
    /// Triangles are met by the test of Moeller and Trumbore, where [`Real::CHOOSES`](crate::real::Real::CHOOSES).
    pub const MOLLER: u32 = 1 << 16;

    /// Is the effect asked for?
    #[inline(always)]
    pub fn has(self, bit: u32) -> bool {
        self.0 & bit != 0
    }
}
