//! Films whose cells have as many samples as their noise asks for.

use std::ops::Range;

use eyerays_shader::stage::{BLOCK, PixelSums, Row};
use rayon::prelude::*;

use super::develop::{Mean, mean_light};
use super::{Coverage, Film, Layout, words_of_row};
use crate::error::{Error, Result};
use crate::noise::{CellSums, Target, decides_at, next, whole_blocks};
use crate::view::{Region, View};

/// How many samples each cell of the image has, and when it has enough.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    pub(super) target: Target,
    /// Samples of a cell that ends though it has more noise.
    pub(super) most: u32,
    /// Row by row, also of those that the film's window is without.
    pub(super) counts: Vec<u32>,
}

impl Cells {
    /// Of an image of which no cell has any sample.
    pub(super) fn new(size: (u32, u32), target: Target, most: u32) -> Cells {
        let count = Cells::across(size) as usize * size.1.div_ceil(Target::CELL) as usize;
        Cells { target, most, counts: vec![0; count] }
    }

    /// How many lie beside each other.
    pub(super) fn across((width, _): (u32, u32)) -> u32 {
        width.div_ceil(Target::CELL)
    }

    /// The noise that was asked for.
    pub fn target(&self) -> &Target {
        &self.target
    }

    /// The most samples of a cell.
    pub fn most(&self) -> u32 {
        self.most
    }
}

impl Film {
    /// Of a view whose cells get as many samples as a target asks for, and at most those of the view: without any.
    pub(crate) fn of_cells(view: &View, target: &Target) -> Result<Film> {
        let most = most_samples(view)?;
        let (window, size) = (view.region(), view.size());
        if Target::around(window, size) != window {
            return Err(Error::new("a tile that noise decides about is cut at cells: give one of whole cells"));
        }
        let film = Film::new(view, view.noisy_film_words());
        Ok(Film { cells: Some(Cells::new(size, *target, most)), ..film })
    }

    /// Which samples its cells have, if noise decides about them.
    pub fn cells(&self) -> Option<&Cells> {
        self.cells.as_ref()
    }

    /// Lets its cells have as many samples as those of a view.
    pub(crate) fn extend_cells(&mut self, view: &View) -> Result<()> {
        let most = most_samples(view)?;
        let Some(cells) = &mut self.cells else { return Err(other_kind()) };
        if cells.counts.iter().any(|&count| count > most) {
            return Err(Error::new(format!("the film has cells of more than {most} samples: ask for as many")));
        }
        cells.most = most;
        Ok(())
    }

    /// Samples of a pixel of a cell.
    pub(crate) fn samples_of_cell(&self, cell: Region) -> u32 {
        self.cells.as_ref().map_or(0, |cells| cells.counts[self.cell_number(cell)])
    }

    /// Adds samples of some cells, which are those after the ones that they have.
    pub(crate) fn add_cells(&mut self, of: &[Region], samples: Range<u32>, added: &CellSums) -> Result<()> {
        for &cell in of {
            let number = self.cell_number(cell);
            let cells = self.cells.as_mut().ok_or_else(other_kind)?;
            assert_eq!(cells.counts[number], samples.start, "samples are added in their order");
            cells.counts[number] = samples.end;
        }
        self.add_rays(added.secondary);
        self.make_room()?;
        let (window, words) = (self.window, self.words);
        let band = |cell: &Region| (cell.y - window.y) / Target::CELL;
        let mut bands = vec![Vec::new(); window.height.div_ceil(Target::CELL) as usize];
        of.iter().zip(&added.sums).for_each(|(cell, sums)| bands[band(cell) as usize].push((*cell, sums)));
        // Rows of cells on all threads: a device waits meanwhile.
        let rows = self.sums.par_chunks_mut(words_of_row(words, Target::CELL * window.width));
        rows.zip(bands).for_each(|(own, cells)| {
            for (cell, sums) in cells {
                let region = Region { y: cell.y, height: cell.height, ..window };
                Layout { region, words }.add(own, cell, sums);
            }
        });
        Ok(())
    }

    /// Has a cell enough samples?
    pub(crate) fn is_done(&self, cell: Region) -> bool {
        let Some(Cells { target, most, .. }) = &self.cells else { return true };
        let count = self.samples_of_cell(cell);
        count >= *most || decides_at(count) && self.cell_error(cell) <= target.noise()
    }

