//! What a physical surface is made of at a place.

use super::Ggx;
use super::fresnel::Reflectance;
use crate::real::{Real, V3};

/// What happens to light that facets do not reflect and the base does not scatter.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Way(u32);

impl Way {
    /// There is none.
    pub const OPAQUE: Way = Way(0);
    /// It goes on behind a thin wall, of one interface or two, as if it were mirrored there.
    pub const THIN: Way = Way(1);
    /// It is refracted into a body, or out of it.
    pub const BODY: Way = Way(2);
}

/// Parts of a surface, each linear RGB in [0, 1].
#[derive(Clone, Copy)]
pub struct Layers<R: Real> {
    /// The base's colour.
    pub diffuse: V3<R>,
    /// The colour of what the base sends to its far side.
    pub beyond: V3<R>,
    /// The colour of what passes.
    pub through: V3<R>,
    /// What facets reflect.
    pub reflectance: Reflectance<R>,
    /// Does the base get only what the facets do not reflect? By Schlick's mean over all directions it sends back as much of it
    /// (Kelemen and Szirmay-Kalos, A Microfacet Based Coupled Specular-Matte BRDF Model, 2001): glTF's own mixture of both, by the
    /// angle to a facet, sends up to a third more light than it gets.
    pub is_coated: bool,
    /// How the rest passes.
    pub way: Way,
    /// How rough the facets lie; zeros for a mirror or a lens.
    pub ggx: Ggx<R>,
}
