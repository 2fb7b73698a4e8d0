//! Devices that films grow on.

use std::ops::Range;
use std::time::Duration;

use crate::error::Result;
use crate::film::{Film, Leasts, Part};
use crate::job::Job;
use crate::noise::{CellSums, Lot};
use crate::picture::Picture;
use crate::rays::Rays;
use crate::team::Lost;
use crate::view::{Region, View};

/// A device that films grow on.
pub(crate) trait Grows: Send {
    /// Goes on with another job. The film is then to be started again.
    fn turn(&mut self, job: &Job) -> Result<()>;

    /// Starts a film of a view, without any sample. Parts that are added lie within one of these regions each, which fill its window.
    fn start(&mut self, view: &View, regions: &[Region]) -> Result<()>;

    /// Adds a part of the view of which it has nothing. `done` hears of shares of the pixels.
    fn add(&mut self, part: Part, done: &(dyn Fn(u64) + Sync)) -> Result<()>;

    /// Waits until what was added is done.
    fn wait(&mut self) -> Result<()>;

    /// How long samples take that are added at once, where one does not take longer: so soon a rendering ends that is stopped.
    fn step(&self) -> Duration {
        Duration::from_secs(1)
    }

    /// Time on the device of all that was rendered and read, if it has a clock.
    fn device_time(&self) -> Option<Duration> {
        None
    }

    /// Devices of several that failed since this was asked last.
    fn lost(&mut self) -> Vec<Lost> {
        Vec::new()
    }

    /// Whole blocks of samples of cells of a view, which may be others each time: their sums, which are of no film that was started.
    fn cells(&mut self, view: &View, cells: &[Region], samples: Range<u32>) -> Result<CellSums>;

    /// Lots of cells until there is none any more: `next` gives one, and waits for it where it is told to; `done` hears what comes of
    /// each, in their order, and of nothing more after a fault.
    fn lots(&mut self, view: &View, next: &mut dyn FnMut(bool) -> Option<Lot>, done: &mut dyn FnMut(Result<CellSums>)) {
        while let Some(Lot { cells, samples }) = next(true) {
            let sums = self.cells(view, &cells, samples);
            let is_lost = sums.is_err();
            done(sums);
            if is_lost {
                return;
            }
        }
    }

    /// How many lots it has under way at once.
    fn lots_at_once(&self) -> usize {
        1
    }

    /// The picture of a film, developed on its threads, and the rays that it took.
    fn develop(&self, film: &Film) -> Result<(Picture, Rays)> {
        film.developed()
    }

    /// Renders all samples of a view at once.
    fn expose(&mut self, view: &View, done: &(dyn Fn(u64) + Sync)) -> Result<Film> {
        self.start(view, &[view.region()])?;
        self.add(view.whole(), done)?;
        self.end()
    }

    /// The same to a picture, without a film.
    fn picture(&mut self, view: &View, done: &(dyn Fn(u64) + Sync)) -> Result<(Picture, Rays)> {
        let film = self.expose(view, done)?;
        self.develop(&film)
    }

    /// The film so far.
    fn film(&mut self) -> Result<Film>;

    /// What a screen shows of the film so far, where that need not leave the device.
    fn show(&mut self, _leasts: Leasts) -> Option<Result<wgpu::Texture>> {
        None
    }

    /// The film, to which nothing is added any more.
    fn end(&mut self) -> Result<Film> {
        self.film()
    }
}