    /// Samples that a cell gets next.
    pub(crate) fn next_samples(&self, count: u32) -> Range<u32> {
        count..self.cells.as_ref().map_or(count, |cells| next(count, cells.most))
    }

    /// The standard error of what is seen of a cell: of its pixels the root mean square.
    fn cell_error(&self, cell: Region) -> f64 {
        let Some(Cells { target, .. }) = &self.cells else { return f64::INFINITY };
        let count = self.samples_of_cell(cell);
        let (width, left) = (self.window.width, cell.x - self.window.x);
        let mut squares = 0.0;
        for y in cell.y - self.window.y..cell.y + cell.height - self.window.y {
            for x in left..left + cell.width {
                let sums = PixelSums::load(&self.sums, Row::new(y, width, self.words), x);
                let light = mean_light(&sums, count);
                let mean = Mean::of(&sums, light, count, BLOCK);
                let share = if mean.brightness > 0.0 { mean.variance.sqrt() / mean.brightness } else { 0.0 };
                let error = target.seen_error(light, share);
                squares += error * error;
            }
        }
        (squares / cell.pixels() as f64).sqrt()
    }

    /// Those of some cells that need more samples.
    pub(crate) fn not_done(&self, cells: &[Region]) -> Vec<Region> {
        cells.par_iter().copied().filter(|&cell| !self.is_done(cell)).collect()
    }

    /// How many of its window's cells need more samples.
    pub fn cells_left(&self) -> usize {
        self.not_done(&Target::cells(self.window).collect::<Vec<_>>()).len()
    }

    /// Takes the counts of a film of the same picture.
    ///
    /// # Errors
    /// Both have samples of a cell, or the most samples are not the same.
    pub(super) fn merged_cells(&self, other: &Film) -> Result<Option<Cells>> {
        let (Some(own), Some(others)) = (&self.cells, &other.cells) else {
            return if self.cells.is_some() == other.cells.is_some() { Ok(None) } else { Err(other_kind()) };
        };
        if own.target != others.target || own.most != others.most {
            let most = |cells: &Cells| format!("noise {} and at most {} samples", cells.target.noise(), cells.most);
            let (a, b) = (most(own), most(others));
            return Err(Error::new(format!("one film has {a}, the other {b}: parts of one picture have the same")));
        }
        let across = Cells::across(self.size) as usize;
        let mut cells = own.clone();
        for (number, (count, &added)) in cells.counts.iter_mut().zip(&others.counts).enumerate() {
            if *count > 0 && added > 0 {
                let (x, y) = (number % across * Target::CELL as usize, number / across * Target::CELL as usize);
                return Err(Error::new(format!("both films have samples of the cell at {x},{y}: give each part once")));
            }
            *count += added;
        }
        Ok(Some(cells))
    }

    /// Samples of all pixels together.
    pub fn volume(&self) -> u64 {
        let of = |cell: Region| cell.pixels() * u64::from(self.samples_of_cell(cell));
        match self.cells {
            Some(_) => Target::cells(self.window).map(of).sum(),
            None => self.coverage.volume(),
        }
    }

    /// How many samples each pixel has of a row of its window.
    pub(super) fn counts(&self, row: u32) -> Vec<u32> {
        let Region { x, y, width, .. } = self.window;
        let Some(Cells { counts, .. }) = &self.cells else {
            return Coverage::counts(&self.coverage, y + row, x, width);
        };
        let first = (y + row) / Target::CELL * Cells::across(self.size);
        (x..x + width).map(|x| counts[(first + x / Target::CELL) as usize]).collect()
    }

    /// Samples that a square of its sums is of.
    pub(super) fn samples_a_square(&self) -> u32 {
        if self.cells.is_some() { BLOCK } else { 1 }
    }

    fn cell_number(&self, cell: Region) -> usize {
        (cell.y / Target::CELL * Cells::across(self.size) + cell.x / Target::CELL) as usize
    }
}

/// The most samples of a cell of a view.
fn most_samples(view: &View) -> Result<u32> {
    let most = whole_blocks(view.range().end);
    if view.range().start > 0 {
        return Err(Error::new("noise decides about all samples of a pixel: render from the first on"));
    }
    if most < Target::LEAST_SAMPLES {
        let least = Target::LEAST_SAMPLES;
        return Err(Error::new(format!("noise decides after {least} samples or more: ask for at least as many")));
    }
    Ok(most)
}

fn other_kind() -> Error {
    Error::new("a film that ends by its noise and one of a fixed number of samples are of different pictures")
}
