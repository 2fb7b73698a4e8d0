//! Textures as kernels read them: every picture once, with coarser levels of itself.

use std::sync::Arc;

use eyerays_shader::data::{
    Colours, Effects, FinishMaps as FinishMapsRecord, Maps as MapsRecord, Normals, Opacity, TexCoords, TextureMap,
};
use glam::{UVec4, Vec2, Vec3, Vec4};

use super::levels;
use super::normalisation::flushed_number;
use super::records::by_slot;
use super::tangents;
use crate::error::{Error, Result};
use crate::image::byte_to_linear;
use crate::memory::Room;
use crate::scene::{Alpha, FinishMaps, Map, Material, Scene, Texels, Texture, Wrap};

/// What covers the surfaces of a scene; each empty unless it has a use for it.
#[derive(Default)]
pub struct Textures {
    /// By material.
    pub maps: Vec<MapsRecord>,
    /// Those of finishes, by material.
    pub finish_maps: Vec<FinishMapsRecord>,
    /// Every map.
    pub textures: Vec<TextureMap>,
    /// The table of sRGB, and the texels of all pictures.
    pub texels: Vec<u32>,
    /// In leaf order, of both sets one after the other.
    pub coordinates: Vec<TexCoords>,
    /// In leaf order.
    pub colours: Vec<Colours>,
    /// In leaf order.
    pub tangents: Vec<Normals>,
    /// By material.
    pub opacities: Vec<Opacity>,
    /// The mean of each map's light, linear RGB where it is a colour.
    means: Vec<Vec3>,
}

impl Textures {
    /// Those of a scene whose primitives have an order.
    ///
    /// # Errors
    /// More texels than kernels count, or than there is memory for.
    pub(super) fn new(scene: &Scene, effects: Effects, order: &[u32]) -> Result<Textures> {
        let (mut pack, mut finish_maps) = (Pack::default(), Vec::new());
        if effects.has(Effects::TEXTURED) {
            pack.maps = scene.materials.iter().map(|material| pack.maps(material)).collect::<Result<_>>()?;
            let finish = |material: &Material| pack.finish_maps(&material.maps.finish);
            finish_maps = scene.materials.iter().map(finish).collect::<Result<_>>()?;
        }
        let mut opacities = Vec::new();
        if effects.has(Effects::CUTOUT) {
            opacities = scene.materials.iter().map(|material| pack.opacity(material)).collect::<Result<_>>()?;
        }
        let mesh = &scene.mesh;
        let of = |set: usize| by_slot(scene, order, |_, corners| texcoords(&mesh.coordinates[set], corners));
        let mut coordinates = Vec::new();
        if effects.has(Effects::TEXTURED) {
            coordinates = of(0);
            // Also where no mesh has the set: kernels read it without asking.
            if pack.textures.iter().any(|map| map.place.w & TextureMap::SECOND_SET != 0) {
                coordinates.extend(of(1));
            }
        }
        let is_coloured = effects.has(Effects::COLOURED);
        let colours =
            if is_coloured { by_slot(scene, order, |_, corners| colours(scene, corners)) } else { Vec::new() };
        let has_tangents = effects.has(Effects::TANGENTS);
        let tangents = if has_tangents { tangents::tangents(scene, order) } else { Vec::new() };
        let (texels, means) =
            if effects.has(Effects::TEXTURED) { pack.texels(Room::now())? } else { Default::default() };
        let Pack { maps, textures, .. } = pack;
        Ok(Textures { maps, finish_maps, textures, texels, coordinates, colours, tangents, opacities, means })
    }

    /// What a material's emission is multiplied with: the map, 0 for none, and the mean of its light, linear RGB.
    pub(super) fn emission(&self, material: usize) -> (u32, Vec3) {
        let map = self.maps.get(material).map_or(0, |maps| maps.of(MapsRecord::EMISSION));
        (map, if map > 0 { self.means[map as usize - 1] } else { Vec3::ONE })
    }

    /// How opaque a material is.
    pub(super) fn opacity(&self, material: usize) -> Opacity {
        let opaque = Opacity { mask: UVec4::new(1.0f32.to_bits(), 0.0f32.to_bits(), 0, 0) };
        self.opacities.get(material).copied().unwrap_or(opaque)
    }

    /// Bytes of the texels of pictures.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.texels[..])
    }
}

