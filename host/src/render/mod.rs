//! From a packed scene to a picture, on the device that was asked for or fits best.

mod choice;
mod rendering;
mod session;
mod several;

use std::time::{Duration, Instant};

use crate::error::{Error, Result};
use crate::gpu::{AdapterRequest, Gpu, Route};
use crate::job::Job;
use crate::method::Traversal;
use crate::view::View;

pub use self::choice::{Choice, DeviceName, DeviceWish, Precision, Several};
pub use self::rendering::Rendering;
pub use self::session::{Display, Session};
use self::several::Devices;
pub use crate::team::Lost;
pub use crate::why::Why;

/// The device of a rendering, opened.
#[derive(Clone)]
enum Opened {
    Cpu,
    Gpu(Box<Gpu>),
    Several(Box<Devices>),
}

/// A device, and why it was taken. Cheap to clone: all clones are the same device.
#[derive(Clone)]
pub struct Backend {
    device: Opened,
    choice: Choice,
    why: Why,
    open_time: Duration,
}

impl Backend {
    /// Opens the device that fits the choice.
    ///
    /// # Errors
    /// A GPU was asked for by name and there is none, or none that can do it.
    pub fn new(choice: &Choice) -> Result<Backend> {
        let start = Instant::now();
        let chosen = |device, why| Backend { device, choice: choice.clone(), why, open_time: start.elapsed() };
        if let Some(several) = &choice.several {
            return Ok(chosen(Opened::Several(Box::new(Devices::open(several, choice)?)), Why::Asked));
        }
        let cpu = |why| chosen(Opened::Cpu, why);
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
                Ok(chosen(Opened::Gpu(Box::new(gpu)), why))
            }
            Err(error) if asked || choice.adapter.is_some() => Err(error),
            Err(error) => Ok(cpu(Why::Instead(error))),
        }
    }

    /// A GPU that is open, such as that of a window ([`Gpu::from_wgpu`]), instead of one that is opened for the choice.
    ///
    /// # Errors
    /// Exact precision is asked for, which it has not; or double precision.
    pub fn on(gpu: Gpu, choice: &Choice) -> Result<Backend> {
        match choice.precision {
            Precision::Reference => return Err(Error::ReferenceOnGpu),
            Precision::Exact if gpu.route == Route::Naga || !gpu.report.exact => {
                return Err(Error::Inexact { device: gpu.report.name, by_naga: false });
            }
            Precision::Exact | Precision::Fast => {}
        }
        let device = Opened::Gpu(Box::new(gpu));
        Ok(Backend { device, choice: choice.clone(), why: Why::Asked, open_time: Duration::ZERO })
    }

    /// The GPU, if it is one and no other device.
    pub fn gpu(&self) -> Option<&Gpu> {
        match &self.device {
            Opened::Gpu(gpu) => Some(gpu),
            Opened::Cpu | Opened::Several(_) => None,
        }
    }

    /// The device and its driver.
    pub fn description(&self) -> String {
        match &self.device {
            Opened::Cpu => "CPU".to_owned(),
            Opened::Several(devices) => devices.names(),
            Opened::Gpu(gpu) => {
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

    /// Gets a scene ready for any number of pictures.
    ///
    /// # Errors
    /// What the device reports. Under `auto`, a scene that the GPU can't hold goes to the CPU.
    pub fn open(&self, job: &Job) -> Result<Session> {
        Session::new(self, job)
    }

    /// Renders one picture `repeat` times, at least once. `done` is called with finished shares of the pixels.
    ///
    /// # Errors
    /// As [`Backend::open`] and [`Session::render`].
    pub fn render(&self, job: &Job, view: &View, repeat: u32, done: &(dyn Fn(u64) + Sync)) -> Result<Rendering> {
        let mut session = self.open(job)?;
        session.reserve(view)?;
        session.render(view, repeat, done)
    }

    /// [`Backend::render`] after a warm-up, which counts for no time.
    ///
    /// # Errors
    /// As [`Backend::render`].
    pub fn measure(&self, job: &Job, view: &View, repeat: u32) -> Result<Rendering> {
        let mut session = self.open(job)?;
        session.reserve(view)?;
        session.measure(view, repeat)
    }
}
