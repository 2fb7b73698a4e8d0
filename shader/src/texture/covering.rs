//! What the textures of a material say at a place.

use super::{FinishCovering, Place, Texel, Textures};
use crate::data::{Effects, FinishMaps, Maps, Specialisation, TextureMap};
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
    /// What lies on it, and what else its base does.
    pub finish: FinishCovering<R>,
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
            finish: FinishCovering::none(),
        }
    }

    /// That of the maps of a material, whose numbers are at least `from` and below `to`: those of [`FinishMaps`] follow the others.
    // A loop, so that a kernel holds the filter once.
    #[inline(always)]
    pub fn new(
        spec: Specialisation,
        textures: &Textures<'_>,
        (maps, further): (impl FnOnce() -> Maps, FinishMaps),
        place: &Place<R>,
        footprint: R,
        (from, to): (u32, u32),
    ) -> Self {
        let (effects, has_finish) = (spec.effects, spec.finishes.any());
        let mut covering = Self::none();
        if effects.has(Effects::TEXTURED) {
            let maps = maps();
            let mut number = from;
            while number < to {
                let is_further = has_finish && number >= Maps::COUNT;
                let index = if is_further { further.of(number - Maps::COUNT) } else { maps.of(number) };
                if index != 0 {
                    let (map, texel) = textures.at(spec.launch, index, place, footprint);
                    if is_further {
                        covering.finish.take(number - Maps::COUNT, &map, texel);
                    } else {
                        covering.take(number, &map, texel);
                    }
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
        let one = R::splat(1.0);
        if number == Maps::BASE {
            self.base = colour;
        } else if number == Maps::METALLIC_ROUGHNESS {
            (self.roughness, self.metalness) = (colour.y, colour.z);
        } else if number == Maps::NORMAL {
            self.normal = signed(map, colour);
        } else if number == Maps::EMISSION {
            self.emission = colour;
        } else if number == Maps::TRANSMISSION {
            self.transmission = colour.x;
        } else if number == Maps::SPECULAR_WEIGHT {
            self.specular_weight = alpha;
        } else if number == Maps::SPECULAR_TINT {
            self.specular_tint = colour;
        } else {
            let flat = V3::new(twice(colour.x) - one, twice(colour.y) - one, R::splat(0.0));
            let (direction, length) = flat.direction_and_length();
            let is_none = length.eq(R::splat(0.0));
            self.axis = (R::select(is_none, one, direction.x) * colour.z, direction.y * colour.z);
        }
    }
}

#[inline(always)]
fn twice<R: Scalar>(x: R) -> R {
    x + x
}

/// The normal that a texel of a map stands for, of any length.
#[inline(always)]
pub(super) fn signed<R: Scalar>(map: &TextureMap, colour: V3<R>) -> V3<R> {
    let (one, scale) = (R::splat(1.0), R::splat(f32::from_bits(map.v.w)));
    V3::new((twice(colour.x) - one) * scale, (twice(colour.y) - one) * scale, twice(colour.z) - one)
}
