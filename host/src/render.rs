//! From a packed scene to a picture, on the device that was asked for or fits best.

use std::time::{Duration, Instant};

use eyerays_bvh::Quality;

use crate::choice::choices;
use crate::cpu;
use crate::device_scene::DeviceScene;
use crate::error::{Error, Result};
use crate::film::Film;
use crate::gpu::{AdapterRequest, Around, Gpu, Renderer, warm};
use crate::method::{Method, Processor, Traversal};
use crate::picture::Picture;
use crate::rays::Rays;
use crate::scene::{Scene, Settings};
use crate::view::View;
use crate::watch::{self, Grows, Watch};
pub use crate::why::Why;

choices! {
    /// How numbers are computed.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum Precision {
        /// The same picture bit for bit on every device.
        #[default]
        Exact = "exact",
        /// A GPU's own division, root and power; a CPU's are exact.
        Fast = "fast",
        /// Double precision on the CPU, to measure errors against.
        Reference = "reference",
    }
}

choices! {
    /// Where to render.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum DeviceWish {
        /// A GPU when one works, else the CPU.
        #[default]
        Auto = "auto",
        /// A GPU, a software one such as lavapipe too.
        Gpu = "gpu",
        /// The CPU.
        Cpu = "cpu",
    }
}

/// What a caller asks of devices.
#[derive(Debug, Clone, Default)]
pub struct Choice {
    /// Where to render.
    pub device: DeviceWish,
    /// How numbers are computed.
    pub precision: Precision,
    /// How rays are followed.
    pub traversal: Traversal,
    /// A GPU's number or part of its name.
    pub adapter: Option<String>,
    /// Translate kernels by naga, as on machines without SPIR-V passthrough.
    pub no_passthrough: bool,
    /// CPU threads; 0 is one a core.
    pub threads: usize,
    /// What is held around the work of a GPU's driver.
    pub around: Option<Around>,
}

impl Choice {
    /// Packs a scene for what is traced, by as many threads.
    ///
    /// # Errors
    /// As [`DeviceScene::new`].
    pub fn pack(&self, scene: &Scene, settings: Settings, quality: Quality) -> Result<DeviceScene> {
        let is_wide = self.traversal.method == Method::Wide && self.device != DeviceWish::Cpu;
        let pack = if is_wide { DeviceScene::with_wide_nodes } else { DeviceScene::new };
        cpu::pool(self.threads)?.install(|| pack(scene, settings, quality))
    }
}

/// The device of a rendering.
enum Device {
    Cpu,
    Gpu(Box<Gpu>),
}

/// A device, and why it was taken.
pub struct Backend {
    device: Device,
    choice: Choice,
    why: Why,
    open_time: Duration,
}

/// A picture and what it took.
pub struct Rendering {
    /// The picture.
    pub picture: Picture,
    /// What it was developed from.
    pub film: Film,
    /// Samples of each pixel, in the mean of all.
    pub samples: u32,
    /// What was traced.
    pub rays: Rays,
    /// The device that ran.
    pub device: String,
    /// Of what kind it is.
    pub processor: Processor,
    /// Why it was taken.
    pub why: Why,
    /// What opening the device took, compiling its kernels, uploading the scene, and making nodes that only it needs.
    pub prepare_time: Duration,
    /// Wall-clock time of a rendering, median of all of them.
    pub time: Duration,
    /// Time on the GPU, median of all renderings, where it has a clock.
    pub device_time: Option<Duration>,
    /// What every rendering took: on the GPU where it has a clock, else all of it.
    pub times: Vec<Duration>,
}

/// A scene, and how it is seen.
type Seen<'a> = (&'a DeviceScene, &'a View);

/// How often a picture is rendered.
#[derive(Clone, Copy)]
struct Runs<'a> {
    /// Is it rendered before any time counts?
    warm_up: bool,
    /// At least once.
    repeat: u32,
    /// Who looks on, and a film that is gone on with.
    watch: Option<(&'a Watch<'a>, Option<&'a Film>)>,
    /// When their preparation began; a GPU that then can't is part of it.
    since: Instant,
}

/// Pictures, with pauses to read them, raise a GPU's clocks in so long.
const LEAST_WARMING: Duration = Duration::from_millis(500);

