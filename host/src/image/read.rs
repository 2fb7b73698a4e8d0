//! Image files back to pictures.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, ErrorKind, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::{
    ColorType, DynamicImage, ImageBuffer, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits, Primitive, Rgb,
};

use super::bounded::{Allowance, Bounded};
use super::transfer::{byte_to_linear, linear_table};
use super::{hdr, jpeg, layer, parts, png};
use crate::error::{Error, Result};
use crate::memory::Room;
use crate::picture::Picture;

/// Reads a PNG, EXR or HDR file, whatever its name says it is, as [`decode`].
///
/// # Errors
/// What is missing, unreadable, empty or not a regular file, and those of [`decode`]. They name
/// the file.
pub fn read(path: &Path) -> Result<Picture> {
    decode(BufReader::new(open(path)?)).map_err(|error| error.of(path))
}

/// Opens an image file.
pub(super) fn open(path: &Path) -> Result<File> {
    let fault = |error: io::Error| Error::file(path, read_error(&error));
    // Before it is opened: to open a FIFO waits for a writer.
    let found = fs::metadata(path).map_err(fault)?;
    if found.is_dir() {
        return Err(Error::file(path, "is a directory; name an image file"));
    }
    if !found.is_file() {
        return Err(Error::file(path, "is no regular file; name an image file"));
    }
    if found.len() == 0 {
        return Err(Error::file(path, "is empty; write the image again"));
    }
    File::open(path).map_err(fault)
}

/// Decodes a PNG, EXR or HDR file, told apart by their first bytes. A PNG's sRGB values become
/// linear light in [0, 1], equal values becoming equal floats that encode to those values again;
/// an EXR keeps its bits. Greys become RGB, and alpha is ignored.
///
/// # Errors
/// What is none of these, damaged, truncated, or larger than a picture may be. They name no file.
pub fn decode(mut reader: impl BufRead + Seek) -> Result<Picture> {
    distrusting(|| {
        if let Some(picture) = layer::grey(&mut reader)? {
            return Ok(picture);
        }
        let kinds =
            Kinds { names: "PNG, EXR or HDR", most_per_pixel, most_pixels: Picture::MAX_PIXELS, otherwise: None };
        let check = |Size { width, height, .. }| Picture::check_size(width, height).map(drop);
        let (Size { width, height, .. }, decoded) = pixels_of(reader, &kinds, check)?;
        Picture::from_pixels(width, height, linear_pixels(decoded))
    })
}

/// Runs a decoder, whose arithmetic is not proof against every hostile header.
pub(super) fn distrusting<T>(decode: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(decode)).unwrap_or_else(|_| Err(Error::new("is damaged; write the image again")))
}

/// The most bytes that are read before the size of an image is known: its header, and what describes it.
pub(super) const MOST_HEADER: u64 = 16 << 20;
/// What decoding takes: two buffers of four floats.
const MEMORY_PER_PIXEL: u64 = 32;

/// The most bytes that a pixel may have in a file, if the format is one of ours.
pub(super) fn most_per_pixel(format: ImageFormat) -> Option<u64> {
    match format {
        ImageFormat::Png => Some(16),
        ImageFormat::Hdr => Some(8),
        // Beside the colors there may be layers of anything.
        ImageFormat::OpenExr => Some(1024),
        _ => None,
    }
}

/// The images that are decoded.
pub(super) struct Kinds {
    /// What they are called.
    pub names: &'static str,
    /// The most bytes that a pixel may have in a file of a format, if it is one of them.
    pub most_per_pixel: fn(ImageFormat) -> Option<u64>,
    /// The most pixels that one may have.
    pub most_pixels: u64,
    /// What an image is that begins as none of them does.
    pub otherwise: Option<ImageFormat>,
}

/// What is known of an image before it is decoded.
#[derive(Clone, Copy)]
pub(super) struct Size {
    pub width: u32,
    pub height: u32,
    /// Are its values floats?
    pub is_float: bool,
}

