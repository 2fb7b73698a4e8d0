//! Launches over cells that lie anywhere in the image, of pictures that end by their noise: a cell alone would be far too small a launch.
//! Their films lie beside and below each other in one, which is read back after each call.

use std::ops::Range;

use eyerays_shader::camera;
use eyerays_shader::data::{Frame, Launch as Bits, Order};
use eyerays_shader::resources::binding;
use eyerays_shader::stage::BLOCK;
use rayon::prelude::*;
use wgpu::BufferUsages as Use;

use super::read::whole_words;
use super::{Memory, Renderer};
use crate::error::{Error, Result};
use crate::gpu::kernel::Kernel;
use crate::gpu::launch::Launch;
use crate::gpu::memory::buffer;
use crate::gpu::recipe::Recipe;
use crate::noise::{CellSums, Target};
use crate::plan::{self, Plan};
use crate::view::{Region, View};

/// What launches over cells take beside those over regions.
pub(super) struct Cells {
    plan: Plan,
    /// By the plan's steps.
    kernels: Vec<Kernel>,
    lot: Option<Lot>,
}

/// Cells that are rendered at once.
struct Lot {
    grid: Grid,
    memory: Memory,
    table: wgpu::Buffer,
    film: wgpu::Buffer,
    /// For the step that binds the film.
    group: wgpu::BindGroup,
}

/// How many cells lie beside and below each other.
#[derive(Clone, Copy, PartialEq)]
struct Grid {
    across: u32,
    down: u32,
}

impl Cells {
    /// Gives memory back.
    pub fn forget(&mut self) {
        self.lot = None;
    }
}

impl Grid {
    /// For at least so many cells, in whole blocks of pixels of an order.
    fn of(cells: u32, order: Order) -> Grid {
        let (columns, rows) = camera::blocks(order);
        let across = columns.div_ceil(Target::CELL);
        Grid { across, down: cells.div_ceil(across).next_multiple_of(rows.div_ceil(Target::CELL)) }
    }

    fn cells(self) -> u32 {
        self.across * self.down
    }

    fn region(self) -> Region {
        Region { x: 0, y: 0, width: self.across * Target::CELL, height: self.down * Target::CELL }
    }

    /// The film of a cell by its place, out of that of all; `words` are those of a pixel.
    fn cut(self, film: &[u32], place: usize, cell: Region, words: u32) -> Vec<u32> {
        let columns = self.across * Target::CELL;
        let (left, top) = (place as u32 % self.across * Target::CELL, place as u32 / self.across * Target::CELL);
        let mut sums = Vec::with_capacity(cell.pixels() as usize * words as usize);
        for row in top..top + cell.height {
            for word in 0..words {
                let first = ((row * words + word) * columns + left) as usize;
                sums.extend_from_slice(&film[first..first + cell.width as usize]);
            }
        }
        sums
    }
}

impl Renderer {
    /// The sums of whole blocks of samples of some cells.
    pub(super) fn render_cells(&mut self, view: &View, cells: &[Region], samples: Range<u32>) -> Result<CellSums> {
        let least = Grid::of(1, self.order);
        let slots_of = |cells: u64| cells * u64::from(BLOCK) * least.region().pixels() / u64::from(least.cells());
        let wanted = slots_of((cells.len() as u64).next_multiple_of(least.cells().into()));
        let wanted = wanted * samples.len() as u64 / u64::from(BLOCK);
        self.reserve(wanted.min(self.most_slots.into()) as u32)?;
        let fits = u64::from(self.slots()) / slots_of(least.cells().into()) * u64::from(least.cells());
        if fits == 0 {
            return Err(Error::new("the GPU has too little memory for a block of samples of a cell"));
        }
        let memory = self.memory.as_ref().expect("it was reserved");
        self.queue.restart(memory.buffers.of(binding::COUNTERS));
        let mut all = CellSums { sums: Vec::with_capacity(cells.len()), secondary: 0 };
        for some in cells.chunks(fits as usize) {
            let lot = self.lot(Grid::of(some.len() as u32, self.order))?;
            let read = self.render_lot(&lot, view, some, samples.clone());
            let (sums, secondary) = read?;
            all.sums.extend(sums);
            all.secondary = secondary;
            self.cells.as_mut().expect("a lot is of them").lot = Some(lot);
        }
        self.queue.forget();
        Ok(all)
    }

