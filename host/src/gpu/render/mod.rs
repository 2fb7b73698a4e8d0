//! Films on the GPU: launches over bands of the image and batches of samples, whose sums stay there until they are read.

mod cells;
mod moved;
mod read;
mod show;

use std::ops::Range;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use eyerays_shader::camera;
use eyerays_shader::data::{Frame, Order};
use eyerays_shader::launch::argument;
use eyerays_shader::resources::binding;
use wgpu::BufferUsages as Use;

use self::cells::Cells;
use super::bands::bands;
use super::device::Gpu;
use super::kernel::{Kernel, Known};
use super::launch::{Launch, Queue};
use super::linear::Linear;
use super::memory::{LaunchBuffers, buffer, most_slots};
use super::recipe::Recipe;
use super::refit::Moving;
use super::scene::SceneBuffers;
use super::screen::Screen;
use crate::error::Result;
use crate::film::{Coverage, Film, Leasts, Part};
use crate::job::Job;
use crate::method::Traversal;
use crate::noise::{CellSums, Lot};
use crate::picture::Picture;
use crate::plan::{self, Plan};
use crate::rays::Rays;
use crate::scene::Light;
use crate::view::{Region, View};
use crate::watch::Grows;

/// A film and what it took.
pub struct GpuRendering {
    /// The film.
    pub film: Film,
    /// Time on the device, if it has a clock.
    pub device_time: Option<Duration>,
}

/// A scene on a GPU, ready for any number of films: cameras, sizes and samples may change from one to the next, and
/// neither geometry nor kernels move for that.
pub struct Renderer {
    gpu: Gpu,
    job: Job,
    exact: bool,
    traversal: Traversal,
    order: Order,
    plan: Plan,
    /// By the plan's steps.
    kernels: Vec<Kernel>,
    /// All that were compiled.
    known: Known,
    scene: SceneBuffers,
    /// Other lights than the scene's.
    relit: Option<Vec<Light>>,
    /// Once vertices have moved.
    moving: Option<Moving>,
    /// Once the device has built a hierarchy.
    linear: Option<Linear>,
    most_slots: u32,
    memory: Option<Memory>,
    growing: Option<Growing>,
    cells: Option<Cells>,
    /// Once a film was shown.
    screen: Option<Screen>,
    queue: Queue,
}

/// What launches exchange, bound to the kernels: for a wave, and for the next, whose queues are exchanged.
pub(super) struct Memory {
    pub buffers: LaunchBuffers,
    /// By the plan's steps; none for those that bind the film.
    pub groups: Vec<Groups>,
}

/// For a wave and the next, unless they are of a step that binds the film.
type Groups = Option<[wgpu::BindGroup; 2]>;

/// A film that samples are added to.
struct Growing {
    view: View,
    bands: Vec<Band>,
    coverage: Coverage,
}

/// A region of the image with its film.
struct Band {
    region: Region,
    /// Has it no sample?
    is_empty: bool,
    film: wgpu::Buffer,
    /// For the steps that bind the film.
    group: wgpu::BindGroup,
}

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

impl Renderer {
    /// Compiles the kernels and uploads the scene.
    ///
    /// # Errors
    /// What does not fit the GPU, or what its driver reports.
    pub fn new(gpu: &Gpu, job: &Job, exact: bool, traversal: impl Into<Traversal>) -> Result<Self> {
        let traversal = traversal.into();
        let (mut known, mut scene) = (Known::default(), SceneBuffers::default());
        let Ready { plan, most_slots, kernels } = ready(gpu, job, exact, traversal, &mut known, &mut scene)?;
        Ok(Renderer {
            gpu: gpu.clone(),
            job: job.clone(),
            exact,
            traversal,
            order: traversal.order.bits(),
            plan,
            kernels,
            known,
            scene,
            relit: None,
            moving: None,
            linear: None,
            most_slots,
            memory: None,
            growing: None,
            cells: None,
            screen: None,
            queue: Queue::new(gpu),
        })
    }

