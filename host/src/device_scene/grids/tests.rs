use std::collections::BTreeMap;

use eyerays_shader::data::CELLS;
use glam::Vec3;

use super::*;
use crate::scene::{LEAF, Leaf};

/// A grid of leaves from a voxel on until another.
fn grid(leaves: &[([i32; 3], Leaf)], extent: [[i32; 3]; 2], background: f32) -> Grid {
    Grid {
        name: "cloud.nvdb".to_owned(),
        leaves: BTreeMap::from_iter(leaves.iter().cloned()),
        background,
        extent,
        placement: DAffine3::IDENTITY,
        has_edges: false,
    }
}

fn uneven(seed: i32) -> Leaf {
    Leaf::of(|[x, y, z]| ((x * 5 + y * 3 + z * 7 + seed) % 11) as f32)
}

fn words(grid: &Grid, room: Room) -> (Result<()>, Vec<u32>) {
    let normalisation = Normalisation { origin: Vec3::ZERO, scale: 1.0 };
    let mut words = Vec::new();
    (append(grid, &normalisation, room, &mut words), words)
}

const fn room(bytes: u64) -> Room {
    Room { bytes, limit: "this test" }
}

/// The number that the words have at a corner of a block.
fn corner(words: &[u32], block: [u32; 3], [x, y, z]: [u32; 3]) -> f32 {
    let [width, height] = [words[Words::BLOCKS as usize], words[Words::BLOCKS as usize + 1]];
    let record = (Words::RECORDS + 2 * ((block[2] * height + block[1]) * width + block[0])) as usize;
    let place = match words[record + 1] {
        Words::EVEN => record as u32,
        numbers => numbers + (z * (CELLS + 1) + y) * (CELLS + 1) + x,
    };
    f32::from_bits(words[place as usize])
}

/// Checks the number at each corner of each block, and that none is kept twice.
fn check(grid: &Grid) {
    let (appended, words) = words(grid, room(u64::MAX));
    appended.unwrap();
    let [first, end] = grid.extent;
    let blocks = [0, 1, 2].map(|axis| words[Words::BLOCKS as usize + axis]);
    let every =
        |[x, y, z]: [u32; 3]| (0..z).flat_map(move |z| (0..y).flat_map(move |y| (0..x).map(move |x| [x, y, z])));
    let mut uneven = 0;
    for block in every(blocks) {
        let mut numbers = Vec::new();
        for at in every([CELLS + 1; 3]) {
            let voxel = std::array::from_fn(|axis| {
                let voxel = first[axis] - 1 + (block[axis] * CELLS + at[axis]) as i32;
                if grid.has_edges { voxel.clamp(first[axis], end[axis] - 1) } else { voxel }
            });
            numbers.push(grid.number(voxel));
            assert_eq!(corner(&words, block, at), grid.number(voxel), "{block:?} {at:?}");
        }
        uneven += usize::from(numbers.iter().any(|&number| number != numbers[0]));
    }
    let count = blocks.iter().product::<u32>() as usize;
    assert_eq!(words.len(), Words::RECORDS as usize + 2 * count + 729 * uneven);
}

#[test]
fn every_corner_has_the_number_of_its_voxel() {
    let leaves = [
        ([-2, -1, 0], uneven(1)),
        ([-1, -1, 0], Leaf::Even(3.0)),
        ([-1, 0, 0], Leaf::Even(3.0)),
        ([3, 2, 1], uneven(2)),
        // Nothing is there of one that lies outside.
        ([9, 9, 9], uneven(3)),
    ];
    let sparse = grid(&leaves, [[-13, -6, 2], [29, 23, 13]], 0.5);
    check(&sparse);
    check(&Grid { has_edges: true, ..sparse });
    let even: Vec<_> = (0..64).map(|i| ([i % 4, i / 4 % 4, i / 16], Leaf::Even(2.0))).collect();
    check(&grid(&even, [[0; 3], [4 * LEAF; 3]], 0.0));
}

/// Two leaves with 1000 x 1000 x 100 blocks between their corners, whose records take 800 MB.
#[test]
fn leaves_that_lie_far_apart_are_refused_before_anything_is_made() {
    let (width, depth) = (8000, 800);
    let leaves = [([0, 0, 0], uneven(1)), ([width / LEAF - 1, width / LEAF - 1, depth / LEAF - 1], uneven(2))];
    let sparse = grid(&leaves, [[0; 3], [width, width, depth]], 0.0);
    let (refused, words) = words(&sparse, room(700_000_000));
    let refused = refused.unwrap_err().message();
    assert_eq!(
        refused,
        "the blocks of cloud.nvdb, which spans 8000 x 8000 x 800 voxels, take about 809 MB of memory, and this test leaves 700 MB: crop it or make it coarser"
    );
    assert_eq!(words.capacity(), 0);
}

/// A leaf's 512 numbers come to lie at the corners of eight blocks.
#[test]
fn corners_are_counted_beside_records() {
    let one = grid(&[([0; 3], uneven(1))], [[0; 3], [LEAF; 3]], 0.0);
    let bytes = 4 * (u64::from(Words::RECORDS) + 8 * (2 + 729));
    let (appended, words) = words(&one, room(bytes));
    appended.unwrap();
    assert_eq!((4 * words.len() as u64, words.capacity()), (bytes, words.len()));
    assert!(self::words(&one, room(bytes - 1)).0.is_err());
}
