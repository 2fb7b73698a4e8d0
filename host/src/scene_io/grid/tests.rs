//! Against a writer of its own, byte by byte as the format's header says, and files that are damaged.

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::memory::Room;
use crate::scene::Leaf;

fn budget() -> Budget {
    Budget::new(Room { bytes: 1 << 30, limit: "a test" })
}

/// Puts numbers at places of a list that grows.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn put(&mut self, at: usize, bytes: &[u8]) {
        let end = at + bytes.len();
        self.0.resize(self.0.len().max(end), 0);
        self.0[at..end].copy_from_slice(bytes);
    }

    fn i32s(&mut self, at: usize, numbers: &[i32]) {
        numbers.iter().enumerate().for_each(|(i, number)| self.put(at + 4 * i, &number.to_le_bytes()));
    }

    fn f64s(&mut self, at: usize, numbers: &[f64]) {
        numbers.iter().enumerate().for_each(|(i, number)| self.put(at + 8 * i, &number.to_le_bytes()));
    }

    fn set(&mut self, mask: usize, bit: usize) {
        let byte = self.0[mask + bit / 8] | 1 << (bit % 8);
        self.put(mask + bit / 8, &[byte]);
    }
}

const TREE: usize = 672;
const ROOT: usize = TREE + 64;
const UPPER: usize = ROOT + 64 + 32;
const LOWER: usize = UPPER + 270_400;
const LEAF_AT: usize = LOWER + 33_856;

/// A grid with one leaf and an even cube of 8 voxels, both in the same node of 128 voxels at `origin`.
fn tree(origin: [i32; 3], leaf: impl Fn([i32; 3]) -> f32, kind: u32) -> Vec<u8> {
    let mut bytes = Bytes::default();
    bytes.put(0, b"NanoVDB1");
    // A voxel is a fifth along each axis, from (1, 2, 3) on.
    bytes.f64s(296 + 88, &[0.2, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.2]);
    bytes.f64s(296 + 232, &[1.0, 2.0, 3.0]);
    bytes.put(632, &2u32.to_le_bytes());
    bytes.put(636, &kind.to_le_bytes());
    bytes.put(TREE + 24, &64u64.to_le_bytes());
    bytes.i32s(ROOT, &origin);
    bytes.i32s(ROOT + 12, &origin.map(|at| at + 15));
    bytes.put(ROOT + 24, &1u32.to_le_bytes());
    bytes.put(ROOT + 28, &0f32.to_le_bytes());
    let part = |at: i32| u64::from(at as u32 >> 12);
    let key = part(origin[2]) | part(origin[1]) << 21 | part(origin[0]) << 42;
    bytes.put(ROOT + 64, &key.to_le_bytes());
    bytes.put(ROOT + 72, &((UPPER - ROOT) as u64).to_le_bytes());
    bytes.put(UPPER, &vec![0; 270_400 + 33_856 + 2144]);
    let child = |at: i32, log2: i32, mask: i32| ((at >> log2) & mask) as usize;
    let of = |log2: i32, edge: i32| {
        let mask = (1 << edge) - 1;
        (child(origin[0], log2, mask) << (2 * edge))
            | (child(origin[1], log2, mask) << edge)
            | child(origin[2], log2, mask)
    };
    let (in_upper, in_lower) = (of(7, 5), of(3, 4));
    bytes.set(UPPER + 32 + 4096, in_upper);
    bytes.put(UPPER + 8256 + 8 * in_upper, &((LOWER - UPPER) as u64).to_le_bytes());
    bytes.set(LOWER + 32 + 512, in_lower);
    bytes.put(LOWER + 1088 + 8 * in_lower, &((LEAF_AT - LOWER) as u64).to_le_bytes());
    // The cube after it along z.
    bytes.set(LOWER + 32, in_lower + 1);
    bytes.put(LOWER + 1088 + 8 * (in_lower + 1), &0.5f32.to_le_bytes());
    for i in 0..512 {
        let number = leaf([i / 64, i / 8 % 8, i % 8]);
        bytes.put(LEAF_AT + 96 + 4 * i as usize, &number.to_le_bytes());
    }
    bytes.0
}

fn ramp([x, y, z]: [i32; 3]) -> f32 {
    (x * 100 + y * 10 + z) as f32
}

