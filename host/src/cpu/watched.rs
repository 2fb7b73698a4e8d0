//! Films that grow on a CPU.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

use eyerays_kernels_cpu::Number;

use super::render::Renderer;
use crate::error::Result;
use crate::film::{Film, Part};
use crate::job::Job;
use crate::noise::CellSums;
use crate::picture::Picture;
use crate::rays::Rays;
use crate::view::{Region, View};
use crate::watch::Grows;

/// A CPU that films grow on, in the arithmetic `R`.
pub(crate) struct OnCpu<R> {
    renderer: Arc<Renderer>,
    growing: Option<Growing>,
    number: PhantomData<fn() -> R>,
}

struct Growing {
    view: View,
    film: Film,
}

impl<R: Number> OnCpu<R> {
    /// Without a film.
    pub fn new(renderer: Arc<Renderer>) -> Self {
        OnCpu { renderer, growing: None, number: PhantomData }
    }
}

impl<R: Number> Grows for OnCpu<R> {
    fn turn(&mut self, job: &Job) -> Result<()> {
        self.growing = None;
        self.renderer = Arc::new(self.renderer.turned(job));
        Ok(())
    }

    fn start(&mut self, view: &View, _: &[Region]) -> Result<()> {
        // There may be no memory for two.
        self.growing = None;
        self.growing = Some(Growing { view: *view, film: self.renderer.start(view) });
        Ok(())
    }

    fn add(&mut self, part: Part, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let Growing { view, film } = self.growing.as_mut().expect("a film was started");
        self.renderer.add::<R>(view, film, part, done, &())
    }

    fn wait(&mut self) -> Result<()> {
        Ok(())
    }

    fn cells(&mut self, view: &View, cells: &[Region], samples: Range<u32>) -> Result<CellSums> {
        Ok(self.renderer.cells::<R>(view, cells, samples))
    }

    fn develop(&self, film: &Film) -> Result<(Picture, Rays)> {
        self.renderer.install(|| film.developed())
    }

    fn film(&mut self) -> Result<Film> {
        Ok(self.growing.as_ref().expect("a film was started").film.clone())
    }

    fn end(&mut self) -> Result<Film> {
        Ok(self.growing.take().expect("a film was started").film)
    }
}
