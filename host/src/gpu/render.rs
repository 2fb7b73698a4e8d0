//! Pictures on the GPU: launches over bands of the image and batches of samples, whose sums the film keeps.

use std::borrow::Cow;
use std::time::Duration;

use eyerays_shader::camera;
use eyerays_shader::data::Order;
use eyerays_shader::launch::argument;
use eyerays_shader::resources::binding;
use glam::UVec4;
use wgpu::BufferUsages as Use;

use super::bands::bands;
use super::device::Gpu;
use super::kernel::{Kernel, compile};
use super::launch::{Launch, Queue};
use super::memory::{LaunchBuffers, buffer, most_slots};
use super::recipe::Recipe;
use super::scene::SceneBuffers;
use crate::device_scene::DeviceScene;
use crate::error::Result;
use crate::method::Traversal;
use crate::picture::Picture;
use crate::plan::{self, Plan};
use crate::rays::Rays;
use crate::scene::Light;
use crate::view::{Region, View};
use crate::watch::{Grows, Watch, grow};

/// Bytes of films that are read back at once.
const READ: u64 = 1 << 28;

/// A picture and what it took.
pub struct GpuRendering {
    /// The picture.
    pub picture: Picture,
    /// Samples of each pixel.
    pub samples: u32,
    /// What was traced.
    pub rays: Rays,
    /// Time on the device, if it has a clock.
    pub device_time: Option<Duration>,
}

/// A scene on a GPU, ready for any number of pictures: cameras, sizes and samples may change from one to the next, and
/// neither geometry nor kernels move for that.
pub struct Renderer<'a> {
    gpu: &'a Gpu,
    packed: &'a DeviceScene,
    order: Order,
    plan: Plan,
    /// By the plan's steps.
    kernels: Vec<Kernel>,
    scene: SceneBuffers,
    most_slots: u32,
    memory: Option<Memory>,
    picture: Option<Growing>,
    queue: Queue<'a>,
}

/// What launches exchange, bound to the kernels: for a wave, and for the next, whose queues are exchanged.
pub(super) struct Memory {
    pub buffers: LaunchBuffers,
    /// By the plan's steps; none for those that bind the film.
    pub groups: Vec<Option<[wgpu::BindGroup; 2]>>,
}

/// A picture that samples are added to.
struct Growing {
    view: View,
    bands: Vec<Band>,
    samples: u32,
}

/// A region of the image with its film.
pub(super) struct Band {
    pub region: Region,
    film: wgpu::Buffer,
    /// For the steps that bind the film.
    pub group: wgpu::BindGroup,
}

impl Grows for Renderer<'_> {
    fn add(&mut self, count: u32) -> Result<()> {
        Renderer::add(self, count, &|_| ())?;
        self.gpu.wait()
    }

    fn picture(&mut self) -> Result<Picture> {
        Ok(self.film()?.picture)
    }
}

impl<'a> Renderer<'a> {
    /// Compiles the kernels and uploads the scene.
    ///
    /// # Errors
    /// What does not fit the GPU, or what its driver reports.
    pub fn new(gpu: &'a Gpu, packed: &'a DeviceScene, exact: bool, traversal: impl Into<Traversal>) -> Result<Self> {
        let traversal = traversal.into();
        let plan = Plan::new(packed, &traversal, |coherence| gpu.resolved(traversal, coherence))?;
        let most_slots = most_slots(gpu, &plan, traversal.order.bits())?;
        let recipes: Vec<Recipe> = plan.steps().map(|&step| Recipe::new(step, gpu.target(exact))).collect();
        let kernels = compile(gpu, &recipes);
        gpu.check()?;
        let scene = SceneBuffers::new(gpu, packed, traversal.layout, (&plan).into())?;
        let (order, queue) = (traversal.order.bits(), Queue::new(gpu));
        Ok(Renderer { gpu, packed, order, plan, kernels, scene, most_slots, memory: None, picture: None, queue })
    }

