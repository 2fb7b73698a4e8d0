//! One launch on the GPU, and the queue of those that are under way.

use std::collections::VecDeque;
use std::time::Duration;

use eyerays_shader::data::{Frame, Launch as LaunchBits};
use eyerays_shader::launch::{argument, counter};
use eyerays_shader::resources::binding;

use super::device::Gpu;
use super::kernel::Kernel;
use super::readback::{self, Readback};
use super::render::Memory;
use super::timer::Timer;
use crate::error::Result;
use crate::integrator::Waves;
use crate::plan::{Executor, Plan, Stage, Step};

/// Waves that are submitted without looking whether any ray is left, where at most so many follow.
const UNSEEN: u32 = 16;
/// Waves that are submitted at first where rays branch; doubled each time.
const FEW: u32 = 4;
/// Waves at most in a submission, so that no watchdog takes it for hung.
const MOST_WAVES: u32 = 64;
/// Launches that wait on the GPU while the host makes the next.
const UNDER_WAY: usize = 2;
/// Bytes of the counters.
const COUNTERS: u64 = 4 * counter::LENGTH as u64;
/// Passes whose times are kept until they are read.
const PASSES: u32 = 256;
/// Passes of a launch between two looks, at most.
const MOST_PASSES: u32 = 4;

/// What was submitted, and what of it is known to be done.
pub(super) struct Queue {
    gpu: Gpu,
    timer: Option<Timer>,
    /// Memory that films were read into before.
    readbacks: Vec<Readback>,
    /// For the counters alone.
    counters: Readback,
    /// Passes since the times were read.
    passes: u32,
    time: Duration,
    /// Secondary rays that were taken from the device.
    rays: u64,
    /// The most that the device may have counted since.
    uncounted: u64,
    /// Submissions with the pixels that each finishes.
    under_way: VecDeque<(wgpu::SubmissionIndex, u64)>,
    done: u64,
    /// The most waves that a launch of branching rays took so far.
    waves: u32,
}

/// Counters, times and films on their way to the host.
pub(super) struct Arriving {
    readback: Readback,
    submission: wgpu::SubmissionIndex,
    /// Bytes of times.
    times: u64,
    /// Bytes of each film.
    films: Vec<u64>,
}

impl Queue {
    pub fn new(gpu: &Gpu) -> Self {
        Queue {
            gpu: gpu.clone(),
            timer: Timer::new(gpu, PASSES),
            readbacks: Vec::new(),
            counters: Readback::new(gpu, COUNTERS),
            passes: 0,
            time: Duration::ZERO,
            rays: 0,
            uncounted: 0,
            under_way: VecDeque::new(),
            done: 0,
            waves: 0,
        }
    }

    /// Does the device tell the time?
    fn has_clock(&self) -> bool {
        self.timer.is_some()
    }

    /// Of all passes whose times were read, if the device tells the time.
    pub fn device_time(&self) -> Option<Duration> {
        self.has_clock().then_some(self.time)
    }

    /// Counts rays from now on, and leaves out the time of passes that were not read.
    pub fn restart(&mut self, counters: &wgpu::Buffer) {
        self.gpu.queue.write_buffer(counters, 0, &[0; COUNTERS as usize]);
        (self.passes, self.rays, self.uncounted) = (0, 0, 0);
    }

    /// Pixels that were finished since this was asked last. Waits while too many launches are under way.
    pub fn finished(&mut self) -> Result<u64> {
        while self.under_way.len() > UNDER_WAY {
            let (submission, pixels) = self.under_way.pop_front().expect("there are some");
            self.gpu.wait_for(submission)?;
            self.done += pixels;
        }
        Ok(std::mem::take(&mut self.done))
    }

    /// The pixels of all launches that nothing waited for.
    pub fn forget(&mut self) -> u64 {
        std::mem::take(&mut self.done) + self.under_way.drain(..).map(|(_, pixels)| pixels).sum::<u64>()
    }

    /// Waits for everything, reads the counters and some films, and tells how many secondary rays there were since
    /// [`Queue::restart`].
    pub fn read(
        &mut self,
        counters: &wgpu::Buffer,
        films: &[(&wgpu::Buffer, u64)],
        look: impl FnMut(usize, &[u8]),
    ) -> Result<u64> {
        let arriving = self.request(counters, films);
        self.receive(arriving, look)?;
        self.done += self.under_way.drain(..).map(|(_, pixels)| pixels).sum::<u64>();
        Ok(self.rays)
    }

