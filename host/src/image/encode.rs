//! Films to the bytes of image files.

use std::borrow::Cow;
use std::io::{Cursor, Write};

use image::codecs::hdr::HdrEncoder;
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageResult};
use rayon::prelude::*;

use super::transfer::quantise;
use super::{BitDepth, Encoding, Format};
use crate::error::{Error, Result};
use crate::film::Film;
use crate::output::write_error;

/// Encodes a film and writes the file's bytes, at once and in order, so that any writer will do.
///
/// In a PNG, NaN and what is below 0 become 0 and what is above 1 becomes 1. In an HDR, NaN and
/// what is below 0 become 0 and infinity becomes the format's greatest value; pixels darker than
/// the least normal `f32` become black. An EXR keeps all of them.
///
/// # Errors
/// An invalid film, an exposure out of range, and those of the writer. They name no file.
pub fn encode(film: &Film, format: Format, encoding: &Encoding, mut writer: impl Write) -> Result<()> {
    film.validate()?;
    let scale = encoding.scale()?;
    let encoded = match (format, encoding.bits) {
        (Format::Png, BitDepth::Eight) => {
            let values = samples(film, |v| quantise(v * scale, 255.0) as u8);
            png(film, &values, ExtendedColorType::Rgb8)
        }
        (Format::Png, BitDepth::Sixteen) => {
            let values = samples(film, |v| quantise(v * scale, 65_535.0) as u16);
            png(film, bytemuck::cast_slice(&values), ExtendedColorType::Rgb16)
        }
        (Format::Exr, _) => exr(film, &exposed(film, scale)),
        (Format::Hdr, _) => hdr(film, &exposed(film, scale)),
    };
    let bytes = encoded.map_err(|error| Error::new(format!("the image cannot be encoded as {format}: {error}")))?;
    writer.write_all(&bytes).map_err(|e| write_error(&e))
}

/// Every channel of every pixel, converted.
fn samples<T: Send>(film: &Film, convert: impl Fn(f64) -> T + Sync) -> Vec<T> {
    let values: &[f32] = film.pixels.as_flattened();
    values.par_iter().map(|&v| convert(v.into())).collect()
}

/// The film's values times `scale`; the very bits where that is 1.
fn exposed(film: &Film, scale: f64) -> Cow<'_, [[f32; 3]]> {
    if scale == 1.0 {
        return Cow::Borrowed(&film.pixels);
    }
    let expose = |v: f32| (f64::from(v) * scale) as f32;
    film.pixels.iter().map(|pixel| pixel.map(expose)).collect()
}

/// The chunks that say what wrote the file and that its colours are sRGB: length, type, data and
/// CRC of each, by the PNG specification (third edition), 11.3.3.3 and 11.3.2.5.
const PNG_CHUNKS: &[u8] = b"\
    \x00\x00\x00\x01sRGB\x00\xae\xce\x1c\xe9\
    \x00\x00\x00\x10tEXtSoftware\x00eyerays\xae\xad\x55\x51";

/// Where a PNG's first chunk, the IHDR, ends.
const PNG_HEADER: usize = 33;

fn png(film: &Film, samples: &[u8], colour: ExtendedColorType) -> ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(samples, film.width, film.height, colour)?;
    bytes.splice(PNG_HEADER..PNG_HEADER, PNG_CHUNKS.iter().copied());
    Ok(bytes)
}

fn exr(film: &Film, pixels: &[[f32; 3]]) -> ImageResult<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    OpenExrEncoder::new(&mut bytes).write_image(
        bytemuck::cast_slice(pixels),
        film.width,
        film.height,
        ExtendedColorType::Rgb32F,
    )?;
    Ok(bytes.into_inner())
}

/// The greatest value of RGBE, 255/256 of 2^127.
const HDR_MAX: f32 = f32::from_bits(0x7eff_0000);

fn hdr(film: &Film, pixels: &[[f32; 3]]) -> ImageResult<Vec<u8>> {
    let pixels: Vec<_> = pixels.iter().map(|&pixel| rgbe_range(pixel)).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes).write_image(
        bytemuck::cast_slice(&pixels),
        film.width,
        film.height,
        ExtendedColorType::Rgb32F,
    )?;
    Ok(bytes)
}

/// Into what RGBE can hold: the encoder's exponent would wrap around at both ends.
fn rgbe_range(pixel: [f32; 3]) -> [f32; 3] {
    // NaN is not above 0.
    let pixel = pixel.map(|v| if v > 0.0 { v.min(HDR_MAX) } else { 0.0 });
    if pixel.iter().all(|&v| v < f32::MIN_POSITIVE) { [0.0; 3] } else { pixel }
}
