//! Textures: pictures, how they are sampled, and how materials lay them.

use std::collections::HashMap;
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;

use glam::Vec2;

use super::buffer::Buffers;
use super::document::{Document, Image, Sampler, pick};
use super::notes::Notes;
use super::shading::{Info, Transform};
use super::uri::{self, Target};
use crate::image::{TextureBudget, decode_texture, read_texture};
use crate::scene::{Map, Placement, Texels, Texture, Unplaced, Wrap};
use crate::scene_io::neighbours::Neighbours;

/// The pictures that materials take, each decoded once.
pub struct Pictures<'f> {
    document: &'f Document,
    buffers: &'f Buffers<'f>,
    neighbours: &'f Neighbours,
    decoded: HashMap<usize, Option<Arc<Texture>>>,
    /// What was made of the glossiness of pictures, by the bits of what it was multiplied with.
    rough: Vec<Rough>,
    budget: TextureBudget,
    first: Option<String>,
    faults: usize,
    /// The files that were read for them.
    pub paths: Vec<PathBuf>,
}

/// A picture of roughness that was made of one of glossiness.
struct Rough {
    of: Arc<Texture>,
    factor: f32,
    made: Arc<Texture>,
}

impl<'f> Pictures<'f> {
    /// Those of a document that has these neighbours.
    pub fn new(document: &'f Document, buffers: &'f Buffers<'f>, neighbours: &'f Neighbours) -> Self {
        Pictures {
            document,
            buffers,
            neighbours,
            decoded: HashMap::new(),
            rough: Vec::new(),
            budget: TextureBudget::default(),
            first: None,
            faults: 0,
            paths: Vec::new(),
        }
    }

    /// A texture as a material takes it; `owner` is the JSON path of where it does. None if there is no picture that is read.
    ///
    /// # Errors
    /// A number that names nothing, a picture that cannot be read, or a transform that is out of range.
    pub fn map(&mut self, info: Option<&Info>, owner: &str, notes: &mut Notes) -> Unplaced<Option<Map>> {
        let Some(info) = info else { return Ok(None) };
        let number = info.index.ok_or_else(|| format!("{owner}.index: there is none; name a texture"))?;
        let texture = pick(&self.document.textures, number, &format!("{owner}.index"), "texture")?;
        let Some(source) = texture.source else {
            notes.left_out("source", &format!("textures[{number}] has no PNG or JPEG image and is left out"));
            return Ok(None);
        };
        let of_sampler = format!("textures[{number}].sampler");
        let sampler = texture.sampler.map(|number| pick(&self.document.samplers, number, &of_sampler, "sampler"));
        let placement = placement(info, sampler.transpose()?, owner, notes)?;
        let texture = self.texture(source, &format!("textures[{number}].source"))?;
        Ok(texture.map(|texture| Map { texture, placement }))
    }

    /// The map of roughness (green), for a map whose opacity times a factor is glossiness.
    ///
    /// # Errors
    /// The pictures before it leave no room.
    pub fn rough(&mut self, glossy: &Map, factor: f32) -> Unplaced<Map> {
        let of = &glossy.texture;
        let known = self.rough.iter().find(|rough| Arc::ptr_eq(&rough.of, of) && rough.factor == factor);
        let texture = match known {
            Some(rough) => rough.made.clone(),
            None => {
                let texels = of.texels.opacities();
                self.budget.take_bytes(of.width, of.height).map_err(|error| error.message())?;
                let rough = |share: f32| [0, (255.0 * (1.0 - factor * share) + 0.5) as u8, 0, 255];
                let texels = Texels::Bytes(texels.map(rough).collect());
                let made = Texture { name: of.name.clone(), width: of.width, height: of.height, texels };
                let made = Arc::new(made);
                self.rough.push(Rough { of: of.clone(), factor, made: made.clone() });
                made
            }
        };
        Ok(Map { texture, placement: glossy.placement })
    }

