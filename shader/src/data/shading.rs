//! What surfaces look like, and lights.

use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// The vertex normals of a triangle in leaf order, bound only where a mesh is smooth.
/// Three zeros stand for a flat triangle. The integers are 0.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Normals {
    /// Normal at the first vertex, of unit length.
    pub a: UVec4,
    /// Normal at the second vertex.
    pub b: UVec4,
    /// Normal at the third vertex.
    pub c: UVec4,
}

/// A surface's answer to light: ambient, Lambert, Phong (thesis 3.1), mirror and glass (3.3).
/// Colours are linear RGB in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Material {
    /// Ambient colour times the scene's ambient light; the integer has a bit for each group of lamps that does not light it.
    pub ambient: UVec4,
    /// Diffuse colour.
    pub diffuse: UVec4,
    /// Specular colour; the integer is the Phong exponent's bits.
    pub specular: UVec4,
    /// Mirror colour; the integer is the bits of the index of refraction, 0 for an opaque surface.
    pub reflection: UVec4,
    /// Colour of what passes; the integer says what is inside, see [`Filling`](super::Filling).
    pub transmission: UVec4,
    /// The checker's second diffuse colour; the integer is the bits of cells per unit, 0 for none.
    pub checker: UVec4,
    /// The second cells' ambient colour times the scene's ambient light.
    pub checker_ambient: UVec4,
}

/// A light without extent.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Light {
    /// Position, or the direction towards a directional light; the integer is its kind, see [`Light::KINDS`].
    pub position: UVec4,
    /// Colour times intensity; the integer is the bits of the cosine of a spot's inner angle.
    pub colour: UVec4,
    /// The axis a spot points along, of unit length; the integer is the bits of the cosine of its
    /// outer angle.
    pub axis: UVec4,
}

impl Light {
    /// [`Light::position`] is a place; light goes every way.
    pub const POINT: u32 = 0;
    /// [`Light::position`] is the unit direction towards the light.
    pub const DIRECTIONAL: u32 = 1;
    /// [`Light::position`] is a place; light fades from the inner to the outer cone.
    pub const SPOT: u32 = 2;
    // 3 and 4 are kinds of [`Emitter`](super::Emitter).
    /// As [`Light::SPOT`], but light fades by the square of a ramp (KHR_lights_punctual) instead of a cubic.
    pub const RAMP: u32 = 5;

    /// The bits of a kind.
    pub const KINDS: u32 = (1 << Self::ILLUMINANT) - 1;
    /// How many these bits are. Above them is the row of the light's spectrum, or 0.
    pub const ILLUMINANT: u32 = 4;
    /// The bits of both. Above them is one more than the place of its first key among the records of copies, if it moves while the
    /// shutter is open: how it is turned against how it is when that opens, and where it is.
    pub const KEYS: u32 = 10;

    /// The row of its spectrum ([`SpectrumRow`](super::SpectrumRow)), 0 for that of D65.
    #[inline(always)]
    pub fn illuminant(&self) -> u32 {
        (self.position.w >> Self::ILLUMINANT) & ((1 << (Self::KEYS - Self::ILLUMINANT)) - 1)
    }

    /// The integer of its position without that.
    #[inline(always)]
    pub fn without_illuminant(&self) -> u32 {
        (self.position.w >> Self::KEYS << Self::KEYS) | (self.position.w & Self::KINDS)
    }

    /// Does it move?
    #[inline(always)]
    pub fn moves(&self) -> bool {
        self.position.w >> Self::KEYS != 0
    }

    /// The place of its first key.
    #[inline(always)]
    pub fn first_key(&self) -> u32 {
        (self.position.w >> Self::KEYS) - 1
    }
}