    /// Memory for so many cells, which was taken before if the last lot had as many.
    fn lot(&mut self, grid: Grid) -> Result<Lot> {
        if self.cells.is_none() {
            self.cells = Some(self.compile_cells()?);
        }
        let cells = self.cells.as_mut().expect("they were compiled");
        if let Some(lot) = cells.lot.take_if(|lot| lot.grid.cells() >= grid.cells()) {
            return Ok(Lot { grid, ..lot });
        }
        let cells = self.cells.as_ref().expect("they were compiled");
        let table = buffer(&self.gpu, binding::CELLS, 4 * u64::from(grid.cells()), Use::STORAGE | Use::COPY_DST);
        let film_bytes = cells.plan.film_bytes() * grid.region().pixels();
        let film = buffer(&self.gpu, binding::FILM, film_bytes, Use::STORAGE | Use::COPY_SRC);
        let buffers = self.buffers().clone();
        let groups = self.groups(&cells.kernels, &buffers, Some(&table));
        let group = self.film_group(&cells.kernels, &film);
        self.gpu.check()?;
        Ok(Lot { grid, memory: Memory { buffers, groups }, table, film, group })
    }

    /// The kernels that start paths and keep the film are others; all else is the same.
    fn compile_cells(&mut self) -> Result<Cells> {
        let plan = self.plan.in_blocks(Bits::CELLS).ok_or_else(|| Error::new("the integrator does not sample"))?;
        let target = self.gpu.target(self.exact);
        let kernels = self.known.compile(&self.gpu, plan.steps().map(|&step| Recipe::new(step, target)).collect());
        self.gpu.check()?;
        Ok(Cells { plan, kernels, lot: None })
    }

    /// Renders cells and reads their films; and how many secondary rays there were since the queue was restarted.
    fn render_lot(
        &mut self,
        lot: &Lot,
        view: &View,
        cells: &[Region],
        samples: Range<u32>,
    ) -> Result<(Vec<Vec<u32>>, u64)> {
        let Cells { plan, kernels, .. } = self.cells.as_ref().expect("a lot is of them");
        let mut corners: Vec<u32> = cells.iter().map(|cell| cell.x | cell.y << 16).collect();
        // Outside of every image.
        corners.resize(lot.grid.cells() as usize, u32::MAX);
        self.gpu.queue.write_buffer(&lot.table, 0, bytemuck::cast_slice(&corners));
        let region = lot.grid.region();
        let batch = lot.memory.buffers.slots / region.pixels() as u32 / BLOCK * BLOCK;
        for first in samples.clone().step_by(batch as usize) {
            let count = batch.min(samples.end - first);
            let launch = view.launch(&self.job, region, first, count, self.order);
            let frame = Frame { anew: (first == samples.start).into(), ..launch };
            let mut launch = Launch::new(plan, kernels, &lot.memory, &lot.group, &frame, &mut self.queue)?;
            plan::run(plan, &mut launch)?;
            launch.submit(0)?;
            self.queue.finished()?;
        }
        let words = plan.film_words;
        let bytes = plan.film_bytes() * region.pixels();
        let mut sums = Vec::new();
        let secondary =
            self.queue.read(lot.memory.buffers.of(binding::COUNTERS), &[(&lot.film, bytes)], |_, bytes| {
                let film = whole_words(bytes);
                let cut = |(place, &cell)| lot.grid.cut(&film, place, cell, words);
                sums = cells.par_iter().enumerate().map(cut).collect();
            })?;
        Ok((sums, secondary))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_are_whole_blocks_of_pixels_and_hold_all_cells() {
        for order in [0, Order::LINEAR, Order::MORTON].map(Order) {
            for cells in [1, 2, 3, 17, 1024] {
                let grid = Grid::of(cells, order);
                let Region { width, height, .. } = grid.region();
                assert!(
                    grid.cells() >= cells && u64::from(camera::slots(width, height, order)) == grid.region().pixels()
                );
            }
        }
        assert_eq!(Grid::of(1024, Order(0)).cells(), 1024);
    }

    #[test]
    fn a_cell_is_cut_out_of_the_film_of_all() {
        let grid = Grid { across: 2, down: 2 };
        let words = 3;
        // Each word tells its row, its word and its column.
        let all = |row: u32, word: u32, column: u32| row * 1000 + word * 100 + column;
        let rows = (0..32).flat_map(|row| (0..words).map(move |word| (row, word)));
        let film: Vec<u32> = rows.flat_map(|(row, word)| (0..32).map(move |column| all(row, word, column))).collect();
        let cell = Region { x: 160, y: 32, width: 5, height: 2 };
        let sums = grid.cut(&film, 3, cell, words);
        let rows = (16..18).flat_map(|row| (0..words).map(move |word| (row, word)));
        assert_eq!(sums, rows.flat_map(|(row, word)| (16..21).map(move |x| all(row, word, x))).collect::<Vec<_>>());
    }
}
