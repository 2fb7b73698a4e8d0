//! Launches over cells that lie anywhere in the image, of pictures that end by their noise: a cell alone would be far too small a launch.
//! Their films lie beside and below each other in one, which is read while the device renders others.

use std::collections::VecDeque;
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
use crate::gpu::launch::{Arriving, Launch};
use crate::gpu::memory::buffer;
use crate::gpu::recipe::Recipe;
use crate::noise::{CellSums, Lot, Target};
use crate::plan::{self, Plan};
use crate::view::{Region, View};

/// Lots that are under way at once: the device renders one while the host takes the films of the one before.
pub(super) const AT_ONCE: usize = 2;

/// What launches over cells take beside those over regions.
pub(super) struct Cells {
    plan: Plan,
    /// By the plan's steps.
    kernels: Vec<Kernel>,
    /// Films that are not in use.
    spare: Vec<CellFilm>,
}

/// A film of cells that are rendered at once.
struct CellFilm {
    grid: Grid,
    memory: Memory,
    table: wgpu::Buffer,
    film: wgpu::Buffer,
    /// For the step that binds the film.
    group: wgpu::BindGroup,
}

/// A lot that the device renders, in as many films as it takes; each has so many of its cells.
struct UnderWay {
    cells: Vec<Region>,
    films: Vec<(usize, CellFilm, Arriving)>,
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
        self.spare.clear();
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
    /// Renders lots of cells, see [`Grows::lots`](crate::watch::Grows::lots): the host hands the next to the device before it takes the
    /// films of the one before.
    pub(super) fn render_lots(
        &mut self,
        view: &View,
        next: &mut dyn FnMut(bool) -> Option<Lot>,
        done: &mut dyn FnMut(Result<CellSums>),
    ) {
        let mut under_way = VecDeque::new();
        loop {
            let lot = if under_way.len() < AT_ONCE { next(under_way.is_empty()) } else { None };
            let received = match (lot, under_way.is_empty()) {
                (Some(lot), _) => self.submit_lot(view, lot, &mut under_way, done).map(|()| None),
                (None, false) => self.receive_first(&mut under_way).map(Some),
                (None, true) => break,
            };
            match received {
                Ok(sums) => sums.into_iter().for_each(|sums| done(Ok(sums))),
                Err(error) => {
                    done(Err(error));
                    break;
                }
            }
        }
        self.queue.forget();
    }

    /// Begins a lot. Those before are waited for if it needs more memory than they do.
    fn submit_lot(
        &mut self,
        view: &View,
        lot: Lot,
        under_way: &mut VecDeque<UnderWay>,
        done: &mut dyn FnMut(Result<CellSums>),
    ) -> Result<()> {
        let Lot { cells, samples } = lot;
        let least = Grid::of(1, self.order);
        let slots_of = |cells: u64| cells * u64::from(BLOCK) * least.region().pixels() / u64::from(least.cells());
        let wanted = slots_of((cells.len() as u64).next_multiple_of(least.cells().into()));
        let wanted = (wanted * samples.len() as u64 / u64::from(BLOCK)).min(self.most_slots.into()) as u32;
        let wanted = u64::from(wanted).max(self.photon_slots(view, BLOCK)).min(u32::MAX.into()) as u32;
        if !self.has_slots(wanted) {
            while !under_way.is_empty() {
                done(Ok(self.receive_first(under_way)?));
            }
            self.reserve(wanted)?;
        }
        let fits = u64::from(self.slots()) / slots_of(least.cells().into()) * u64::from(least.cells());
        if fits == 0 {
            return Err(Error::new("the GPU has too little memory for a block of samples of a cell"));
        }
        if under_way.is_empty() {
            let memory = self.memory.as_ref().expect("it was reserved");
            self.queue.restart(memory.buffers.of(binding::COUNTERS));
        }
        let mut films = Vec::new();
        for some in cells.chunks(fits as usize) {
            let film = self.cell_film(Grid::of(some.len() as u32, self.order))?;
            let arriving = self.launch_cells(&film, view, some, samples.clone())?;
            films.push((some.len(), film, arriving));
        }
        under_way.push_back(UnderWay { cells, films });
        Ok(())
    }

