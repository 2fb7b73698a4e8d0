//! Textures, and how materials take them.

use std::sync::Arc;

use glam::Vec2;
use serde::{Deserialize, Serialize};

use crate::choice::choices;
use crate::error::{Error, Result};

/// A picture that surfaces are covered with. Its first row is the upper one, where the second texture coordinate is 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// What messages call it: its file.
    pub name: String,
    /// In texels, in [1, [`Texture::MOST_SIDE`]].
    pub width: u32,
    /// Likewise.
    pub height: u32,
    /// Row by row, as many as width times height.
    pub texels: Texels,
}

/// The texels of a texture.
#[derive(Debug, Clone, PartialEq)]
pub enum Texels {
    /// RGB and opacity in 8 bits. Whether they are sRGB or shares of 255 is up to what they are taken for: colours are sRGB.
    Bytes(Vec<[u8; 4]>),
    /// Linear RGB, finite and at least 0, and opacity in [0, 1].
    Floats(Vec<[f32; 4]>),
}

impl Texels {
    /// The opacity of each, in [0, 1].
    pub fn opacities(&self) -> impl Iterator<Item = f32> + '_ {
        let count = match self {
            Texels::Bytes(bytes) => bytes.len(),
            Texels::Floats(floats) => floats.len(),
        };
        (0..count).map(|texel| match self {
            Texels::Bytes(bytes) => f32::from(bytes[texel][3]) / 255.0,
            Texels::Floats(floats) => floats[texel][3],
        })
    }
}

choices! {
    /// What a texture does beyond [0, 1].
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Wrap {
        /// It begins anew
        #[default]
        Repeat = "repeat",
        /// It is mirrored
        Mirror = "mirror",
        /// Its edge goes on
        Clamp = "clamp",
    }
}

/// A texture as a material takes it.
#[derive(Debug, Clone)]
pub struct Map {
    /// The picture; many maps may share one.
    pub texture: Arc<Texture>,
    /// Where on it a surface is.
    pub placement: Placement,
}

/// Two maps are the same if they take the same picture, not an equal one.
impl PartialEq for Map {
    fn eq(&self, other: &Map) -> bool {
        Arc::ptr_eq(&self.texture, &other.texture) && self.placement == other.placement
    }
}

/// From a surface to a texture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Which set of texture coordinates, 0 or 1.
    pub set: u32,
    /// Rows of an affine map of them (KHR_texture_transform): a coordinate is the product of the first two numbers with both, and
    /// the third.
    pub transform: [[f32; 3]; 2],
    /// Beyond the first coordinate's [0, 1], and the second's.
    pub wrap: [Wrap; 2],
    /// Does its nearest texel count, whatever filter is asked for?
    pub nearest: bool,
}

impl Default for Placement {
    fn default() -> Self {
        Placement { set: 0, transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], wrap: [Wrap::Repeat; 2], nearest: false }
    }
}

/// The maps of a material, each multiplied with its own number.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Maps {
    /// Base and diffuse colour, sRGB; its alpha is opacity.
    pub base: Option<Map>,
    /// Roughness (green) and metalness (blue), linear.
    pub metallic_roughness: Option<Map>,
    /// Normals in the frame of tangent, bitangent and normal, linear.
    pub normal: Option<Map>,
    /// What slopes of the normals are multiplied with.
    pub normal_scale: f32,
    /// Emission, sRGB.
    pub emission: Option<Map>,
    /// Transmission (red), linear.
    pub transmission: Option<Map>,
    /// Strength of the reflection of what is no metal (alpha).
    pub specular_weight: Option<Map>,
    /// Its tint, sRGB.
    pub specular_tint: Option<Map>,
    /// Direction (red, green) and strength (blue) of anisotropy, linear.
    pub anisotropy: Option<Map>,
    /// Opacity alone (alpha); without this that of `base` counts.
    pub opacity: Option<Map>,
    /// What is multiplied with the numbers of coats, sheen and what else a material has beside these.
    pub finish: FinishMaps,
}

