//! What a binary scene begins with, and where its sections lie.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use eyerays_shader::data::{Bounds, NodePair};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use crate::scene::{Disk, Instance, Sphere, Unplaced};

/// No text begins like this.
const MAGIC: [u8; 8] = *b"\x89EYERAYS";
/// Of the form that this program writes and reads.
const VERSION: u32 = 9;
/// Sections begin at multiples of so many bytes.
pub const ALIGNMENT: usize = 64;
/// Bytes that a thread hashes at once.
const BLOCK: usize = 1 << 20;
/// Sections of a file.
pub const SECTIONS: usize = 17;

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
    /// Both sets of texture coordinates, tangents and colours, likewise.
    pub coordinates: [u64; 2],
    pub tangents: u64,
    pub colours: u64,
    /// Each has a material too.
    pub triangles: u64,
    pub spheres: u64,
    pub disks: u64,
    /// Copies of meshes.
    pub instances: u64,
    /// Bytes of where things are while the shutter is open.
    pub poses: u64,
    /// Bytes of the texels of all textures.
    pub texels: u64,
    /// Of the hierarchy; all zero without one.
    pub pairs: u64,
    /// Each has a primitive and a box.
    pub slots: u64,
}

impl Counts {
    /// The bytes of every section; none where they are more than can be counted.
    fn lengths(&self) -> Option<[usize; SECTIONS]> {
        let number = size_of::<u32>();
        let sections = [
            (self.description, 1),
            (self.positions, size_of::<Vec3>()),
            (self.normals, size_of::<Vec3>()),
            (self.coordinates[0], size_of::<Vec2>()),
            (self.coordinates[1], size_of::<Vec2>()),
            (self.tangents, size_of::<Vec4>()),
            (self.colours, size_of::<Vec4>()),
            (self.triangles, 3 * number),
            (self.triangles, number),
            (self.spheres, size_of::<Sphere>()),
            (self.disks, size_of::<Disk>()),
            (self.instances, size_of::<Instance>()),
            (self.poses, 1),
            (self.texels, 1),
            (self.pairs, size_of::<NodePair>()),
            (self.slots, number),
            (self.slots, size_of::<Bounds>()),
        ];
        let mut lengths = [0; SECTIONS];
        for (length, (count, size)) in lengths.iter_mut().zip(sections) {
            *length = usize::try_from(count).ok()?.checked_mul(size)?;
        }
        Some(lengths)
    }
}

/// Where the sections of a file lie.
pub type Sections = [Range<usize>; SECTIONS];

impl Header {
    /// The header of these sections.
    pub fn of(counts: Counts, sections: &[&[u8]; SECTIONS]) -> Self {
        Header { magic: MAGIC, version: VERSION, reserved: 0, hash: hash(&counts, sections.iter().copied()), counts }
    }

    /// The header of a file, and where its sections lie, all of them inside.
    ///
    /// # Errors
    /// Those of [`Header::of_start`], and something between the sections.
    pub fn read(file: &[u8]) -> Unplaced<(Header, Sections)> {
        let (header, sections) = Header::of_start(file, file.len() as u64)?;
        match odd(file, &sections) {
            Some(at) => Err(format!("its byte {at}, which belongs to no section, is not zero; {AGAIN}")),
            None => Ok((header, sections)),
        }
    }

    /// The same of the first bytes of a file of this length.
    ///
    /// # Errors
    /// It is not of this form, of another version, or not as long as its header says.
    pub fn of_start(start: &[u8], length: u64) -> Unplaced<(Header, Sections)> {
        if !start.starts_with(&MAGIC) {
            return Err("this is no binary scene; write one with eyerays convert".into());
        }
        let Some(header) = start.get(..size_of::<Header>()) else {
            return Err(format!("its {length} bytes are less than a header, as if it were cut off; {AGAIN}"));
        };
        let header: Header = bytemuck::pod_read_unaligned(header);
        if header.version != VERSION {
            let version = header.version;
            return Err(format!("version {version} of the binary form, and {VERSION} is what is read; {AGAIN}"));
        }
        if header.reserved != 0 {
            return Err(format!("its header has other than zeros in its spare bytes; {AGAIN}"));
        }
        let sections = header.counts.lengths().and_then(|lengths| sections(lengths, length));
        sections
            .map(|sections| (header, sections))
            .ok_or_else(|| format!("its {length} bytes are not what its header tells, as if it were cut off; {AGAIN}"))
    }

    /// Refuses sections that are not those that were written.
    ///
    /// # Errors
    /// Their hash is another.
    pub fn check(&self, sections: &[&[u8]; SECTIONS]) -> Unplaced<()> {
        // Fuzzers are to get past it.
        if cfg!(fuzzing) || self.hash == hash(&self.counts, sections.iter().copied()) {
            return Ok(());
        }
        Err(format!("its contents have another hash than its header tells, so they were changed; {AGAIN}"))
    }
}

/// The remedy for a file that is not as it was written.
pub const AGAIN: &str = "write it again with eyerays convert";

/// The sections of a file, if they are all of it.
fn sections(lengths: [usize; SECTIONS], file: u64) -> Option<Sections> {
    let mut sections = [const { 0..0 }; SECTIONS];
    let mut end = size_of::<Header>();
    for (section, length) in sections.iter_mut().zip(lengths) {
        let start = end.checked_next_multiple_of(ALIGNMENT)?;
        end = start.checked_add(length)?;
        *section = start..end;
    }
    (end as u64 == file).then_some(sections)
}

/// The first byte between sections that is not zero, which no hash covers.
fn odd(file: &[u8], sections: &Sections) -> Option<usize> {
    let ends = [size_of::<Header>()].into_iter().chain(sections.iter().map(|section| section.end));
    let mut between = ends.zip(sections).flat_map(|(end, section)| end..section.start);
    between.find(|&at| file[at] != 0)
}

/// The hash of the counts and of every section's hash, which is that of its blocks' hashes: threads share them.
pub fn hash<'a>(counts: &Counts, sections: impl IntoIterator<Item = &'a [u8]>) -> [u8; 32] {
    let mut all = Sha256::new_with_prefix(bytemuck::bytes_of(counts));
    for section in sections {
        let blocks = section.par_chunks(BLOCK).map(|block| -> [u8; 32] { Sha256::digest(block).into() });
        all.update(Sha256::digest(blocks.collect::<Vec<_>>().as_flattened()));
    }
    all.finalize().into()
}