    /// Waits for the lot that began first.
    fn receive_first(&mut self, under_way: &mut VecDeque<UnderWay>) -> Result<CellSums> {
        let UnderWay { cells, films } = under_way.pop_front().expect("one is under way");
        let Cells { plan, spare, .. } = self.cells.as_mut().expect("a lot is of them");
        let (mut rest, words, mut sums) = (&cells[..], plan.film_words.all(), Vec::with_capacity(cells.len()));
        for (count, film, arriving) in films {
            let (some, others) = rest.split_at(count);
            self.queue.receive(arriving, |_, bytes| {
                let all = whole_words(bytes);
                let cut = |(place, &cell)| film.grid.cut(&all, place, cell, words);
                sums.par_extend(some.par_iter().enumerate().map(cut));
            })?;
            spare.push(film);
            rest = others;
        }
        Ok(CellSums { sums, secondary: self.queue.take_rays() })
    }

    /// A film of so many cells: one that was used before, if it is large enough.
    fn cell_film(&mut self, grid: Grid) -> Result<CellFilm> {
        if self.cells.is_none() {
            self.cells = Some(self.compile_cells()?);
        }
        let cells = self.cells.as_mut().expect("they were compiled");
        if let Some(place) = cells.spare.iter().position(|film| film.grid.cells() >= grid.cells()) {
            // The next may not be cut as this one.
            return Ok(CellFilm { grid, ..cells.spare.swap_remove(place) });
        }
        // Those that are too small are no longer of use.
        cells.spare.clear();
        let cells = self.cells.as_ref().expect("they were compiled");
        let table = buffer(&self.gpu, binding::CELLS, 4 * u64::from(grid.cells()), Use::STORAGE | Use::COPY_DST);
        let film_bytes = cells.plan.film_bytes() * grid.region().pixels();
        let film = buffer(&self.gpu, binding::FILM, film_bytes, Use::STORAGE | Use::COPY_SRC);
        let buffers = self.buffers().clone();
        let groups = self.groups(&cells.kernels, &buffers, Some(&table));
        let group = self.film_group(&cells.kernels, &film);
        self.gpu.check()?;
        Ok(CellFilm { grid, memory: Memory { buffers, groups, photons: None }, table, film, group })
    }

    /// The kernels that start paths and keep the film are others; all else is the same.
    fn compile_cells(&mut self) -> Result<Cells> {
        let plan = self.plan.in_blocks(Bits::CELLS).ok_or_else(|| Error::new("the integrator does not sample"))?;
        let target = self.gpu.target(self.exact);
        let kernels = self.known.compile(&self.gpu, plan.steps().map(|&step| Recipe::new(step, target)).collect());
        self.gpu.check()?;
        Ok(Cells { plan, kernels, spare: Vec::new() })
    }

    /// Has cells rendered and their film sent.
    fn launch_cells(
        &mut self,
        film: &CellFilm,
        view: &View,
        cells: &[Region],
        samples: Range<u32>,
    ) -> Result<Arriving> {
        let mut corners: Vec<u32> = cells.iter().map(|cell| cell.x | cell.y << 16).collect();
        // Outside of every image.
        corners.resize(film.grid.cells() as usize, u32::MAX);
        self.gpu.queue.write_buffer(&film.table, 0, bytemuck::cast_slice(&corners));
        let region = film.grid.region();
        let slots = film.memory.buffers.slots;
        let most = (slots / region.pixels() as u32).min(self.photon_samples(view, slots));
        let batch = (most / BLOCK * BLOCK).max(BLOCK);
        for first in samples.clone().step_by(batch as usize) {
            let count = batch.min(samples.end - first);
            self.land(view, first, count)?;
            let launch = view.launch(&self.job, region, first, count, self.order);
            let frame = Frame { anew: (first == samples.start).into(), ..launch };
            let Cells { plan, kernels, .. } = self.cells.as_ref().expect("a lot is of them");
            let mut launch = Launch::new(plan, kernels, &film.memory, &film.group, &frame, &mut self.queue)?;
            plan::run(plan, &mut launch)?;
            launch.submit(0)?;
            self.queue.finished()?;
        }
        let Cells { plan, .. } = self.cells.as_ref().expect("a lot is of them");
        let bytes = plan.film_bytes() * region.pixels();
        Ok(self.queue.request(film.memory.buffers.of(binding::COUNTERS), &[(&film.film, bytes)]))
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
