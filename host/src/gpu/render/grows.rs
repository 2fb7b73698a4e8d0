//! A renderer as a device that films grow on.

use std::ops::Range;
use std::time::Duration;

use super::{Renderer, cells};
use crate::error::Result;
use crate::film::{Film, Leasts, Part};
use crate::job::Job;
use crate::noise::{CellSums, Lot};
use crate::picture::Picture;
use crate::rays::Rays;
use crate::view::{Region, View};
use crate::watch::Grows;

impl Grows for Renderer {
    fn turn(&mut self, job: &Job) -> Result<()> {
        Renderer::turn(self, job)
    }

    fn start(&mut self, view: &View, regions: &[Region]) -> Result<()> {
        self.start_in(view, regions)
    }

    fn add(&mut self, part: Part, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        self.add_part(part, done)
    }

    fn wait(&mut self) -> Result<()> {
        self.gpu.wait()
    }

    fn cells(&mut self, view: &View, cells: &[Region], samples: Range<u32>) -> Result<CellSums> {
        let mut lot = Some(Lot { cells: cells.to_vec(), samples });
        let mut sums = None;
        self.render_lots(view, &mut |_| lot.take(), &mut |done| sums = Some(done));
        sums.expect("each lot is answered")
    }

    fn lots(&mut self, view: &View, next: &mut dyn FnMut(bool) -> Option<Lot>, done: &mut dyn FnMut(Result<CellSums>)) {
        self.render_lots(view, next, done);
    }

    fn lots_at_once(&self) -> usize {
        cells::AT_ONCE
    }

    fn device_time(&self) -> Option<Duration> {
        Renderer::device_time(self)
    }

    fn film(&mut self) -> Result<Film> {
        Renderer::film(self)
    }

    fn show(&mut self, leasts: Leasts) -> Option<Result<wgpu::Texture>> {
        Some(Renderer::show(self, leasts))
    }

    fn picture(&mut self, view: &View, done: &(dyn Fn(u64) + Sync)) -> Result<(Picture, Rays)> {
        Renderer::start(self, view)?;
        self.add_part(view.whole(), done)?;
        let picture = self.develop()?;
        done(self.queue.forget());
        Ok(picture)
    }
}
