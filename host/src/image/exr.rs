//! Pictures to OpenEXR files, compressed by ZIP, which loses nothing.

use std::io::Cursor;

use exr::block::writer::ChunksWriter;
use exr::block::{self, UncompressedBlock};
use exr::error::UnitResult;
use exr::image::write::layers::{LayersWriter, WritableLayers};
use exr::prelude::*;
use rayon::prelude::*;

use super::SOFTWARE;
use super::white::balanced;
use crate::about::About;
use crate::choice::Named;
use crate::layers::{self, Values};
use crate::picture::Picture;

/// Blocks of 16 lines that are compressed at once: enough for every core, and few of them in memory.
const BATCH: usize = 64;

/// The file's bytes with floats of 32 bits, their values times `scale`; the very bits where that is 1.
pub(super) fn single(picture: &Picture, scale: f64) -> Result<Vec<u8>> {
    bytes(picture, |v| exposed(v, scale))
}

/// The file's bytes with floats of 16 bits, the nearest to the values times `scale`. What is finite stays finite:
/// beyond ±65504, the greatest of these floats, it becomes that.
pub(super) fn half(picture: &Picture, scale: f64) -> Result<Vec<u8>> {
    bytes(picture, |v| nearest_half(exposed(v, scale)))
}

/// A value as it is exposed.
pub(super) fn exposed(v: f32, scale: f64) -> f32 {
    // A NaN's bits would not outlive the product.
    if scale == 1.0 { v } else { (f64::from(v) * scale) as f32 }
}

fn nearest_half(v: f32) -> f16 {
    let most = f16::MAX.to_f32();
    f16::from_f32(if v.is_finite() { v.clamp(-most, most) } else { v })
}

/// The file's bytes with layers beside a picture that is balanced already, whose channels have the layer's name before a point. Light is
/// balanced and exposed, and in floats of 16 bits if those are asked for; lengths and numbers keep 32 bits.
pub(super) fn layered(
    picture: &Picture,
    layers: &[(layers::Layer, Values)],
    encoding: &super::Encoding,
    scale: f64,
) -> Result<Vec<u8>> {
    let is_half = encoding.half;
    let of = |name: String, values: &Values| match values {
        Values::Light(picture) => three(&balanced(picture, encoding.white), &name, ["R", "G", "B"], scale, is_half),
        Values::Colours(picture) => three(picture, &name, ["R", "G", "B"], 1.0, is_half),
        Values::Vectors(picture) => three(picture, &name, ["X", "Y", "Z"], 1.0, is_half),
        Values::Coordinates(picture) => {
            let mut all = three(picture, &name, ["U", "V", "W"], 1.0, is_half);
            all.truncate(2);
            all
        }
        Values::Ways(picture) => {
            let mut all = three(picture, &name, ["X", "Y", "Z"], 1.0, false);
            all.truncate(2);
            all
        }
        Values::Parts(parts) => {
            let of = |(name, picture): &(String, Picture)| {
                three(&balanced(picture, encoding.white), &format!("{name}."), ["R", "G", "B"], scale, is_half)
            };
            parts.iter().flat_map(of).collect()
        }
        Values::Lengths(lengths) => vec![channel(&name, "Z", FlatSamples::F32(lengths.clone()))],
        Values::Numbers(numbers) => vec![channel(&name, "id", FlatSamples::U32(numbers.clone()))],
        Values::Shares(matte) => {
            let channels = matte.channels().into_iter();
            channels.map(|(name, values)| channel("", &name, FlatSamples::F32(values))).collect()
        }
    };
    let mut channels: SmallVec<[_; 4]> = three(picture, "", ["R", "G", "B"], scale, is_half).into();
    let alpha = picture.alpha.as_ref().map(|alpha| channel("", "A", floats(alpha.par_iter().copied(), is_half)));
    channels.extend(alpha);
    channels.extend(layers.iter().flat_map(|(layer, values)| of(format!("{}.", layer.name()), values)));
    let mut image = Image::from_encoded_channels(size(picture), Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    image.layer_data.attributes = attributes(&picture.about);
    for (_, values) in layers {
        let Values::Shares(matte) = values else { continue };
        let said = matte.attributes().into_iter();
        let texts = said.filter_map(|(name, value)| Some((Text::new_or_none(name)?, Text::new_or_none(value)?)));
        let other = &mut image.layer_data.attributes.other;
        other.extend(texts.map(|(name, value)| (name, AttributeValue::Text(value))));
    }
    let mut bytes = Cursor::new(Vec::new());
    write(&image, &mut bytes)?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes);
    Ok(bytes)
}

