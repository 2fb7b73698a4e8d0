//! Launches on the GPU: waves of trace, shadow and shade over bands of the image.

use std::time::Duration;

use eyerays_shader::camera;
use eyerays_shader::data::{Features, numbers};
use eyerays_shader::launch::counter;
use eyerays_shader::stage::NON_FINITE;
use glam::UVec4;

use super::buffers::{self, Buffers, Room};
use super::device::Gpu;
use super::kernel::{Kernel, compile};
use super::plan::Plan;
use super::readback;
use super::recipe::{Recipe, Step};
use super::scene::SceneBuffers;
use super::timer::Timer;
use crate::error::Result;
use crate::film::Film;
use crate::method::Traversal;
use crate::pack::{Packed, Region};
use crate::rays::Rays;

/// Waves that are first submitted without looking whether any ray is left; doubled each time.
const WAVES: u32 = 4;
/// Waves at most in a submission, so that no watchdog takes it for hung.
const MOST_WAVES: u32 = 64;

/// A picture and what it took.
pub struct GpuRendering {
    /// The picture.
    pub film: Film,
    /// What was traced.
    pub rays: Rays,
    /// Time on the device, if it has a clock.
    pub device_time: Option<Duration>,
}

/// A scene on a GPU, ready to be rendered any number of times.
pub struct Renderer<'a> {
    gpu: &'a Gpu,
    packed: &'a Packed,
    traversal: Traversal,
    /// Of the first wave, in order.
    first: Vec<Kernel>,
    /// Of each further wave, in order.
    further: Vec<Kernel>,
    buffers: Buffers,
    timer: Option<Timer>,
    bands: Vec<Region>,
}

impl<'a> Renderer<'a> {
    /// Compiles the kernels and uploads the scene.
    ///
    /// # Errors
    /// What does not fit the GPU, or what its driver reports.
    pub fn new(gpu: &'a Gpu, packed: &'a Packed, exact: bool, traversal: impl Into<Traversal>) -> Result<Self> {
        let traversal = traversal.into();
        let slots = buffers::most_slots(gpu, packed)?;
        let bands = bands(packed.settings.size, slots, traversal.features());
        let layout = buffers::layout(gpu);
        let plan = Plan::new(packed, exact, &traversal, |coherence| gpu.resolved(traversal, coherence))?;
        let recipes: Vec<Recipe> = plan.recipes().cloned().collect();
        let mut first = compile(gpu, &layout, &recipes);
        let further = first.split_off(plan.first.len());
        gpu.check()?;
        let most = |size: &dyn Fn(&Region) -> u32| bands.iter().map(size).max().unwrap_or(0).into();
        let slots = most(&|r| camera::slots(r.width, r.height, traversal.features()));
        let room = Room::of(packed, slots, most(&|r| r.width * r.height));
        let scene = SceneBuffers::new(gpu, packed, traversal.layout, plan.hierarchies())?;
        let buffers = Buffers::new(gpu, &layout, &scene, &room)?;
        Ok(Renderer { gpu, packed, traversal, first, further, buffers, timer: Timer::new(gpu, 1), bands })
    }

