//! Image files to textures.

use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use image::{DynamicImage, ImageFormat};

use super::read::{Kinds, Size, distrusting, most_per_pixel, open, pixels_of, room};
use crate::error::{Error, Result};
use crate::scene::displace::Heights;
use crate::scene::{Texels, Texture};

/// What the pictures of a file may take, and what those before have left of it.
#[derive(Debug, Clone)]
pub struct TextureBudget(u64);

impl TextureBudget {
    /// Bytes of the texels of all pictures, 4 each, or 16 of floats: with a third more for their levels, what kernels number by words
    /// of 4 bytes.
    pub const MOST: u64 = 12 << 30;

    /// So many bytes, for tests.
    #[cfg(test)]
    pub(super) fn of(bytes: u64) -> Self {
        TextureBudget(bytes)
    }

    /// Takes the share of a picture of so many texels that is made of another, of 4 bytes each.
    ///
    /// # Errors
    /// The pictures before it leave less.
    pub fn take_bytes(&mut self, width: u32, height: u32) -> Result<()> {
        self.take(Size { width, height, is_float: false })
    }

    /// Likewise of floats, 16 bytes each, if there is memory for them.
    ///
    /// # Errors
    /// More texels than a texture may have, or than the pictures before it or memory leave.
    pub fn take_floats(&mut self, width: u32, height: u32) -> Result<()> {
        Texture::check_size(width, height)?;
        self.take(Size { width, height, is_float: true })?;
        room(width, height, 16)
    }

    /// Takes a picture's share.
    fn take(&mut self, Size { width, height, is_float }: Size) -> Result<()> {
        let bytes = u64::from(width) * u64::from(height) * if is_float { 16 } else { 4 };
        self.0 = self.0.checked_sub(bytes).ok_or_else(|| {
            let left = self.0;
            let fault = format!("has {width}x{height} texels, which take {bytes} bytes");
            Error::new(format!("{fault}, and the pictures before it leave {left}; make them smaller"))
        })?;
        Ok(())
    }
}

impl Default for TextureBudget {
    fn default() -> Self {
        TextureBudget(Self::MOST)
    }
}

/// Reads a PNG, JPEG, BMP, TIFF, EXR or HDR file, or a TGA file by its ending, whatever else its name says it is, as [`decode_texture`].
///
/// # Errors
/// What is missing, unreadable, empty or not a regular file, and those of [`decode_texture`]. They name the file.
pub fn read_texture(path: &Path, budget: &mut TextureBudget) -> Result<Texture> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    decode_texture(&name, BufReader::new(open(path)?), budget).map_err(|error| error.of(path))
}

/// Decodes a PNG, JPEG, BMP, TIFF, EXR or HDR file, told apart by their first bytes, or a TGA file by the end of its name. Of all but EXR and HDR the values stay what they are, in 8 bits;
/// light that is below 0 or NaN becomes 0, and infinite light the greatest number. Colours of an EXR with opacity, which are
/// multiplied with it, are divided by it.
///
/// # Errors
/// What is none of these, damaged, truncated, larger than a texture may be, or more than the budget or memory has room for. They
/// name no file.
pub fn decode_texture(name: &str, reader: impl BufRead + Seek, budget: &mut TextureBudget) -> Result<Texture> {
    let (Size { width, height, .. }, image) = decoded(name, reader, budget)?;
    Ok(Texture { name: name.to_owned(), width, height, texels: distrusting(|| Ok(texels(image)))? })
}

/// Reads a picture of heights, its first channel: whole numbers are shares of the greatest, and what is not finite is 0.
///
/// # Errors
/// As [`read_texture`].
pub fn read_heights(path: &Path, budget: &mut TextureBudget) -> Result<Heights> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (size, image) = decoded(&name, BufReader::new(open(path)?), budget).map_err(|error| error.of(path))?;
    distrusting(|| Ok(heights(size, image)))
}

/// The heights of an image, as [`read_heights`].
pub(super) fn heights(Size { width, height, .. }: Size, image: DynamicImage) -> Heights {
    let height_of = |pixel: &image::Rgba<f32>| if pixel.0[0].is_finite() { pixel.0[0] } else { 0.0 };
    Heights { width, height, values: image.into_rgba32f().pixels().map(height_of).collect() }
}

/// An image of a file of this name, which takes its share of the budget.
pub(super) fn decoded(
    name: &str,
    reader: impl BufRead + Seek,
    budget: &mut TextureBudget,
) -> Result<(Size, DynamicImage)> {
    const MOST: u64 = Texture::MOST_SIDE as u64;
    distrusting(|| {
        // Files of this kind have no first bytes to be told by.
        let otherwise = name.to_ascii_lowercase().ends_with(".tga").then_some(ImageFormat::Tga);
        let names = "PNG, JPEG, TGA, BMP, TIFF, EXR or HDR";
        let kinds = Kinds { names, most_per_pixel: most_per_texel, most_pixels: MOST * MOST, otherwise };
        pixels_of(reader, &kinds, |size| {
            Texture::check_size(size.width, size.height)?;
            budget.take(size)
        })
    })
}

/// The most bytes that a texel may have in a file, if the format is one of ours.
fn most_per_texel(format: ImageFormat) -> Option<u64> {
    match format {
        ImageFormat::Jpeg | ImageFormat::Tga | ImageFormat::Bmp => Some(8),
        ImageFormat::Tiff => Some(32),
        other => most_per_pixel(other),
    }
}

pub(super) fn texels(image: DynamicImage) -> Texels {
    use DynamicImage::{ImageRgb32F, ImageRgba32F};
    match image {
        ImageRgb32F(_) | ImageRgba32F(_) => {
            Texels::Floats(image.into_rgba32f().pixels().map(|pixel| straight(pixel.0)).collect())
        }
        // 16 bits become 8, rounded.
        _ => Texels::Bytes(image.into_rgba8().pixels().map(|pixel| pixel.0).collect()),
    }
}

/// Light and opacity in their ranges, with the colour that it has where it is opaque.
fn straight([r, g, b, opacity]: [f32; 4]) -> [f32; 4] {
    let positive = |x: f32| if x > 0.0 { x.min(f32::MAX) } else { 0.0 };
    let opacity = positive(opacity).min(1.0);
    let [r, g, b] = [r, g, b].map(|x| if opacity > 0.0 { positive(positive(x) / opacity) } else { positive(x) });
    [r, g, b, opacity]
}