/// Two chunks of Blosc, which hold their bytes as they are.
fn chunks(bytes: &[u8]) -> Vec<u8> {
    let chunk = |part: &[u8]| {
        let (size, stored) = (part.len() as u32, part.len() as u32 + 16);
        let header = [&[2, 1, 2, 4][..], &size.to_le_bytes(), &size.to_le_bytes(), &stored.to_le_bytes()].concat();
        [&u64::from(stored).to_le_bytes()[..], &header, part].concat()
    };
    let (first, second) = bytes.split_at(bytes.len() / 3);
    [chunk(first), chunk(second)].concat()
}

/// A file of grids in one segment.
fn file(grids: &[(&str, Vec<u8>)], codec: u16) -> Vec<u8> {
    let stored: Vec<Vec<u8>> = grids
        .iter()
        .map(|(_, bytes)| match codec {
            1 => {
                let mut packed = flate2::read::ZlibEncoder::new(&bytes[..], flate2::Compression::fast());
                let mut out = Vec::new();
                std::io::Read::read_to_end(&mut packed, &mut out).unwrap();
                [&(out.len() as u64).to_le_bytes()[..], &out].concat()
            }
            2 => chunks(bytes),
            _ => bytes.clone(),
        })
        .collect();
    let mut out = b"NanoVDB2".to_vec();
    out.extend(32u32.to_le_bytes());
    out.extend((grids.len() as u16).to_le_bytes());
    out.extend(codec.to_le_bytes());
    for ((name, bytes), stored) in grids.iter().zip(&stored) {
        let mut meta = Bytes::default();
        meta.put(175, &[0]);
        meta.put(0, &(bytes.len() as u64).to_le_bytes());
        meta.put(8, &(stored.len() as u64).to_le_bytes());
        meta.put(32, &bytes[636..640]);
        meta.put(136, &(name.len() as u32 + 1).to_le_bytes());
        out.extend(meta.0);
        out.extend(name.bytes().chain([0]));
    }
    stored.into_iter().for_each(|bytes| out.extend(bytes));
    out
}

fn parsed(bytes: &[u8], name: Option<&str>) -> Unplaced<Grid> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("g.nvdb");
    std::fs::write(&path, bytes).unwrap();
    read(&path, (Quantity::Density, name), &budget())
}

#[test]
fn every_voxel_of_a_file_is_found_where_it_is() {
    for origin in [[0, 0, 0], [8, 120, 64], [-8, -4096, 16_384], [-16, 2048, -128]] {
        let bytes = tree(origin, ramp, 1);
        for (what, bytes) in [
            ("as it is", bytes.clone()),
            ("in a file", file(&[("temperature", tree([0; 3], ramp, 1)), ("density", bytes.clone())], 0)),
            ("compressed by ZIP", file(&[("density", bytes.clone())], 1)),
            ("compressed by Blosc", file(&[("density", bytes)], 2)),
        ] {
            let grid = parsed(&bytes, None).unwrap_or_else(|fault| panic!("{what}, {origin:?}: {fault}"));
            assert_eq!(grid.leaves.len(), 2, "{what}");
            assert_eq!(grid.extent, [origin, origin.map(|at| at + 16)]);
            for (x, y, z) in [(0, 0, 0), (7, 3, 5), (1, 7, 0)] {
                let voxel = [origin[0] + x, origin[1] + y, origin[2] + z];
                assert_eq!(grid.number(voxel), ramp([x, y, z]), "{what}, {voxel:?}");
            }
            assert_eq!(grid.number([origin[0] + 3, origin[1] + 7, origin[2] + 9]), 0.5);
            assert_eq!(grid.number([origin[0] + 8, origin[1], origin[2]]), 0.0);
            let at = grid.placement.transform_point3(DVec3::new(1.0, 2.0, 5.0));
            assert!((at - DVec3::new(1.2, 2.4, 4.0)).length() < 1e-12, "{at}");
        }
    }
}