/// Brings the attributes of a file of one part into the order of their names: the crate keeps those that it does not know in another order
/// each time.
fn sort_attributes(bytes: &mut [u8]) {
    // Behind the magic number and the version.
    const FIRST: usize = 8;
    let mut attributes = Vec::new();
    let mut at = FIRST;
    while bytes[at] != 0 {
        let text = |from: usize| from + bytes[from..].iter().position(|&byte| byte == 0).expect("texts end") + 1;
        let value = text(text(at));
        let size = bytes[value..value + 4].try_into().expect("four bytes");
        let end = value + 4 + u32::from_le_bytes(size) as usize;
        attributes.push(bytes[at..end].to_vec());
        at = end;
    }
    attributes.sort_unstable();
    bytes[FIRST..at].copy_from_slice(&attributes.concat());
}

fn channel(layer: &str, name: &str, samples: FlatSamples) -> AnyChannel<FlatSamples> {
    AnyChannel::new(format!("{layer}{name}").as_str(), samples)
}

fn floats(values: impl IndexedParallelIterator<Item = f32>, is_half: bool) -> FlatSamples {
    if is_half { FlatSamples::F16(values.map(nearest_half).collect()) } else { FlatSamples::F32(values.collect()) }
}

fn three(picture: &Picture, layer: &str, names: [&str; 3], scale: f64, is_half: bool) -> Vec<AnyChannel<FlatSamples>> {
    let samples = |i: usize| floats(picture.pixels.par_iter().map(|pixel| exposed(pixel[i], scale)), is_half);
    names.into_iter().enumerate().map(|(i, name)| channel(layer, name, samples(i))).collect()
}

fn bytes<T>(picture: &Picture, convert: impl Fn(f32) -> T + Sync) -> Result<Vec<u8>>
where
    T: IntoSample,
{
    let pixel = |Vec2(x, y): Vec2<usize>| {
        let [r, g, b] = picture.pixels[y * picture.width as usize + x];
        (convert(r), convert(g), convert(b))
    };
    let mut image = Image::from_encoded_channels(size(picture), Encoding::SMALL_LOSSLESS, SpecificChannels::rgb(pixel));
    image.layer_data.attributes = attributes(&picture.about);
    let mut bytes = Cursor::new(Vec::new());
    write(&image, &mut bytes)?;
    Ok(bytes.into_inner())
}

fn size(picture: &Picture) -> Vec2<usize> {
    Vec2(picture.width as usize, picture.height as usize)
}

/// What the picture says of itself.
fn attributes(about: &About) -> LayerAttributes {
    let mut attributes = LayerAttributes {
        software_name: Text::new_or_none(SOFTWARE),
        world_to_camera: about.matrix(About::WORLD_TO_CAMERA),
        world_to_normalized_device: about.matrix(About::WORLD_TO_NDC),
        ..LayerAttributes::default()
    };
    if let Some(text) = Text::new_or_none(about.json()).filter(|_| !about.is_empty()) {
        attributes.other.insert("eyerays".into(), AttributeValue::Text(text));
    }
    attributes
}

/// Compresses on every core. The crate can as well (its feature `rayon`), but would then also read on threads on
/// which a damaged file's panic ends the whole program.
fn write<'a, L: WritableLayers<'a>>(image: &'a Image<L>, bytes: &mut Cursor<Vec<u8>>) -> UnitResult {
    let headers = image.layer_data.infer_headers(&image.attributes);
    let layers = image.layer_data.create_writer(&headers);
    block::write(bytes, headers, true, |meta, out| {
        let blocks: Vec<_> = block::enumerate_ordered_header_block_indices(&meta.headers).collect();
        for batch in blocks.chunks(BATCH) {
            let compress = |&(place, index)| {
                let data = layers.extract_uncompressed_block(&meta.headers, index);
                Ok((place, UncompressedBlock { index, data }.compress_to_chunk(&meta.headers)?))
            };
            let chunks: Result<Vec<_>> = batch.par_iter().map(compress).collect();
            for (place, chunk) in chunks? {
                out.write_chunk(place, chunk)?;
            }
        }
        Ok(())
    })
}