    /// Has the counters and some films sent when all that was submitted is done, and waits for nothing. Rays are counted anew from there.
    pub fn request(&mut self, counters: &wgpu::Buffer, films: &[(&wgpu::Buffer, u64)]) -> Arriving {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let timed = self.timer.as_ref().filter(|_| self.passes > 0).map(|timer| {
            timer.resolve(&mut encoder, self.passes);
            timer.resolved(self.passes)
        });
        let all = [(counters, COUNTERS)].into_iter().chain(timed).chain(films.iter().copied());
        let size = all.clone().map(|(_, size)| size).sum();
        let fits = self.readbacks.iter().position(|readback| readback.size() >= size);
        let readback = match fits {
            Some(place) => self.readbacks.swap_remove(place),
            None => Readback::new(&self.gpu, size),
        };
        let mut offset = 0;
        for (buffer, size) in all {
            readback.copy(&mut encoder, buffer, offset, size);
            offset += size;
        }
        encoder.clear_buffer(counters, 4 * u64::from(counter::RAYS), Some(4));
        let submission = self.gpu.queue.submit([encoder.finish()]);
        let times = timed.map_or(0, |(_, size)| size);
        (self.passes, self.uncounted) = (0, 0);
        Arriving { readback, submission, times, films: films.iter().map(|(_, size)| *size).collect() }
    }

    /// Waits until it has arrived, and shows each film.
    pub fn receive(&mut self, arriving: Arriving, mut look: impl FnMut(usize, &[u8])) -> Result<()> {
        let Arriving { readback, submission, times, films } = arriving;
        let size = COUNTERS + times + films.iter().sum::<u64>();
        readback.receive(&self.gpu, submission, size, |bytes| {
            let (counters, rest) = bytes.split_at(COUNTERS as usize);
            let (times, mut rest) = rest.split_at(times as usize);
            if let Some(timer) = &self.timer {
                self.time += timer.times(times).into_iter().sum::<Duration>();
            }
            for (i, size) in films.into_iter().enumerate() {
                let (film, others) = rest.split_at(size as usize);
                look(i, film);
                rest = others;
            }
            let rays = readback::words(counters).nth(counter::RAYS as usize);
            self.rays += u64::from(rays.expect("it is one of the counters"));
        })?;
        // Those that were too small are not kept beside it.
        self.readbacks.retain(|other| other.size() >= size);
        self.readbacks.push(readback);
        Ok(())
    }

    /// Secondary rays of all that has arrived since this was asked last.
    pub fn take_rays(&mut self) -> u64 {
        std::mem::take(&mut self.rays)
    }

    /// Takes what the device has counted of secondary rays, and lets it count anew.
    fn count(&mut self, counters: &wgpu::Buffer, rays: u32) {
        self.gpu.queue.write_buffer(counters, 4 * u64::from(counter::RAYS), &[0; 4]);
        self.rays += u64::from(rays);
        self.uncounted = 0;
    }

    /// Must the times be read before more passes are timed?
    fn is_timer_full(&self) -> bool {
        self.has_clock() && self.passes + MOST_PASSES > PASSES
    }

    /// Begins the pass of a submission.
    fn pass(&mut self, encoder: &mut wgpu::CommandEncoder) -> wgpu::ComputePass<'static> {
        let timestamp_writes =
            self.timer.as_ref().filter(|_| self.passes < PASSES).map(|timer| timer.writes(self.passes));
        self.passes = (self.passes + 1).min(PASSES);
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes }).forget_lifetime()
    }

    fn submit(&mut self, encoder: wgpu::CommandEncoder) -> wgpu::SubmissionIndex {
        self.gpu.queue.submit([encoder.finish()])
    }
}

/// A launch that is being recorded: samples of a band of the image.
pub(super) struct Launch<'l> {
    kernels: &'l [Kernel],
    memory: &'l Memory,
    /// For the steps that bind the film; none of photons.
    film: Option<&'l wgpu::BindGroup>,
    frame: &'l Frame,
    queue: &'l mut Queue,
    plan: &'l Plan,
    /// The counters that rays are counted by.
    counted: &'l wgpu::Buffer,
    // Before the encoder, since it must be dropped first.
    pass: Option<wgpu::ComputePass<'static>>,
    encoder: wgpu::CommandEncoder,
    /// Is the queue of this wave the second?
    is_second: bool,
    /// Waves to be recorded before anyone looks whether a ray is left.
    unseen: u32,
    /// Waves that are recorded next.
    next: u32,
    /// Waves that were recorded.
    recorded: u32,
}

impl<'l> Launch<'l> {
    pub fn new(
        plan: &'l Plan,
        kernels: &'l [Kernel],
        memory: &'l Memory,
        film: &'l wgpu::BindGroup,
        frame: &'l Frame,
        queue: &'l mut Queue,
    ) -> Result<Self> {
        let rays = match plan.waves {
            Waves::AtMost(count) => u64::from(count) * u64::from(frame.slots),
            // Counted whenever the waves are looked at.
            Waves::Branching => 0,
        };
        if queue.is_timer_full() || queue.uncounted + rays > u64::from(u32::MAX) {
            queue.read(memory.buffers.of(binding::COUNTERS), &[], |_, _| ())?;
        }
        queue.uncounted += rays;
        let counted = memory.buffers.of(binding::COUNTERS);
        Ok(Self::begun(plan, kernels, memory, frame, queue, counted, Some(film)))
    }

