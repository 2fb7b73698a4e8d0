//! Grids of densities as kernels read them, see [`eyerays_shader::data::Grid`].

use eyerays_shader::data::{CELLS, Grid as Words};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::normalisation::Normalisation;
use crate::error::{Error, Result};
use crate::scene::{Grid, LEAF};

/// Corners along an edge of a block.
const EDGE: i32 = CELLS as i32 + 1;
/// The most blocks of a grid: their records take 2 GiB.
const MOST_BLOCKS: i64 = 1 << 28;

/// The words of a grid.
///
/// # Errors
/// It is too large, or has no place in the scene.
pub fn words(grid: &Grid, normalisation: &Normalisation) -> Result<Vec<u32>> {
    // A corner more on each side, which is of the background or goes on.
    let cells = grid.size().map(|voxels| voxels + 1);
    let blocks = cells.map(|cells| cells.div_euclid(CELLS.into()) + i64::from(cells % i64::from(CELLS) != 0));
    let count = blocks.iter().try_fold(1i64, |all, &along| all.checked_mul(along)).unwrap_or(i64::MAX);
    if count > MOST_BLOCKS || cells.iter().any(|&cells| cells > i64::from(u32::MAX >> 9)) {
        let [x, y, z] = grid.size();
        return Err(Error::new(format!(
            "{} spans {x} x {y} x {z} voxels, more than devices hold: make it coarser",
            grid.name
        )));
    }
    let place = |number: i64| {
        let [x, y] = [number % blocks[0], number / blocks[0]];
        [x, y % blocks[1], y / blocks[1]].map(|at| at as i32)
    };
    let made: Vec<Block> = (0..count).into_par_iter().map(|number| Block::of(grid, place(number))).collect();
    let numbers = made.iter().filter(|block| !block.numbers.is_empty()).count() as u64;
    let first = u64::from(Words::RECORDS) + 2 * count as u64;
    let all = first + numbers * (EDGE * EDGE * EDGE) as u64;
    if all > u64::from(u32::MAX) {
        return Err(Error::new(format!(
            "{} takes {} bytes, more than devices hold: make it coarser",
            grid.name,
            4 * all
        )));
    }
    let mut words = Vec::new();
    words.try_reserve_exact(all as usize).map_err(|_| {
        Error::new(format!("{} takes {} bytes, and there is no memory for them: make it coarser", grid.name, 4 * all))
    })?;
    words.extend(transform(grid, normalisation)?.map(f32::to_bits));
    words.extend(cells.map(|cells| cells as u32));
    words.extend(blocks.map(|blocks| blocks as u32));
    words.extend([if grid.has_edges { 0.5f32.to_bits() } else { 0 }, 0]);
    let mut at = first as u32;
    for block in &made {
        let is_even = block.numbers.is_empty();
        words.extend([block.greatest.to_bits(), if is_even { Words::EVEN } else { at }]);
        at += block.numbers.len() as u32;
    }
    made.iter().for_each(|block| words.extend(block.numbers.iter().map(|number| number.to_bits())));
    Ok(words)
}

/// Rows that take places of the normalised scene to cells: the first voxel is at 1.
fn transform(grid: &Grid, normalisation: &Normalisation) -> Result<[f32; 12]> {
    let fault = || Error::new(format!("{} has no size in the scene: give it bounds that have a volume", grid.name));
    if grid.placement.matrix3.determinant() == 0.0 {
        return Err(fault());
    }
    let first = DVec3::from(grid.extent[0].map(f64::from));
    let to_cells = DAffine3::from_translation(DVec3::ONE - first) * grid.placement.inverse();
    let all = to_cells * normalisation.inverse();
    let [x, y, z] = all.matrix3.transpose().to_cols_array_2d();
    let rows = [x, y, z].into_iter().zip(all.translation.to_array());
    let numbers: Vec<f32> = rows.flat_map(|([a, b, c], d)| [a, b, c, d].map(|number| number as f32)).collect();
    // Beyond, products with coordinates of the scene are not exact to a cell any more, nor finite in the end.
    let is_fine = numbers.iter().all(|number| number.abs() < (1u64 << 40) as f32);
    if is_fine { Ok(numbers.try_into().expect("twelve numbers")) } else { Err(fault()) }
}

/// The numbers at the corners of a block's cells.
struct Block {
    greatest: f32,
    /// None if all are as the greatest.
    numbers: Vec<f32>,
}

impl Block {
    fn of(grid: &Grid, block: [i32; 3]) -> Block {
        // The first corner is a voxel before the first.
        let [first, end] = grid.extent;
        let start: [i32; 3] = std::array::from_fn(|axis| first[axis] - 1 + CELLS as i32 * block[axis]);
        if let Some(even) = Self::even(grid, start) {
            return even;
        }
        let clamped = |voxel: [i32; 3]| std::array::from_fn(|axis| voxel[axis].clamp(first[axis], end[axis] - 1));
        let number = |voxel: [i32; 3]| {
            let number = if grid.has_edges { grid.number(clamped(voxel)) } else { grid.number(voxel) };
            // Less than nothing is nothing, and what is subnormal too.
            if number >= f32::MIN_POSITIVE { number.min(MOST_DENSITY) } else { 0.0 }
        };
        let mut numbers = Vec::with_capacity((EDGE * EDGE * EDGE) as usize);
        for (z, y) in (0..EDGE).flat_map(|z| (0..EDGE).map(move |y| (z, y))) {
            numbers.extend((0..EDGE).map(|x| number([start[0] + x, start[1] + y, start[2] + z])));
        }
        let greatest = numbers.iter().copied().fold(0.0, f32::max);
        if numbers.iter().all(|&number| number == greatest) {
            numbers = Vec::new();
        }
        Block { greatest, numbers }
    }

    /// One far from all leaves.
    fn even(grid: &Grid, start: [i32; 3]) -> Option<Block> {
        if grid.has_edges {
            return None;
        }
        let leaf = |at: i32| at.div_euclid(LEAF);
        let along = |axis: usize| leaf(start[axis])..=leaf(start[axis] + EDGE - 1);
        let near = along(0).any(|x| along(1).any(|y| along(2).any(|z| grid.leaves.contains_key(&[x, y, z]))));
        (!near).then_some(Block { greatest: grid.background.clamp(0.0, MOST_DENSITY), numbers: Vec::new() })
    }
}

/// Beyond this nothing is seen through a voxel, and products overflow.
const MOST_DENSITY: f32 = 1e12;