    /// Goes on with another job. What the device holds of its scene stays there, and so do kernels that were compiled. The film is then
    /// to be started again.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn turn(&mut self, job: &Job) -> Result<()> {
        // Its groups bind the buffers of the plan before.
        (self.memory, self.growing, self.cells) = (None, None, None);
        if !Arc::ptr_eq(self.job.scene(), job.scene()) {
            (self.scene, self.relit) = (SceneBuffers::default(), None);
            (self.moving, self.linear) = (None, None);
        }
        let (known, scene) = (&mut self.known, &mut self.scene);
        let ready = ready(&self.gpu, job, self.exact, self.traversal, known, scene)?;
        (self.plan, self.most_slots, self.kernels) = (ready.plan, ready.most_slots, ready.kernels);
        self.job = job.clone();
        match self.relit.take() {
            Some(lights) => self.set_lights(&lights),
            None => Ok(()),
        }
    }

    /// Goes on with other lights: as many as the scene's, of the same kinds.
    ///
    /// # Errors
    /// As [`DeviceScene::relit`](crate::device_scene::DeviceScene::relit).
    pub fn set_lights(&mut self, lights: &[Light]) -> Result<()> {
        let (records, lighting) = self.job.relit(lights)?;
        let write = |binding, bytes| {
            if let Some(buffer) = self.scene.find(binding) {
                self.gpu.queue.write_buffer(buffer, 0, bytes);
            }
        };
        write(binding::LIGHTS, bytemuck::cast_slice(&records));
        write(binding::EMITTERS, bytemuck::cast_slice(&lighting.emitters));
        write(binding::LIGHT_NODES, bytemuck::cast_slice(&lighting.nodes));
        write(binding::EMISSIONS, bytemuck::cast_slice(&lighting.emissions));
        self.relit = Some(lights.to_vec());
        Ok(())
    }

    /// Renders a view. `done` hears of every finished share of the pixels.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn render(&mut self, view: &View, done: &(dyn Fn(u64) + Sync)) -> Result<GpuRendering> {
        let before = self.device_time();
        let film = self.expose(view, done)?;
        done(self.queue.forget());
        let device_time = self.device_time().zip(before).map(|(after, before)| after - before);
        Ok(GpuRendering { film, device_time })
    }

    /// Time on the device of all that was rendered and read, if it has a clock.
    pub fn device_time(&self) -> Option<Duration> {
        self.queue.device_time()
    }

    /// Starts a film of a view without any sample. Memory is taken if no film before needed as much.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn start(&mut self, view: &View) -> Result<()> {
        self.start_in(view, &[view.region()])
    }

    /// The same, for parts that lie within one of these regions each.
    fn start_in(&mut self, view: &View, regions: &[Region]) -> Result<()> {
        let slots = |region: &Region| u64::from(camera::slots(region.width, region.height, self.order));
        let wanted = regions.iter().map(slots).max().unwrap_or(0) * u64::from(view.samples());
        self.reserve(wanted.min(self.most_slots.into()) as u32)?;
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

    fn add_part(&mut self, part: Part, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
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
        let batch = (self.slots() / camera::slots(width, height, self.order)).max(1);
        let mut first = samples.start;
        while first < samples.end {
            let count = batch.min(samples.end - first);
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

    fn buffers(&self) -> &LaunchBuffers {
        &self.memory.as_ref().expect("it was reserved").buffers
    }

    fn slots(&self) -> u32 {
        self.buffers().slots
    }

    /// Has it memory for launches of so many slots?
    fn has_slots(&self, slots: u32) -> bool {
        self.memory.as_ref().is_some_and(|memory| memory.buffers.slots >= slots)
    }

    /// Takes memory for launches of so many slots, or of fewer where there is too little.
    fn reserve(&mut self, mut slots: u32) -> Result<()> {
        if self.has_slots(slots) {
            return Ok(());
        }
        // What launches under way use is given back only when they are done.
        self.gpu.wait()?;
        (self.memory, self.growing) = (None, None);
        self.cells.iter_mut().for_each(Cells::forget);
        let (columns, rows) = camera::blocks(self.order);
        let mut refusal = None;
        let buffers = loop {
            match LaunchBuffers::new(&self.gpu, &self.plan.slot_bytes, slots) {
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
        let groups = self.groups(&self.kernels, &buffers, None);
        self.gpu.check()?;
        self.memory = Some(Memory { buffers, groups });
        Ok(())
    }

    /// What kernels bind that do not bind the film; those over cells bind their table, too.
    fn groups(&self, kernels: &[Kernel], buffers: &LaunchBuffers, table: Option<&wgpu::Buffer>) -> Vec<Groups> {
        let group = |kernel: &Kernel, is_second| {
            kernel.group(&self.gpu, |binding| match kernel.source(binding, &self.plan) {
                binding::CELLS => table,
                binding => self.scene.find(binding).or_else(|| buffers.find(binding, is_second)),
            })
        };
        let both = |kernel: &Kernel| [group(kernel, false), group(kernel, true)];
        kernels.iter().map(|kernel| (!kernel.binds(binding::FILM)).then(|| both(kernel))).collect()
    }

    /// What the kernel that keeps the film binds.
    fn film_group(&self, kernels: &[Kernel], film: &wgpu::Buffer) -> wgpu::BindGroup {
        let kernel = kernels.iter().find(|kernel| kernel.binds(binding::FILM)).expect("a step keeps the film");
        kernel.group(&self.gpu, |binding| match binding {
            binding::FILM => Some(film),
            other => self.buffers().find(other, false),
        })
    }

    fn band(&self, region: Region) -> Result<Band> {
        let size = self.plan.film_bytes() * region.pixels();
        let film = buffer(&self.gpu, binding::FILM, size, Use::STORAGE | Use::COPY_SRC);
        let group = self.film_group(&self.kernels, &film);
        self.gpu.check()?;
        Ok(Band { region, is_empty: true, film, group })
    }
}

/// What pictures of a job take.
struct Ready {
    plan: Plan,
    most_slots: u32,
    kernels: Vec<Kernel>,
}

/// Compiles the kernels of a job that are not known yet, and uploads what is not there of its scene meanwhile.
fn ready(
    gpu: &Gpu,
    job: &Job,
    exact: bool,
    traversal: Traversal,
    known: &mut Known,
    scene: &mut SceneBuffers,
) -> Result<Ready> {
    let plan = Plan::new(job, &traversal, |coherence| gpu.resolved(traversal, coherence))?;
    let most_slots = most_slots(gpu, &plan, traversal.order.bits())?;
    let recipes: Vec<Recipe> = plan.steps().map(|&step| Recipe::new(step, gpu.target(exact))).collect();
    let (kernels, uploaded) = thread::scope(|scope| {
        let kernels = scope.spawn(|| known.compile(gpu, recipes));
        let uploaded = scene.complete(gpu, job, traversal.layout, (&plan).into());
        (kernels.join().unwrap_or_else(|panic| resume_unwind(panic)), uploaded)
    });
    gpu.check()?;
    uploaded?;
    Ok(Ready { plan, most_slots, kernels })
}

/// Launches of fewer slots are not worth a try.
const LEAST_SLOTS: u32 = 1 << 16;
