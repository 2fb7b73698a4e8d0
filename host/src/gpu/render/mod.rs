//! Films on the GPU: launches over bands of the image and batches of samples, whose sums stay there until they are read.

mod cells;
mod growing;
mod grows;
mod memory;
mod moved;
mod photons;
mod read;
mod show;

use std::panic::resume_unwind;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use eyerays_shader::data::Order;
use eyerays_shader::resources::binding;

use self::cells::Cells;
use self::growing::{Band, Growing};
pub(super) use self::memory::Memory;
use self::photons::Photons;
use super::device::Gpu;
use super::kernel::{Kernel, Known};
use super::launch::Queue;
use super::linear::Linear;
use super::memory::most_slots;
use super::recipe::Recipe;
use super::refit::Moving;
use super::scene::SceneBuffers;
use super::screen::Screen;
use crate::error::Result;
use crate::film::Film;
use crate::job::Job;
use crate::method::Traversal;
use crate::plan::Plan;
use crate::scene::Light;
use crate::view::View;
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
    /// Where photons tell of caustics.
    photons: Option<Photons>,
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

impl Renderer {
    /// Compiles the kernels and uploads the scene.
    ///
    /// # Errors
    /// What does not fit the GPU, or what its driver reports.
    pub fn new(gpu: &Gpu, job: &Job, exact: bool, traversal: impl Into<Traversal>) -> Result<Self> {
        let traversal = traversal.into();
        let (mut known, mut scene) = (Known::default(), SceneBuffers::default());
        let Ready { plan, most_slots, kernels, photons } = ready(gpu, job, exact, traversal, &mut known, &mut scene)?;
        Ok(Renderer {
            gpu: gpu.clone(),
            job: job.clone(),
            exact,
            traversal,
            order: traversal.order.bits(),
            plan,
            kernels,
            photons,
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
        self.photons = ready.photons;
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
}

/// What pictures of a job take.
struct Ready {
    plan: Plan,
    most_slots: u32,
    kernels: Vec<Kernel>,
    photons: Option<Photons>,
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
    let of_photons = Plan::of_photons(job, &traversal, |coherence| gpu.resolved(traversal, coherence))?;
    let steps = plan.steps().chain(of_photons.iter().flat_map(Plan::steps));
    let recipes: Vec<Recipe> = steps.map(|&step| Recipe::new(step, gpu.target(exact))).collect();
    let (mut kernels, uploaded) = thread::scope(|scope| {
        let kernels = scope.spawn(|| known.compile(gpu, recipes));
        let uploaded = scene.complete(gpu, job, traversal.layout, (&plan).into());
        (kernels.join().unwrap_or_else(|panic| resume_unwind(panic)), uploaded)
    });
    gpu.check()?;
    uploaded?;
    let own = kernels.split_off(plan.steps().count());
    let photons = of_photons.map(|plan| Photons { plan, kernels: own });
    Ok(Ready { plan, most_slots, kernels, photons })
}
