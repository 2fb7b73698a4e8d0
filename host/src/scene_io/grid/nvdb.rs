//! NanoVDB files (Museth, NanoVDB: A GPU-Friendly and Portable VDB Data Structure, 2021; the layout is that of its `PNanoVDB.h`, ABI 32):
//! a tree of 4096, 128 and 8 voxels along an edge, of single precision.

use std::collections::BTreeMap;
use std::io::Read;

use glam::{DAffine3, DMat3, DVec3};

use super::blosc;
use super::bytes::Bytes;
use crate::scene::{Grid, LEAF, Leaf, Unplaced};
use crate::scene_io::budget::Budget;

/// Is it one?
pub fn is(bytes: &[u8]) -> bool {
    [b"NanoVDB0", b"NanoVDB1", b"NanoVDB2"].iter().any(|magic| bytes.starts_with(*magic))
}

/// A grid of such a file: that of a name, or of another by convention, or else the first of single precision.
///
/// # Errors
/// There is none, it is of other numbers or compressed otherwise, or the file is damaged.
pub fn grid(bytes: &[u8], (name, usual): (Option<&str>, &str), title: &str, budget: &Budget) -> Unplaced<Grid> {
    if bytes.starts_with(b"NanoVDB1") {
        // What is in memory, as it is.
        return tree(Bytes(bytes), title, budget);
    }
    let entries = entries(Bytes(bytes))?;
    let is_right = |entry: &&Entry| name.map_or(entry.kind == FLOAT, |name| entry.name == name);
    let first = entries.iter().find(|entry| is_right(entry) && (name.is_some() || entry.name == usual));
    let Some(entry) = first.or_else(|| entries.iter().find(is_right)) else {
        let names: Vec<String> = entries.iter().map(|entry| format!("{:?}", entry.name)).collect();
        let wanted = name.map_or("grid of single precision".to_owned(), |name| format!("grid {name:?}"));
        return Err(format!("it has no {wanted}, but {}; name another", names.join(", ")));
    };
    if entry.kind != FLOAT {
        let Entry { name, kind, .. } = entry;
        return Err(format!("its grid {name:?} has numbers of kind {kind}; only single precision ({FLOAT}) is read"));
    }
    let data = Bytes(bytes).part(entry.at, entry.stored)?;
    match entry.codec {
        0 => tree(data, title, budget),
        1 => tree(Bytes(&inflated(data, entry.size, budget)?), title, budget),
        2 => tree(Bytes(&unpacked(data, entry.size, budget)?), title, budget),
        other => Err(format!(
            "it is compressed as {other}, which is not read; write it with ZIP, Blosc or without compression"
        )),
    }
}

/// The kind of grids of single precision.
const FLOAT: u32 = 1;
/// The class of those that are distances to a surface.
const LEVEL_SET: u32 = 1;

/// What a file says of a grid.
struct Entry {
    name: String,
    kind: u32,
    codec: u16,
    /// Bytes once it is decompressed.
    size: u64,
    at: u64,
    stored: u64,
}

const FILE_HEADER: u64 = 16;
const META: u64 = 176;

/// Those of all segments.
fn entries(bytes: Bytes<'_>) -> Unplaced<Vec<Entry>> {
    let mut entries = Vec::new();
    let mut at = 0;
    while at < bytes.0.len() as u64 {
        if !is(bytes.part(at, 8)?.0) {
            return Err(format!("what is at byte {at} is no segment of NanoVDB; is the file whole?"));
        }
        let (count, codec) = (bytes.u16(at + 12)?, bytes.u16(at + 14)?);
        at += FILE_HEADER;
        let first = entries.len();
        for _ in 0..count {
            let name_bytes = u64::from(bytes.u32(at + 136)?);
            let name = bytes.part(Bytes::beside(at, META)?, name_bytes)?.0;
            let name = String::from_utf8_lossy(name).trim_end_matches('\0').to_owned();
            let (size, stored, kind) = (bytes.u64(at)?, bytes.u64(at + 8)?, bytes.u32(at + 32)?);
            entries.push(Entry { name, kind, codec, size, at: 0, stored });
            at = at + META + name_bytes;
        }
        for entry in &mut entries[first..] {
            entry.at = at;
            bytes.part(at, entry.stored)?;
            at += entry.stored;
        }
    }
    Ok(entries)
}

