//! Streams of rays on the GPU: one dispatch each, timed by itself.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use eyerays_shader::data::{Launch, Media, Specialisation};
use eyerays_shader::launch::{ROW, WORKGROUP};
use eyerays_shader::resources::binding;
use eyerays_shader::scene::LaunchContext;
use eyerays_shader::stage::Found;
use glam::UVec4;

use super::device::Gpu;
use super::kernel::{Kernel, Known};
use super::memory::LaunchBuffers;
use super::pipe::Lane;
use super::readback;
use super::recipe::Recipe;
use super::scene::{Hierarchies, SceneBuffers};
use super::timer::Timer;
use super::warm::warm;
use crate::error::{Content, Error, Result};
use crate::job::Job;
use crate::method::{Coherence, Layout, Traversal};
use crate::plan::{Stage, Step};
use crate::stream::{Answers, Question, Stream};

/// Dispatches of a submission.
const BATCH: u32 = 8;
/// Dispatches without a pause between them raise a GPU's clocks in so long.
const LEAST_WARMING: Duration = Duration::from_millis(100);

/// A scene on a GPU, ready for streams of rays. Kernels are compiled once for all streams.
pub struct Caster {
    pub(super) gpu: Gpu,
    pub(super) packed: Job,
    layout: Layout,
    scene: SceneBuffers,
    /// By whether they are exact.
    kernels: Mutex<HashMap<(bool, Step), Arc<Kernel>>>,
    timer: Option<Timer>,
    /// What [`super::pipe`] keeps for the next rays.
    pub(super) idle: Mutex<Vec<Lane>>,
}

/// A stream on the GPU, and room for its answers.
pub struct Cast {
    pub(super) buffers: LaunchBuffers,
    pub(super) count: u32,
}

impl Cast {
    /// Records a dispatch.
    pub(super) fn dispatch(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (kernel, group): (&Kernel, &wgpu::BindGroup),
        timestamp_writes: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        encoder.clear_buffer(self.buffers.of(binding::COUNTERS), 0, None);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
        kernel.run(&mut pass, group, self.count.min(ROW), self.count.div_ceil(ROW));
    }
}

impl Caster {
    /// Uploads a scene with all hierarchies that it has and its triangles in a layout.
    ///
    /// # Errors
    /// What does not fit the GPU, or what its driver reports.
    pub fn new(gpu: &Gpu, packed: &Job, layout: Layout) -> Result<Self> {
        let scene =
            SceneBuffers::new(gpu, packed, layout, Hierarchies { binary: true, wide: !packed.wide().is_empty() })?;
        let timer = Timer::new(gpu, BATCH);
        Ok(Caster {
            gpu: gpu.clone(),
            packed: packed.clone(),
            layout,
            scene,
            kernels: Mutex::default(),
            timer,
            idle: Mutex::default(),
        })
    }

    /// Records of a hit.
    pub(super) fn rows(&self) -> u64 {
        u64::from(Found::<f32>::records(self.packed.effects()))
    }

    /// Uploads a stream.
    ///
    /// # Errors
    /// If it has more rays than a buffer holds, or what the GPU reports.
    pub fn upload(&self, stream: &Stream) -> Result<Cast> {
        let cast = self.room(stream.len())?;
        let frame = self.packed.stream_frame(stream.len());
        self.gpu.queue.write_buffer(cast.buffers.of(binding::FRAME), 0, bytemuck::bytes_of(&frame));
        self.gpu.queue.write_buffer(cast.buffers.of(binding::PATHS), 0, bytemuck::cast_slice(stream.words()));
        self.gpu.queue.submit([]);
        self.gpu.wait()?;
        Ok(cast)
    }

    /// Room for so many rays.
    ///
    /// # Errors
    /// If that is more than a buffer holds, or what the GPU reports.
    pub(super) fn room(&self, count: usize) -> Result<Cast> {
        let (size, limit) = (32 * count as u64, self.gpu.report.max_binding.min(self.gpu.report.max_buffer));
        if size > limit {
            return Err(Error::TooLarge {
                device: self.gpu.report.name.clone(),
                what: Content::Rays(count as u64),
                bytes: size,
                limit,
            });
        }
        // Of a ray and of either answer.
        let bytes = [(binding::PATHS, 32), (binding::HITS, 16 * self.rows()), (binding::SHADOWS, 4)];
        Ok(Cast { buffers: LaunchBuffers::new(&self.gpu, &bytes, count as u32)?, count: count as u32 })
    }

    /// Traces a stream once, and returns what the dispatch took on the device (zero without a clock).
    ///
    /// # Errors
    /// If the GPU can't run the method, or what it reports.
    pub fn trace(&self, cast: &Cast, exact: bool, traversal: Traversal, question: Question) -> Result<Duration> {
        let kernel = self.kernel(exact, traversal, question)?;
        Ok(self.batch(cast, &kernel, 1)?[0])
    }

    /// What each of `repeats` dispatches takes on the device, one right after the other, once the GPU is warm.
    ///
    /// # Errors
    /// As [`Caster::trace`].
    pub fn measure(
        &self,
        cast: &Cast,
        exact: bool,
        traversal: Traversal,
        question: Question,
        repeats: u32,
    ) -> Result<Vec<Duration>> {
        let kernel = self.kernel(exact, traversal, question)?;
        warm(LEAST_WARMING, || Ok(self.batch(cast, &kernel, BATCH)?.into_iter().min().unwrap_or_default()))?;
        let mut times = Vec::new();
        while times.len() < repeats as usize {
            let batch = (repeats - times.len() as u32).min(BATCH);
            times.extend(self.batch(cast, &kernel, batch)?);
        }
        Ok(times)
    }

