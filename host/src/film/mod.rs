//! The film: what the samples of a picture come to, as a value that is added to, merged, kept and developed. Its sums have no order
//! ([`eyerays_shader::stage::PixelSums`]), so that parts of a picture, merged in any order, have the bits of all at once.

mod cells;
mod coverage;
mod develop;
mod file;
mod identity;
mod screen;
#[cfg(test)]
mod tests;

use eyerays_shader::stage::{AovSums, FilmWords, PixelSums, Row};
use rayon::prelude::*;

pub use cells::Cells;
pub use coverage::{Coverage, Part};
pub(crate) use develop::Developer;
pub use identity::Identity;
pub use screen::Leasts;

use crate::error::{Error, Result};
use crate::view::{Region, View};

/// Sums of the samples of a picture, or of a part of it: 40 bytes a pixel, and 56 where noise is told; 4 more where what is clear is
/// counted, 36 more for each arbitrary output variable.
#[derive(Debug, Clone)]
pub struct Film {
    size: (u32, u32),
    window: Region,
    /// Of a pixel.
    words: FilmWords,
    /// Row by row; in a row one word of all its pixels after another. Nothing before the first are added, since a system takes
    /// milliseconds to hand over so much memory.
    sums: Vec<u32>,
    /// Empty where `cells` tell the samples.
    coverage: Coverage,
    /// Of a picture that ends by its noise.
    cells: Option<Cells>,
    /// Reflected and refracted rays.
    secondary: u64,
    /// What it is a film of.
    pub identity: Identity,
}

impl Film {
    /// Without any sample, for a view; `words` are those of a pixel.
    pub(crate) fn new(view: &View, words: FilmWords) -> Film {
        Film {
            size: view.size(),
            window: view.region(),
            words,
            sums: Vec::new(),
            coverage: Coverage::default(),
            cells: None,
            secondary: 0,
            identity: Identity::default(),
        }
    }

    /// How many arbitrary output variables it keeps of each pixel.
    pub fn aovs(&self) -> u32 {
        self.words.aovs
    }

    /// Columns and rows of the image that it is of.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// What of the image it holds.
    pub fn window(&self) -> Region {
        self.window
    }

    /// Which samples it has, unless noise decides about them ([`Film::cells`]).
    pub fn coverage(&self) -> &Coverage {
        &self.coverage
    }

    /// The part of a view that it should have.
    pub fn missing(&self, view: &View) -> Vec<Part> {
        self.coverage.missing(&view.whole())
    }

    /// Says that it has got samples, whose sums are added by [`Film::add_sums`].
    ///
    /// # Panics
    /// If it had some of them.
    pub(crate) fn cover(&mut self, part: Part) {
        self.coverage.add(part).expect("samples are added once");
    }

    /// Takes the sums of a film of the same window, whose samples nobody else has.
    ///
    /// # Errors
    /// If there is no memory for them.
    pub(crate) fn absorb(&mut self, other: &Film) -> Result<()> {
        self.secondary = self.secondary.saturating_add(other.secondary);
        self.add_sums(other.window, &other.sums)
    }

    /// Says which samples it has.
    pub(crate) fn set_coverage(&mut self, coverage: Coverage) {
        self.coverage = coverage;
    }

    /// Counts reflected and refracted rays.
    pub(crate) fn add_rays(&mut self, secondary: u64) {
        self.secondary += secondary;
    }

    /// Adds the samples of another film of the same picture.
    ///
    /// # Errors
    /// Both have some samples, or they are of different pictures: then nothing has changed.
    pub fn merge(&mut self, other: Film) -> Result<()> {
        self.identity.check(&other.identity)?;
        if (self.size, self.words) != (other.size, other.words) {
            return Err(Error::new(
                "the films are of different pictures: parts of one picture have its size and integrator",
            ));
        }
        let cells = self.merged_cells(&other)?;
        let mut coverage = self.coverage.clone();
        for part in other.coverage.parts() {
            let twice = |both| Error::new(format!("both films have {both}: give each part once"));
            coverage.add(part.clone()).map_err(twice)?;
        }
        self.widen(other.window)?;
        if self.identity == Identity::default() {
            self.identity = other.identity;
        }
        (self.coverage, self.cells) = (coverage, cells);
        self.secondary = self.secondary.saturating_add(other.secondary);
        self.add_sums(other.window, &other.sums)
    }

