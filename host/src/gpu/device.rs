//! One GPU, opened.

use std::any::Any;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use super::adapter::{self, AdapterReport};
use super::recipe::{Target, parse_ahead};
use crate::error::{Error, Result};
use crate::method::{Coherence, Method, Processor, Scheduling, Traversal};

/// How kernels reach the driver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Route {
    /// The committed SPIR-V as it is.
    Passthrough,
    /// Translated by naga, which drops what forbids contraction: not for exact precision.
    Naga,
}

/// Makes what a caller holds while a driver opens a GPU or compiles kernels. Drivers, layers and the libraries they load write to
/// standard error whatever they like meanwhile: a command may keep it from its user, which is not for a library to do.
pub type Around = fn() -> Box<dyn Any>;

/// What a caller asks of a GPU.
#[derive(Debug, Clone, Default)]
pub struct AdapterRequest {
    /// A number or part of a name.
    pub adapter: Option<String>,
    /// Is a software adapter welcome?
    pub software: bool,
    /// Take naga's route even where passthrough is possible.
    pub naga: bool,
    /// Must it render in exact precision?
    pub exact: bool,
    /// What is held around the work of its driver.
    pub around: Option<Around>,
}

/// An opened GPU. Cheap to clone: all clones are the same device.
#[derive(Clone)]
pub struct Gpu {
    /// What it offers.
    pub report: AdapterReport,
    /// How kernels reach it.
    pub route: Route,
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) around: Option<Around>,
    fault: Arc<Mutex<Option<String>>>,
    is_lost: Arc<AtomicBool>,
}

impl Gpu {
    /// Opens the GPU that fits.
    ///
    /// # Errors
    /// If there is none.
    pub fn open(want: &AdapterRequest) -> Result<Gpu> {
        let _around = want.around.map(|begin| begin());
        parse_ahead(want.exact);
        let (index, adapter) = adapter::choose(&adapter::instance(), want.adapter.as_deref())?;
        let report = AdapterReport::of(index, &adapter);
        if report.is_software() && !want.software {
            return Err(Error::OnlySoftware { device: report.name });
        }
        let route = if report.passthrough && !want.naga { Route::Passthrough } else { Route::Naga };
        if want.exact && (route == Route::Naga || !report.exact) {
            return Err(Error::Inexact { device: report.name, by_naga: want.naga });
        }
        let request = adapter.request_device(&descriptor(&adapter, route));
        let (device, queue) = pollster::block_on(request)
            .map_err(|e| Error::NotOpened { device: report.name.clone(), message: e.to_string() })?;
        Ok(Gpu::on(report, route, device, queue, want.around))
    }

    /// What to open a device with that is to be [shared](Gpu::from_wgpu): all that the adapter has of what kernels want. Others may
    /// add to its features.
    pub fn descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
        let passthrough = adapter.features().contains(wgpu::Features::PASSTHROUGH_SHADERS);
        descriptor(adapter, if passthrough { Route::Passthrough } else { Route::Naga })
    }

    /// A device that somebody else has opened, such as that of a window, so that pictures need not leave it. It hears of the device's
    /// faults instead of handlers that were set before.
    ///
    /// # Errors
    /// The device was opened with smaller limits than kernels take: open it by [`Gpu::descriptor`].
    pub fn from_wgpu(adapter: &wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Result<Gpu> {
        let (features, limits, most) = (device.features(), device.limits(), adapter.limits());
        let of_adapter = AdapterReport::of(0, adapter);
        if limits.max_storage_buffers_per_shader_stage < most.max_storage_buffers_per_shader_stage {
            let message = "it was opened with few buffers a kernel: open it by Gpu::descriptor".to_owned();
            return Err(Error::NotOpened { device: of_adapter.name, message });
        }
        let passthrough = features.contains(wgpu::Features::PASSTHROUGH_SHADERS);
        let report = AdapterReport {
            passthrough,
            exact: passthrough && of_adapter.exact,
            max_buffer: limits.max_buffer_size,
            max_binding: limits.max_storage_buffer_binding_size,
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            ..of_adapter
        };
        let route = if passthrough { Route::Passthrough } else { Route::Naga };
        Ok(Gpu::on(report, route, device, queue, None))
    }

    /// The same device, with this held around the work of its driver.
    #[must_use]
    pub fn with_around(self, around: Option<Around>) -> Gpu {
        Gpu { around, ..self }
    }

    fn on(
        report: AdapterReport,
        route: Route,
        device: wgpu::Device,
        queue: wgpu::Queue,
        around: Option<Around>,
    ) -> Gpu {
        let fault = Arc::new(Mutex::new(None));
        let (first, lost) = (fault.clone(), fault.clone());
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            let message = e.to_string();
            if !is_of_surface(&message) {
                note(&first, message);
            }
        }));
        let is_lost = Arc::new(AtomicBool::new(false));
        let gone = is_lost.clone();
        device.set_device_lost_callback(move |reason, message| {
            gone.store(true, Ordering::SeqCst);
            if reason != wgpu::DeviceLostReason::Destroyed {
                note(&lost, format!("the device was lost: {message}"));
            }
        });
        Gpu { report, route, device, queue, around, fault, is_lost }
    }

    /// The method and scheduling for rays of some coherence.
    ///
    /// # Errors
    /// What was asked for votes, and there is nobody to vote with.
    pub fn resolved(&self, traversal: Traversal, coherence: Coherence) -> Result<Traversal> {
        // Lavapipe ends an invocation's loops after 65,535 rounds, which a persistent subgroup comes to in a large launch.
        let scheduling = match traversal.scheduling {
            Scheduling::Auto if self.report.is_software() => Scheduling::Grid,
            chosen => chosen,
        };
        let traversal = Traversal { scheduling, ..traversal };
        let resolved = traversal.resolved(Processor::Gpu, coherence);
        if !resolved.votes() || self.device.features().contains(wgpu::Features::SUBGROUP) {
            return Ok(resolved);
        }
        if traversal.method.votes() || traversal.scheduling == Scheduling::Persistent {
            return Err(Error::NoSubgroups { device: self.report.name.clone() });
        }
        let method = if traversal.method == Method::Auto { Method::IfIf } else { traversal.method };
        Ok(Traversal { method, scheduling: Scheduling::Grid, ..traversal })
    }

    /// Which kernels it takes in a precision.
    pub(super) fn target(&self, exact: bool) -> Target {
        Target { exact, subgroups: self.device.features().contains(wgpu::Features::SUBGROUP) }
    }

    /// The first fault that the GPU reported since, if any.
    ///
    /// # Errors
    /// That fault.
    pub fn check(&self) -> Result<()> {
        match self.fault.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take() {
            Some(message) => Err(Error::DeviceFailed { device: self.report.name.clone(), message }),
            None => Ok(()),
        }
    }

    /// Is the device gone? Nothing is rendered by it any more, nor drawn.
    pub fn is_lost(&self) -> bool {
        self.is_lost.load(Ordering::SeqCst)
    }

    /// Waits until all that was submitted is done.
    ///
    /// # Errors
    /// What the GPU reported.
    pub fn wait(&self) -> Result<()> {
        self.poll(wgpu::PollType::wait_indefinitely())
    }

    /// Waits until a submission is done.
    ///
    /// # Errors
    /// What the GPU reported.
    pub(super) fn wait_for(&self, submission: wgpu::SubmissionIndex) -> Result<()> {
        self.poll(wgpu::PollType::Wait { submission_index: Some(submission), timeout: None })
    }

    fn poll(&self, what: wgpu::PollType) -> Result<()> {
        let polled = self.device.poll(what);
        self.check()?;
        polled.map(|_| ()).map_err(|e| Error::DeviceFailed { device: self.report.name.clone(), message: e.to_string() })
    }
}