    /// Dispatches one after the other in a submission, and what each took.
    fn batch(&self, cast: &Cast, kernel: &Kernel, count: u32) -> Result<Vec<Duration>> {
        let group = self.group(cast, kernel);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        for pass in 0..count {
            let timestamp_writes = self.timer.as_ref().map(|timer| timer.writes(pass));
            cast.dispatch(&mut encoder, (kernel, &group), timestamp_writes);
        }
        if let Some(timer) = &self.timer {
            timer.resolve(&mut encoder, count);
        }
        self.gpu.queue.submit([encoder.finish()]);
        match &self.timer {
            Some(timer) => timer.read(&self.gpu, count),
            None => self.gpu.wait().map(|()| vec![Duration::ZERO; count as usize]),
        }
    }

    /// What a kernel takes of the scene and of a stream.
    pub(super) fn group(&self, cast: &Cast, kernel: &Kernel) -> wgpu::BindGroup {
        kernel.group(&self.gpu, |own| self.scene.find(own).or_else(|| cast.buffers.find(own, false)))
    }

    /// The next crossing of each ray of a stream, past the one that is told of it.
    ///
    /// # Errors
    /// As [`Caster::upload`] and [`Caster::trace`].
    pub(crate) fn cross(&self, stream: &Stream, found: &mut [Found<f32>]) -> Result<()> {
        let cast = self.upload(stream)?;
        let frame = self.packed.stream_frame(stream.len());
        let context = LaunchContext::new(&frame, self.specialisation(Traversal::default()), &[], &[]);
        let mut records = vec![UVec4::ZERO; self.rows() as usize * found.len()];
        found.iter().zip(0..).for_each(|(found, slot)| found.store(&context, slot, &mut records));
        self.gpu.queue.write_buffer(cast.buffers.of(binding::HITS), 0, bytemuck::cast_slice(&records));
        self.found(Stage::Cross, &cast, &context, found)
    }

    /// What is nearest to where the rays of a stream start.
    ///
    /// # Errors
    /// As [`Caster::upload`] and [`Caster::trace`].
    pub(crate) fn nearest(&self, stream: &Stream) -> Result<Vec<Found<f32>>> {
        let mut found = vec![Found::nothing(); stream.len()];
        let frame = self.packed.stream_frame(stream.len());
        let context = LaunchContext::new(&frame, self.specialisation(Traversal::default()), &[], &[]);
        self.found(Stage::Nearest, &self.upload(stream)?, &context, &mut found)?;
        Ok(found)
    }

    /// What a stage finds that follows no method.
    fn found(&self, stage: Stage, cast: &Cast, context: &LaunchContext<'_>, found: &mut [Found<f32>]) -> Result<()> {
        let kernel = self.compiled(true, Step { stage, traversal: None, spec: context.spec })?;
        self.batch(cast, &kernel, 1)?;
        if let Answers::Closest(records) = self.answers(cast, Question::Closest)? {
            found.iter_mut().zip(0..).for_each(|(found, slot)| *found = Found::load(context, slot, &records));
        }
        Ok(())
    }

    /// The answers of the last [`Caster::trace`] with this question.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn answers(&self, cast: &Cast, question: Question) -> Result<Answers> {
        let count = u64::from(cast.count);
        Ok(match question {
            Question::Closest => {
                let bytes = readback::read(&self.gpu, cast.buffers.of(binding::HITS), 16 * count * self.rows())?;
                let words: Vec<u32> = readback::words(&bytes).collect();
                Answers::Closest(words.chunks_exact(4).map(UVec4::from_slice).collect())
            }
            Question::Occlusion => {
                let bytes = readback::read(&self.gpu, cast.buffers.of(binding::SHADOWS), 4 * count)?;
                Answers::Occlusion(readback::words(&bytes).collect())
            }
        })
    }

    /// The kernel for rays as they come: `auto` is resolved by the caller, who knows what they are.
    pub(super) fn kernel(&self, exact: bool, traversal: Traversal, question: Question) -> Result<Arc<Kernel>> {
        let stage = match question {
            Question::Closest => Stage::Trace,
            Question::Occlusion => Stage::Shadow,
        };
        let traversal = self.gpu.resolved(Traversal { layout: self.layout, ..traversal }, Coherence::Scattered)?;
        self.packed.check_walks(traversal.method)?;
        self.compiled(exact, Step { stage, traversal: Some(traversal), spec: self.specialisation(traversal) })
    }

    /// What kernels are compiled for that follow rays in memory.
    fn specialisation(&self, traversal: Traversal) -> Specialisation {
        let own = self.packed.specialisation(&Traversal { layout: self.layout, ..traversal });
        Specialisation { media: Media::default(), ..own }.with_launch(Launch::STREAM)
    }

    /// The kernel of a step, compiled once.
    fn compiled(&self, exact: bool, step: Step) -> Result<Arc<Kernel>> {
        let mut kernels = self.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kernel) = kernels.get(&(exact, step)) {
            return Ok(kernel.clone());
        }
        let recipe = Recipe::new(step, self.gpu.target(exact));
        let kernel = Known::default().compile(&self.gpu, vec![recipe]).pop().map(Arc::new);
        self.gpu.check()?;
        let kernel = kernel.expect("a kernel for a recipe");
        kernels.insert((exact, step), kernel.clone());
        Ok(kernel)
    }
}

const _: () = assert!(ROW.is_multiple_of(WORKGROUP) && ROW / WORKGROUP <= 65_535);
