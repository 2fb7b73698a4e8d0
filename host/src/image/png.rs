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