#[test]
fn a_grid_is_found_by_its_name_or_named_where_there_is_none() {
    let grids =
        [("heat", tree([0; 3], |_| 2.0, 1)), ("flags", tree([0; 3], ramp, 4)), ("density", tree([8; 3], ramp, 1))];
    let bytes = file(&grids, 0);
    assert_eq!(parsed(&bytes, None).unwrap().extent[0], [8; 3]);
    assert_eq!(parsed(&bytes, Some("heat")).unwrap().leaves[&[0; 3]], Leaf::Even(2.0));
    let refused = |name| parsed(&bytes, Some(name)).unwrap_err();
    assert_eq!(refused("smoke"), "it has no grid \"smoke\", but \"heat\", \"flags\", \"density\"; name another");
    assert_eq!(refused("flags"), "its grid \"flags\" has numbers of kind 4; only single precision (1) is read");
}

/// A file of fire has both; what is named in neither way is the first.
#[test]
fn densities_and_temperatures_are_told_apart_by_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fire.nvdb");
    let grids = ["density", "flame", "temperature"].map(|name| (name, tree([8 * name.len() as i32, 0, 0], ramp, 1)));
    let first = |grids: &[(&str, Vec<u8>)], quantity| {
        std::fs::write(&path, file(grids, 0)).unwrap();
        read(&path, (quantity, None), &budget()).unwrap().extent[0][0] as usize / 8
    };
    assert_eq!(first(&grids, Quantity::Density), "density".len());
    assert_eq!(first(&grids, Quantity::Temperature), "temperature".len());
    assert_eq!(first(&grids[1..2], Quantity::Temperature), "flame".len());
    std::fs::write(&path, tree([0; 3], |_| -1.0, 1)).unwrap();
    let refused = read(&path, (Quantity::Temperature, None), &budget()).unwrap_err();
    assert_eq!(refused, "the grid has the number -1; temperatures are finite and at least 0");
}

#[test]
fn what_is_not_read_says_why() {
    let of = |bytes: &[u8]| parsed(bytes, None).unwrap_err();
    assert!(of(b" BDV\0\0\0\0").contains("convert it to NanoVDB"));
    assert!(of(b"hello").contains("neither NanoVDB"));
    assert!(of(&file(&[("density", tree([0; 3], ramp, 1))], 3)).contains("compressed as 3"));
    assert!(of(&tree([0; 3], |_| -1.0, 1)).contains("the number -1; densities"));
    assert!(of(&tree([0; 3], |_| f32::NAN, 1)).contains("densities are finite"));
    let mut level_set = tree([0; 3], ramp, 1);
    level_set[632] = 1;
    assert!(of(&level_set).contains("level set"));
    let small = Budget::new(Room { bytes: 1000, limit: "a test" });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("g.nvdb");
    std::fs::write(&path, tree([0; 3], ramp, 1)).unwrap();
    assert!(read(&path, (Quantity::Density, None), &small).unwrap_err().contains("a test leaves"));
}

/// A node whose children are all the same node: a small file that would be read for hours.
#[test]
fn nodes_that_lie_in_each_other_are_refused() {
    let mut bytes = tree([0; 3], ramp, 1);
    for i in 0..32_768usize {
        bytes[UPPER + 32 + 4096 + i / 8] = 0xff;
        bytes[UPPER + 8256 + 8 * i..][..8].copy_from_slice(&((LOWER - UPPER) as u64).to_le_bytes());
    }
    assert!(parsed(&bytes, None).unwrap_err().contains("lie in each other"));
    let mut even = tree([0; 3], ramp, 1);
    // All but the one that has a node.
    for i in 1..32_768usize {
        even[UPPER + 32 + i / 8] = 0xff;
        even[UPPER + 8256 + 8 * i..][..4].copy_from_slice(&1f32.to_le_bytes());
    }
    assert!(parsed(&even, None).unwrap_err().contains("large even parts"));
}

/// Numbers of `blosc/*.blosc`, which c-blosc 1.21.7 wrote (`blosc.compress(.., typesize=4, clevel=.., shuffle=1, cname="lz4")`), and three
/// bytes after them: 700 have noise in their first bytes, so that one stream is stored as it was; 36,000 take three blocks.
fn numbers(count: u32) -> Vec<u8> {
    let mut state = 1u32;
    let noise = (0..count).map(|i| {
        state = state.wrapping_mul(1_103_515_245).wrapping_add(12_345) & 0x7fff_ffff;
        if count < 1000 { state >> 16 & 255 } else { (i / 512) & 255 }
    });
    let numbers = noise.enumerate().flat_map(|(i, low)| ((i as u32 / 64) << 8 | low).to_le_bytes());
    numbers.chain(*b"end").collect()
}