impl Backend {
    /// Opens the device that fits the choice.
    ///
    /// # Errors
    /// A GPU was asked for by name and there is none, or none that can do it.
    pub fn new(choice: &Choice) -> Result<Backend> {
        let start = Instant::now();
        let chosen = |device, why| Backend { device, choice: choice.clone(), why, open_time: start.elapsed() };
        let cpu = |why| chosen(Device::Cpu, why);
        if choice.device == DeviceWish::Cpu {
            return Ok(cpu(Why::Asked));
        }
        if choice.precision == Precision::Reference {
            return match choice.device {
                DeviceWish::Gpu => Err(Error::ReferenceOnGpu),
                _ => Ok(cpu(Why::Reference)),
            };
        }
        let asked = choice.device == DeviceWish::Gpu;
        let want = AdapterRequest {
            adapter: choice.adapter.clone(),
            software: asked || choice.adapter.is_some(),
            naga: choice.no_passthrough,
            exact: choice.precision == Precision::Exact,
            around: choice.around,
        };
        match Gpu::open(&want) {
            Ok(gpu) => {
                let why = if asked { Why::Asked } else { Why::Works };
                Ok(chosen(Device::Gpu(Box::new(gpu)), why))
            }
            Err(error) if asked || choice.adapter.is_some() => Err(error),
            Err(error) => Ok(cpu(Why::Instead(error))),
        }
    }

    /// The GPU, unless it is the CPU.
    pub fn gpu(&self) -> Option<&Gpu> {
        match &self.device {
            Device::Gpu(gpu) => Some(gpu),
            Device::Cpu => None,
        }
    }

    /// The device and its driver.
    pub fn description(&self) -> String {
        match &self.device {
            Device::Cpu => "CPU".to_owned(),
            Device::Gpu(gpu) => {
                let report = &gpu.report;
                format!("{} ({}, {})", report.name, report.backend, report.driver)
            }
        }
    }

    /// What was asked for.
    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    /// Goes on in another precision, with another traversal. A GPU that was opened for fast precision may have
    /// no other.
    pub fn turn(&mut self, precision: Precision, traversal: Traversal) {
        (self.choice.precision, self.choice.traversal) = (precision, traversal);
    }

    /// Renders `repeat` times, at least once. `done` is called with finished shares of the pixels.
    ///
    /// # Errors
    /// What the device reports. Under `auto`, a scene that the GPU can't hold goes to the CPU.
    pub fn render(
        &self,
        packed: &DeviceScene,
        view: &View,
        repeat: u32,
        done: &(dyn Fn(u64) + Sync),
    ) -> Result<Rendering> {
        self.run((packed, view), Runs { warm_up: false, repeat, watch: None, since: Instant::now() }, done)
    }

    /// Renders while somebody looks on, who may end it before all samples of the view are done: the picture has the bits of one of
    /// [`Rendering::samples`]. Where there is a film `from` before, only what it has not is rendered.
    ///
    /// # Errors
    /// As [`Backend::render`]; or a film of another picture.
    pub fn render_watched(
        &self,
        packed: &DeviceScene,
        view: &View,
        from: Option<&Film>,
        watch: &Watch<'_>,
    ) -> Result<Rendering> {
        let runs = Runs { warm_up: false, repeat: 1, watch: Some((watch, from)), since: Instant::now() };
        self.run((packed, view), runs, &|_| ())
    }

    /// [`Backend::render`] after a warm-up, which counts for no time.
    ///
    /// # Errors
    /// As [`Backend::render`].
    pub fn measure(&self, packed: &DeviceScene, view: &View, repeat: u32) -> Result<Rendering> {
        self.run((packed, view), Runs { warm_up: true, repeat, watch: None, since: Instant::now() }, &|_| ())
    }

    fn run(&self, scene: Seen<'_>, runs: Runs<'_>, done: &(dyn Fn(u64) + Sync)) -> Result<Rendering> {
        if let Device::Gpu(gpu) = &self.device {
            match self.on_gpu(gpu, scene, runs, done) {
                Err(error) if self.choice.device == DeviceWish::Auto => {
                    return self.on_cpu(scene, Why::Instead(error), runs, done);
                }
                result => return result,
            }
        }
        self.on_cpu(scene, self.why.clone(), runs, done)
    }