/// Is there memory for a grid of such a size?
fn check(size: u64, budget: &Budget) -> Unplaced<()> {
    budget.check_bytes(size).map_err(|why| format!("its {size} bytes {why}; make it coarser"))
}

/// What a grid is before it was compressed by Blosc, in chunks behind their sizes.
fn unpacked(data: Bytes<'_>, size: u64, budget: &Budget) -> Unplaced<Vec<u8>> {
    check(size, budget)?;
    let (mut bytes, mut at) = (Vec::new(), 0);
    while (bytes.len() as u64) < size {
        let stored = data.u64(at)?;
        blosc::unpack(data.part(at + 8, stored)?, size - bytes.len() as u64, &mut bytes)?;
        at += 8 + stored;
    }
    Ok(bytes)
}

/// What a grid is before it was compressed by zlib.
fn inflated(data: Bytes<'_>, size: u64, budget: &Budget) -> Unplaced<Vec<u8>> {
    check(size, budget)?;
    let packed = data.part(8, data.u64(0)?)?;
    let mut bytes = Vec::new();
    let read = flate2::read::ZlibDecoder::new(packed.0).take(size).read_to_end(&mut bytes);
    match read {
        Ok(count) if count as u64 == size => Ok(bytes),
        _ => Err("its compressed numbers are damaged; write it anew".to_owned()),
    }
}

/// Where the tree begins.
const TREE: u64 = 672;
/// The map from voxels to the world, in double precision.
const MATRIX: u64 = 296 + 88;
const TRANSLATION: u64 = 296 + 232;

/// The numbers of a grid in memory.
fn tree(bytes: Bytes<'_>, title: &str, budget: &Budget) -> Unplaced<Grid> {
    let (class, kind) = (bytes.u32(632)?, bytes.u32(636)?);
    if kind != FLOAT {
        return Err(format!("its numbers are of kind {kind}; only single precision ({FLOAT}) is read"));
    }
    if class == LEVEL_SET {
        return Err("it holds distances to a surface (a level set); convert it to a fog volume".to_owned());
    }
    let double = |at: u64| bytes.f64(at);
    let row = |i: u64| {
        Ok::<_, String>(DVec3::new(
            double(MATRIX + 24 * i)?,
            double(MATRIX + 24 * i + 8)?,
            double(MATRIX + 24 * i + 16)?,
        ))
    };
    let matrix3 = DMat3::from_cols(row(0)?, row(1)?, row(2)?).transpose();
    let translation = DVec3::new(double(TRANSLATION)?, double(TRANSLATION + 8)?, double(TRANSLATION + 16)?);
    let root = Bytes::beside(TREE, bytes.u64(TREE + 24)?)?;
    let corner = |at: u64| Ok::<_, String>([bytes.i32(at)?, bytes.i32(at + 4)?, bytes.i32(at + 8)?]);
    let (first, last) = (corner(root)?, corner(Bytes::beside(root, 12)?)?);
    let background = bytes.f32(Bytes::beside(root, 28)?)?;
    let mut reader = Reader { bytes, leaves: BTreeMap::new(), background, nodes: 0, even: 0 };
    // Each leaf takes as much as in the file.
    budget.check_bytes(2 * bytes.0.len() as u64).map_err(|why| format!("its grid {why}; make it coarser"))?;
    for tile in 0..u64::from(bytes.u32(root + 24)?) {
        reader.tile(root, root + ROOT + 32 * tile)?;
    }
    Ok(Grid {
        name: title.to_owned(),
        background: reader.background,
        leaves: reader.leaves,
        extent: [first, last.map(|at| at.saturating_add(1))],
        placement: DAffine3 { matrix3, translation },
        has_edges: false,
    })
}

/// Bytes of a root before its tiles.
const ROOT: u64 = 64;

/// How a node of the tree lies in a file, and what its children are.
struct Level {
    /// The logarithms of its children along an edge, and of voxels along an edge of each.
    log2: u32,
    child_log2: u32,
    /// Where its table begins.
    table: u64,
}

const UPPER: Level = Level { log2: 5, child_log2: 7, table: 8256 };
const LOWER: Level = Level { log2: 4, child_log2: 3, table: 1088 };

struct Reader<'a> {
    bytes: Bytes<'a>,
    leaves: BTreeMap<[i32; 3], Leaf>,
    background: f32,
    /// Bytes of nodes so far, which no two parents share.
    nodes: u64,
    /// Even leaves so far.
    even: u32,
}

