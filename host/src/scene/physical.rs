//! Materials by microfacets, as glTF 2.0 and its extensions describe them.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::finish::{Coat, DiffuseTransmission, Sheen, ThinFilm};
use super::hair::Hair;
use crate::choice::choices;
use crate::math;
use crate::spectrum::{Glass, Metal};

/// How a surface scatters light by microfacets (glTF 2.0, appendix B). Colours are linear RGB in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Physical {
    /// The colour of what is matt and of metal.
    pub base: Vec3,
    /// How much of it is metal, in [0, 1].
    pub metallic: f32,
    /// Perceived roughness in [0, 1]; its square is that of the facets. Below 1/32 the surface is a mirror or a lens.
    pub roughness: f32,
    /// How much rougher than across the facets lie along an axis, in [0, 1] (KHR_materials_anisotropy). Highlights are stretched along
    /// it: metal is brushed across it.
    pub anisotropy: f32,
    /// The angle from the tangent to that axis, counter-clockwise, in degrees.
    pub anisotropy_rotation: f32,
    /// How strongly what is no metal reflects, in [0, 1] (KHR_materials_specular).
    pub specular_weight: f32,
    /// What that reflection at normal incidence is multiplied with, linear RGB of at least 0; it reflects all of the light at most.
    pub specular_tint: Vec3,
    /// The share of the base's light that passes instead of being scattered, of what is no metal.
    pub transmission: Vec3,
    /// Index of refraction of what is no metal, in [1, 4].
    pub ior: f32,
    /// What lets light pass.
    pub wall: Wall,
    /// What a body takes of light on its way inside.
    pub absorption: Option<Absorption>,
    /// A metal by its complex index of refraction, in place of all but roughness, anisotropy, coat and sheen.
    pub conductor: Option<Conductor>,
    /// A layer over all of it.
    #[serde(default)]
    pub coat: Option<Coat>,
    /// Fibres below that.
    #[serde(default)]
    pub sheen: Option<Sheen>,
    /// What of the base's light leaves on the far side.
    #[serde(default)]
    pub diffuse_transmission: Option<DiffuseTransmission>,
    /// A film on the facets.
    #[serde(default)]
    pub film: Option<ThinFilm>,
    /// The Abbe number of a body that lets light pass, by which it bends blue light more than red, in [1, 1000]
    /// (KHR_materials_dispersion); without one it bends all light alike.
    #[serde(default)]
    pub abbe: Option<f32>,
    /// What bends light of each wavelength as was measured; `ior` is its index for yellow light, and `abbe` is not asked.
    #[serde(default)]
    pub glass: Option<Glass>,
    /// A fibre of the base's colour in place of all but that, `ior` and what it emits.
    #[serde(default)]
    pub hair: Option<Hair>,
}

choices! {
    /// What lets light pass.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Wall {
        /// A body, whose surface bends it
        #[default]
        Body = "body",
        /// A pane too thin to bend it, of two faces
        Pane = "pane",
        /// One interface that does not bend it, as glTF has it where it has no volume
        Interface = "interface",
    }
}

/// What a body absorbs (KHR_materials_volume).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Absorption {
    /// What is left of white light, linear RGB in [0, 1], ...
    pub colour: Vec3,
    /// ... after so many world units.
    pub distance: f32,
}

/// A complex index of refraction `eta + i k`, for red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Conductor {
    /// The refractive part, in [0, 100].
    pub eta: Vec3,
    /// The absorbing part, in [0, 100].
    pub k: Vec3,
    /// The metal whose index it is, which was measured at each wavelength.
    #[serde(default)]
    pub metal: Option<Metal>,
}

impl Absorption {
    /// How far light goes on average before it is absorbed, in world units.
    pub(crate) fn mean_way(&self) -> Vec3 {
        self.colour.map(|left| (f64::from(self.distance) / Self::depth(left).max(1e-9)) as f32)
    }

    /// The optical depth behind which so much is left.
    pub(crate) fn depth(left: f32) -> f64 {
        // Nothing is left of what a single precision number holds.
        if left > 0.0 { -math::ln(left.into()) } else { 100.0 }
    }
}

impl Default for Physical {
    /// A rough white dielectric.
    fn default() -> Self {
        Physical {
            base: Vec3::ONE,
            metallic: 0.0,
            roughness: 1.0,
            anisotropy: 0.0,
            anisotropy_rotation: 0.0,
            specular_weight: 1.0,
            specular_tint: Vec3::ONE,
            transmission: Vec3::ZERO,
            ior: 1.5,
            wall: Wall::Body,
            absorption: None,
            conductor: None,
            coat: None,
            sheen: None,
            diffuse_transmission: None,
            film: None,
            abbe: None,
            glass: None,
            hair: None,
        }
    }
}

impl Physical {
    /// Does light pass?
    pub fn is_transparent(&self) -> bool {
        self.transmission != Vec3::ZERO && self.conductor.is_none() && self.hair.is_none()
    }

    /// Does its base scatter light to its far side?
    pub fn scatters_through(&self) -> bool {
        self.diffuse_transmission.is_some_and(|of| of.weight > 0.0) && self.conductor.is_none() && self.hair.is_none()
    }

    /// Does light pass its surface into something inside?
    pub(crate) fn lets_light_in(&self) -> bool {
        (self.is_transparent() || self.scatters_through()) && self.wall == Wall::Body
    }

    /// Half of the difference between its indices of refraction for blue and for red light (the F and the C line), which the Abbe number
    /// divides `ior - 1` by, in a body that lets light pass.
    pub(crate) fn dispersion(&self) -> f32 {
        let of_abbe = self.abbe.map_or(0.0, |abbe| (self.ior - 1.0) / (2.0 * abbe));
        let spread = self.glass.map_or(of_abbe, |glass| glass.spread() as f32);
        if self.is_transparent() && self.wall == Wall::Body { spread } else { 0.0 }
    }

    /// What it reflects at normal incidence where it is no metal, linear RGB.
    pub fn reflectance(&self) -> Vec3 {
        self.tinted().min(Vec3::ONE) * self.specular_weight
    }

    /// The same before its weight, of which at most 1 counts.
    pub fn tinted(&self) -> Vec3 {
        let root = (self.ior - 1.0) / (self.ior + 1.0);
        (self.specular_tint * (root * root)).min(Vec3::MAX)
    }
}

impl Conductor {
    /// What it reflects at normal incidence, linear RGB.
    pub fn reflectance(&self) -> Vec3 {
        let square = |v: Vec3| v * v;
        let (eta, k) = (self.eta, square(self.k));
        let over = square(eta + Vec3::ONE) + k;
        (square(eta - Vec3::ONE) + k) / over
    }
}
