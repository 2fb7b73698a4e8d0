//! Chunks of Blosc 1 (`README_CHUNK_FORMAT.rst` of c-blosc), whose streams are of LZ4, as NanoVDB writes them.

use super::bytes::Bytes;
use crate::scene::Unplaced;

/// What is before the places of a chunk's blocks.
const HEADER: u64 = 16;

/// Flags of a chunk: bytes of its numbers lie apart, first ones first; it is as it was; bits of its numbers lie apart; a block is one stream.
const SHUFFLED: u8 = 1;
const STORED: u8 = 2;
const BITS_SHUFFLED: u8 = 4;
const WHOLE: u8 = 16;
/// The format of streams, above the flags.
const LZ4: u8 = 1;

/// What a chunk says of itself.
struct Chunk<'a> {
    bytes: Bytes<'a>,
    flags: u8,
    /// Bytes of one of its numbers, of a block, and of all that it holds.
    number: usize,
    block: usize,
    size: usize,
}

/// Adds what a chunk holds, at most so many bytes, to others.
///
/// # Errors
/// It holds more, is compressed by something else, or is damaged.
pub fn unpack(chunk: Bytes<'_>, most: u64, out: &mut Vec<u8>) -> Unplaced<()> {
    let chunk = Chunk::of(chunk)?;
    if chunk.size as u64 > most {
        return Err(damaged());
    }
    if chunk.flags & STORED != 0 {
        out.extend(chunk.bytes.part(HEADER, chunk.size as u64)?.0);
        return Ok(());
    }
    if chunk.flags >> 5 != LZ4 || chunk.flags & BITS_SHUFFLED != 0 {
        return Err("it is compressed by another part of Blosc than NanoVDB's, LZ4; write it with ZIP".to_owned());
    }
    let mut place = HEADER;
    let mut start = 0;
    while start < chunk.size {
        let block = chunk.block(u64::from(chunk.bytes.u32(place)?), chunk.block.min(chunk.size - start))?;
        chunk.put(&block, out);
        start += block.len();
        place += 4;
    }
    Ok(())
}

fn damaged() -> String {
    "its numbers, compressed by Blosc, are damaged; write it anew".to_owned()
}

impl<'a> Chunk<'a> {
    fn of(bytes: Bytes<'a>) -> Unplaced<Self> {
        let [.., flags, number] = bytes.part(0, 4)?.0 else { return Err(damaged()) };
        let (size, block) = (bytes.u32(4)? as usize, bytes.u32(8)? as usize);
        let is_sound = *number > 0 && (block > 0 || size == 0);
        is_sound.then_some(Self { bytes, flags: *flags, number: usize::from(*number), block, size }).ok_or_else(damaged)
    }

    /// The bytes of a block, which are shuffled still.
    fn block(&self, at: u64, length: usize) -> Unplaced<Vec<u8>> {
        // One stream for each byte of a number, but not in the last block, if it is shorter, nor in tiny ones.
        let is_split = self.flags & WHOLE == 0 && self.number <= 16 && self.block / self.number >= 128;
        let streams = if is_split && length == self.block { self.number } else { 1 };
        let mut block = vec![0; length];
        let mut at = at;
        for stream in block.chunks_mut(length.div_ceil(streams)) {
            let packed = self.bytes.part(Bytes::beside(at, 4)?, u64::from(self.bytes.u32(at)?))?.0;
            if packed.len() == stream.len() {
                stream.copy_from_slice(packed);
            } else if lz4_flex::block::decompress_into(packed, stream).ok() != Some(stream.len()) {
                return Err(damaged());
            }
            at += 4 + packed.len() as u64;
        }
        Ok(block)
    }

    /// Adds a block with the bytes of its numbers beside each other; those after its last whole number are as they were.
    fn put(&self, block: &[u8], out: &mut Vec<u8>) {
        let count = block.len() / self.number;
        let is_shuffled = self.flags & SHUFFLED != 0 && self.number > 1;
        let shuffled = if is_shuffled { count * self.number } else { 0 };
        out.extend((0..shuffled).map(|i| block[i % self.number * count + i / self.number]));
        out.extend(&block[shuffled..]);
    }
}