/// What a device is opened with.
fn descriptor(adapter: &wgpu::Adapter, route: Route) -> wgpu::DeviceDescriptor<'static> {
    let mut features = adapter.features() & (wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::SUBGROUP);
    if route == Route::Passthrough {
        features |= wgpu::Features::PASSTHROUGH_SHADERS;
    }
    wgpu::DeviceDescriptor {
        label: Some("eyerays"),
        required_features: features,
        required_limits: adapter.limits(),
        // SAFETY: passthrough is the one experimental feature in use; `module` says why it is sound.
        experimental_features: unsafe { wgpu::ExperimentalFeatures::enabled() },
        // Of the larger blocks that `Performance` begins with, the first that the host reads takes 25 ms (an H200).
        memory_hints: wgpu::MemoryHints::Manual { suballocated_device_memory_block_size: 4 << 20..256 << 20 },
        trace: wgpu::Trace::Off,
    }
}

/// Is a fault the business of a window that has the device, too? It can't have its surface as it wants it while kernels are under way,
/// and asks again with its next frame.
fn is_of_surface(message: &str) -> bool {
    message.contains("In Surface::")
}

/// Keeps the first fault, its lines made one.
fn note(fault: &Mutex<Option<String>>, message: String) {
    let lines: Vec<&str> = message.lines().map(str::trim).filter(|l| !l.is_empty()).collect();
    fault.lock().unwrap_or_else(std::sync::PoisonError::into_inner).get_or_insert(lines.join("; "));
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    #[test]
    fn what_a_window_does_with_its_surface_is_no_fault_of_a_picture() {
        let of_window =
            "Validation Error\n\nCaused by:\n  In Surface::configure\n    Failed to wait for GPU to come idle";
        assert!(is_of_surface(of_window));
        assert!(!is_of_surface("Validation Error\n\nCaused by:\n  In Queue::submit\n    a buffer is destroyed"));
    }

    /// How many were made, and how many of them are gone.
    static MADE: [AtomicU32; 2] = [AtomicU32::new(0), AtomicU32::new(0)];

    struct Held;

    impl Drop for Held {
        fn drop(&mut self) {
            MADE[1].fetch_add(1, Ordering::Relaxed);
        }
    }

    #[test]
    fn a_caller_holds_what_it_likes_while_a_driver_opens_a_gpu_or_finds_none() {
        let around = || -> Box<dyn Any> {
            MADE[0].fetch_add(1, Ordering::Relaxed);
            Box::new(Held)
        };
        let opened = Gpu::open(&AdapterRequest {
            adapter: Some("no such".to_owned()),
            around: Some(around),
            ..Default::default()
        });
        assert!(opened.is_err());
        assert_eq!(MADE.each_ref().map(|count| count.load(Ordering::Relaxed)), [1, 1]);
    }
}