#[test]
fn chunks_that_c_blosc_wrote_give_their_bytes() {
    for (count, chunk) in [(700, &include_bytes!("blosc/700.blosc")[..]), (36_000, include_bytes!("blosc/36000.blosc"))]
    {
        let (mut out, expected) = (b"before".to_vec(), numbers(count));
        blosc::unpack(bytes::Bytes(chunk), expected.len() as u64, &mut out).unwrap();
        assert!(out.strip_prefix(b"before") == Some(&expected), "{count} differ");
    }
    let mut stored = [2, 1, 2, 4, 5, 0, 0, 0, 5, 0, 0, 0, 21, 0, 0, 0].to_vec();
    stored.extend(b"smoke");
    let mut out = Vec::new();
    blosc::unpack(bytes::Bytes(&stored), 5, &mut out).unwrap();
    assert_eq!(out, b"smoke");
}

#[test]
fn chunks_that_are_damaged_are_refused() {
    let chunk = include_bytes!("blosc/700.blosc");
    let unpacked = |chunk: &[u8], most: u64| blosc::unpack(bytes::Bytes(chunk), most, &mut Vec::new());
    let with = |at: usize, bytes: &[u8]| {
        let mut chunk = chunk.to_vec();
        chunk[at..at + bytes.len()].copy_from_slice(bytes);
        unpacked(&chunk, 2803).unwrap_err()
    };
    assert!(unpacked(chunk, 2802).unwrap_err().contains("damaged"));
    assert!(unpacked(&chunk[..800], 2803).unwrap_err().contains("is it whole?"));
    assert!(with(2, &[0x81]).contains("LZ4; write it with ZIP"));
    assert!(with(2, &[0x25]).contains("LZ4; write it with ZIP"));
    assert!(with(3, &[0]).contains("damaged"));
    assert!(with(8, &[0; 4]).contains("damaged"));
    assert!(with(16, &[0xff; 4]).contains("is it whole?"));
    // The first stream, stored as it was, with a byte less: what follows is no stream.
    assert!(with(24, &699u32.to_le_bytes()).contains("damaged"));
}

#[test]
fn mitsubas_volumes_fill_their_box() {
    let mut bytes = b"VOL\x03".to_vec();
    [1, 3, 2, 2, 1].iter().for_each(|number: &i32| bytes.extend(number.to_le_bytes()));
    [0f32, 0.0, 0.0, 3.0, 4.0, 2.0].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    (0..12).for_each(|i| bytes.extend((i as f32).to_le_bytes()));
    let grid = parsed(&bytes, None).unwrap();
    assert_eq!((grid.number([2, 1, 1]), grid.number([0, 1, 0])), (11.0, 3.0));
    assert_eq!(grid.bounds(), [DVec3::ZERO, DVec3::new(3.0, 4.0, 2.0)]);
    bytes.pop();
    assert!(parsed(&bytes, None).unwrap_err().contains("is it whole?"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    /// Whatever is damaged: a grid or a line, at once.
    #[test]
    fn damaged_files_are_read_or_refused(
        changes in proptest::collection::vec((0usize..3000, any::<u8>()), 1..6), cut in 0usize..4000, codec in 0u16..3,
    ) {
        let mut bytes = file(&[("density", tree([8, 0, -8], ramp, 1))], codec);
        for (at, value) in changes {
            let at = at % bytes.len();
            bytes[at] = value;
        }
        if cut < 1000 {
            bytes.truncate(bytes.len() - cut.min(bytes.len() - 1));
        }
        let read = parsed(&bytes, None);
        prop_assert!(read.is_ok() || !read.unwrap_err().is_empty());
    }

    /// Whatever is damaged: no more than was asked for, at once.
    #[test]
    fn no_damage_to_a_chunk_breaks_its_reader(at in 0usize..834, byte in any::<u8>(), end in 0usize..=834) {
        let mut chunk = include_bytes!("blosc/700.blosc").to_vec();
        chunk[at] = byte;
        let mut out = Vec::new();
        let read = blosc::unpack(bytes::Bytes(&chunk[..end]), 2803, &mut out);
        prop_assert!(read.is_err() || out.len() <= 2803);
    }
}
