//! Several devices: which they are, and a picture by all of them.

use std::sync::Arc;
use std::thread;

use super::{Choice, DeviceName, Precision, Several};
use crate::cpu;
use crate::error::{Error, Result};
use crate::gpu::{AdapterRequest, Gpu, Renderer, adapters};
use crate::job::Job;
use crate::method::Traversal;
use crate::team::{Member, Team};

/// Devices that are open.
#[derive(Clone)]
pub(super) struct Devices {
    gpus: Vec<Gpu>,
    /// How many threads the CPU gives, if it takes part.
    threads: Option<usize>,
}

impl Devices {
    /// Opens those that were asked for.
    ///
    /// # Errors
    /// Another precision than exact, none, the same twice, or one that can't be had.
    pub fn open(several: &Several, choice: &Choice) -> Result<Devices> {
        if choice.precision != Precision::Exact {
            return Err(Error::SeveralInexact);
        }
        let names = match several {
            Several::All => all(choice),
            Several::These(names) => names.clone(),
        };
        let with_cpu = names.iter().filter(|&name| *name == DeviceName::Cpu).count();
        let gpus = names.iter().filter_map(|name| match name {
            DeviceName::Gpu(adapter) => Some(adapter.clone()),
            DeviceName::Cpu => None,
        });
        let open = |adapter| {
            Gpu::open(&AdapterRequest { adapter, software: true, naga: false, exact: true, around: choice.around })
        };
        let gpus: Vec<Gpu> = gpus.map(open).collect::<Result<_>>()?;
        let mut numbers: Vec<usize> = gpus.iter().map(|gpu| gpu.report.index).collect();
        numbers.sort_unstable();
        if with_cpu > 1 || numbers.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(Error::new("a device is named twice: name each once"));
        }
        let cores = thread::available_parallelism().map_or(1, usize::from);
        // A GPU needs a thread that makes its launches.
        let threads = if choice.threads == 0 { cores.saturating_sub(gpus.len()).max(1) } else { choice.threads };
        Ok(Devices { gpus, threads: (with_cpu == 1).then_some(threads) })
    }

    /// What they are called.
    pub fn names(&self) -> String {
        let gpus = self.gpus.iter().map(|gpu| format!("{} ({})", gpu.report.name, gpu.report.backend));
        let cpu = self.threads.map(cpu_name);
        gpus.chain(cpu).collect::<Vec<_>>().join(" + ")
    }

    /// Gets all of them ready for a scene.
    ///
    /// # Errors
    /// A GPU that can't hold the scene.
    pub fn team(&self, traversal: Traversal, packed: &Job) -> Result<Team> {
        let renderers: Vec<Result<Renderer>> = thread::scope(|scope| {
            let ready = self.gpus.iter().map(|gpu| scope.spawn(move || Renderer::new(gpu, packed, true, traversal)));
            let ready: Vec<_> = ready.collect();
            ready.into_iter().map(|thread| thread.join().expect("a driver's fault is an error")).collect()
        });
        let gpus = self.gpus.iter().zip(renderers);
        let gpus = gpus.map(|(gpu, renderer)| Ok(Member::new(gpu.report.name.clone(), renderer?)));
        let mut members = gpus.collect::<Result<Vec<_>>>()?;
        if let Some(threads) = self.threads {
            let renderer = Arc::new(cpu::Renderer::new(packed, traversal, threads)?);
            members.push(Member::new(cpu_name(threads), cpu::OnCpu::<f32>::new(renderer)));
        }
        let team = Team::new(members);
        Ok(if packed.has_photons() { team.of_whole_samples() } else { team })
    }
}

/// What a CPU is called.
pub(super) fn cpu_name(threads: usize) -> String {
    let plural = if threads == 1 { "" } else { "s" };
    format!("CPU ({threads} thread{plural})")
}

/// Every GPU in hardware that renders exactly, and the CPU.
fn all(choice: &Choice) -> Vec<DeviceName> {
    let _around = choice.around.map(|begin| begin());
    let gpus = adapters().into_iter().filter(|report| report.exact && !report.is_software());
    gpus.map(|report| DeviceName::Gpu(Some(report.index.to_string()))).chain([DeviceName::Cpu]).collect()
}