/// The maps of what lies on a material, and of what else its base does with light, each multiplied with its own number.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FinishMaps {
    /// How much of the surface the coat is on (red), linear.
    pub coat: Option<Map>,
    /// The coat's roughness (green), linear.
    pub coat_roughness: Option<Map>,
    /// Its normals in the frame of tangent, bitangent and normal, linear. Without this map it is as smooth as the mesh is.
    pub coat_normal: Option<Map>,
    /// What slopes of these normals are multiplied with.
    pub coat_normal_scale: f32,
    /// The sheen's colour, sRGB.
    pub sheen_colour: Option<Map>,
    /// Its roughness (alpha).
    pub sheen_roughness: Option<Map>,
    /// The share of the base's light that leaves on the far side (alpha).
    pub diffuse_transmission: Option<Map>,
    /// The colour of that light, sRGB.
    pub diffuse_transmission_colour: Option<Map>,
    /// How much of the surface the film is on (red), linear.
    pub film: Option<Map>,
    /// The film's thickness from the least to the greatest (green), linear.
    pub film_thickness: Option<Map>,
}

impl FinishMaps {
    /// All maps that there are.
    pub fn all(&self) -> impl Iterator<Item = &Map> {
        let FinishMaps {
            coat,
            coat_roughness,
            coat_normal,
            coat_normal_scale: _,
            sheen_colour,
            sheen_roughness,
            diffuse_transmission,
            diffuse_transmission_colour,
            film,
            film_thickness,
        } = self;
        let all = [
            coat,
            coat_roughness,
            coat_normal,
            sheen_colour,
            sheen_roughness,
            diffuse_transmission,
            diffuse_transmission_colour,
            film,
            film_thickness,
        ];
        all.into_iter().flatten()
    }

    /// These maps, and `under` where there is none.
    pub fn over(self, under: FinishMaps) -> FinishMaps {
        let has_normals = self.coat_normal.is_some();
        FinishMaps {
            coat: self.coat.or(under.coat),
            coat_roughness: self.coat_roughness.or(under.coat_roughness),
            coat_normal: self.coat_normal.or(under.coat_normal),
            coat_normal_scale: if has_normals { self.coat_normal_scale } else { under.coat_normal_scale },
            sheen_colour: self.sheen_colour.or(under.sheen_colour),
            sheen_roughness: self.sheen_roughness.or(under.sheen_roughness),
            diffuse_transmission: self.diffuse_transmission.or(under.diffuse_transmission),
            diffuse_transmission_colour: self.diffuse_transmission_colour.or(under.diffuse_transmission_colour),
            film: self.film.or(under.film),
            film_thickness: self.film_thickness.or(under.film_thickness),
        }
    }
}

impl Maps {
    /// All maps that there are.
    pub fn all(&self) -> impl Iterator<Item = &Map> {
        let Maps {
            base,
            metallic_roughness,
            normal,
            normal_scale: _,
            emission,
            transmission,
            specular_weight,
            specular_tint,
            anisotropy,
            opacity,
            finish,
        } = self;
        let all = [
            base,
            metallic_roughness,
            normal,
            emission,
            transmission,
            specular_weight,
            specular_tint,
            anisotropy,
            opacity,
        ];
        all.into_iter().flatten().chain(finish.all())
    }

    /// These maps, and `under` where there is none.
    pub fn over(self, under: Maps) -> Maps {
        let has_normals = self.normal.is_some();
        Maps {
            base: self.base.or(under.base),
            metallic_roughness: self.metallic_roughness.or(under.metallic_roughness),
            normal: self.normal.or(under.normal),
            normal_scale: if has_normals { self.normal_scale } else { under.normal_scale },
            emission: self.emission.or(under.emission),
            transmission: self.transmission.or(under.transmission),
            specular_weight: self.specular_weight.or(under.specular_weight),
            specular_tint: self.specular_tint.or(under.specular_tint),
            anisotropy: self.anisotropy.or(under.anisotropy),
            opacity: self.opacity.or(under.opacity),
            finish: self.finish.over(under.finish),
        }
    }
}

