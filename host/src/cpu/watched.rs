//! Films that grow on a CPU.

use std::marker::PhantomData;

use eyerays_kernels_cpu::Number;

use super::render::Renderer;
use crate::error::Result;
use crate::film::Film;
use crate::view::View;
use crate::watch::Grows;

/// A CPU that films grow on, in the arithmetic `R`.
pub(crate) struct OnCpu<'a, R> {
    renderer: &'a Renderer<'a>,
    growing: Option<Growing>,
    number: PhantomData<R>,
}

struct Growing {
    view: View,
    film: Film,
    /// The next sample.
    next: u32,
}

impl<'a, R: Number> OnCpu<'a, R> {
    /// Without a film.
    pub fn new(renderer: &'a Renderer<'a>) -> Self {
        OnCpu { renderer, growing: None, number: PhantomData }
    }
}

impl<R: Number> Grows for OnCpu<'_, R> {
    fn start(&mut self, view: &View) -> Result<()> {
        // There may be no memory for two.
        self.growing = None;
        self.growing = Some(Growing { view: *view, film: self.renderer.start(view)?, next: view.range().start });
        Ok(())
    }

    fn add(&mut self, count: u32, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let Growing { view, film, next } = self.growing.as_mut().expect("a film was started");
        let samples = *next..*next + count;
        *next = samples.end;
        self.renderer.add::<R>(view, film, samples, done, &())
    }

    fn wait(&mut self) -> Result<()> {
        Ok(())
    }

    fn film(&mut self) -> Result<Film> {
        Ok(self.growing.as_ref().expect("a film was started").film.clone())
    }

    fn end(&mut self) -> Result<Film> {
        Ok(self.growing.take().expect("a film was started").film)
    }
}
