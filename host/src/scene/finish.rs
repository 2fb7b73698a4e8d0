//! What lies on a material by microfacets, and what else its base does with light, as glTF's extensions describe it.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A layer of lacquer over all else (KHR_materials_clearcoat), of the index of refraction 1.5.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Coat {
    /// How much of the surface it is on, in [0, 1].
    pub weight: f32,
    /// Perceived roughness in [0, 1], as that of the material.
    pub roughness: f32,
}

/// Fibres like those of velvet (KHR_materials_sheen), as Zeltner and others have them (Practical Multiple-Scattering Sheen Using
/// Linearly Transformed Cosines, 2022). They lie below the coat.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sheen {
    /// What they scatter, linear RGB in [0, 1].
    pub colour: Vec3,
    /// Perceived roughness in [0, 1]: how far fibres stand from upright.
    pub roughness: f32,
}

/// A base that scatters light to its far side, too, as leaves and paper do (KHR_materials_diffuse_transmission).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DiffuseTransmission {
    /// The share of the base's light that leaves on the far side, in [0, 1].
    pub weight: f32,
    /// The colour of that light, linear RGB in [0, 1].
    pub colour: Vec3,
}

/// A film whose faces reflect waves that interfere, as those of soap do (KHR_materials_iridescence).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ThinFilm {
    /// How much of the surface it is on, in [0, 1].
    pub weight: f32,
    /// Its index of refraction, in [1, 4].
    pub ior: f32,
    /// Its thickness in nanometres where the map of it is 0, and where that is 1 or there is none; in [0, 100000].
    pub thickness: [f32; 2],
}
