//! Textures in a file: the description tells what they are and who takes them, their texels lie in a section.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::scene::hierarchy::records;
use crate::scene::{Environment, Map, Maps, Placement, Scene, Texels, Texture, Unplaced};

/// A picture: its texels follow those of the picture before.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Picture {
    name: String,
    width: u32,
    height: u32,
    /// Three floats a texel, not four bytes?
    floats: bool,
}

/// The maps of a material.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Taken {
    material: u32,
    normal_scale: f32,
    coat_normal_scale: f32,
    maps: Vec<Use>,
}

/// A map.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Use {
    what: What,
    picture: u32,
    placement: Placement,
}

/// A field of [`Maps`], or of its [`FinishMaps`](crate::scene::FinishMaps).
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum What {
    Base,
    MetallicRoughness,
    Normal,
    Emission,
    Transmission,
    SpecularWeight,
    SpecularTint,
    Anisotropy,
    Opacity,
    Coat,
    CoatRoughness,
    CoatNormal,
    SheenColour,
    SheenRoughness,
    DiffuseTransmission,
    DiffuseTransmissionColour,
    Film,
    FilmThickness,
}

/// An environment.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Around {
    picture: u32,
    rotation: f32,
    scale: f32,
    visible: bool,
}

/// Every picture of a scene, once, and who takes it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pictures {
    environment: Option<Around>,
    pictures: Vec<Picture>,
    taken: Vec<Taken>,
}

impl What {
    const ALL: [What; 18] = [
        What::Base,
        What::MetallicRoughness,
        What::Normal,
        What::Emission,
        What::Transmission,
        What::SpecularWeight,
        What::SpecularTint,
        What::Anisotropy,
        What::Opacity,
        What::Coat,
        What::CoatRoughness,
        What::CoatNormal,
        What::SheenColour,
        What::SheenRoughness,
        What::DiffuseTransmission,
        What::DiffuseTransmissionColour,
        What::Film,
        What::FilmThickness,
    ];

    fn of(self, maps: &mut Maps) -> &mut Option<Map> {
        match self {
            What::Base => &mut maps.base,
            What::MetallicRoughness => &mut maps.metallic_roughness,
            What::Normal => &mut maps.normal,
            What::Emission => &mut maps.emission,
            What::Transmission => &mut maps.transmission,
            What::SpecularWeight => &mut maps.specular_weight,
            What::SpecularTint => &mut maps.specular_tint,
            What::Anisotropy => &mut maps.anisotropy,
            What::Opacity => &mut maps.opacity,
            What::Coat => &mut maps.finish.coat,
            What::CoatRoughness => &mut maps.finish.coat_roughness,
            What::CoatNormal => &mut maps.finish.coat_normal,
            What::SheenColour => &mut maps.finish.sheen_colour,
            What::SheenRoughness => &mut maps.finish.sheen_roughness,
            What::DiffuseTransmission => &mut maps.finish.diffuse_transmission,
            What::DiffuseTransmissionColour => &mut maps.finish.diffuse_transmission_colour,
            What::Film => &mut maps.finish.film,
            What::FilmThickness => &mut maps.finish.film_thickness,
        }
    }
}

impl Pictures {
    /// Those of a scene, and the textures whose texels follow each other in a file.
    pub fn of(scene: &Scene) -> (Pictures, Vec<Arc<Texture>>) {
        let mut textures = Vec::new();
        let environment = scene.environment.as_ref().map(|environment| Around {
            picture: number(&mut textures, &environment.texture),
            rotation: environment.rotation,
            scale: environment.scale,
            visible: environment.visible,
        });
        let mut taken = Vec::new();
        for (of, material) in scene.materials.iter().zip(0..) {
            let mut maps = of.maps.clone();
            if maps == Maps::default() {
                continue;
            }
            let mut uses = Vec::new();
            for what in What::ALL {
                if let Some(Map { texture, placement }) = what.of(&mut maps) {
                    uses.push(Use { what, picture: number(&mut textures, texture), placement: *placement });
                }
            }
            let (normal_scale, coat_normal_scale) = (maps.normal_scale, maps.finish.coat_normal_scale);
            taken.push(Taken { material, normal_scale, coat_normal_scale, maps: uses });
        }
        let pictures = textures.iter().map(|texture| Picture::of(texture)).collect();
        (Pictures { environment, pictures, taken }, textures)
    }

    /// Gives a scene these textures, whose texels are those of a section.
    ///
    /// # Errors
    /// A size that no texture has, another number of texels, or something that takes or is taken by nothing.
    pub fn give(self, scene: &mut Scene, mut texels: &[u8]) -> Unplaced<()> {
        let mut textures = Vec::new();
        for picture in self.pictures {
            textures.push(Arc::new(picture.texture(&mut texels)?));
        }
        if !texels.is_empty() {
            return Err(format!("its textures leave {} bytes of texels over", texels.len()));
        }
        let texture = |number: u32| match textures.get(number as usize) {
            Some(texture) => Ok(Arc::clone(texture)),
            None => Err(format!("something takes texture {number}, but there are {}", textures.len())),
        };
        if let Some(Around { picture, rotation, scale, visible }) = self.environment {
            scene.environment = Some(Environment { texture: texture(picture)?, rotation, scale, visible });
        }
        for Taken { material, normal_scale, coat_normal_scale, maps } in self.taken {
            let materials = scene.materials.len();
            let Some(material) = scene.materials.get_mut(material as usize) else {
                return Err(format!("material {material} takes textures, but there are {materials}"));
            };
            material.maps.normal_scale = normal_scale;
            material.maps.finish.coat_normal_scale = coat_normal_scale;
            for Use { what, picture, placement } in maps {
                *what.of(&mut material.maps) = Some(Map { texture: texture(picture)?, placement });
            }
        }
        Ok(())
    }
}

impl Picture {
    /// That of a texture.
    fn of(texture: &Texture) -> Self {
        let floats = matches!(texture.texels, Texels::Floats(_));
        Picture { name: texture.name.clone(), width: texture.width, height: texture.height, floats }
    }

    /// The texture, from the first of the texels that are left.
    fn texture(self, texels: &mut &[u8]) -> Unplaced<Texture> {
        let Picture { name, width, height, floats } = self;
        let of = |fault: String| format!("the texture {name:?} {fault}");
        Texture::check_size(width, height).map_err(|error| of(error.message()))?;
        let count = width as usize * height as usize;
        let bytes = count * if floats { size_of::<[f32; 4]>() } else { size_of::<[u8; 4]>() };
        let Some((own, rest)) = texels.split_at_checked(bytes) else {
            return Err(of(format!("has {} bytes of texels and needs {bytes}", texels.len())));
        };
        *texels = rest;
        let texels = if floats { Texels::Floats(records(own)) } else { Texels::Bytes(records(own)) };
        Ok(Texture { name, width, height, texels })
    }
}

/// A texture's texels as a file has them.
pub fn bytes(texture: &Texture) -> &[u8] {
    match &texture.texels {
        Texels::Bytes(bytes) => bytes.as_flattened(),
        Texels::Floats(floats) => bytemuck::cast_slice(floats),
    }
}

/// The number of a texture among those so far, which it is put to.
fn number(textures: &mut Vec<Arc<Texture>>, texture: &Arc<Texture>) -> u32 {
    let found = textures.iter().position(|other| Arc::ptr_eq(other, texture));
    let number = found.unwrap_or_else(|| {
        textures.push(texture.clone());
        textures.len() - 1
    });
    number as u32
}