    fn on_gpu(
        &self,
        gpu: &Gpu,
        (packed, view): Seen<'_>,
        runs: Runs<'_>,
        done: &(dyn Fn(u64) + Sync),
    ) -> Result<Rendering> {
        let mut renderer =
            Renderer::new(gpu, packed, self.choice.precision == Precision::Exact, self.choice.traversal)?;
        renderer.start(view)?;
        let prepare_time = self.open_time + runs.since.elapsed();
        if runs.warm_up {
            warm(LEAST_WARMING, || {
                let start = Instant::now();
                let rendering = renderer.render(view, &|_| ())?;
                Ok(rendering.device_time.unwrap_or_else(|| start.elapsed()))
            })?;
        }
        let mut device_times = Some(Vec::new());
        let (last, times) = repeated(runs.repeat, || {
            let before = renderer.device_time();
            let film = runs.film(&mut renderer, view, done)?;
            match renderer.device_time().zip(before).zip(device_times.as_mut()) {
                Some(((after, before), times)) => times.push(after - before),
                None => device_times = None,
            }
            Ok((film.develop()?, film))
        })?;
        let route = if self.choice.no_passthrough { ", through naga" } else { "" };
        let device = format!("{} ({}{route})", gpu.report.name, gpu.report.backend);
        let taken =
            Taken { device, processor: Processor::Gpu, why: self.why.clone(), prepare_time, times, device_times };
        Ok(taken.rendering(last))
    }

    fn on_cpu(
        &self,
        (packed, view): Seen<'_>,
        why: Why,
        runs: Runs<'_>,
        done: &(dyn Fn(u64) + Sync),
    ) -> Result<Rendering> {
        let threads = self.choice.threads;
        let renderer = cpu::Renderer::new(packed, self.choice.traversal, threads)?;
        let prepare_time = self.open_time + runs.since.elapsed();
        let render = |done: &(dyn Fn(u64) + Sync)| {
            let film = match self.choice.precision {
                Precision::Exact | Precision::Fast => runs.film(&mut cpu::OnCpu::<f32>::new(&renderer), view, done),
                Precision::Reference => runs.film(&mut cpu::OnCpu::<f64>::new(&renderer), view, done),
            }?;
            Ok((renderer.install(|| film.develop())?, film))
        };
        if runs.warm_up {
            render(&|_| ())?;
        }
        let (last, times) = repeated(runs.repeat, || render(done))?;
        let threads = if threads == 0 { std::thread::available_parallelism().map_or(1, usize::from) } else { threads };
        let plural = if threads == 1 { "" } else { "s" };
        let device = format!("CPU ({threads} thread{plural})");
        let taken = Taken { device, processor: Processor::Cpu, why, prepare_time, times, device_times: None };
        Ok(taken.rendering(last))
    }
}

impl Runs<'_> {
    /// Renders once.
    fn film(&self, device: &mut impl Grows, view: &View, done: &(dyn Fn(u64) + Sync)) -> Result<Film> {
        match self.watch {
            Some((watch, from)) => watch::go_on(device, view, from.cloned(), watch),
            None => watch::render(device, view, done),
        }
    }
}

/// What renderings took.
struct Taken {
    device: String,
    processor: Processor,
    why: Why,
    prepare_time: Duration,
    /// Of the wall clock.
    times: Vec<Duration>,
    device_times: Option<Vec<Duration>>,
}

impl Taken {
    fn rendering(self, (picture, film): (Picture, Film)) -> Rendering {
        let rays = film.rays();
        Rendering {
            samples: (rays.primary / film.window().pixels()) as u32,
            picture,
            film,
            rays,
            device: self.device,
            processor: self.processor,
            why: self.why,
            prepare_time: self.prepare_time,
            time: median(self.times.clone()),
            device_time: self.device_times.clone().map(median),
            times: self.device_times.unwrap_or(self.times),
        }
    }
}

/// Runs `repeat` times, at least once, and keeps the last result and all times.
fn repeated<T>(repeat: u32, mut run: impl FnMut() -> Result<T>) -> Result<(T, Vec<Duration>)> {
    let mut times = Vec::new();
    loop {
        let start = Instant::now();
        let result = run()?;
        times.push(start.elapsed());
        if times.len() >= repeat as usize {
            return Ok((result, times));
        }
    }
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times[times.len() / 2]
}
