//! The JSON of materials, which is as little trusted as the rest of it.

use serde::Deserialize;
use serde::de::IgnoredAny;

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Material {
    pub name: Option<String>,
    pub pbr_metallic_roughness: Option<Box<Metal>>,
    pub normal_texture: Option<Box<Info>>,
    pub emissive_texture: Option<Box<Info>>,
    pub emissive_factor: Option<[f64; 3]>,
    pub alpha_mode: Option<String>,
    pub alpha_cutoff: Option<f64>,
    pub double_sided: bool,
    pub extensions: Option<Box<Extensions>>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Metal {
    pub base_color_factor: Option<[f64; 4]>,
    pub base_color_texture: Option<Info>,
    pub metallic_factor: Option<f64>,
    pub roughness_factor: Option<f64>,
    pub metallic_roughness_texture: Option<Info>,
}

/// Which texture, and how it is laid.
#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Info {
    pub index: Option<usize>,
    pub tex_coord: Option<u64>,
    /// Of normals.
    pub scale: Option<f64>,
    pub extensions: InfoExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct InfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub transform: Option<Transform>,
}

/// Radians, counter-clockwise.
#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Transform {
    pub offset: Option<[f64; 2]>,
    pub rotation: Option<f64>,
    pub scale: Option<[f64; 2]>,
    pub tex_coord: Option<u64>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Extensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub strength: Option<Strength>,
    #[serde(rename = "KHR_materials_ior")]
    pub ior: Option<Ior>,
    #[serde(rename = "KHR_materials_transmission")]
    pub transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_volume")]
    pub volume: Option<Volume>,
    #[serde(rename = "KHR_materials_volume_scatter", alias = "KHR_materials_scatter")]
    pub scatter: Option<Scatter>,
    #[serde(rename = "KHR_materials_specular")]
    pub specular: Option<Specular>,
    #[serde(rename = "KHR_materials_anisotropy")]
    pub anisotropy: Option<Anisotropy>,
    #[serde(rename = "KHR_materials_clearcoat")]
    pub clearcoat: Option<Box<Clearcoat>>,
    #[serde(rename = "KHR_materials_sheen")]
    pub sheen: Option<Box<Sheen>>,
    #[serde(rename = "KHR_materials_diffuse_transmission")]
    pub diffuse_transmission: Option<Box<DiffuseTransmission>>,
    #[serde(rename = "KHR_materials_iridescence")]
    pub iridescence: Option<Box<Iridescence>>,
    #[serde(rename = "KHR_materials_dispersion")]
    pub dispersion: Option<Dispersion>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub gloss: Option<Gloss>,
    #[serde(rename = "KHR_materials_unlit")]
    pub unlit: Option<IgnoredAny>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Strength {
    pub emissive_strength: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Ior {
    pub ior: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Transmission {
    pub transmission_factor: Option<f64>,
    pub transmission_texture: Option<Info>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Volume {
    pub thickness_factor: Option<f64>,
    /// World units; without it the body absorbs nothing.
    pub attenuation_distance: Option<f64>,
    pub attenuation_color: Option<[f64; 3]>,
}

/// Of drafts whose names of the colour differ.
#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Scatter {
    #[serde(alias = "multiscatterColorFactor")]
    pub multiscatter_color: Option<[f64; 3]>,
    pub scatter_strength_factor: Option<f64>,
    pub scatter_anisotropy: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Specular {
    pub specular_factor: Option<f64>,
    pub specular_texture: Option<Info>,
    pub specular_color_factor: Option<[f64; 3]>,
    pub specular_color_texture: Option<Info>,
}

/// Radians, counter-clockwise.
#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Anisotropy {
    pub anisotropy_strength: Option<f64>,
    pub anisotropy_rotation: Option<f64>,
    pub anisotropy_texture: Option<Info>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Clearcoat {
    pub clearcoat_factor: Option<f64>,
    pub clearcoat_texture: Option<Info>,
    pub clearcoat_roughness_factor: Option<f64>,
    pub clearcoat_roughness_texture: Option<Info>,
    pub clearcoat_normal_texture: Option<Info>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Sheen {
    pub sheen_color_factor: Option<[f64; 3]>,
    pub sheen_color_texture: Option<Info>,
    pub sheen_roughness_factor: Option<f64>,
    pub sheen_roughness_texture: Option<Info>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct DiffuseTransmission {
    pub diffuse_transmission_factor: Option<f64>,
    pub diffuse_transmission_texture: Option<Info>,
    pub diffuse_transmission_color_factor: Option<[f64; 3]>,
    pub diffuse_transmission_color_texture: Option<Info>,
}

/// Nanometres.
#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Iridescence {
    pub iridescence_factor: Option<f64>,
    pub iridescence_texture: Option<Info>,
    pub iridescence_ior: Option<f64>,
    pub iridescence_thickness_minimum: Option<f64>,
    pub iridescence_thickness_maximum: Option<f64>,
    pub iridescence_thickness_texture: Option<Info>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Dispersion {
    /// 20 over the Abbe number; 0 for none.
    pub dispersion: Option<f64>,
}

/// What takes the place of `pbrMetallicRoughness`.
#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Gloss {
    pub diffuse_factor: Option<[f64; 4]>,
    pub diffuse_texture: Option<Info>,
    pub specular_factor: Option<[f64; 3]>,
    pub glossiness_factor: Option<f64>,
    /// Specular colour, and glossiness as alpha.
    pub specular_glossiness_texture: Option<Info>,
}