/// The most even leaves, whose file may be small.
const MOST_EVEN: u32 = 1 << 22;

impl Reader<'_> {
    /// Counts a node.
    fn take(&mut self, bytes: u64) -> Unplaced<()> {
        self.nodes += bytes;
        let is_possible = self.nodes <= self.bytes.0.len() as u64;
        is_possible.then_some(()).ok_or_else(|| "its nodes lie in each other; write it anew".to_owned())
    }

    /// A tile of the root, which has a node or is even.
    fn tile(&mut self, root: u64, at: u64) -> Unplaced<()> {
        let (key, child) = (self.bytes.u64(at)?, self.bytes.u64(at + 8)?);
        // 20 bits of each coordinate, in 21.
        let along = |shift: u32| (((key >> shift) as u32 & 0x1f_ffff) << 12) as i32;
        let origin = [along(42), along(21), along(0)];
        if child != 0 {
            return self.node(Bytes::beside(root, child)?, origin, &UPPER);
        }
        let (is_active, value) = (self.bytes.u32(at + 16)? != 0, self.bytes.f32(at + 20)?);
        if is_active && value != self.background {
            return Err("a cube of 4096 voxels of it is even; crop it".to_owned());
        }
        Ok(())
    }

    fn node(&mut self, at: u64, origin: [i32; 3], level: &Level) -> Unplaced<()> {
        let count = 1u64 << (3 * level.log2);
        self.take(level.table + 8 * count)?;
        let bits = |mask: u64, i: u64| Ok::<_, String>(self.bytes.part(mask + i / 8, 1)?.0[0] >> (i % 8) & 1 == 1);
        let (values, children) = (Bytes::beside(at, 32)?, Bytes::beside(at, 32 + count / 8)?);
        // All of it is there, so that a damaged file is refused at once.
        self.bytes.part(at, level.table + 8 * count)?;
        let mut found = Vec::new();
        for i in 0..count {
            let (has_child, is_active) = (bits(children, i)?, bits(values, i)?);
            if has_child || is_active {
                found.push((i, has_child));
            }
        }
        for (i, has_child) in found {
            let mask = (1u64 << level.log2) - 1;
            let part = |shift: u32| ((i >> (shift * level.log2)) & mask) as i32;
            // The last axis first.
            let steps = [part(2), part(1), part(0)];
            let child = std::array::from_fn(|axis| origin[axis].wrapping_add(steps[axis] << level.child_log2));
            let entry = at + level.table + 8 * i;
            if !has_child {
                self.even(child, 1 << level.child_log2, self.bytes.f32(entry)?)?;
            } else if level.child_log2 == 3 {
                self.leaf(Bytes::beside(at, self.bytes.u64(entry)?)?, child)?;
            } else {
                self.node(Bytes::beside(at, self.bytes.u64(entry)?)?, child, &LOWER)?;
            }
        }
        Ok(())
    }

    /// A cube of one number.
    fn even(&mut self, origin: [i32; 3], edge: i32, value: f32) -> Unplaced<()> {
        if value == self.background {
            return Ok(());
        }
        let steps = edge / LEAF;
        self.even += (steps * steps * steps) as u32;
        if self.even > MOST_EVEN {
            return Err("it has large even parts; crop it".to_owned());
        }
        for i in 0..steps * steps * steps {
            let step = [i % steps, i / steps % steps, i / steps / steps];
            self.leaves.insert(std::array::from_fn(|axis| origin[axis] / LEAF + step[axis]), Leaf::Even(value));
        }
        Ok(())
    }

    fn leaf(&mut self, at: u64, origin: [i32; 3]) -> Unplaced<()> {
        self.take(96 + 4 * 512)?;
        let values = self.bytes.part(Bytes::beside(at, 96)?, 4 * 512)?;
        let number = |[x, y, z]: [i32; 3]| {
            let place = 4 * (x * 64 + y * 8 + z) as usize;
            f32::from_le_bytes(values.0[place..place + 4].try_into().expect("four bytes"))
        };
        let leaf = Leaf::of(number);
        if leaf != Leaf::Even(self.background) {
            self.leaves.insert(origin.map(|at| at.div_euclid(LEAF)), leaf);
        }
        Ok(())
    }
}
