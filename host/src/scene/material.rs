//! What surfaces are made of.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::{Alpha, Maps, Physical, Visibility, Volume};
use crate::spectrum::Illuminant;

/// The thesis' illumination model (chapters 3.1 and 3.3); colours are linear RGB in [0, 1].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// By this name a scene file overrides it.
    pub name: String,
    /// Answer to the scene's ambient light, if it is not the diffuse colour.
    pub ambient: Option<Vec3>,
    /// Lambert's diffuse colour.
    pub diffuse: Vec3,
    /// Phong's specular colour.
    pub specular: Vec3,
    /// Phong's exponent, at least 0.
    pub shininess: f32,
    /// Share of the mirrored ray that an opaque surface adds.
    pub reflection: Vec3,
    /// What of the light passes, weighted by Fresnel's equations; zero is opaque.
    pub transmission: Vec3,
    /// Index of refraction of the inside, in [1, 4]; of use where `transmission` is not zero.
    pub ior: f32,
    /// A second diffuse colour in cells of a checkerboard.
    pub checker: Option<Checker>,
    /// Radiance that it sends out, linear RGB, at least 0.
    pub emission: Vec3,
    /// The spectrum of that, where light has wavelengths; without one it is D65's.
    #[serde(default)]
    pub illuminant: Option<Illuminant>,
    /// Does its back emit too? Culling leaves it.
    pub two_sided: bool,
    /// The group of lamps that what is made of it is in, empty for none.
    #[serde(default)]
    pub group: String,
    /// The groups of lamps that light it, [`LightGroups::REST`](super::LightGroups::REST) for those without one; all if none is said. Paths tell.
    #[serde(default)]
    pub lit_by: Option<Vec<String>>,
    /// Is the emission multiplied with the colours of vertices?
    #[serde(default)]
    pub emission_is_coloured: bool,
    /// How it scatters where integrators sample it; without this as the rest says.
    pub physical: Option<Physical>,
    /// What is inside of its closed surfaces, if anything is.
    #[serde(default)]
    pub volume: Option<Volume>,
    /// Its textures.
    #[serde(skip)]
    pub maps: Maps,
    /// Who sees what is made of it.
    #[serde(default)]
    pub visibility: Visibility,
    /// How opaque it is.
    #[serde(default)]
    pub alpha: Alpha,
    /// The opacity in [0, 1] that `alpha` asks for, where its texture has 1.
    #[serde(default = "opaque")]
    pub opacity: f32,
}

fn opaque() -> f32 {
    1.0
}

/// A procedural checkerboard over the surface's two major axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Checker {
    /// The diffuse colour of every second cell; the others have the material's.
    pub colour: Vec3,
    /// The answer of those cells to the scene's ambient light.
    pub ambient: Vec3,
    /// A cell's edge in world units.
    pub size: f32,
}

impl Material {
    /// May it mirror or refract light, so that it casts caustics? What has a picture of its roughness may wherever that is dark.
    pub(crate) fn casts(&self) -> bool {
        /// Less rough, it is a mirror or a lens.
        const ROUGH: f32 = 1.0 / 32.0;
        let Some(physical) = &self.physical else {
            return self.reflection != Vec3::ZERO || self.transmission != Vec3::ZERO;
        };
        let is_smooth = |roughness: f32, has_map: bool| roughness < ROUGH || has_map;
        let coat = physical.coat.is_some_and(|coat| {
            coat.weight > 0.0 && is_smooth(coat.roughness, self.maps.finish.coat_roughness.is_some())
        });
        let facets = is_smooth(physical.roughness, self.maps.metallic_roughness.is_some());
        physical.hair.is_none() && (facets || coat)
    }

    /// Do its surfaces need tangents?
    pub(crate) fn has_axes(&self) -> bool {
        self.maps.normal.is_some()
            || self.maps.finish.coat_normal.is_some()
            || self.physical.is_some_and(|p| p.anisotropy > 0.0 || p.hair.is_some())
    }
}
