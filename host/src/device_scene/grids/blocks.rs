//! The blocks that a grid is cut into.

use eyerays_shader::data::CELLS;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::scene::{Grid, LEAF, Leaf};

/// Corners along an edge of a block.
const EDGE: i32 = CELLS as i32 + 1;
/// Corners of a block.
const CORNERS: usize = (EDGE * EDGE * EDGE) as usize;
/// The most blocks of a grid: their records take 2 GiB.
const MOST_BLOCKS: i64 = 1 << 28;
/// Beyond this nothing is seen through a voxel, and products overflow.
const MOST_DENSITY: f32 = 1e12;

/// The blocks of a grid, by their numbers, x first; none is made yet.
pub struct Blocks<'a> {
    grid: &'a Grid,
    /// Cells along each axis.
    pub cells: [i64; 3],
    /// Blocks along each axis.
    pub along: [i64; 3],
}

impl Blocks<'_> {
    /// Those of a grid.
    ///
    /// # Errors
    /// They are more than devices hold.
    pub fn of(grid: &Grid) -> Result<Blocks<'_>> {
        // A corner more on each side, which is of the background or goes on.
        let cells = grid.size().map(|voxels| voxels + 1);
        let along = cells.map(|cells| (cells + i64::from(CELLS) - 1).div_euclid(CELLS.into()));
        let blocks = Blocks { grid, cells, along };
        let count = along.iter().try_fold(1i64, |all, &along| all.checked_mul(along)).unwrap_or(i64::MAX);
        if count > MOST_BLOCKS || cells.iter().any(|&cells| cells > i64::from(u32::MAX >> 9)) {
            return Err(blocks.fault("are more than devices hold"));
        }
        Ok(blocks)
    }

    /// How many there are.
    pub fn count(&self) -> u64 {
        self.along.iter().product::<i64>() as u64
    }

    /// A fault of all of them, and its remedy.
    pub fn fault(&self, why: &str) -> Error {
        let (name, [x, y, z]) = (&self.grid.name, self.grid.size());
        Error::new(format!(
            "the blocks of {name}, which spans {x} x {y} x {z} voxels, {why}: crop it or make it coarser"
        ))
    }

    /// The number of those that touch no leaf.
    pub fn background(&self) -> f32 {
        kept(self.grid.background)
    }

    /// Those that touch leaves, in order.
    pub fn near(&self) -> Vec<u32> {
        let mut near: Vec<u32> = self.grid.leaves.keys().flat_map(|&leaf| self.touching(leaf)).collect();
        near.sort_unstable();
        near.dedup();
        near
    }

    /// Numbers that are kept at corners, at most: blocks whose leaves are even and alike need none.
    pub fn most_corners(&self) -> u64 {
        let is_uneven = |number: &&u32| self.even(self.start(**number)).is_none();
        (CORNERS * self.near().par_iter().filter(is_uneven).count()) as u64
    }

    /// Makes some.
    pub fn made(&self, numbers: &[u32]) -> Vec<(u32, Block)> {
        numbers.par_iter().map(|&number| (number, self.block(self.start(number)))).collect()
    }

    /// Those that a leaf touches: at most two along each axis, since blocks share their faces.
    fn touching(&self, leaf: [i32; 3]) -> impl Iterator<Item = u32> {
        let [width, height, _] = self.along;
        let [x, y, z] = std::array::from_fn(|axis| {
            // The leaf's first voxel, counted in corners.
            let first = i64::from(leaf[axis]) * i64::from(LEAF) - (i64::from(self.grid.extent[0][axis]) - 1);
            let block = |corner: i64| corner.div_euclid(CELLS.into());
            block(first - 1).max(0)..(block(first + i64::from(LEAF) - 1) + 1).min(self.along[axis])
        });
        let rows = z.flat_map(move |z| y.clone().map(move |y| z * height + y));
        rows.flat_map(move |row| x.clone().map(move |x| (row * width + x) as u32))
    }

    /// The first corner of one: that of the first is a voxel before the grid's.
    fn start(&self, number: u32) -> [i32; 3] {
        let (number, [width, height, _]) = (i64::from(number), self.along);
        let place = [number % width, number / width % height, number / width / height];
        std::array::from_fn(|axis| self.grid.extent[0][axis] - 1 + CELLS as i32 * place[axis] as i32)
    }

    /// The voxel at a corner: where the grid has edges, the outermost go on.
    fn voxel(&self, corner: [i32; 3]) -> [i32; 3] {
        let [first, end] = self.grid.extent;
        if !self.grid.has_edges {
            return corner;
        }
        std::array::from_fn(|axis| corner[axis].clamp(first[axis], end[axis] - 1))
    }

    /// The number of all corners of one, if the leaves that it touches tell without asking for their voxels.
    fn even(&self, start: [i32; 3]) -> Option<f32> {
        let ends =
            [start, start.map(|at| at + EDGE - 1)].map(|corner| self.voxel(corner).map(|at| at.div_euclid(LEAF)));
        let mut numbers = (0..8).map(|bits| {
            let leaf: [i32; 3] = std::array::from_fn(|axis| ends[bits >> axis & 1][axis]);
            match self.grid.leaves.get(&leaf) {
                None => Some(self.grid.background),
                Some(Leaf::Even(number)) => Some(*number),
                Some(Leaf::Voxels(_)) => None,
            }
        });
        let first = numbers.next()?;
        if numbers.all(|number| number == first) { first } else { None }
    }

    fn block(&self, start: [i32; 3]) -> Block {
        if let Some(number) = self.even(start) {
            return Block { greatest: kept(number), corners: Vec::new() };
        }
        let number = |corner| kept(self.grid.number(self.voxel(corner)));
        let mut corners = Vec::with_capacity(CORNERS);
        for (z, y) in (0..EDGE).flat_map(|z| (0..EDGE).map(move |y| (z, y))) {
            corners.extend((0..EDGE).map(|x| number([start[0] + x, start[1] + y, start[2] + z])));
        }
        let greatest = corners.iter().copied().fold(0.0, f32::max);
        if corners.iter().all(|&corner| corner == greatest) {
            corners = Vec::new();
        }
        Block { greatest, corners }
    }
}

/// The numbers at the corners of a block's cells.
pub struct Block {
    pub greatest: f32,
    /// None if all are as the greatest.
    pub corners: Vec<f32>,
}

/// A number as kernels take it: less than nothing is nothing, and what is subnormal too.
fn kept(number: f32) -> f32 {
    if number >= f32::MIN_POSITIVE { number.min(MOST_DENSITY) } else { 0.0 }
}
