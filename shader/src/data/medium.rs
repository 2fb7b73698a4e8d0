//! Participating media: what is between surfaces.

use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// A homogeneous medium (Pharr, Jakob and Humphreys, Physically Based Rendering, 4th edition, chapter 11). All lengths are those of the
/// normalised scene.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Medium {
    /// The extinction coefficient, linear RGB: how likely light is absorbed or scattered on a unit of its way, over that unit. The integer
    /// is the priority: of several media in one place the one of the highest is there.
    pub extinction: UVec4,
    /// The share of that which is scattered, linear RGB in [0, 1]; the integer is the bits of the mean cosine of the angle by which it is.
    pub albedo: UVec4,
    /// Radiance that it sends where it absorbs, linear RGB: much of it is as bright as this. The integer is the bits of its index of
    /// refraction.
    pub emission: UVec4,
    /// The first word of a [`Grid`](super::Grid) of densities that coefficients are multiplied with; those of a grid of temperatures and
    /// of the [light](super::GlowTable) of each, which what it sends is multiplied with; and flags.
    pub density: UVec4,
}

impl Medium {
    /// The flag of a medium that is not as dense everywhere.
    pub const HAS_GRID: u32 = 1;

    /// The flag of one that glows as its temperature says.
    pub const HAS_TEMPERATURE: u32 = 2;

    /// The same with a grid of densities at this word.
    pub fn with_grid(mut self, at: u32) -> Self {
        self.density.x = at;
        self.density.w |= Self::HAS_GRID;
        self
    }

    /// The same with a grid of temperatures at a word, and the table of their light at another.
    pub fn with_temperature(mut self, at: u32, table: u32) -> Self {
        (self.density.y, self.density.z) = (at, table);
        self.density.w |= Self::HAS_TEMPERATURE;
        self
    }

    /// Is it denser in some places?
    #[inline(always)]
    pub fn has_grid(&self) -> bool {
        self.density.w & Self::HAS_GRID != 0
    }

    /// Is it hotter in some places?
    #[inline(always)]
    pub fn has_temperature(&self) -> bool {
        self.density.w & Self::HAS_TEMPERATURE != 0
    }

    /// The first word of its grid of densities.
    #[inline(always)]
    pub fn grid(&self) -> u32 {
        self.density.x
    }
}

/// What a material says of the inside of its surfaces, in an integer of its record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Filling(pub u32);

impl Filling {
    /// The most media of a scene.
    pub const MOST: u32 = 255;
    /// The flag of surfaces that are not there: only what is inside of them is.
    const OPEN: u32 = 256;

    /// A medium by its number, from 1 on, or 0 for none, below a surface that is there or not.
    pub fn new(medium: u32, is_open: bool) -> Self {
        Filling(medium | if is_open { Self::OPEN } else { 0 })
    }

    /// The medium's number, from 1 on; 0 for none.
    #[inline(always)]
    pub fn medium(self) -> u32 {
        self.0 & Self::MOST
    }

    /// Is the surface not there?
    #[inline(always)]
    pub fn is_open(self) -> bool {
        self.0 & Self::OPEN != 0
    }
}
