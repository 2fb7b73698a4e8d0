//! Numbers of little endian at places of a file that may be shorter.

use crate::scene::Unplaced;

/// A part of a file.
#[derive(Clone, Copy)]
pub struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    /// So many bytes from a place on.
    pub fn part(self, at: u64, count: u64) -> Unplaced<Bytes<'a>> {
        let end = at.checked_add(count).filter(|&end| end <= self.0.len() as u64);
        let end = end.ok_or_else(|| format!("it ends at byte {} and names byte {at}; is it whole?", self.0.len()))?;
        Ok(Bytes(&self.0[at as usize..end as usize]))
    }

    fn array<const N: usize>(self, at: u64) -> Unplaced<[u8; N]> {
        Ok(self.part(at, N as u64)?.0.try_into().expect("so many bytes"))
    }

    pub fn u16(self, at: u64) -> Unplaced<u16> {
        self.array(at).map(u16::from_le_bytes)
    }

    pub fn u32(self, at: u64) -> Unplaced<u32> {
        self.array(at).map(u32::from_le_bytes)
    }

    pub fn i32(self, at: u64) -> Unplaced<i32> {
        self.array(at).map(i32::from_le_bytes)
    }

    pub fn u64(self, at: u64) -> Unplaced<u64> {
        self.array(at).map(u64::from_le_bytes)
    }

    pub fn f32(self, at: u64) -> Unplaced<f32> {
        self.array(at).map(f32::from_le_bytes)
    }

    pub fn f64(self, at: u64) -> Unplaced<f64> {
        self.array(at).map(f64::from_le_bytes)
    }

    /// The place of what lies so far from another.
    pub fn beside(at: u64, offset: u64) -> Unplaced<u64> {
        at.checked_add(offset).ok_or_else(|| "a part of it lies nowhere; write it anew".to_owned())
    }
}