    /// One of photons, whose rays are not counted; `counted` are the counters of those that are.
    pub fn of_photons(
        plan: &'l Plan,
        kernels: &'l [Kernel],
        memory: &'l Memory,
        frame: &'l Frame,
        queue: &'l mut Queue,
        counted: &'l wgpu::Buffer,
    ) -> Result<Self> {
        if queue.is_timer_full() {
            queue.read(counted, &[], |_, _| ())?;
        }
        let mut launch = Self::begun(plan, kernels, memory, frame, queue, counted, None);
        launch.encoder.clear_buffer(memory.buffers.of(binding::HEADS), 0, None);
        Ok(launch)
    }

    fn begun(
        plan: &'l Plan,
        kernels: &'l [Kernel],
        memory: &'l Memory,
        frame: &'l Frame,
        queue: &'l mut Queue,
        counted: &'l wgpu::Buffer,
        film: Option<&'l wgpu::BindGroup>,
    ) -> Self {
        queue.gpu.queue.write_buffer(memory.buffers.of(binding::FRAME), 0, bytemuck::bytes_of(frame));
        let mut encoder = queue.gpu.device.create_command_encoder(&Default::default());
        encoder.clear_buffer(memory.buffers.of(binding::COUNTERS), 0, Some(4 * u64::from(counter::LAUNCH)));
        let unseen = match plan.waves {
            Waves::AtMost(count) if count <= UNSEEN => count,
            _ => queue.waves.clamp(FEW, MOST_WAVES),
        };
        Launch {
            kernels,
            memory,
            film,
            frame,
            queue,
            plan,
            counted,
            pass: None,
            encoder,
            is_second: false,
            unseen,
            next: unseen,
            recorded: 0,
        }
    }

    /// Ends the launch, which finishes so many pixels.
    pub fn submit(mut self, pixels: u64) -> Result<()> {
        drop(self.pass.take());
        let submission = self.queue.submit(self.encoder);
        self.queue.under_way.push_back((submission, pixels));
        self.queue.gpu.check()
    }

    /// Hands what is recorded to the device, which begins with it while the rest is recorded.
    fn flush(&mut self) {
        drop(self.pass.take());
        let next = self.queue.gpu.device.create_command_encoder(&Default::default());
        self.queue.submit(std::mem::replace(&mut self.encoder, next));
    }

    /// Submits what is recorded, waits, and tells whether any ray is left.
    fn look(&mut self) -> Result<bool> {
        drop(self.pass.take());
        self.queue.counters.copy(&mut self.encoder, self.memory.buffers.of(binding::COUNTERS), 0, COUNTERS);
        self.flush();
        let look = |bytes: &[u8]| readback::words(bytes).collect::<Vec<u32>>();
        let counters = self.queue.counters.read(&self.queue.gpu, COUNTERS, look)?;
        let is_counted = self.film.is_some();
        if is_counted && counters[counter::RAYS as usize] > u32::MAX / 2 {
            self.queue.count(self.counted, counters[counter::RAYS as usize]);
        }
        if self.queue.is_timer_full() {
            self.queue.read(self.counted, &[], |_, _| ())?;
        }
        let waves = counters[counter::WAVES as usize];
        self.queue.waves = self.queue.waves.max(waves);
        Ok(counters[counter::NEXT as usize] > 0)
    }
}

impl Executor for Launch<'_> {
    fn step(&mut self, index: usize, step: &Step) -> Result<()> {
        if step.stage == Stage::Advance {
            self.is_second = !self.is_second;
        }
        let kernel = &self.kernels[index];
        let group = match &self.memory.groups[index] {
            Some(groups) => &groups[usize::from(self.is_second)],
            None => self.film.expect("photons bind no film"),
        };
        let pass = self.pass.get_or_insert_with(|| self.queue.pass(&mut self.encoder));
        let rows = if step.stage == Stage::Shadow { self.frame.shadow_rays } else { 1 };
        match step.stage {
            Stage::Advance => kernel.run(pass, group, 1, 1),
            Stage::Gather | Stage::Accumulate => kernel.run(pass, group, self.frame.pixel_slots, 1),
            _ if step.spec.launch.has(LaunchBits::SECONDARY) => {
                let arguments = self.memory.buffers.of(binding::ARGUMENTS);
                let offset = if step.stage == Stage::Shadow { argument::SHADOWS } else { argument::SLOTS };
                kernel.run_indirect(pass, group, arguments, offset);
            }
            _ => kernel.run(pass, group, self.frame.slots, rows),
        }
        Ok(())
    }

    fn goes_on(&mut self) -> Result<bool> {
        if self.unseen == 0 {
            let is_known = matches!(self.plan.waves, Waves::AtMost(count) if count <= UNSEEN);
            if is_known || !self.look()? {
                return Ok(false);
            }
            self.next = (2 * self.next).min(MOST_WAVES);
            self.unseen = self.next;
        }
        self.unseen -= 1;
        self.recorded += 1;
        // The first waves have the most rays: the device is at work on them while the others are recorded.
        if self.recorded == FEW && self.unseen > FEW {
            self.flush();
        }
        Ok(true)
    }
}
