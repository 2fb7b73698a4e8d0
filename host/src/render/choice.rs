//! What a caller asks of devices.

use eyerays_bvh::Quality;

use crate::choice::choices;
use crate::cpu;
use crate::error::Result;
use crate::gpu::Around;
use crate::job::Job;
use crate::method::{Method, Traversal};
use crate::scene::{Scene, Settings};

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
    /// These devices together instead, in exact precision.
    pub several: Option<Several>,
}

/// Devices that render one picture together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Several {
    /// Every GPU in hardware, and the CPU.
    All,
    /// Those that are named.
    These(Vec<DeviceName>),
}

/// A device of several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DeviceName {
    /// A GPU by its number or part of its name; the best without.
    Gpu(Option<String>),
    /// The CPU.
    Cpu,
}

impl Choice {
    /// Packs a scene for what is traced, by as many threads.
    ///
    /// # Errors
    /// As [`Job::new`].
    pub fn pack(&self, scene: &Scene, settings: Settings, quality: Quality) -> Result<Job> {
        let is_wide = self.traversal.method == Method::Wide && self.device != DeviceWish::Cpu;
        let pack = if is_wide { Job::with_wide_nodes } else { Job::new };
        cpu::pool(self.threads)?.install(|| pack(scene, settings, quality))
    }

    /// Packs the scene of a job as it is at another moment, see [`Job::moved`], by as many threads.
    ///
    /// # Errors
    /// As [`Job::moved`].
    pub fn pack_moved(&self, before: &Job, scene: &Scene, settings: Settings) -> Result<Job> {
        cpu::pool(self.threads)?.install(|| before.moved(scene, settings))
    }
}