    /// Goes on with other lights: as many as the scene's, of the same kinds.
    ///
    /// # Errors
    /// As [`DeviceScene::relit`].
    pub fn set_lights(&mut self, lights: &[Light]) -> Result<()> {
        let (records, lighting) = self.packed.relit(lights)?;
        let write = |binding, bytes| {
            if let Some(buffer) = self.scene.find(binding) {
                self.gpu.queue.write_buffer(buffer, 0, bytes);
            }
        };
        write(binding::LIGHTS, bytemuck::cast_slice(&records));
        write(binding::EMITTERS, bytemuck::cast_slice(&lighting.emitters));
        write(binding::LIGHT_NODES, bytemuck::cast_slice(&lighting.nodes));
        write(binding::EMISSIONS, bytemuck::cast_slice(&lighting.emissions));
        Ok(())
    }

    /// Renders a picture. `done` hears of every finished share of the pixels.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn render(&mut self, view: &View, done: &(dyn Fn(u64) + Sync)) -> Result<GpuRendering> {
        self.start(view)?;
        self.add(view.samples(), done)?;
        let rendering = self.film()?;
        done(self.queue.forget());
        Ok(rendering)
    }

    /// Renders the samples of a view while somebody looks on, who may end it before.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn render_watched(&mut self, view: &View, watch: &Watch<'_>) -> Result<GpuRendering> {
        self.start(view)?;
        grow(self, view.samples(), watch)?;
        Renderer::film(self)
    }

    /// Starts a picture without any sample. Memory is taken if no picture before needed as much.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn start(&mut self, view: &View) -> Result<()> {
        let (width, height) = view.size();
        let wanted = u64::from(camera::slots(width, height, self.order)) * u64::from(view.samples());
        self.reserve(wanted.min(self.most_slots.into()) as u32)?;
        let regions = bands((width, height), self.slots(), self.order);
        let bands = match self.picture.take() {
            Some(picture) if picture.bands.iter().map(|band| band.region).eq(regions.iter().copied()) => picture.bands,
            _ => regions.into_iter().map(|region| self.band(region)).collect::<Result<_>>()?,
        };
        self.picture = Some(Growing { view: *view, bands, samples: 0 });
        self.queue.forget();
        let memory = self.memory.as_ref().expect("it was reserved");
        self.queue.restart(memory.buffers.of(binding::COUNTERS));
        Ok(())
    }

    /// Adds the next `count` samples of each pixel, or as many as the view has: n and then n more give the bits of 2n at
    /// once. Does not wait for the GPU, unless it has enough to do, or reflected and refracted rays branch, where the end of
    /// each launch is waited for. `done` hears of shares of the pixels that are known to be finished; after
    /// [`Renderer::film`] all are.
    ///
    /// # Errors
    /// What the GPU reports; the picture must then be started again.
    ///
    /// # Panics
    /// If no picture was started.
    pub fn add(&mut self, count: u32, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let mut picture = self.picture.take().expect("a picture was started");
        self.add_to(&picture, count, done)?;
        picture.samples = picture.samples.saturating_add(count).min(picture.view.samples());
        self.picture = Some(picture);
        Ok(())
    }

    fn add_to(&mut self, picture: &Growing, count: u32, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let Growing { view, bands, samples } = picture;
        let end = samples.saturating_add(count).min(view.samples());
        for band in bands {
            let (width, height) = (band.region.width, band.region.height);
            let batch = (self.slots() / camera::slots(width, height, self.order)).max(1);
            let mut first = *samples;
            while first < end {
                let count = batch.min(end - first);
                let frame = view.launch(self.packed, band.region, first, count, self.order);
                let share = |samples| band.region.pixels() * u64::from(samples) / u64::from(view.samples());
                let memory = self.memory.as_ref().expect("it was reserved");
                let mut launch = Launch::new(&self.plan, &self.kernels, memory, band, &frame, &mut self.queue)?;
                plan::run(&self.plan, &mut launch)?;
                launch.submit(share(first + count) - share(first))?;
                done(self.queue.finished()?);
                first += count;
            }
        }
        Ok(())
    }

    /// Waits for the picture: the mean of its samples so far, black without any, and the rays that they took.
    ///
    /// # Errors
    /// What the GPU reports, or if there is no memory for the film.
    ///
    /// # Panics
    /// If no picture was started.
    pub fn film(&mut self) -> Result<GpuRendering> {
        let Growing { view, bands, samples } = self.picture.as_ref().expect("a picture was started");
        let (width, height) = view.size();
        let (mut film, mut rays) = (Picture::new(width, height)?, Rays::default());
        let mut device_time = self.queue.has_clock().then_some(Duration::ZERO);
        if *samples == 0 {
            return Ok(GpuRendering { picture: film, samples: 0, rays, device_time });
        }
        let counters = self.buffers().of(binding::COUNTERS).clone();
        let mut rest = &bands[..];
        while !rest.is_empty() {
            let mut bytes = 0;
            let fits = |band: &&Band| {
                bytes += self.plan.film_bytes * band.region.pixels();
                bytes <= READ
            };
            let (now, later) = rest.split_at(rest.iter().take_while(fits).count().max(1));
            let films: Vec<_> =
                now.iter().map(|band| (&band.film, self.plan.film_bytes * band.region.pixels())).collect();
            let read = self.queue.read(&counters, &films, |i, bytes| {
                let records = bytemuck::try_cast_slice::<u8, UVec4>(bytes);
                let records = records.map_or_else(|_| bytemuck::pod_collect_to_vec(bytes).into(), Cow::Borrowed);
                film.develop_on_all_threads::<f32>(now[i].region, &records, *samples, &mut rays);
            })?;
            (rays.secondary, device_time) = (read.rays, read.device_time);
            rest = later;
        }
        rays.primary = view.region().pixels() * u64::from(*samples);
        Ok(GpuRendering { picture: film, samples: *samples, rays, device_time })
    }

    fn buffers(&self) -> &LaunchBuffers {
        &self.memory.as_ref().expect("it was reserved").buffers
    }

    fn slots(&self) -> u32 {
        self.buffers().slots
    }

    /// Takes memory for launches of so many slots, or of fewer where there is too little.
    fn reserve(&mut self, mut slots: u32) -> Result<()> {
        if self.memory.as_ref().is_some_and(|memory| memory.buffers.slots >= slots) {
            return Ok(());
        }
        // What launches under way use is given back only when they are done.
        self.gpu.wait()?;
        (self.memory, self.picture) = (None, None);
        let (columns, rows) = camera::blocks(self.order);
        let mut refusal = None;
        let buffers = loop {
            match LaunchBuffers::new(self.gpu, &self.plan.slot_bytes, slots) {
                Ok(buffers) => break buffers,
                Err(error) if slots > LEAST_SLOTS => {
                    refusal.get_or_insert(error);
                    slots = (slots / 2).next_multiple_of(columns * rows);
                    self.most_slots = slots;
                }
                Err(error) => return Err(refusal.unwrap_or(error)),
            }
        };
        // The kernels write how many groups there are in a row, and no more.
        let mut arguments = [0; argument::LENGTH as usize];
        for (of, rows) in [(argument::SLOTS, 1), (argument::SHADOWS, self.plan.shadow_rays)] {
            (arguments[of as usize + 1], arguments[of as usize + 2]) = (rows, 1);
        }
        self.gpu.queue.write_buffer(buffers.of(binding::ARGUMENTS), 0, bytemuck::cast_slice::<u32, u8>(&arguments));
        let group = |kernel: &Kernel, is_second| {
            kernel.group(self.gpu, |binding| {
                let binding = kernel.source(binding, &self.plan);
                self.scene.find(binding).or_else(|| buffers.find(binding, is_second))
            })
        };
        let both = |kernel: &Kernel| [group(kernel, false), group(kernel, true)];
        let groups = self.kernels.iter().map(|kernel| (!kernel.binds(binding::FILM)).then(|| both(kernel))).collect();
        self.gpu.check()?;
        self.memory = Some(Memory { buffers, groups });
        Ok(())
    }

    fn band(&self, region: Region) -> Result<Band> {
        let size = self.plan.film_bytes * region.pixels();
        let film = buffer(self.gpu, binding::FILM, size, Use::STORAGE | Use::COPY_SRC);
        let kernel = self.kernels.iter().find(|kernel| kernel.binds(binding::FILM)).expect("a step keeps the film");
        let group = kernel.group(self.gpu, |binding| match binding {
            binding::FILM => Some(&film),
            other => self.buffers().find(other, false),
        });
        self.gpu.check()?;
        Ok(Band { region, film, group })
    }
}

/// Launches of fewer slots are not worth a try.
const LEAST_SLOTS: u32 = 1 << 16;
