//! Lights as integrators take them that sample one of them: those without extent, and primitives that emit.

use super::Light;
use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// A light that may be chosen, and an entry of the table by which it is (Walker, An Efficient Method for Generating Discrete
/// Random Variables with General Distributions, 1977).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Emitter {
    /// A light without extent, whose colour is in units of the normalised scene; or of kind [`Emitter::PRIMITIVE`], whose axis'
    /// integer is the index of the primitive, and the other numbers those of the functions below.
    pub light: Light,
    /// The threshold below which a draw that came to this entry means it, the number of the emitter that it means otherwise,
    /// the bits of the probability that this emitter is chosen at all, and from bit [`Emitter::STEPS`] on its group. Where lights are chosen by a
    /// [hierarchy](super::LightNode), of all that are far away alone, with the steps of 2^-23 of the probability that one of these is below
    /// the group.
    pub choice: UVec4,
}

impl Emitter {
    /// The bits of the integer of `choice` below those of its group.
    pub const STEPS: u32 = 24;
    /// The kind of a primitive that emits.
    pub const PRIMITIVE: u32 = 3;
    /// The kind of light from far away.
    pub const ENVIRONMENT: u32 = 4;

    /// Steps of the probability that a light is chosen which is far away.
    #[inline(always)]
    pub fn steps(&self) -> u32 {
        self.choice.w & ((1 << Self::STEPS) - 1)
    }

    /// The group of a light that is no primitive; 0 for none. That of a primitive is its material's, see [`Emission::group`].
    #[inline(always)]
    pub fn group(&self) -> u32 {
        self.choice.w >> Self::STEPS
    }

    /// A primitive's number in the scene.
    #[inline(always)]
    pub fn number(&self) -> u32 {
        self.light.position.x
    }

    /// The way to a primitive's leaf in the hierarchy: from the lowest bit on, 1 for each second child.
    #[inline(always)]
    pub fn trail(&self) -> u32 {
        self.light.position.y
    }

    /// The first key of the copy that a primitive is in, or [`Hit::NOTHING`](crate::ray::Hit::NOTHING).
    #[inline(always)]
    pub fn instance(&self) -> u32 {
        self.light.position.z
    }

    /// One over a primitive's area in the normalised scene.
    #[inline(always)]
    pub fn per_area(&self) -> f32 {
        f32::from_bits(self.light.colour.x)
    }
}

/// What a material emits.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Emission {
    /// Radiance, linear RGB; the integer is the bits of the probability density over the area of the normalised scene that a
    /// place on it is chosen as a light, 0 if it emits nothing.
    pub radiance: UVec4,
    /// Bits of [`Emission::TWO_SIDED`] and [`Emission::COLOURED`] with the row of its spectrum (0 for that of D65) and the group of lamps above them, the map that it is multiplied with as in [`Maps`](super::Maps), and of what is not opaque everywhere
    /// the map of its opacity and the bits of a number: at least 0 what opacity is multiplied with, and below 0 less the least opacity
    /// that is there.
    pub sides: UVec4,
}

impl Emission {
    /// The bits below those of the group.
    pub const FLAGS: u32 = 8;
    /// The bits below those of the spectrum.
    pub const ILLUMINANT: u32 = 2;
    /// Backs emit too.
    pub const TWO_SIDED: u32 = 1;
    /// The radiance is multiplied with the colours of vertices.
    pub const COLOURED: u32 = 2;

    /// The group of lamps that what is made of it is in; 0 for none.
    #[inline(always)]
    pub fn group(&self) -> u32 {
        self.sides.x >> Self::FLAGS
    }

    /// The row of its spectrum ([`SpectrumRow`](super::SpectrumRow)), 0 for that of D65.
    #[inline(always)]
    pub fn illuminant(&self) -> u32 {
        (self.sides.x & ((1 << Self::FLAGS) - 1)) >> Self::ILLUMINANT
    }

    /// Does it shine to whoever sees its front, or its back?
    #[inline(always)]
    pub fn shines(&self, front: bool) -> bool {
        front || self.sides.x & Self::TWO_SIDED != 0
    }
}
