//! Where and how all is measured, for people who read the figures later.

use super::{Kind, Plan};
use crate::preset::name;
use eyerays::method::Processor;

impl Plan {
    /// A device's name, and its driver or number of threads.
    pub(super) fn device(&self, processor: Processor) -> (String, String) {
        match (&self.gpu, processor) {
            (Some(gpu), Processor::Gpu) => {
                let report = &gpu.report;
                (report.name.clone(), format!("{} {}", report.backend, report.driver))
            }
            _ => (cpu_model(), self.threads()),
        }
    }

    /// The quality of the hierarchies, as the command line spells it.
    pub(super) fn bvh(&self) -> String {
        format!("{:?}", self.quality).to_lowercase()
    }

    /// How many CPU threads run.
    fn threads(&self) -> String {
        let every_core = || std::thread::available_parallelism().map_or(1, usize::from);
        let threads = if self.threads == 0 { every_core() } else { self.threads };
        format!("{threads} thread{}", if threads == 1 { "" } else { "s" })
    }

    /// Names and values of all that figures depend on.
    pub fn setup(&self) -> Vec<(String, String)> {
        let mut lines = vec![
            ("program", format!("eyerays {}", env!("CARGO_PKG_VERSION"))),
            ("machine", format!("{}, {} {}", cpu_model(), std::env::consts::OS, std::env::consts::ARCH)),
        ];
        if let Some(gpu) = &self.gpu {
            let (device, driver) = self.device(Processor::Gpu);
            let clock = match gpu.report.timestamps {
                true => "device time of the trace dispatch, by timestamps",
                false => "wall-clock time around the trace dispatch: this GPU has no timestamps",
            };
            lines.push(("GPU", format!("{device}, {driver}; {clock}")));
            let precisions = [(self.exact, "exact"), (self.fast, "fast")];
            let precisions: Vec<_> = precisions.into_iter().filter(|p| p.0).map(|p| p.1).collect();
            lines.push(("precision of the GPU", precisions.join(", ")));
        }
        if self.cpu {
            lines.push(("CPU", format!("{}, exact precision; wall-clock time of tracing", self.threads())));
        }
        let (width, height) = self.size;
        let kinds: Vec<_> = self.kinds.iter().copied().map(Kind::name).collect();
        let orders: Vec<_> = self.orders.iter().copied().map(name).collect();
        let (stack, cut) = (self.tuning.stack_max(), self.tuning.cut());
        lines.extend([
            ("size", format!("{width}x{height}, one ray a pixel, in {} order", orders.join(", "))),
            ("rays", kinds.join(", ")),
            ("BVH", self.bvh()),
            ("hybrids", format!("stack methods part at {stack} waiting nodes, cut methods below {cut} % of 32 rays")),
            ("time", format!("median of {} after a warm-up", self.repeat)),
        ]);
        lines.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// The processor's name where the system reports it.
pub(crate) fn cpu_model() -> String {
    let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = information.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    model.map_or_else(|| "CPU".to_owned(), |(_, name)| name.trim().to_owned())
}
