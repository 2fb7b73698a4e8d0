//! What the textures of a material say at a place.

use super::{Place, Texel, Textures};
use crate::data::{Effects, Launch, Maps, TextureMap};
use crate::real::{Real, Scalar, V3};

/// What is multiplied with a material's own numbers, but for normals.
#[derive(Clone, Copy)]
pub struct Covering<R: Real> {
    /// Base colour.
    pub base: V3<R>,
    /// Roughness.
    pub roughness: R,
    /// Metalness.
    pub metalness: R,
    /// The shading normal by tangent, bitangent and normal, of any length.
    pub normal: V3<R>,
    /// Emission.
    pub emission: V3<R>,
    /// Transmission.
    pub transmission: R,
    /// Strength of the reflection of what is no metal.
    pub specular_weight: R,
    /// Its tint.
    pub specular_tint: V3<R>,
    /// Cosine and sine of the angle of the axis of anisotropy times the strength of anisotropy.
    pub axis: (R, R),
}

impl<R: Scalar> Covering<R> {
    /// That of no texture.
    #[inline(always)]
    pub fn none() -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let white = V3::new(one, one, one);
        Covering {
            base: white,
            roughness: one,
            metalness: one,
            normal: V3::new(zero, zero, one),
            emission: white,
            transmission: one,
            specular_weight: one,
            specular_tint: white,
            axis: (one, zero),
        }
    }

    /// That of the maps of a material, whose numbers are at least `from` and below `to`.
    // A loop, so that a kernel holds the filter once.
    #[inline(always)]
    pub fn new(
        (effects, launch): (Effects, Launch),
        textures: &Textures<'_>,
        maps: impl FnOnce() -> Maps,
        place: &Place<R>,
        footprint: R,
        (from, to): (u32, u32),
    ) -> Self {
        let mut covering = Self::none();
        if effects.has(Effects::TEXTURED) {
            let maps = maps();
            let mut number = from;
            while number < to {
                let index = maps.of(number);
                if index != 0 {
                    let (map, texel) = textures.at(launch, index, place, footprint);
                    covering.take(number, &map, texel);
                }
                number += 1;
            }
        }
        if effects.has(Effects::COLOURED) {
            covering.base = covering.base.times(place.colour(effects, textures));
        }
        covering
    }

    #[inline(always)]
    fn take(&mut self, number: u32, map: &TextureMap, Texel { colour, alpha }: Texel<R>) {
        let (one, signed) = (R::splat(1.0), |x: R| x + x - R::splat(1.0));
        if number == Maps::BASE {
            self.base = colour;
        } else if number == Maps::METALLIC_ROUGHNESS {
            (self.roughness, self.metalness) = (colour.y, colour.z);
        } else if number == Maps::NORMAL {
            let scale = R::splat(f32::from_bits(map.v.w));
            self.normal = V3::new(signed(colour.x) * scale, signed(colour.y) * scale, signed(colour.z));
        } else if number == Maps::EMISSION {
            self.emission = colour;
        } else if number == Maps::TRANSMISSION {
            self.transmission = colour.x;
        } else if number == Maps::SPECULAR_WEIGHT {
            self.specular_weight = alpha;
        } else if number == Maps::SPECULAR_TINT {
            self.specular_tint = colour;
        } else {
            let (direction, length) = V3::new(signed(colour.x), signed(colour.y), R::splat(0.0)).direction_and_length();
            let is_none = length.eq(R::splat(0.0));
            self.axis = (R::select(is_none, one, direction.x) * colour.z, direction.y * colour.z);
        }
    }
}
