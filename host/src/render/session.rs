//! A scene on a device, ready for any number of pictures.

mod live;

use std::cell::RefCell;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::rendering::{Rendering, Taken, repeated};
use super::several::{Devices, cpu_name};
use super::{Backend, Choice, DeviceWish, Opened, Precision, Why};
use crate::choice;
use crate::cpu::{self, OnCpu};
use crate::error::{Error, Result};
use crate::film::Film;
use crate::fireflies::{self, Bucket, Buckets};
use crate::gpu::{Gpu, Renderer, warm};
use crate::integrator::needs;
use crate::job::Job;
use crate::method::Processor;
use crate::noise::{self, Target};
use crate::picture::Picture;
use crate::rays::Rays;
use crate::view::View;
use crate::watch::{self, Grows, Watch};

pub use self::live::Display;

/// Pictures, with pauses to read them, raise a GPU's clocks in so long.
const LEAST_WARMING: Duration = Duration::from_millis(500);

/// A scene whose kernels are compiled and whose data are where the device wants them. Cameras, sizes, parts and samples may change
/// from picture to picture.
pub struct Session {
    backend: Backend,
    job: Job,
    device: Device,
    name: String,
    processor: Processor,
    why: Why,
    /// What opening the device took and getting the scene there, until a picture has told it.
    opening: Duration,
    prepare_time: Duration,
}

impl Session {
    pub(super) fn new(backend: &Backend, job: &Job) -> Result<Self> {
        let since = Instant::now();
        let session = |device, name, processor| Session {
            backend: backend.clone(),
            job: job.clone(),
            device,
            name,
            processor,
            why: backend.why.clone(),
            opening: backend.open_time + since.elapsed(),
            prepare_time: Duration::ZERO,
        };
        match &backend.device {
            Opened::Cpu => {
                let (device, name) = on_cpu(backend, job)?;
                Ok(session(device, name, Processor::Cpu))
            }
            Opened::Gpu(gpu) => match on_gpu(backend, gpu, job) {
                Ok((device, name)) => Ok(session(device, name, Processor::Gpu)),
                Err(error) if backend.choice.device == DeviceWish::Auto => {
                    let (device, name) = on_cpu(backend, job)?;
                    Ok(Session { why: Why::Instead(error), ..session(device, name, Processor::Cpu) })
                }
                Err(error) => Err(error),
            },
            Opened::Several(devices) => {
                let device = on_several(backend, devices, job)?;
                Ok(session(device, devices.names(), Processor::Gpu))
            }
        }
    }

    /// What was asked of devices.
    pub(crate) fn choice(&self) -> &Choice {
        &self.backend.choice
    }

    /// What is rendered.
    pub fn job(&self) -> &Job {
        &self.job
    }

    /// Goes on with another job. What devices hold of its scene stays there, and so do kernels that were compiled.
    ///
    /// # Errors
    /// As [`Backend::open`].
    pub fn turn(&mut self, job: &Job) -> Result<()> {
        self.on_device(|device| device.turn(job))?;
        self.job = job.clone();
        Ok(())
    }

    /// Takes the memory that pictures of a view need. What that and all before took is told with the next picture.
    ///
    /// # Errors
    /// What the device reports.
    pub fn reserve(&mut self, view: &View) -> Result<()> {
        let start = Instant::now();
        self.on_device(|device| device.start(view, &[view.region()]))?;
        self.prepare_time = std::mem::take(&mut self.opening) + start.elapsed();
        Ok(())
    }

    /// Renders a picture `repeat` times, at least once, and keeps no film. `done` is called with finished shares of the pixels.
    ///
    /// # Errors
    /// What the device reports. Under `auto`, what a GPU can't do goes to the CPU.
    pub fn render(&mut self, view: &View, repeat: u32, done: &(dyn Fn(u64) + Sync)) -> Result<Rendering> {
        self.rendered(view, repeat, |device| Ok((device.picture(view, done)?, None)))
    }