fn texcoords(coordinates: &[Vec2], corners: [u32; 3]) -> TexCoords {
    let at = |vertex: u32| coordinates.get(vertex as usize).copied().unwrap_or(Vec2::ZERO);
    let bits = |x: f32| flushed_number(x).to_bits();
    let [a, b, c] = corners.map(at);
    TexCoords { ab: UVec4::new(bits(a.x), bits(a.y), bits(b.x), bits(b.y)), c: UVec4::new(bits(c.x), bits(c.y), 0, 0) }
}

fn colours(scene: &Scene, corners: [u32; 3]) -> Colours {
    let at = |vertex: u32| scene.mesh.colours.get(vertex as usize).copied().unwrap_or(Vec4::ONE);
    let [a, b, c] = corners.map(|vertex| UVec4::from_array(at(vertex).to_array().map(|x| flushed_number(x).to_bits())));
    Colours { a, b, c }
}

/// Maps so far, and the pictures that they lay.
#[derive(Default)]
struct Pack {
    maps: Vec<MapsRecord>,
    textures: Vec<TextureMap>,
    /// Which picture each of them lays.
    laid: Vec<usize>,
    pictures: Vec<Picture>,
    /// Words of all pictures.
    words: u64,
}

/// A picture and its levels among the words of all.
struct Picture {
    texture: Arc<Texture>,
    is_colour: bool,
    start: u32,
    levels: u32,
}

/// Words of the table from which linear light of sRGB's bytes is taken. All pictures follow it.
const TABLE: u64 = 1 << u8::BITS;

impl Pack {
    fn maps(&mut self, material: &Material) -> Result<MapsRecord> {
        let maps = &material.maps;
        let mut put = |map: &Option<Map>, is_colour| self.map(map.as_ref(), is_colour, 1.0);
        let base = put(&maps.base, true)?;
        let metallic_roughness = put(&maps.metallic_roughness, false)?;
        let emission = put(&maps.emission, true)?;
        let transmission = put(&maps.transmission, false)?;
        let weight = put(&maps.specular_weight, false)?;
        let tint = put(&maps.specular_tint, true)?;
        let anisotropy = put(&maps.anisotropy, false)?;
        let normal = self.map(maps.normal.as_ref(), false, maps.normal_scale)?;
        Ok(MapsRecord {
            first: UVec4::new(base, metallic_roughness, normal, emission),
            second: UVec4::new(transmission, weight, tint, anisotropy),
        })
    }

    fn finish_maps(&mut self, maps: &FinishMaps) -> Result<FinishMapsRecord> {
        let mut put = |map: &Option<Map>, is_colour| self.map(map.as_ref(), is_colour, 1.0);
        let (coat, coat_roughness) = (put(&maps.coat, false)?, put(&maps.coat_roughness, false)?);
        let (sheen, sheen_roughness) = (put(&maps.sheen_colour, true)?, put(&maps.sheen_roughness, false)?);
        let beyond = put(&maps.diffuse_transmission, false)?;
        let beyond_colour = put(&maps.diffuse_transmission_colour, true)?;
        let (film, film_thickness) = (put(&maps.film, false)?, put(&maps.film_thickness, false)?);
        let coat_normal = self.map(maps.coat_normal.as_ref(), false, maps.coat_normal_scale)?;
        Ok(FinishMapsRecord {
            first: UVec4::new(coat, coat_roughness, coat_normal, sheen),
            second: UVec4::new(sheen_roughness, beyond, beyond_colour, film),
            third: UVec4::new(film_thickness, 0, 0, 0),
        })
    }

    fn opacity(&mut self, material: &Material) -> Result<Opacity> {
        let (opacity, least) = match material.alpha {
            Alpha::Opaque => (1.0, 0.0),
            Alpha::Mask(least) => (material.opacity, least),
            Alpha::Blend => (material.opacity, -1.0),
        };
        let map = match material.alpha {
            Alpha::Opaque => 0,
            // Its alpha is no colour.
            _ => self.map(material.maps.opacity.as_ref().or(material.maps.base.as_ref()), true, 1.0)?,
        };
        Ok(Opacity { mask: UVec4::new(flushed_number(opacity).to_bits(), flushed_number(least).to_bits(), map, 0) })
    }