/// Decodes an image whose size `check` accepts and that there is memory for, reading no more of it than its size accounts for.
pub(super) fn pixels_of(
    mut reader: impl BufRead + Seek,
    kinds: &Kinds,
    check: impl FnOnce(Size) -> Result<()>,
) -> Result<(Size, DynamicImage)> {
    let guessed = ImageReader::new(&mut reader).with_guessed_format().map_err(unreadable)?.format().or(kinds.otherwise);
    let kind = guessed.and_then(|format| Some((format, (kinds.most_per_pixel)(format)?)));
    let Some((format, most_per_pixel)) = kind else {
        return Err(Error::new(not_read(reader, kinds.names).map_err(unreadable)?));
    };
    let allowance = Allowance::new(MOST_HEADER);
    // A JPEG is looked through to its end, which is no further than the largest has it.
    let most = if format == ImageFormat::Jpeg { kinds.most_pixels * most_per_pixel } else { 0 };
    let most_taken = match format {
        ImageFormat::Png => png::most_taken(&mut reader).map_err(unreadable)?,
        // The widest pixel is one of four floats.
        _ => kinds.most_pixels * 16,
    };
    let exposure = check_header(Bounded::new(&mut reader, Allowance::new(MOST_HEADER + most)), format)?;
    reader.rewind().map_err(unreadable)?;
    let mut reader = ImageReader::with_format(Bounded::new(reader, allowance.clone()), format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(most_taken);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(decode_error)?;
    let (width, height) = decoder.dimensions();
    let is_float = matches!(decoder.color_type(), ColorType::Rgb32F | ColorType::Rgba32F);
    let size = Size { width, height, is_float };
    check(size)?;
    room(width, height, MEMORY_PER_PIXEL)?;
    allowance.add(u64::from(width) * u64::from(height) * most_per_pixel);
    let mut image = DynamicImage::from_decoder(decoder).map_err(decode_error)?;
    if let DynamicImage::ImageRgb32F(pixels) = &mut image
        && exposure != 1.0
    {
        pixels.iter_mut().for_each(|x| *x /= exposure);
    }
    Ok((size, image))
}

/// Refuses what no decoder does, or too late, and returns what light is to be divided by.
fn check_header(mut reader: impl BufRead, format: ImageFormat) -> Result<f32> {
    match format {
        ImageFormat::OpenExr => check_parts(&mut reader)?,
        ImageFormat::Jpeg if jpeg::is_cut_off(&mut reader).map_err(unreadable)? => {
            return Err(Error::new("ends before its picture does; write the image again"));
        }
        ImageFormat::Hdr => {
            let exposure = hdr::exposure(reader).map_err(unreadable)?;
            return exposure.ok_or_else(|| Error::new("has an EXPOSURE that is no number above 0; write it again"));
        }
        _ => (),
    }
    Ok(1.0)
}

/// What is said of an image that begins as none of the `names` does.
fn not_read(mut reader: impl BufRead, names: &str) -> io::Result<String> {
    let start = reader.fill_buf()?;
    let is_webp = start.starts_with(b"RIFF") && start.get(8..12) == Some(b"WEBP");
    let others = [(is_webp, "WebP"), (start.starts_with(b"\xABKTX"), "KTX"), (start.starts_with(b"DDS "), "DDS")];
    Ok(match others.into_iter().find(|(is_it, _)| *is_it) {
        Some((_, name)) => format!("is a {name} image, which is not read; convert it to {names}"),
        None => format!("is not a {names} image; convert it to one of these"),
    })
}

/// Refuses pixels of so many bytes each that there is no memory for.
pub(super) fn room(width: u32, height: u32, each: u64) -> Result<()> {
    let bytes = u64::from(width) * u64::from(height) * each;
    Room::now().check(bytes).map_err(|why| {
        Error::new(format!("has {width}x{height} pixels, which {why}; end other programs or make it smaller"))
    })
}

/// Refuses an EXR without colours, or with parts that are too large.
fn check_parts(reader: &mut impl BufRead) -> Result<()> {
    let parts = parts::headers(reader)?;
    if !parts::have(&parts, &["R", "G", "B"]) {
        return Err(Error::new("has no channels called R, G and B; write it with these"));
    }
    parts::check(&parts)
}

fn linear_pixels(image: DynamicImage) -> Vec<[f32; 3]> {
    use DynamicImage::*;
    match image {
        ImageLuma8(_) | ImageLumaA8(_) | ImageRgb8(_) | ImageRgba8(_) => pixels(&image.into_rgb8(), byte_to_linear),
        ImageLuma16(_) | ImageLumaA16(_) | ImageRgb16(_) | ImageRgba16(_) => {
            let table = linear_table(u16::MAX);
            pixels(&image.into_rgb16(), |v| table[usize::from(v)])
        }
        _ => pixels(&image.into_rgb32f(), |v| v),
    }
}

fn pixels<T>(image: &ImageBuffer<Rgb<T>, Vec<T>>, linear: impl Fn(T) -> f32) -> Vec<[f32; 3]>
where
    T: Primitive,
    Rgb<T>: image::Pixel<Subpixel = T>,
{
    image.pixels().map(|pixel| pixel.0.map(&linear)).collect()
}

fn decode_error(error: ImageError) -> Error {
    Error::new(match error {
        ImageError::IoError(error) => read_error(&error),
        ImageError::Limits(_) => format!("is too large; an image has at most {} pixels", Picture::MAX_PIXELS),
        // Decoders' own words are of their insides.
        ImageError::Unsupported(_) => {
            "is of a kind that is not read; write it as RGB of 8 or 16 bits, or of floats".to_owned()
        }
        _ => "is damaged; write the image again".to_owned(),
    })
}

/// The error of what can not be read.
pub(super) fn unreadable(error: io::Error) -> Error {
    Error::new(read_error(&error))
}

fn read_error(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => "no such file; check the name".to_owned(),
        ErrorKind::PermissionDenied => "no permission to read; change it".to_owned(),
        ErrorKind::FileTooLarge => "holds more than an image of its size can; write the image again".to_owned(),
        ErrorKind::UnexpectedEof => "is truncated; write the image again".to_owned(),
        _ => format!("cannot be read: {error}"),
    }
}