    /// Renders while somebody looks on, who may end it before all samples of the view are done: the picture has the bits of one of
    /// [`Rendering::samples`]. Where there is a film `from` before, only what it has not is rendered.
    ///
    /// # Errors
    /// As [`Session::render`]; or a film of another picture.
    pub fn render_watched(&mut self, view: &View, from: Option<&Film>, watch: &Watch<'_>) -> Result<Rendering> {
        self.watched(view, from, watch, |device, from, watch| watch::go_on(device, view, from, watch))
    }

    /// Renders until the noise of what is seen is low enough, or cells have all samples of the view, while somebody looks on: each cell
    /// of [`Target::CELL`] pixels an edge gets as many samples as it needs. Where there is a film `from` before, it is gone on with.
    ///
    /// # Errors
    /// As [`Session::render_watched`]; an integrator that does not sample, a tile that cuts cells, or too few samples to decide.
    pub fn render_until(
        &mut self,
        view: &View,
        target: &Target,
        from: Option<&Film>,
        watch: &Watch<'_>,
    ) -> Result<Rendering> {
        if !needs(&self.job).stages.tells_noise {
            let integrator = choice::Named::name(self.job.settings().transport.integrator);
            return Err(Error::NoNoise { integrator });
        }
        self.prepare_time = std::mem::take(&mut self.opening);
        self.watched(view, from, watch, |device, from, watch| noise::go_on(device, view, target, from, watch))
    }

    /// Lets a film go on that somebody looks at; if a GPU fails that is left to us, a CPU goes on with what was looked at last.
    fn watched(
        &mut self,
        view: &View,
        from: Option<&Film>,
        watch: &Watch<'_>,
        go_on: impl Fn(&mut dyn Grows, Option<Film>, &Watch<'_>) -> Result<Film>,
    ) -> Result<Rendering> {
        let last = Last::new(self.is_left_to_us());
        let keep = |film: &Film| last.keep(film);
        let grown = watch::keeping(watch, &keep);
        self.rendered(view, 1, |device| {
            let film = go_on(device, last.or(from), &Watch { grown: &grown, ..*watch })?;
            Ok((device.develop(&film)?, Some(film)))
        })
    }

    /// Renders a picture and keeps its film.
    ///
    /// # Errors
    /// As [`Session::render`].
    pub fn expose(&mut self, view: &View, done: &(dyn Fn(u64) + Sync)) -> Result<Rendering> {
        self.rendered(view, 1, |device| {
            let film = device.expose(view, done)?;
            Ok((device.develop(&film)?, Some(film)))
        })
    }

    /// Renders a picture in buckets of its samples, without what a few of them are far too bright by, see [`fireflies`]. The film is that
    /// of all samples. A picture of each bucket is kept meanwhile, 12 bytes a pixel.
    ///
    /// # Errors
    /// As [`Session::render`], and fewer samples than buckets.
    pub fn expose_in(&mut self, view: &View, buckets: Buckets, done: &(dyn Fn(u64) + Sync)) -> Result<Rendering> {
        let parts = buckets.of(view.range())?;
        self.rendered(view, 1, |device| {
            let (mut pictures, mut all) = (Vec::new(), None::<Film>);
            for samples in &parts {
                let film = device.expose(&view.part(view.region(), samples.clone())?, done)?;
                pictures.push(Bucket { picture: device.develop(&film)?.0, samples: samples.len() as u32 });
                match &mut all {
                    Some(all) => all.merge(film)?,
                    None => all = Some(film),
                }
            }
            let film = all.expect("there are several buckets");
            let (picture, rays) = device.develop(&film)?;
            Ok(((fireflies::without(picture, &pictures)?, rays), Some(film)))
        })
    }

    /// [`Session::render`] after a warm-up, which counts for no time.
    ///
    /// # Errors
    /// As [`Session::render`].
    pub fn measure(&mut self, view: &View, repeat: u32) -> Result<Rendering> {
        let run = |device: &mut dyn Grows| {
            let (start, before) = (Instant::now(), device.device_time());
            device.picture(view, &|_| ())?;
            let on_device = device.device_time().zip(before).map(|(after, before)| after - before);
            Ok(on_device.unwrap_or_else(|| start.elapsed()))
        };
        match self.processor {
            Processor::Gpu => self.on_device(|device| warm(LEAST_WARMING, || run(device)))?,
            Processor::Cpu => drop(self.on_device(run)?),
        }
        self.render(view, repeat, &|_| ())
    }

    /// Runs something on the device, or on the CPU where that is left to us and the GPU can't.
    fn on_device<T>(&mut self, mut work: impl FnMut(&mut dyn Grows) -> Result<T>) -> Result<T> {
        match work(self.device.as_mut()) {
            Err(error) if self.processor == Processor::Gpu && self.is_left_to_us() => {
                (self.device, self.name) = on_cpu(&self.backend, &self.job)?;
                (self.processor, self.why) = (Processor::Cpu, Why::Instead(error));
                work(self.device.as_mut())
            }
            done => done,
        }
    }

    fn is_left_to_us(&self) -> bool {
        matches!(self.backend.device, Opened::Gpu(_)) && self.backend.choice.device == DeviceWish::Auto
    }

    fn rendered(
        &mut self,
        view: &View,
        repeat: u32,
        mut work: impl FnMut(&mut dyn Grows) -> Result<Made>,
    ) -> Result<Rendering> {
        let mut device_times = Some(Vec::new());
        let (last, times) = repeated(repeat, || {
            self.on_device(|device| {
                let before = device.device_time();
                let made = work(device)?;
                match device.device_time().zip(before).zip(device_times.as_mut()) {
                    Some(((after, before), times)) => times.push(after - before),
                    None => device_times = None,
                }
                Ok(made)
            })
        })?;
        Ok(self.taken(times, device_times).rendering(view.region(), last))
    }

    fn taken(&mut self, times: Vec<Duration>, device_times: Option<Vec<Duration>>) -> Taken {
        Taken {
            device: self.name.clone(),
            processor: self.processor,
            why: self.why.clone(),
            prepare_time: self.prepare_time,
            times,
            device_times,
            lost: self.device.lost(),
        }
    }
}

/// A picture with what was counted, and its film where that is kept.
pub(super) type Made = ((Picture, Rays), Option<Film>);

/// The film that somebody looked at last, from where a CPU goes on if a GPU fails that is left to us.
struct Last {
    keeps: bool,
    film: RefCell<Option<Film>>,
}

impl Last {
    fn new(keeps: bool) -> Last {
        Last { keeps, film: RefCell::new(None) }
    }

