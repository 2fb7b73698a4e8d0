//! Is a JPEG whole? Decoders fill what is missing with grey.

use std::io::{self, BufRead, Read};

/// The byte that begins a marker.
const MARKER: u8 = 0xff;

/// Does a JPEG end without the marker of its end (ITU-T T.81, annex B)?
///
/// # Errors
/// It cannot be read.
pub fn is_cut_off(reader: &mut impl BufRead) -> io::Result<bool> {
    // Between markers lies what is compressed.
    while reader.skip_until(MARKER)? > 0 {
        let Some(code) = code(reader)? else { break };
        match code {
            0xd9 => return Ok(false),
            // A byte of data that looks like a marker's, and markers without a segment.
            0x00 | 0x01 | 0xd0..=0xd8 => (),
            _ => {
                let mut length = [0; 2];
                if reader.read_exact(&mut length).is_err() {
                    break;
                }
                let rest = u64::from(u16::from_be_bytes(length)).saturating_sub(2);
                io::copy(&mut reader.by_ref().take(rest), &mut io::sink())?;
            }
        }
    }
    Ok(true)
}

/// What a marker says, behind as many of its first bytes as there are.
fn code(reader: &mut impl BufRead) -> io::Result<Option<u8>> {
    let mut code = [MARKER];
    while code[0] == MARKER {
        if reader.read(&mut code)? == 0 {
            return Ok(None);
        }
    }
    Ok(Some(code[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::image::{DynamicImage, ImageFormat, RgbImage};

    #[test]
    fn a_picture_is_whole_or_cut_off_wherever_it_ends() {
        let noise =
            |x: u32, y: u32, k: u32| ((x * 97) ^ (y * 59) ^ (k * 31)).wrapping_mul(0x9e37_79b9).to_be_bytes()[0];
        let picture = RgbImage::from_fn(40, 30, |x, y| ::image::Rgb([0, 1, 2].map(|k| noise(x, y, k))));
        let mut file = io::Cursor::new(Vec::new());
        DynamicImage::from(picture).write_to(&mut file, ImageFormat::Jpeg).unwrap();
        let mut file = file.into_inner();
        for end in 0..file.len() {
            assert!(is_cut_off(&mut &file[..end]).unwrap(), "{end} of {}", file.len());
        }
        assert!(!is_cut_off(&mut &file[..]).unwrap());
        file.extend(b"what a camera adds");
        assert!(!is_cut_off(&mut &file[..]).unwrap());
        // A small picture in a segment of a large one.
        let thumbnail = [&[0xff, 0xd8, 0xff, 0xe1, 0, 6, 0xff, 0xd8, 0xff, 0xd9], &file[2..200]].concat();
        assert!(is_cut_off(&mut &thumbnail[..]).unwrap());
    }
}
