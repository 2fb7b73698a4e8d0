//! What the textures of a material say of its coat, its fibres and what else it has beside base and facets.

use super::Texel;
use super::covering::signed;
use crate::data::{FinishMaps, TextureMap};
use crate::real::{Real, Scalar, V3};

/// What is multiplied with a material's own numbers, but for normals and thickness.
#[derive(Clone, Copy)]
pub struct FinishCovering<R: Real> {
    /// How much of the surface the coat is on.
    pub coat: R,
    /// Its roughness.
    pub coat_roughness: R,
    /// Its shading normal by tangent, bitangent and normal, of any length; zero where no map says one.
    pub coat_normal: V3<R>,
    /// The colour of fibres.
    pub sheen: V3<R>,
    /// Their roughness.
    pub sheen_roughness: R,
    /// The share of the base's light that leaves on the far side.
    pub beyond: R,
    /// Its colour.
    pub beyond_colour: V3<R>,
    /// How much of the surface the film is on.
    pub film: R,
    /// How thick it is, from the least to the greatest, in [0, 1].
    pub film_thickness: R,
}

impl<R: Scalar> FinishCovering<R> {
    /// That of no texture.
    #[inline(always)]
    pub fn none() -> Self {
        let one = R::splat(1.0);
        let white = V3::new(one, one, one);
        FinishCovering {
            coat: one,
            coat_roughness: one,
            coat_normal: V3::zero(),
            sheen: white,
            sheen_roughness: one,
            beyond: one,
            beyond_colour: white,
            film: one,
            film_thickness: one,
        }
    }

    /// Takes what the map of a number says.
    #[inline(always)]
    pub(super) fn take(&mut self, number: u32, map: &TextureMap, Texel { colour, alpha }: Texel<R>) {
        if number == FinishMaps::COAT {
            self.coat = colour.x;
        } else if number == FinishMaps::COAT_ROUGHNESS {
            self.coat_roughness = colour.y;
        } else if number == FinishMaps::COAT_NORMAL {
            self.coat_normal = signed(map, colour);
        } else if number == FinishMaps::SHEEN_COLOUR {
            self.sheen = colour;
        } else if number == FinishMaps::SHEEN_ROUGHNESS {
            self.sheen_roughness = alpha;
        } else if number == FinishMaps::BEYOND {
            self.beyond = alpha;
        } else if number == FinishMaps::BEYOND_COLOUR {
            self.beyond_colour = colour;
        } else if number == FinishMaps::FILM {
            self.film = colour.x;
        } else {
            self.film_thickness = colour.y;
        }
    }
}
