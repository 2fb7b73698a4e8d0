//! A session, or one that is being opened while somebody else works: drivers compile kernels for seconds.

use std::thread::{self, JoinHandle};
use std::time::Instant;

use eyerays::error::{Error, Result};
use eyerays::gpu::{Around, Gpu};
use eyerays::job::Job;
use eyerays::render::{Backend, Choice, DeviceWish, Precision, Session};

use crate::wish::Device;

/// What renders.
#[derive(Default)]
pub(super) enum Seat {
    /// Nothing yet.
    #[default]
    Empty,
    /// A session is being opened, since so long.
    Opening(Opening, Instant),
    /// It is there. Is its device the window's?
    Ready(Box<Session>, bool),
}

/// A session, and whether its device is the window's.
type Opened = Result<(Session, bool)>;

/// A thread that opens a session.
pub(super) struct Opening(Option<JoinHandle<Opened>>);

impl Opening {
    fn by(open: impl FnOnce() -> Opened + Send + 'static) -> Seat {
        Seat::Opening(Opening(Some(thread::spawn(open))), Instant::now())
    }

    fn is_done(&self) -> bool {
        self.0.as_ref().is_some_and(JoinHandle::is_finished)
    }

    fn session(mut self) -> Opened {
        let thread = self.0.take().expect("it is taken once");
        thread.join().unwrap_or_else(|_| Err(Error::new("a driver failed while it compiled kernels")))
    }
}

impl Drop for Opening {
    /// A driver that compiles kernels must not be left behind by a process that ends.
    fn drop(&mut self) {
        if let Some(thread) = self.0.take() {
            let _ = thread.join();
        }
    }
}

impl Seat {
    /// Opens a session for a job, on the window's GPU where that is what is wished for.
    pub fn open(&mut self, (device, around): (&Device, Option<Around>), shared: Option<&Gpu>, job: &Job) {
        let (device, shared, job) = (device.clone(), shared.cloned(), job.clone());
        *self = Opening::by(move || opened(&device, Choice { around, ..device.choice() }, shared, &job));
    }

    /// Has the session that there is go on with another job.
    pub fn turn(&mut self, job: &Job) {
        if let Seat::Ready(mut session, is_shared) = std::mem::take(self) {
            let job = job.clone();
            *self = Opening::by(move || session.turn(&job).map(|()| (*session, is_shared)));
        }
    }

    /// Takes the session that has been opened, if it is there by now.
    ///
    /// # Errors
    /// What opening it met; the seat is empty then.
    pub fn look(&mut self) -> Result<()> {
        *self = match std::mem::take(self) {
            Seat::Opening(opening, _) if opening.is_done() => {
                let (session, is_shared) = opening.session()?;
                Seat::Ready(Box::new(session), is_shared)
            }
            other => other,
        };
        Ok(())
    }
}

fn opened(device: &Device, choice: Choice, shared: Option<Gpu>, job: &Job) -> Opened {
    let shared = shared.filter(|gpu| fits(device, gpu));
    if let Some(Ok(backend)) = shared.map(|gpu| Backend::on(gpu, &choice)) {
        return Ok((backend.open(job)?, true));
    }
    // There may be another.
    Ok((Backend::new(&choice)?.open(job)?, false))
}

/// Is a window's GPU what a wish is for? One in software is asked for by who tests, and is slower than the CPU that it runs on.
fn fits(device: &Device, gpu: &Gpu) -> bool {
    let is_gpu = match device.wish {
        DeviceWish::Gpu => true,
        DeviceWish::Auto => !gpu.report.is_software() && device.precision != Precision::Reference,
        DeviceWish::Cpu => false,
    };
    is_gpu && device.several.is_none() && device.adapter.is_none() && !device.no_passthrough
}