    /// The number of a map plus one; 0 for none.
    fn map(&mut self, map: Option<&Map>, is_colour: bool, factor: f32) -> Result<u32> {
        let Some(map) = map else { return Ok(0) };
        let laid = self.place(&map.texture, is_colour)?;
        let Picture { start, levels, .. } = self.pictures[laid];
        let placement = &map.placement;
        let wrap = |wrap| match wrap {
            Wrap::Repeat => TextureMap::REPEAT,
            Wrap::Mirror => TextureMap::MIRROR,
            Wrap::Clamp => TextureMap::CLAMP,
        };
        let [across, down] = placement.wrap.map(wrap);
        let flag = |flag, holds| if holds { flag } else { 0 };
        let is_float = matches!(map.texture.texels, Texels::Floats(_));
        let flags = flag(TextureMap::FLOATS, is_float)
            | flag(TextureMap::SRGB, is_colour && !is_float)
            | flag(TextureMap::NEAREST, placement.nearest)
            | flag(TextureMap::SECOND_SET, placement.set == 1)
            | (across | down << 2) << TextureMap::WRAP_SHIFT;
        let row = |row: [f32; 3], word| {
            let [a, b, c] = row.map(|x| flushed_number(x).to_bits());
            UVec4::new(a, b, c, word)
        };
        let [u, v] = placement.transform;
        let record = TextureMap {
            place: UVec4::new(start, map.texture.width, map.texture.height, flags),
            u: row(u, levels),
            v: row(v, flushed_number(factor).to_bits()),
        };
        let found = self.textures.iter().position(|other| *other == record);
        let number = found.unwrap_or_else(|| {
            self.textures.push(record);
            self.laid.push(laid);
            self.textures.len() - 1
        });
        Ok(number as u32 + 1)
    }

    /// The number of a picture, which gets a place when it is first asked for.
    fn place(&mut self, texture: &Arc<Texture>, is_colour: bool) -> Result<usize> {
        let same = |other: &Picture| Arc::ptr_eq(&other.texture, texture) && other.is_colour == is_colour;
        if let Some(found) = self.pictures.iter().position(same) {
            return Ok(found);
        }
        let (levels, words) = levels::size(texture);
        let full = || Error::new(format!("the texture {:?} is one too many; use smaller ones", texture.name));
        let start = TABLE + self.words;
        // Kernels count words in 32 bits.
        u32::try_from(start + words).map_err(|_| full())?;
        self.pictures.push(Picture { texture: texture.clone(), is_colour, start: start as u32, levels });
        self.words += words;
        Ok(self.pictures.len() - 1)
    }

    /// The words of all pictures, and the mean of each map's light.
    fn texels(&self, room: Room) -> Result<(Vec<u32>, Vec<Vec3>)> {
        let texels = |picture: &Picture| u64::from(picture.texture.width) * u64::from(picture.texture.height);
        let largest = self.pictures.iter().map(texels).max().unwrap_or(0);
        let count = TABLE + self.words;
        let fits = room.check(count * 4 + largest * levels::BYTES_PER_TEXEL);
        fits.map_err(|why| Error::new(format!("the textures' levels {why}; use smaller ones")))?;
        let mut words = Vec::with_capacity(count as usize);
        words.extend((0..=u8::MAX).map(|byte| byte_to_linear(byte).to_bits()));
        let append = |picture: &Picture| Vec3::from(levels::append(&picture.texture, picture.is_colour, &mut words));
        let means: Vec<Vec3> = self.pictures.iter().map(append).collect();
        Ok((words, self.laid.iter().map(|&picture| means[picture]).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pictures of a million texels: with their levels 11 MB, and 5 MB while those of one are made.
    #[test]
    fn levels_that_there_is_no_memory_for_are_refused_before_they_are_made() {
        let mut pack = Pack::default();
        for name in ["a", "b"] {
            let texels = Texels::Bytes(vec![[7; 4]; 1 << 20]);
            pack.place(&Arc::new(Texture { name: name.into(), width: 1 << 10, height: 1 << 10, texels }), true)
                .unwrap();
        }
        let texels = |bytes| pack.texels(Room { bytes, limit: "this test" });
        let (words, _) = texels(17 << 20).unwrap();
        assert_eq!(words.len(), (TABLE + pack.words) as usize);
        assert_eq!(words.capacity(), words.len(), "no more is taken than was asked for");
        let refused = texels(15 << 20).unwrap_err().message();
        assert!(refused.starts_with("the textures' levels take about 16 MB of memory, and this test"), "{refused}");
    }
}
