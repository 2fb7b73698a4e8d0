//! What a PNG file may unpack to.

use std::io::{self, Read, Seek};

/// What colour profiles and other chunks may take beside the pixels, in bytes.
const MOST_CHUNKS: u64 = 16 << 20;

/// The most memory that decoding may take, in bytes, by the size of the picture: its other chunks are compressed too, and a
/// profile of 2 MB may unpack to 2 GB. The reader is where it was before.
///
/// # Errors
/// Those of the reader, but for a file that ends early, which the decoder refuses.
pub fn most_taken(reader: &mut (impl Read + Seek)) -> io::Result<u64> {
    let mut start = Vec::new();
    reader.by_ref().take(24).read_to_end(&mut start)?;
    reader.rewind()?;
    // After a signature of 8 bytes, and the length and the name of the first chunk.
    let side = |at: usize| {
        let bytes = start.get(at..).and_then(|bytes| bytes.first_chunk::<4>());
        bytes.map_or(0, |&bytes| u64::from(u32::from_be_bytes(bytes)))
    };
    // The widest pixel is one of four times 16 bits.
    Ok(side(16).saturating_mul(side(20)).saturating_mul(8).saturating_add(MOST_CHUNKS))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    #[test]
    fn a_picture_of_a_pixel_may_unpack_to_little_and_a_large_one_to_its_pixels_more() {
        let taken = |width: u32, height: u32| {
            let start = [b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR", &width.to_be_bytes()[..], &height.to_be_bytes()].concat();
            let mut reader = Cursor::new(start);
            let most = most_taken(&mut reader).unwrap();
            assert_eq!(reader.position(), 0);
            most
        };
        assert_eq!(taken(1, 1), MOST_CHUNKS + 8);
        assert_eq!(taken(3000, 2000), MOST_CHUNKS + 48_000_000);
        assert_eq!(taken(u32::MAX, u32::MAX), u64::MAX);
        assert_eq!(most_taken(&mut Cursor::new(b"\x89PNG")).unwrap(), MOST_CHUNKS);
    }
}