    fn keep(&self, film: &Film) {
        if self.keeps {
            *self.film.borrow_mut() = Some(film.clone());
        }
    }

    /// It, or the film that the rendering began with.
    fn or(&self, from: Option<&Film>) -> Option<Film> {
        self.film.borrow().clone().or_else(|| from.cloned())
    }
}

/// A device that films grow on.
type Device = Box<dyn Grows>;

/// It with its name.
type Named = (Device, String);

fn on_gpu(backend: &Backend, gpu: &Gpu, job: &Job) -> Result<Named> {
    let choice = &backend.choice;
    let renderer = Renderer::new(gpu, job, choice.precision == Precision::Exact, choice.traversal)?;
    let route = if choice.no_passthrough { ", through naga" } else { "" };
    Ok((Box::new(renderer), format!("{} ({}{route})", gpu.report.name, gpu.report.backend)))
}

fn on_cpu(backend: &Backend, job: &Job) -> Result<Named> {
    let choice = &backend.choice;
    let renderer = Arc::new(cpu::Renderer::new(job, choice.traversal, choice.threads)?);
    let device: Device = match choice.precision {
        Precision::Exact | Precision::Fast => Box::new(OnCpu::<f32>::new(renderer)),
        Precision::Reference => Box::new(OnCpu::<f64>::new(renderer)),
    };
    let threads = match choice.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        asked => asked,
    };
    Ok((device, cpu_name(threads)))
}

fn on_several(backend: &Backend, devices: &Devices, job: &Job) -> Result<Device> {
    Ok(Box::new(devices.team(backend.choice.traversal, job)?))
}
