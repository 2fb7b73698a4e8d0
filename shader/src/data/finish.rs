//! What lies on surfaces by microfacets, and what else their bases do with light.

use super::word;
use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// What a physical material has beside a base, facets and what passes, bound only where some material has any of it: one for each
/// material.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Finish {
    /// How much of the surface a coat is on, in [0, 1], its roughness in [0, 1], and how much of it a film is on, in [0, 1]; the
    /// integer is the bits of the film's index of refraction.
    pub coat: UVec4,
    /// What fibres scatter, linear RGB in [0, 1]; the integer is the bits of their roughness in [0, 1].
    pub sheen: UVec4,
    /// The colour of light of the base that leaves on the far side, linear RGB in [0, 1]; the integer is the bits of its share of the
    /// base's light.
    pub beyond: UVec4,
    /// The least and the greatest thickness of the film in nanometres, and half of the difference of the indices of refraction of
    /// blue and red light; the integer is the row of the spectrum ([`SpectrumRow`](super::SpectrumRow)) of what the index is above that of
    /// yellow light, over the third number, or 0 for Cauchy's.
    pub film: UVec4,
    /// Of hair, which has nothing else of this: one over the number by whose square a colour's logarithm to the base 2 tells what is
    /// absorbed, the variance of what is reflected along it, more than 0, and the scale of that around it, in turns; the integer is
    /// the bits of the sine of the angle by which its scales lean. Zeros of what is no hair.
    pub hair: UVec4,
    /// The maps of all that.
    pub maps: FinishMaps,
}

impl Finish {
    /// Nothing beside base, facets and what passes.
    pub const NONE: Finish = Finish {
        coat: UVec4::ZERO,
        sheen: UVec4::ZERO,
        beyond: UVec4::ZERO,
        film: UVec4::ZERO,
        hair: UVec4::ZERO,
        maps: FinishMaps::NONE,
    };

    /// Is it hair?
    #[inline(always)]
    pub fn is_hair(&self) -> bool {
        self.hair.y != 0
    }

    /// Does the base send light to its far side?
    #[inline(always)]
    pub fn is_translucent(&self) -> bool {
        self.beyond.w != 0
    }
}

/// The maps of a [`Finish`]: each an index into all [`TextureMap`](super::TextureMap)s, plus one, or 0 for none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct FinishMaps {
    /// How much of the surface the coat is on (red), its roughness (green), its normals, and the colour of fibres.
    pub first: UVec4,
    /// The roughness of fibres (alpha), the share of the base's light that leaves on the far side (alpha) and its colour, and how much
    /// of the surface the film is on (red).
    pub second: UVec4,
    /// The film's thickness from the least to the greatest (green); the rest is 0.
    pub third: UVec4,
}

impl FinishMaps {
    /// No maps.
    pub const NONE: FinishMaps = FinishMaps { first: UVec4::ZERO, second: UVec4::ZERO, third: UVec4::ZERO };
    /// How many there may be.
    pub const COUNT: u32 = 9;
    /// Their numbers.
    pub const COAT: u32 = 0;
    /// The coat's roughness.
    pub const COAT_ROUGHNESS: u32 = 1;
    /// Its normals.
    pub const COAT_NORMAL: u32 = 2;
    /// The colour of fibres.
    pub const SHEEN_COLOUR: u32 = 3;
    /// Their roughness.
    pub const SHEEN_ROUGHNESS: u32 = 4;
    /// The share of the base's light that leaves on the far side.
    pub const BEYOND: u32 = 5;
    /// The colour of that.
    pub const BEYOND_COLOUR: u32 = 6;
    /// How much of the surface the film is on.
    pub const FILM: u32 = 7;
    /// The film's thickness.
    pub const FILM_THICKNESS: u32 = 8;

    /// The map of a number.
    #[inline(always)]
    pub fn of(&self, number: u32) -> u32 {
        let four = if number < 4 {
            self.first
        } else if number < 8 {
            self.second
        } else {
            self.third
        };
        word(four, number)
    }
}
