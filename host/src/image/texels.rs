//! Image files to textures.

use std::io::{BufRead, BufReader, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::{DynamicImage, ImageFormat, ImageReader, Limits};

use super::bounded::{Allowance, Bounded};
use super::read::{MOST_HEADER, check_parts, decode_error, open, read_error, room};
use crate::error::{Error, Result};
use crate::scene::{Texels, Texture};

/// What decoding takes: the file's pixels, four floats at most, and the texels.
const MEMORY_PER_TEXEL: u64 = 32;

/// Reads a PNG, JPEG, EXR or HDR file, whatever its name says it is, as [`decode`].
///
/// # Errors
/// What is missing, unreadable, empty or not a regular file, and those of [`decode`]. They name the file.
pub fn read_texture(path: &Path) -> Result<Texture> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    decode_texture(&name, BufReader::new(open(path)?)).map_err(|error| error.of(path))
}

/// Decodes a PNG, JPEG, EXR or HDR file, told apart by their first bytes. Of the first two the values stay what they are, in 8 bits;
/// light that is below 0 or NaN becomes 0, and infinite light the greatest number.
///
/// # Errors
/// What is none of these, damaged, truncated, or larger than a texture may be. They name no file.
pub fn decode_texture(name: &str, reader: impl BufRead + Seek) -> Result<Texture> {
    // The decoders' arithmetic is not proof against every hostile header.
    catch_unwind(AssertUnwindSafe(|| decode_trusting(name, reader)))
        .unwrap_or_else(|_| Err(Error::new("is damaged; write the image again")))
}

/// The most bytes that a texel may have in a file, if the format is one of ours.
fn most_per_texel(format: ImageFormat) -> Option<u64> {
    match format {
        ImageFormat::Png => Some(16),
        ImageFormat::Jpeg | ImageFormat::Hdr => Some(8),
        ImageFormat::OpenExr => Some(1024),
        _ => None,
    }
}

fn decode_trusting(name: &str, reader: impl BufRead + Seek) -> Result<Texture> {
    let allowance = Allowance::new(MOST_HEADER);
    let reader = Bounded::new(reader, allowance.clone());
    let unreadable = |e: std::io::Error| Error::new(read_error(&e));
    let reader = ImageReader::new(reader).with_guessed_format().map_err(unreadable)?;
    let kind = reader.format().and_then(|format| Some((format, most_per_texel(format)?)));
    let Some((format, most_per_texel)) = kind else {
        return Err(Error::new("is not a PNG, JPEG, EXR or HDR image"));
    };
    let mut reader = reader.into_inner();
    if format == ImageFormat::OpenExr {
        check_parts(&mut reader)?;
        reader.rewind().map_err(unreadable)?;
    }
    let mut reader = ImageReader::with_format(reader, format);
    let mut limits = Limits::default();
    let most = u64::from(Texture::MOST_SIDE);
    limits.max_alloc = Some(most * most * 16);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(decode_error)?;
    let (width, height) = image::ImageDecoder::dimensions(&decoder);
    Texture::check_size(width, height)?;
    room(width, height, MEMORY_PER_TEXEL)?;
    allowance.add(u64::from(width) * u64::from(height) * most_per_texel);
    let decoded = DynamicImage::from_decoder(decoder).map_err(decode_error)?;
    Ok(Texture { name: name.to_owned(), width, height, texels: texels(decoded) })
}

fn texels(image: DynamicImage) -> Texels {
    use DynamicImage::{ImageRgb32F, ImageRgba32F};
    match image {
        ImageRgb32F(_) | ImageRgba32F(_) => {
            let light = |x: f32| if x > 0.0 { x.min(f32::MAX) } else { 0.0 };
            Texels::Floats(image.into_rgb32f().pixels().map(|pixel| pixel.0.map(light)).collect())
        }
        // 16 bits become 8, rounded.
        _ => Texels::Bytes(image.into_rgba8().pixels().map(|pixel| pixel.0).collect()),
    }
}