/// How opaque a material is.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum Alpha {
    /// Everywhere, whatever its textures say.
    #[default]
    Opaque,
    /// Where its opacity is at least so much; elsewhere it is not there.
    Mask(f32),
    /// As often as its opacity says.
    Blend,
}

impl Texture {
    /// The largest width and height in texels.
    pub const MOST_SIDE: u32 = eyerays_shader::data::TextureMap::MOST_SIDE;

    /// Refuses what no picture may have.
    ///
    /// # Errors
    /// A side of no texels or too many, another number of texels, or a number that is not finite or below 0.
    pub fn check(&self) -> Result<()> {
        Texture::check_size(self.width, self.height)?;
        let (found, odd) = match &self.texels {
            Texels::Bytes(bytes) => (bytes.len(), None),
            Texels::Floats(floats) => {
                let most = [f32::MAX, f32::MAX, f32::MAX, 1.0];
                let mut numbers = floats.iter().flat_map(|texel| texel.iter().zip(most));
                (floats.len(), numbers.find(|(x, most)| !(0.0..=*most).contains(*x)).map(|(x, _)| *x))
            }
        };
        let wanted = self.width as usize * self.height as usize;
        if found != wanted {
            return Err(Error::new(format!("the texture {:?} has {found} texels and needs {wanted}", self.name)));
        }
        let fault =
            |odd| format!("the texture {:?} holds {odd}; light is finite and at least 0, opacity at most 1", self.name);
        odd.map_or(Ok(()), |odd| Err(Error::new(fault(odd))))
    }

    /// Does any texel let something through?
    pub fn has_opacity(&self) -> bool {
        match &self.texels {
            Texels::Bytes(bytes) => bytes.iter().any(|texel| texel[3] < u8::MAX),
            Texels::Floats(floats) => floats.iter().any(|texel| texel[3] < 1.0),
        }
    }

    /// Its opacity in every channel: that of its texels where it [has](Texture::has_opacity) one, and else their red.
    pub fn opacity(&self) -> Texture {
        let channel = if self.has_opacity() { 3 } else { 0 };
        let texels = match &self.texels {
            Texels::Bytes(bytes) => bytes.iter().map(|texel| [texel[channel]; 4]).collect(),
            Texels::Floats(floats) => {
                let share = |x: f32| (f64::from(x).min(1.0) * 255.0).round() as u8;
                floats.iter().map(|texel| [share(texel[channel]); 4]).collect()
            }
        };
        Texture { name: self.name.clone(), texels: Texels::Bytes(texels), ..*self }
    }

    /// Refuses a size that no texture may have.
    ///
    /// # Errors
    /// A side of no texels, or of too many.
    pub fn check_size(width: u32, height: u32) -> Result<()> {
        let sides = 1..=Texture::MOST_SIDE;
        if sides.contains(&width) && sides.contains(&height) {
            return Ok(());
        }
        let most = Texture::MOST_SIDE;
        Err(Error::new(format!("is {width}x{height} texels large; a texture has 1 to {most} a side: make it smaller")))
    }
}

impl Placement {
    /// That of scaled, then turned, then moved coordinates (KHR_texture_transform): the angle in degrees, counter-clockwise.
    pub fn transformed(self, scale: Vec2, rotation: f32, offset: Vec2) -> Self {
        let (sine, cosine) = crate::math::sin_cos(f64::from(rotation).to_radians());
        let number = |x: f64| x as f32;
        let (x, y) = (f64::from(scale.x), f64::from(scale.y));
        let transform =
            [[number(cosine * x), number(sine * y), offset.x], [number(-sine * x), number(cosine * y), offset.y]];
        Placement { transform, ..self }
    }
}
