//! What a binary scene begins with, and where its sections lie.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use crate::scene::{Disk, Sphere, Unplaced};

/// No text begins like this.
const MAGIC: [u8; 8] = *b"\x89EYERAYS";
/// Of the form that this program writes and reads.
const VERSION: u32 = 1;
/// Sections begin at multiples of so many bytes.
pub const ALIGNMENT: usize = 64;
/// Bytes that a thread hashes at once.
const BLOCK: usize = 1 << 20;
/// Sections of a file.
pub const SECTIONS: usize = 7;

/// The first bytes of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Header {
    magic: [u8; 8],
    version: u32,
    /// Zero.
    reserved: u32,
    hash: [u8; 32],
    pub counts: Counts,
}

/// How many there are of what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Counts {
    /// Bytes of TOML.
    pub description: u64,
    pub positions: u64,
    /// As many as positions, or none.
    pub normals: u64,
    /// Each has a material too.
    pub triangles: u64,
    pub spheres: u64,
    pub disks: u64,
}

impl Counts {
    /// The bytes of every section; none where they are more than can be counted.
    fn lengths(&self) -> Option<[usize; SECTIONS]> {
        let corners = size_of::<[u32; 3]>();
        let sections = [
            (self.description, 1),
            (self.positions, size_of::<Vec3>()),
            (self.normals, size_of::<Vec3>()),
            (self.triangles, corners),
            (self.triangles, size_of::<u32>()),
            (self.spheres, size_of::<Sphere>()),
            (self.disks, size_of::<Disk>()),
        ];
        let mut lengths = [0; SECTIONS];
        for (length, (count, size)) in lengths.iter_mut().zip(sections) {
            *length = usize::try_from(count).ok()?.checked_mul(size)?;
        }
        Some(lengths)
    }
}

impl Header {
    /// The header of these sections.
    pub fn of(counts: Counts, sections: &[&[u8]; SECTIONS]) -> Self {
        Header { magic: MAGIC, version: VERSION, reserved: 0, hash: hash(&counts, sections), counts }
    }

    /// Splits a file into its header and its sections.
    ///
    /// # Errors
    /// It is not of this form, of another version, or not as long as its header says.
    pub fn split(file: &[u8]) -> Unplaced<(Header, [&[u8]; SECTIONS])> {
        let Some(header) = file.get(..size_of::<Header>()).filter(|start| start.starts_with(&MAGIC)) else {
            return Err("this is no binary scene; write one with eyerays convert".into());
        };
        let header: Header = bytemuck::pod_read_unaligned(header);
        if header.version != VERSION {
            let version = header.version;
            return Err(format!("version {version} of the binary form, and {VERSION} is what is read; {AGAIN}"));
        }
        let sections = header.counts.lengths().and_then(|lengths| sections(file, lengths));
        sections.map(|sections| (header, sections)).ok_or_else(|| {
            format!("its {} bytes are not what its header tells, as if it were cut off; {AGAIN}", file.len())
        })
    }

    /// Refuses sections that are not those that were written.
    ///
    /// # Errors
    /// Their hash is another.
    pub fn check(&self, sections: &[&[u8]; SECTIONS]) -> Unplaced<()> {
        if self.hash == hash(&self.counts, sections) {
            return Ok(());
        }
        Err(format!("its contents have another hash than its header tells, so they were changed; {AGAIN}"))
    }
}

/// The remedy for a file that is not as it was written.
const AGAIN: &str = "write it again with eyerays convert";

/// The sections of a file, if they are all of it.
fn sections(file: &[u8], lengths: [usize; SECTIONS]) -> Option<[&[u8]; SECTIONS]> {
    let mut sections = [&file[..0]; SECTIONS];
    let mut end = size_of::<Header>();
    for (section, length) in sections.iter_mut().zip(lengths) {
        let start = end.checked_next_multiple_of(ALIGNMENT)?;
        end = start.checked_add(length)?;
        *section = file.get(start..end)?;
    }
    (end == file.len()).then_some(sections)
}

/// The hash of the counts and of every section's hash, which is that of its blocks' hashes: threads share them.
fn hash(counts: &Counts, sections: &[&[u8]; SECTIONS]) -> [u8; 32] {
    let of_block = |block: &[u8]| -> [u8; 32] { Sha256::digest(block).into() };
    let of_section =
        |section: &&[u8]| Sha256::digest(section.par_chunks(BLOCK).map(of_block).collect::<Vec<_>>().as_flattened());
    let mut all = Sha256::new_with_prefix(bytemuck::bytes_of(counts));
    sections.iter().for_each(|section| all.update(of_section(section)));
    all.finalize().into()
}
