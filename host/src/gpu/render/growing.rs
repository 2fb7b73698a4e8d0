//! A film on the device that samples are added to, in bands of the image.

use std::ops::Range;

use eyerays_shader::camera;
use eyerays_shader::data::Frame;
use eyerays_shader::resources::binding;
use wgpu::BufferUsages as Use;

use super::Renderer;
use crate::error::Result;
use crate::film::{Coverage, Part};
use crate::gpu::bands::bands;
use crate::gpu::launch::Launch;
use crate::gpu::memory::buffer;
use crate::plan;
use crate::view::{Region, View};

/// A film that samples are added to.
pub(super) struct Growing {
    pub view: View,
    pub bands: Vec<Band>,
    pub coverage: Coverage,
}

/// A region of the image with its film.
pub(super) struct Band {
    pub region: Region,
    /// Has it no sample?
    pub is_empty: bool,
    pub film: wgpu::Buffer,
    /// For the steps that bind the film.
    pub group: wgpu::BindGroup,
}

impl Renderer {
    /// Starts a film of a view without any sample. Memory is taken if no film before needed as much.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn start(&mut self, view: &View) -> Result<()> {
        self.start_in(view, &[view.region()])
    }

    /// The same, for parts that lie within one of these regions each.
    pub(super) fn start_in(&mut self, view: &View, regions: &[Region]) -> Result<()> {
        let slots = |region: &Region| u64::from(camera::slots(region.width, region.height, self.order));
        let wanted = regions.iter().map(slots).max().unwrap_or(0) * u64::from(view.samples());
        let of_photons = self.photon_slots(view, view.samples()).min(self.most_slots.into());
        let of_photons = of_photons.max(self.photon_slots(view, 1));
        self.reserve(wanted.min(self.most_slots.into()).max(of_photons) as u32)?;
        let regions: Vec<_> = regions.iter().flat_map(|&region| bands(region, self.slots(), self.order)).collect();
        let mut bands = match self.growing.take() {
            Some(growing) if growing.bands.iter().map(|band| band.region).eq(regions.iter().copied()) => growing.bands,
            _ => regions.into_iter().map(|region| self.band(region)).collect::<Result<_>>()?,
        };
        bands.iter_mut().for_each(|band| band.is_empty = true);
        self.growing = Some(Growing { view: *view, bands, coverage: Coverage::default() });
        self.queue.forget();
        let memory = self.memory.as_ref().expect("it was reserved");
        self.queue.restart(memory.buffers.of(binding::COUNTERS));
        Ok(())
    }

    /// Adds samples of each pixel: n and then n more give the bits of 2n at once, in any order. Does not wait for the GPU, unless it
    /// has enough to do, or reflected and refracted rays branch, where the end of each launch is waited for. `done` hears of shares
    /// of the pixels that are known to be finished; after [`Renderer::film`] all are.
    ///
    /// # Errors
    /// The view has no such samples, or what the GPU reports; the film must then be started again.
    ///
    /// # Panics
    /// If no film was started.
    pub fn add(&mut self, samples: Range<u32>, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let region = self.growing.as_ref().expect("a film was started").view.region();
        self.add_part(Part { region, samples }, done)
    }

    pub(super) fn add_part(&mut self, part: Part, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let mut growing = self.growing.take().expect("a film was started");
        growing.view.part(part.region, part.samples.clone())?;
        let within = |band: &&mut Band| part.region.around(band.region) == part.region;
        for band in growing.bands.iter_mut().filter(within) {
            self.add_to(band, &growing.view, part.samples.clone(), done)?;
        }
        growing.coverage.add(part).map_err(Part::twice)?;
        self.growing = Some(growing);
        Ok(())
    }

    fn add_to(&mut self, band: &mut Band, view: &View, samples: Range<u32>, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let (width, height) = (band.region.width, band.region.height);
        let batch = self.slots() / camera::slots(width, height, self.order);
        let batch = batch.min(self.photon_samples(view, self.slots())).max(1);
        let mut first = samples.start;
        while first < samples.end {
            let count = batch.min(samples.end - first);
            self.land(view, first, count)?;
            let launch = view.launch(&self.job, band.region, first, count, self.order);
            let frame = Frame { anew: band.is_empty.into(), ..launch };
            let share = |samples| band.region.pixels() * u64::from(samples) / u64::from(view.samples());
            let memory = self.memory.as_ref().expect("it was reserved");
            let mut launch = Launch::new(&self.plan, &self.kernels, memory, &band.group, &frame, &mut self.queue)?;
            plan::run(&self.plan, &mut launch)?;
            let since = first - view.range().start;
            launch.submit(share(since + count) - share(since))?;
            done(self.queue.finished()?);
            band.is_empty = false;
            first += count;
        }
        Ok(())
    }

    fn band(&self, region: Region) -> Result<Band> {
        let size = self.plan.film_bytes() * region.pixels();
        let film = buffer(&self.gpu, binding::FILM, size, Use::STORAGE | Use::COPY_SRC);
        let group = self.film_group(&self.kernels, &film);
        self.gpu.check()?;
        Ok(Band { region, is_empty: true, film, group })
    }
}
