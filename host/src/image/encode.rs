//! Pictures to the bytes of image files.

use std::fmt;
use std::io::Write;

use image::codecs::hdr::HdrEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageResult};
use png::EncodingError;
use rayon::prelude::*;

use super::SOFTWARE;
use super::exr::{self, exposed};
use super::transfer::{quantise, quantise_to_byte};
use super::white::balanced;
use super::{BitDepth, Encoding, Format, ToneMap};
use crate::choice::Named;
use crate::error::{Error, Result};
use crate::layers::{Layer, Values};
use crate::math;
use crate::picture::Picture;

/// Encodes a picture and writes the file's bytes, at once and in order, so that any writer will do.
///
/// In a PNG, NaN and what is below 0 become 0 and what is above 1 becomes 1, unless a tone map finds a place for it. In an HDR, NaN and
/// what is below 0 become 0 and infinity becomes the format's greatest value; pixels darker than
/// the least normal `f32` become black. An EXR keeps all of them; with floats of 16 bits, finite values
/// beyond ±65504 become that. Of a picture that tells how opaque it is, a PNG has the light that its opaque share sends by itself
/// (straight), an EXR what that share of the pixel sends (associated).
///
/// # Errors
/// An invalid picture, those of [`Encoding::check`], an HDR of a picture that tells how opaque it is, and those of the writer. They name
/// no file.
pub fn encode(picture: &Picture, format: Format, encoding: &Encoding, mut writer: impl Write) -> Result<()> {
    picture.validate()?;
    encoding.check(format)?;
    let scale = encoding.scale()?;
    let picture = &*balanced(picture, encoding.white);
    let refused = |error: &dyn fmt::Display| Error::new(format!("the image cannot be encoded as {format}: {error}"));
    let bytes = match format {
        Format::Png => png(picture, encoding, scale).map_err(|e| refused(&e))?,
        // With how opaque it is, channels have names.
        Format::Exr if picture.alpha.is_some() => {
            exr::layered(picture, &[], encoding, scale).map_err(|e| refused(&e))?
        }
        Format::Exr if encoding.half => exr::half(picture, scale).map_err(|e| refused(&e))?,
        Format::Exr => exr::single(picture, scale).map_err(|e| refused(&e))?,
        Format::Hdr if picture.alpha.is_some() => return Err(Error::NoAlpha { format: format.name() }),
        Format::Hdr => hdr(picture, scale).map_err(|e| refused(&e))?,
    };
    writer.write_all(&bytes).map_err(|e| Error::writing(&e))
}

/// Encodes a picture with layers of it as an EXR, as [`encode`]: layers of light are exposed as it is, and floats of 16 bits hold
/// all but lengths and numbers.
///
/// # Errors
/// As [`encode`], and a layer of another number of pixels.
pub fn encode_layers(
    picture: &Picture,
    layers: &[(Layer, Values)],
    encoding: &Encoding,
    mut writer: impl Write,
) -> Result<()> {
    picture.validate()?;
    encoding.check(Format::Exr)?;
    if let Some((layer, _)) = layers.iter().find(|(_, values)| values.pixels() != picture.pixels.len()) {
        return Err(Error::new(format!(
            "the layer {} has other pixels than the picture; render it again",
            layer.name()
        )));
    }
    let shown = balanced(picture, encoding.white);
    let bytes = exr::layered(&shown, layers, encoding, encoding.scale()?);
    let bytes = bytes.map_err(|error| Error::new(format!("the layers cannot be encoded as EXR: {error}")))?;
    writer.write_all(&bytes).map_err(|e| Error::writing(&e))
}

/// What a screen shows of a picture: the values of a PNG of 8 bits, with how opaque each pixel is (255 where the picture does not tell),
/// row by row.
///
/// # Errors
/// An invalid picture, and those of [`Encoding::scale`].
pub fn screen(picture: &Picture, encoding: &Encoding) -> Result<Vec<[u8; 4]>> {
    picture.validate()?;
    let scale = encoding.scale()?;
    let bytes = bytes(&balanced(picture, encoding.white), encoding.tone, scale);
    Ok(match picture.alpha {
        Some(_) => bytes.as_chunks().0.to_vec(),
        None => bytes.as_chunks().0.iter().map(|&[red, green, blue]| [red, green, blue, 255]).collect(),
    })
}

