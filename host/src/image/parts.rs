//! The parts of an OpenEXR file, as its headers tell of them before any pixel is decoded.

use std::io::BufRead;

use ::exr::meta::MetaData;
use ::exr::meta::header::Header;
use image::ImageFormat;

use super::read::{most_per_pixel, room, unreadable};
use crate::error::{Error, Result};
use crate::picture::Picture;

/// The headers of a file's parts.
///
/// # Errors
/// No readable headers.
pub fn headers(reader: &mut impl BufRead) -> Result<Vec<Header>> {
    Ok(MetaData::read_from_buffered(reader, false).map_err(fault)?.headers.into_vec())
}

/// Refuses a file whose parts hold more than their pixels may: a decoder takes memory by the size of the data, and
/// `image` asks for that of the display alone.
///
/// # Errors
/// A part that is too large, of too many channels, or that there is no memory for.
pub fn check(parts: &[Header]) -> Result<()> {
    let most = most_per_pixel(ImageFormat::OpenExr).unwrap_or(0);
    parts.iter().try_for_each(|part| {
        let [width, height] =
            [part.layer_size.0, part.layer_size.1].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
        Picture::check_size(width, height)?;
        let each = part.channels.bytes_per_pixel as u64;
        if each > most {
            return Err(Error::new(format!("has pixels of more than {most} bytes; write fewer layers")));
        }
        room(width, height, each)
    })
}

/// Whether one of the parts has these channels.
pub fn have(parts: &[Header], names: &[&str]) -> bool {
    let has = |part: &Header, name: &str| part.channels.list.iter().any(|channel| channel.name.eq(name));
    parts.iter().any(|part| names.iter().all(|name| has(part, name)))
}

/// What is wrong with a file that the crate can't read.
pub fn fault(error: ::exr::error::Error) -> Error {
    match error {
        ::exr::error::Error::Io(error) => unreadable(error),
        _ => Error::new("is damaged; write the image again"),
    }
}