    /// The picture of this number, if there is one that can be read; surfaces are drawn without those that cannot.
    fn texture(&mut self, number: usize, owner: &str) -> Unplaced<Option<Arc<Texture>>> {
        if let Some(texture) = self.decoded.get(&number) {
            return Ok(texture.clone());
        }
        let image = pick(&self.document.images, number, owner, "image")?;
        let texture = match self.decode(image, number) {
            Ok(texture) => Some(Arc::new(texture)),
            Err(fault) => {
                self.faults += 1;
                self.first.get_or_insert(fault);
                None
            }
        };
        self.decoded.insert(number, texture.clone());
        Ok(texture)
    }

    /// What is said of pictures that surfaces are drawn without.
    pub fn warning(&self) -> Option<String> {
        let more = match self.faults.checked_sub(1)? {
            0 => String::new(),
            more => format!(" and {more} more like it"),
        };
        self.first.as_ref().map(|first| format!("{first}{more}: surfaces are drawn without"))
    }

    fn decode(&mut self, image: &Image, number: usize) -> Unplaced<Texture> {
        let here = format!("images[{number}]");
        let name = image.name.as_deref().filter(|name| !name.is_empty()).unwrap_or(&here);
        let budget = &mut self.budget;
        let mut of_bytes = |bytes: &[u8], key| {
            decode_texture(name, Cursor::new(bytes), budget)
                .map_err(|error| format!("{here}.{key}: the image {}", error.message()))
        };
        if let Some(view) = image.buffer_view {
            let (bytes, _) = self.buffers.view(view, &format!("{here}.bufferView"))?;
            return of_bytes(bytes, "bufferView");
        }
        let Some(uri) = &image.uri else {
            return Err(format!("{here}: there is neither a uri nor a bufferView; write the file again"));
        };
        match uri::follow(uri, self.neighbours).map_err(|fault| format!("{here}.uri: {fault}"))? {
            Target::Bytes(bytes) => of_bytes(&bytes, "uri"),
            Target::Missing(name) => Err(format!("{here}.uri: {}", uri::missing(&name))),
            Target::File(path) => {
                let texture = read_texture(&path, &mut self.budget).map_err(|error| format!("{here}.uri: {error}"))?;
                self.paths.push(path);
                Ok(texture)
            }
        }
    }
}

fn placement(info: &Info, sampler: Option<&Sampler>, owner: &str, notes: &mut Notes) -> Unplaced<Placement> {
    let transform = info.extensions.transform.as_ref();
    let set = transform.and_then(|transform| transform.tex_coord).or(info.tex_coord).unwrap_or(0);
    if set > 1 {
        notes.changed(
            "set",
            &format!("{owner}.texCoord: the set {set} is not read, 0 takes its place: only 0 and 1 are"),
        );
    }
    let set = if set == 1 { 1 } else { 0 };
    let default = Sampler::default();
    let sampler = sampler.unwrap_or(&default);
    let wrap = [sampler.wrap_s, sampler.wrap_t].map(wrap);
    let placement = Placement { set, wrap, nearest: sampler.mag_filter == Some(9728), ..Placement::default() };
    let Some(transform) = transform else { return Ok(placement) };
    laid(placement, transform).ok_or_else(|| {
        format!("{owner}.extensions.KHR_texture_transform: a number is out of single precision; repair it")
    })
}

fn wrap(code: Option<u64>) -> Wrap {
    match code {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

/// The placement by a transform, if all its numbers are finite.
fn laid(placement: Placement, transform: &Transform) -> Option<Placement> {
    let pair = |[x, y]: [f64; 2]| Vec2::new(x as f32, y as f32);
    let scale = transform.scale.map_or(Vec2::ONE, pair);
    let offset = transform.offset.map_or(Vec2::ZERO, pair);
    let degrees = transform.rotation.unwrap_or(0.0).to_degrees() as f32;
    if !degrees.is_finite() {
        return None;
    }
    let placement = placement.transformed(scale, degrees, offset);
    placement.transform.as_flattened().iter().all(|number| number.is_finite()).then_some(placement)
}
