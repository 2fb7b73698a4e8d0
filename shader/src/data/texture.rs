//! Textures, and where surfaces take them from.

use super::word;
use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// A texture as a material takes it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct TextureMap {
    /// The word at which the texels of its finest level start, the width and the height of that level in texels, each in
    /// [1, 16384], and the flags. Each further level follows the one before and is half as wide and high, rounded down, at least 1.
    pub place: UVec4,
    /// The first texture coordinate is the product of its first two numbers with the surface's coordinates, and the third; the
    /// integer is how many levels there are, at least 1.
    pub u: UVec4,
    /// The same for the second; the integer is the bits of a factor: of the slopes of a normal map.
    pub v: UVec4,
}

impl TextureMap {
    /// Texels are four single-precision numbers, linear RGB and opacity; without this flag a word of four bytes, red in the lowest.
    pub const FLOATS: u32 = 1;
    /// Bytes of colours are in the sRGB transfer function; else they are shares of 255.
    pub const SRGB: u32 = 2;
    /// The nearest texel counts whatever filter is asked for.
    pub const NEAREST: u32 = 4;
    /// The second set of texture coordinates counts.
    pub const SECOND_SET: u32 = 8;
    /// How far the way to wrap the first coordinate is shifted; that of the second follows.
    pub const WRAP_SHIFT: u32 = 4;
    /// Outside of [0, 1] the texture begins anew.
    pub const REPEAT: u32 = 0;
    /// It is mirrored.
    pub const MIRROR: u32 = 1;
    /// Its edge goes on.
    pub const CLAMP: u32 = 2;
    /// The largest width and height in texels.
    pub const MOST_SIDE: u32 = 16_384;
}

/// The maps of a material: each an index into all [`TextureMap`]s, plus one, or 0 for none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Maps {
    /// Base colour and opacity; metalness (blue) and roughness (green); normals; emission.
    pub first: UVec4,
    /// Transmission (red); strength (alpha) and tint (red, green, blue) of the reflection of what is no metal; direction (red,
    /// green) and strength (blue) of anisotropy.
    pub second: UVec4,
}

impl Maps {
    /// How many there may be.
    pub const COUNT: u32 = 8;
    /// Their numbers.
    pub const BASE: u32 = 0;
    /// Metalness and roughness.
    pub const METALLIC_ROUGHNESS: u32 = 1;
    /// Normals.
    pub const NORMAL: u32 = 2;
    /// Emission.
    pub const EMISSION: u32 = 3;
    /// Transmission.
    pub const TRANSMISSION: u32 = 4;
    /// Strength of the reflection of what is no metal.
    pub const SPECULAR_WEIGHT: u32 = 5;
    /// Its tint.
    pub const SPECULAR_TINT: u32 = 6;
    /// Anisotropy.
    pub const ANISOTROPY: u32 = 7;

    /// The map of a number.
    #[inline(always)]
    pub fn of(&self, number: u32) -> u32 {
        word(if number < 4 { self.first } else { self.second }, number)
    }
}

/// Texture coordinates of a triangle's vertices, as bits: first and second of the first and the second vertex; of the third, and
/// two zeros. All zeros of what is no triangle.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct TexCoords {
    /// Of the first and the second vertex.
    pub ab: UVec4,
    /// Of the third.
    pub c: UVec4,
}

/// Colours of a triangle's vertices, linear RGB and opacity as bits; bound only where a mesh has them.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Colours {
    /// At the first vertex.
    pub a: UVec4,
    /// At the second.
    pub b: UVec4,
    /// At the third.
    pub c: UVec4,
}

/// How opaque a material is; bound only where one is not.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Opacity {
    /// The bits of the factor of the opacity, the bits of the least opacity that counts as opaque (below zero where surfaces are
    /// met as often as they are opaque), the map of it as in [`Maps`], and 0.
    pub mask: UVec4,
}