    /// Renders the picture. `done` hears of every finished share of the pixels.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn render(&self, done: &(dyn Fn(u64) + Sync)) -> Result<GpuRendering> {
        let (width, height) = self.packed.settings.size;
        let mut film = Film::new(width, height)?;
        let mut rays = Rays::default();
        let mut time = Duration::ZERO;
        for &band in &self.bands {
            let pixels = u64::from(band.width * band.height);
            for sample in 0..self.packed.samples() {
                let (secondary, took) = self.launch(band, sample)?;
                rays.secondary += secondary;
                time += took;
            }
            rays.primary += pixels * u64::from(self.packed.samples());
            let bytes = readback::read(self.gpu, &self.buffers.film, 16 * pixels)?;
            keep(band, &bytes, &mut film, &mut rays);
            done(pixels);
        }
        Ok(GpuRendering { film, rays, device_time: self.timer.is_some().then_some(time) })
    }

    /// One sample of a band: the first wave, and further ones until no ray is left. Returns the
    /// secondary rays and the device time.
    fn launch(&self, band: Region, sample: u32) -> Result<(u64, Duration)> {
        let frame = self.packed.frame(band, sample, self.traversal.features());
        self.gpu.queue.write_buffer(&self.buffers.frame, 0, bytemuck::bytes_of(&frame));
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        if sample == 0 {
            encoder.clear_buffer(&self.buffers.film, 0, None);
        }
        encoder.clear_buffer(&self.buffers.counters, 0, None);
        let mut waves = if self.further.is_empty() { 0 } else { WAVES };
        self.first_wave(&mut encoder, frame.limits.z, waves == 0);
        let (mut turn, mut time) = (0, Duration::ZERO);
        loop {
            for wave in 0..waves {
                turn = 1 - turn;
                self.further_wave(&mut encoder, turn, wave + 1 == waves);
            }
            time += self.submit(encoder)?;
            if waves == 0 {
                return Ok((0, time));
            }
            let bytes = readback::read(self.gpu, &self.buffers.counters, 4 * u64::from(counter::LENGTH))?;
            let counters: Vec<u32> = readback::words(&bytes).collect();
            if counters[counter::NEXT as usize] == 0 {
                return Ok((counters[counter::RAYS as usize].into(), time));
            }
            waves = (2 * waves).min(MOST_WAVES);
            encoder = self.gpu.device.create_command_encoder(&Default::default());
            // The start of the submission's time, which the first wave marks elsewhere.
            self.pass(&mut encoder, true, false);
        }
    }

    fn submit(&self, mut encoder: wgpu::CommandEncoder) -> Result<Duration> {
        if let Some(timer) = &self.timer {
            timer.resolve(&mut encoder, 1);
        }
        self.gpu.queue.submit([encoder.finish()]);
        match &self.timer {
            Some(timer) => Ok(timer.read(self.gpu, 1)?[0]),
            None => self.gpu.wait().map(|()| Duration::ZERO),
        }
    }

    fn pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, first: bool, last: bool) -> wgpu::ComputePass<'e> {
        let timestamp_writes = self.timer.as_ref().and_then(|t| t.writes(0, first, last));
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes })
    }

    /// One thread a slot, and one a slot and light.
    fn first_wave(&self, encoder: &mut wgpu::CommandEncoder, slots: u32, last: bool) {
        let mut pass = self.pass(encoder, true, last);
        pass.set_bind_group(0, &self.buffers.groups[0], &[]);
        for kernel in &self.first {
            let rows = if kernel.step == Step::Shadow { self.packed.lights.len() as u32 } else { 1 };
            kernel.run(&mut pass, slots, rows);
        }
    }

    /// The same over the slots that still have a ray, as many as the GPU has counted.
    fn further_wave(&self, encoder: &mut wgpu::CommandEncoder, turn: usize, last: bool) {
        let [advance, stages @ ..] = &self.further[..] else { return };
        let Buffers { counters, arguments, groups, .. } = &self.buffers;
        {
            let mut pass = self.pass(encoder, false, false);
            pass.set_bind_group(0, &groups[turn], &[]);
            advance.run(&mut pass, 1, 1);
        }
        encoder.copy_buffer_to_buffer(counters, 0, arguments, 0, arguments.size());
        let mut pass = self.pass(encoder, false, last);
        pass.set_bind_group(0, &groups[turn], &[]);
        for kernel in stages {
            let offset = if kernel.step == Step::Shadow { counter::SHADOWS } else { counter::SLOTS };
            kernel.run_indirect(&mut pass, arguments, 4 * u64::from(offset));
        }
    }
}

/// Cuts the image into regions of at most `slots` slots: whole rows, if that many fit.
fn bands((width, height): (u32, u32), slots: u32, features: Features) -> Vec<Region> {
    let (least, most) = camera::blocks(features);
    let columns = width.min((slots / (least * most) * least).max(least));
    let rows = (slots / camera::slots(columns, most, features) * most).max(most);
    let tops = (0..height).step_by(rows as usize);
    tops.flat_map(|y| (0..width).step_by(columns as usize).map(move |x| (x, y)))
        .map(|(x, y)| Region { x, y, width: (width - x).min(columns), height: (height - y).min(rows) })
        .collect()
}

/// Copies a band into the image and counts.
fn keep(band: Region, bytes: &[u8], film: &mut Film, rays: &mut Rays) {
    let words: Vec<u32> = readback::words(bytes).collect();
    for (row, line) in words.chunks_exact(4 * band.width as usize).enumerate() {
        let start = (band.y as usize + row) * film.width as usize + band.x as usize;
        for (pixel, record) in film.pixels[start..].iter_mut().zip(line.chunks_exact(4)) {
            *pixel = numbers(UVec4::from_slice(record)).to_array();
            rays.shadow += u64::from(record[3] & !NON_FINITE);
            rays.non_finite += u64::from(record[3] & NON_FINITE != 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_every_pixel_once_and_fit() {
        for (size, slots) in [((1, 1), 32), ((100, 70), 32), ((100, 70), 512), ((100, 70), 1 << 22), ((9, 3), 64)] {
            let mut seen = vec![0; (size.0 * size.1) as usize];
            for band in bands(size, slots, Features(0)) {
                assert!(camera::slots(band.width, band.height, Features(0)) <= slots, "{size:?} {slots}: {band:?}");
                for y in band.y..band.y + band.height {
                    for x in band.x..band.x + band.width {
                        seen[(y * size.0 + x) as usize] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&n| n == 1), "{size:?} {slots}");
        }
    }
}