/// The values of a PNG of 8 bits.
fn bytes(picture: &Picture, tone: ToneMap, scale: f64) -> Vec<u8> {
    samples(picture, (tone, scale), quantise_to_byte, |alpha| (alpha * 255.0).round() as u8)
}

/// Every channel of every pixel, exposed, mapped to the screen and converted; with how opaque it is, converted by `share`, if the picture
/// tells that.
fn samples<T: Send>(
    picture: &Picture,
    (tone, scale): (ToneMap, f64),
    convert: impl Fn(f64) -> T + Sync,
    share: impl Fn(f64) -> T + Sync,
) -> Vec<T> {
    let shown = |pixel: &[f32; 3], scale: f64| tone.apply(pixel.map(|v| f64::from(v) * scale)).map(&convert);
    let Some(alpha) = &picture.alpha else {
        return picture.pixels.par_iter().map(|pixel| shown(pixel, scale)).collect::<Vec<_>>().into_flattened();
    };
    let straight = |(pixel, &alpha): (&[f32; 3], &f32)| {
        let alpha = f64::from(alpha);
        let [red, green, blue] = shown(pixel, if alpha > 0.0 { scale / alpha } else { 0.0 });
        [red, green, blue, share(alpha)]
    };
    picture.pixels.par_iter().zip(alpha).map(straight).collect::<Vec<_>>().into_flattened()
}

fn png(picture: &Picture, encoding: &Encoding, scale: f64) -> std::result::Result<Vec<u8>, EncodingError> {
    match encoding.bits {
        BitDepth::Eight => png_of(picture, &bytes(picture, encoding.tone, scale), png::BitDepth::Eight),
        BitDepth::Sixteen => {
            let share = |alpha: f64| (alpha * 65_535.0).round() as u16;
            let values = samples(picture, (encoding.tone, scale), |v| quantise(v, 65_535.0) as u16, share);
            let bytes: Vec<[u8; 2]> = values.iter().map(|value| value.to_be_bytes()).collect();
            png_of(picture, bytes.as_flattened(), png::BitDepth::Sixteen)
        }
    }
}

/// Tells that its colours are sRGB, what wrote it, and what the picture says of itself.
fn png_of(picture: &Picture, samples: &[u8], depth: png::BitDepth) -> std::result::Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(if picture.alpha.is_some() { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.add_text_chunk("Software".to_owned(), SOFTWARE.to_owned())?;
    if !picture.about.is_empty() {
        encoder.add_text_chunk("eyerays".to_owned(), picture.about.json())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(samples)?;
    writer.finish()?;
    Ok(bytes)
}

/// The greatest value of RGBE, 255/256 of 2^127.
const HDR_MAX: f32 = f32::from_bits(0x7eff_0000);

fn hdr(picture: &Picture, scale: f64) -> ImageResult<Vec<u8>> {
    let pixels: Vec<_> = picture.pixels.iter().map(|pixel| rgbe(pixel.map(|v| exposed(v, scale)))).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes).write_image(
        bytemuck::cast_slice(&pixels),
        picture.width,
        picture.height,
        ExtendedColorType::Rgb32F,
    )?;
    Ok(bytes)
}

/// To the 8 bits a channel that RGBE holds. The encoder's exponent would wrap around at both ends of its range, and of
/// a number just below a power of two it would hang on the platform's logarithm.
fn rgbe(pixel: [f32; 3]) -> [f32; 3] {
    // NaN is not above 0.
    let pixel = pixel.map(|v| if v > 0.0 { v.min(HDR_MAX) } else { 0.0 });
    let greatest = pixel.into_iter().fold(0.0, f32::max);
    if greatest < f32::MIN_POSITIVE {
        return [0.0; 3];
    }
    let step = math::power_of_two_below(greatest.into()) / 128.0;
    pixel.map(|v| ((f64::from(v) / step).floor() * step) as f32)
}