    /// Makes room for a region.
    pub(crate) fn widen(&mut self, region: Region) -> Result<()> {
        let window = self.window.around(region);
        if window != self.window {
            let (old, old_window) = (std::mem::take(&mut self.sums), self.window);
            self.window = window;
            self.add_sums(old_window, &old)?;
        }
        Ok(())
    }

    /// Adds sums that are laid out as a film of the region.
    ///
    /// # Errors
    /// If there is no memory for them.
    pub(crate) fn add_sums(&mut self, region: Region, sums: &[u32]) -> Result<()> {
        if sums.is_empty() {
            return Ok(());
        }
        if self.sums.is_empty() && region == self.window {
            self.reserve()?;
            self.sums.par_extend(sums.par_iter().copied());
            return Ok(());
        }
        self.make_room()?;
        Layout { region: self.window, words: self.words }.add(&mut self.sums, region, sums);
        Ok(())
    }

    /// Sums of nothing, where there are none yet. On all threads: a system takes long to hand so much memory to one.
    pub(crate) fn make_room(&mut self) -> Result<()> {
        if self.sums.is_empty() {
            let all = self.reserve()?;
            self.sums.par_extend(rayon::iter::repeat_n(0, all));
        }
        Ok(())
    }

    /// Adds the sums of a part by this thread alone, once there is room, see [`Layout::add_alone`].
    pub(crate) fn add_part_alone(&mut self, region: Region, sums: &[u32]) {
        Layout { region: self.window, words: self.words }.add_alone(&mut self.sums, region, sums);
    }

    /// Takes the memory of all sums, of so many words.
    fn reserve(&mut self) -> Result<usize> {
        let all = self.window.pixels() as usize * self.words.all() as usize;
        let (width, height) = self.size;
        self.sums.try_reserve_exact(all).map_err(|_| Error::Memory { width, height })?;
        Ok(all)
    }
}

/// Words of a row of so many pixels.
fn words_of_row(words: FilmWords, width: u32) -> usize {
    words.all() as usize * width as usize
}

/// How sums lie in memory: row by row of a region, in a row one word of all its pixels after another.
#[derive(Clone, Copy)]
pub(crate) struct Layout {
    pub region: Region,
    /// Of a pixel.
    pub words: FilmWords,
}

impl Layout {
    /// Adds sums of a region within this one.
    pub fn add(self, own: &mut [u32], region: Region, added: &[u32]) {
        let (row, added_row) = self.lengths(region);
        let rows = own.par_chunks_mut(row).skip((region.y - self.region.y) as usize).take(region.height as usize);
        let rows = rows.zip(added.par_chunks(added_row)).with_min_len(16);
        rows.for_each(|(own, added)| self.add_row(own, region, added));
    }

    /// The same by this thread alone: who holds a lock that others of its pool wait for must not wait for its pool, where it would
    /// take up work that wants the lock, too.
    pub fn add_alone(self, own: &mut [u32], region: Region, added: &[u32]) {
        let (row, added_row) = self.lengths(region);
        let rows = own.chunks_mut(row).skip((region.y - self.region.y) as usize).take(region.height as usize);
        rows.zip(added.chunks(added_row)).for_each(|(own, added)| self.add_row(own, region, added));
    }

    /// Words of a row of both.
    fn lengths(self, region: Region) -> (usize, usize) {
        (words_of_row(self.words, self.region.width), words_of_row(self.words, region.width))
    }

    fn add_row(self, own: &mut [u32], region: Region, added: &[u32]) {
        let left = region.x - self.region.x;
        let (to, from) = (Row::new(0, self.region.width, self.words), Row::new(0, region.width, self.words));
        for x in 0..region.width {
            let both = PixelSums::load(own, to, left + x).plus(PixelSums::load(added, from, x));
            both.store(own, to, left + x);
        }
        for number in 0..self.words.aovs {
            for x in 0..region.width {
                let both = AovSums::load(own, to, number, left + x).plus(AovSums::load(added, from, number, x));
                both.store(own, to, number, left + x);
            }
        }
    }
}
