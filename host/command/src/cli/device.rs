//! The options that say what renders, and how.

use clap::Args;
use eyerays_shader::data::Tuning;

use super::choice::choice;
use super::hush;
use super::threads;
use crate::error::{Error, Result, within};
use crate::preset::Preset;
use eyerays::method::{Layout, Method, Order, Scheduling, Traversal, TriangleTest};
use eyerays::render::{Choice, DeviceWish, Precision};

/// Which device, and its arithmetic.
#[derive(Args, Clone)]
#[command(next_help_heading = "Device")]
pub(super) struct DeviceArgs {
    /// Exact: the same bits everywhere; fast: a GPU's own arithmetic, a CPU's is exact; reference: double
    /// precision [default: exact]
    #[arg(long, value_parser = choice::<Precision>())]
    precision: Option<Precision>,
    /// How rays are followed; every method gives the same picture [default: auto]
    #[arg(long, value_parser = choice::<Method>())]
    method: Option<Method>,
    /// Stack methods: nodes that wait when a packet parts, 1 to 63
    #[arg(long, value_name = "N", default_value_t = Tuning::default().stack_max())]
    pub stack_max: u32,
    /// Cut methods: percent of a packet that must want a node for it to stay together
    #[arg(long, value_name = "PERCENT", default_value_t = Tuning::default().cut())]
    pub cut: u32,
    /// How a GPU's subgroups come by their rays: if-if, while-while and wide can do both
    #[arg(long, value_parser = choice::<Scheduling>(), default_value_t = Scheduling::Auto)]
    pub scheduling: Scheduling,
    /// Which pixels' rays lie beside each other
    #[arg(long, value_parser = choice::<Order>(), default_value_t = Order::Tiled)]
    pub order: Order,
    /// How the hierarchy and its triangles lie in memory [default: gathered]
    #[arg(long, value_parser = choice::<Layout>())]
    layout: Option<Layout>,
    /// How a ray is tested against a triangle; moller on a GPU in fast precision only [default: watertight]
    #[arg(long, value_name = "TEST", value_parser = choice::<TriangleTest>())]
    triangle: Option<TriangleTest>,
    /// A GPU by its number or a part of its name, as `eyerays info` lists them
    #[arg(long, value_name = "NAME|INDEX")]
    pub adapter: Option<String>,
    /// CPU threads [default: one a core]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Translate the kernels through naga, as where SPIR-V passthrough is missing (fast only)
    #[arg(long)]
    pub no_passthrough: bool,
}

impl DeviceArgs {
    /// With a settings file below the command line, which undoes the file's triangle test where it asks for what has only one:
    /// another precision, or a CPU.
    pub fn over(&self, file: &Preset, device: DeviceWish) -> DeviceArgs {
        let has_choice = device != DeviceWish::Cpu && self.precision.is_none_or(|own| Some(own) == file.precision);
        let triangle = file.triangle.filter(|_| has_choice);
        DeviceArgs {
            precision: self.precision.or(file.precision),
            method: self.method.or(file.method),
            layout: self.layout.or(file.layout),
            triangle: self.triangle.or(triangle),
            ..self.clone()
        }
    }

    /// How numbers are computed.
    pub fn precision(&self) -> Precision {
        self.precision.unwrap_or_default()
    }

    /// The choice of devices these options make.
    pub fn choice(&self, device: DeviceWish) -> Result<Choice> {
        let (threads, precision) = (threads::chosen(self.threads)?, self.precision());
        let triangle = self.triangle.unwrap_or_default();
        if self.no_passthrough && precision != Precision::Fast {
            return Err(Error::new("--no-passthrough can't keep exact arithmetic: add --precision fast"));
        }
        if device == DeviceWish::Cpu && (self.adapter.is_some() || self.no_passthrough) {
            return Err(Error::new("--adapter and --no-passthrough are for GPUs: drop them, or --device cpu"));
        }
        check_tests(&[triangle], precision == Precision::Fast)?;
        check_processor(&[triangle], device)?;
        let method = self.method.unwrap_or_default();
        if self.scheduling == Scheduling::Persistent && method != Method::Auto && !method.is_resumable() {
            let message = "--scheduling persistent is for if-if, while-while and wide: choose one of them, or drop it";
            return Err(Error::new(message));
        }
        let traversal = Traversal {
            method,
            tuning: tuning(self.stack_max, self.cut)?,
            scheduling: self.scheduling,
            order: self.order,
            layout: self.layout.unwrap_or_default(),
            triangle,
        };
        let adapter = self.adapter.clone();
        Ok(Choice {
            device,
            precision,
            traversal,
            adapter,
            no_passthrough: self.no_passthrough,
            threads,
            around: Some(hush::around),
            several: None,
        })
    }
}

/// `--triangle`.
pub(super) fn check_tests(tests: &[TriangleTest], fast: bool) -> Result<()> {
    if tests.contains(&TriangleTest::Moller) && !fast {
        return Err(Error::new("--triangle moller is for fast precision: add --precision fast, or drop it"));
    }
    Ok(())
}

/// `--triangle` where a CPU was asked for, whose numbers are exact.
pub(super) fn check_processor(tests: &[TriangleTest], device: DeviceWish) -> Result<()> {
    if tests.contains(&TriangleTest::Moller) && device == DeviceWish::Cpu {
        return Err(Error::new("--triangle moller is for GPUs: drop it, or --device cpu"));
    }
    Ok(())
}

/// `--stack-max` and `--cut`.
pub(super) fn tuning(stack_max: u32, cut: u32) -> Result<Tuning> {
    within("--stack-max", &[stack_max], 1..=63)?;
    within("--cut", &[cut], 0..=100)?;
    Ok(Tuning::new(stack_max, cut))
}
