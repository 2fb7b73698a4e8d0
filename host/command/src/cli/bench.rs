//! `eyerays bench`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::slice;

use clap::{Args, ValueEnum};
use eyerays_shader::data::Tuning;

use super::camera;
use super::choice::choice;
use super::device;
use super::options;
use super::reading::{Read, Reading};
use super::{console, hush, progress, threads};
use crate::bench::rays::MOST_RAYS;
use crate::bench::{self, Kind, Plan, Report, Subject};
use crate::error::{Error, Result};
use crate::output::{self, Destination, write_error};
use eyerays::gpu::{AdapterRequest, Gpu};
use eyerays::method::{Layout, Method, Order, Scheduling, TriangleTest};
use eyerays::picture::Picture;
use eyerays::quality::Bvh;
use eyerays::scene::{Camera, Scene};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays bench scenes/cornell.toml --quick
  eyerays bench hall.toml forest.toml cathedral.toml --precision exact,fast -o tables.md
  eyerays bench hall.toml --kinds primary,ao --methods packet,if-if --device gpu -o hall.csv
Exit code 1 tells that a method failed or gave other answers in exact precision.";

/// Exit code of answers that differ.
const DIFFERENT: u8 = 1;
/// The most pixels: with four ambient occlusion rays each they fill the most rays of a stream.
const MOST_PIXELS: u64 = MOST_RAYS as u64 / bench::rays::AO_RAYS as u64;

#[derive(Args)]
pub(super) struct Bench {
    /// Scenes (.toml), or bare meshes (.obj)
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// The tables, .md, .csv or .json; - is standard output [default: -]
    #[arg(short, long, value_name = "FILE")]
    output: Option<std::ffi::OsString>,
    /// How results are written [default: by the file's extension, else markdown]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// A run of about a minute: 256x256, 3 repetitions, the first view of each scene; other options override it
    #[arg(long)]
    quick: bool,
    /// How often each stream is traced after a warm-up [default: 10]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: Option<u32>,
    #[command(flatten)]
    rays: RayOptions,
    #[command(flatten)]
    ways: Ways,
    #[command(flatten)]
    on: Devices,
    #[command(flatten)]
    reading: Reading,
}

/// Which rays.
#[derive(Args)]
#[command(next_help_heading = "Rays")]
struct RayOptions {
    /// Width and height in pixels; the scenes' own do not count [default: 1024x1024]
    #[arg(long, value_name = "WxH", value_parser = options::size)]
    size: Option<(u32, u32)>,
    /// A view of each scene, by name or number from 0; may be given several times [default: all]
    #[arg(long, value_name = "NAME|INDEX")]
    camera: Vec<String>,
    /// Kinds of rays, for example primary,ao [default: all]
    #[arg(long, value_enum, value_delimiter = ',', hide_default_value = true, default_values_t = Kind::ALL)]
    kinds: Vec<Kind>,
    /// Length of ambient occlusion rays in the scenes' units [default: 20 % of the scene's diagonal]
    #[arg(long, value_name = "LENGTH")]
    ao_length: Option<f64>,
}

/// How they are traced.
#[derive(Args)]
#[command(next_help_heading = "Methods")]
struct Ways {
    /// How rays are followed, for example packet,if-if; auto is the one that it stands for [default: all]
    #[arg(
        long,
        value_parser = choice::<Method>(),
        value_delimiter = ',',
        hide_default_value = true,
        default_values_t = Method::ALL
    )]
    methods: Vec<Method>,
    /// How a GPU's subgroups come by their rays
    #[arg(long, value_parser = choice::<Scheduling>(), value_delimiter = ',', default_values_t = [Scheduling::Auto])]
    scheduling: Vec<Scheduling>,
    /// Which pixels' rays lie beside each other
    #[arg(long, value_parser = choice::<Order>(), value_delimiter = ',', default_values_t = [Order::Tiled])]
    order: Vec<Order>,
    /// How the hierarchy and its triangles lie in memory
    #[arg(long, value_parser = choice::<Layout>(), value_delimiter = ',', default_values_t = [Layout::Gathered])]
    layout: Vec<Layout>,
    /// How a ray is tested against a triangle; moller in fast precision only
    #[arg(
        long,
        value_name = "TEST",
        value_parser = choice::<TriangleTest>(),
        value_delimiter = ',',
        default_values_t = [TriangleTest::Watertight]
    )]
    triangle: Vec<TriangleTest>,
    /// Stack methods: nodes that wait when a packet parts, 1 to 63
    #[arg(long, value_name = "N", default_value_t = Tuning::default().stack_max())]
    stack_max: u32,
    /// Cut methods: percent of a packet that must want a node for it to stay together
    #[arg(long, value_name = "PERCENT", default_value_t = Tuning::default().cut())]
    cut: u32,
    /// Quality of the hierarchy
    #[arg(long, value_name = "QUALITY", value_parser = choice::<Bvh>(), default_value_t = Bvh::Medium)]
    bvh: Bvh,
}

/// On what.
#[derive(Args)]
#[command(next_help_heading = "Device")]
struct Devices {
    /// What is measured [default: both where a hardware GPU works, else the CPU]
    #[arg(long, value_enum)]
    device: Option<Device>,
    /// Precisions of the GPU; the CPU's is exact
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Precision::Exact])]
    precision: Vec<Precision>,
    /// A GPU by its number or a part of its name, as `eyerays info` lists them
    #[arg(long, value_name = "NAME|INDEX")]
    adapter: Option<String>,
    /// CPU threads [default: one a core]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Device {
    /// A GPU, a software one such as lavapipe too
    Gpu,
    /// The CPU
    Cpu,
    /// Both
    Both,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Precision {
    /// The same bits everywhere
    Exact,
    /// The device's own arithmetic
    Fast,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Format {
    /// Tables to read
    Markdown,
    /// A line a measurement
    Csv,
    /// Everything
    Json,
}

impl Bench {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let destination = self.output.clone().map_or(Destination::Stdout, Destination::from);
        let format = self.format(&destination)?;
        if destination.file().is_some() {
            output::check_apart(slice::from_ref(&destination), &self.scenes)?;
            output::check_writable(&destination)?;
        }
        let plan = self.plan()?;
        let subjects = self.subjects(slice::from_ref(&destination), quiet)?;
        let progress = progress::steps(bench::streams(&plan, &subjects), quiet);
        let report = bench::run(&plan, &subjects, &|stream| console::step(&progress, stream));
        progress.finish_and_clear();
        let report = report?;
        let text = text(&report, format)?;
        match &destination {
            Destination::Stdout => console::print(&text)?,
            file => file.write(|out| out.write_all(text.as_bytes()).map_err(|e| write_error(&e)))?,
        }
        for note in report.notes.iter().filter(|_| !quiet) {
            console::say(format_args!("note: {note}"));
        }
        for fault in &report.faults {
            console::say(format_args!("error: {fault}"));
        }
        Ok(if report.faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(DIFFERENT) })
    }

    fn format(&self, destination: &Destination) -> Result<Format> {
        let Destination::File(path) = destination else { return Ok(self.format.unwrap_or(Format::Markdown)) };
        if let Some(format) = self.format {
            return Ok(format);
        }
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("md") => Ok(Format::Markdown),
            Some("csv") => Ok(Format::Csv),
            Some("json") => Ok(Format::Json),
            _ => Err(Error::file(path, "unknown kind of table; name a .md, .csv or .json file, or add --format")),
        }
    }

    fn plan(&self) -> Result<Plan> {
        let size = self.rays.size.unwrap_or(if self.quick { (256, 256) } else { (1024, 1024) });
        Picture::check_size(size.0, size.1)?;
        if u64::from(size.0) * u64::from(size.1) > MOST_PIXELS {
            let (width, height) = size;
            return Err(Error::new(format!("--size {width}x{height} has more than {MOST_PIXELS} pixels: choose less")));
        }
        if self.rays.ao_length.is_some_and(|length| !(length > 0.0 && length.is_finite())) {
            return Err(Error::new("--ao-length is no finite number above 0"));
        }
        let (ways, on) = (&self.ways, &self.on);
        device::check_tests(&ways.triangle, on.precision.contains(&Precision::Fast))?;
        let mut kinds = self.rays.kinds.clone();
        kinds.sort_unstable();
        kinds.dedup();
        Ok(Plan {
            kinds,
            methods: ways.methods.clone(),
            schedulings: ways.scheduling.clone(),
            orders: unique(&ways.order),
            layouts: unique(&ways.layout),
            triangles: unique(&ways.triangle),
            tuning: device::tuning(ways.stack_max, ways.cut)?,
            exact: on.precision.contains(&Precision::Exact),
            fast: on.precision.contains(&Precision::Fast),
            threads: threads::chosen(on.threads)?,
            size,
            repeat: self.repeat.unwrap_or(if self.quick { 3 } else { 10 }),
            ao_length: self.rays.ao_length,
            quality: ways.bvh.quality(),
            cpu: on.device != Some(Device::Gpu),
            gpu: on.gpu()?,
        })
    }

    /// Every scene, before any is measured, with the cameras that are asked for.
    fn subjects(&self, outputs: &[Destination], quiet: bool) -> Result<Vec<Subject>> {
        let mut subjects: Vec<Subject> = Vec::new();
        for path in &self.scenes {
            let scene = Read::scene(path, outputs, self.reading.flat()?, quiet)?.unbuilt();
            let cameras = self.cameras(&scene).map_err(|e| e.of(path))?;
            subjects.push(Subject { name: self.name(path), file: path.clone(), scene, cameras });
        }
        Ok(subjects)
    }

    fn cameras(&self, scene: &Scene) -> Result<Vec<Camera>> {
        let all = if self.quick { &scene.cameras[..1] } else { &scene.cameras[..] };
        if self.rays.camera.is_empty() {
            return Ok(all.to_vec());
        }
        let mut cameras: Vec<Camera> = Vec::new();
        for wish in &self.rays.camera {
            let camera = camera::pick(&scene.cameras, wish)?;
            if !cameras.contains(camera) {
                cameras.push(camera.clone());
            }
        }
        Ok(cameras)
    }

    /// A scene's name without folder and ending, unless another one has the same.
    fn name(&self, path: &Path) -> String {
        let twins = self.scenes.iter().filter(|other| other.file_stem() == path.file_stem()).count();
        match path.file_stem() {
            Some(stem) if twins == 1 => stem.to_string_lossy().into_owned(),
            _ => path.display().to_string(),
        }
    }
}

impl Devices {
    /// The GPU to measure; none if there is no hardware and nothing was asked for.
    fn gpu(&self) -> Result<Option<Gpu>> {
        if self.device == Some(Device::Cpu) {
            return match self.adapter {
                Some(_) => Err(Error::new("--adapter is for GPUs: drop it, or --device cpu")),
                None => Ok(None),
            };
        }
        let asked = self.device.is_some() || self.adapter.is_some();
        let exact = self.precision.contains(&Precision::Exact);
        let want = AdapterRequest {
            adapter: self.adapter.clone(),
            software: asked,
            naga: false,
            exact,
            around: Some(hush::around),
        };
        match Gpu::open(&want) {
            Ok(gpu) => Ok(Some(gpu)),
            Err(error) if asked => Err(error.into()),
            Err(_) => Ok(None),
        }
    }
}

/// Without what comes again.
fn unique<T: Copy + PartialEq>(all: &[T]) -> Vec<T> {
    let mut once = Vec::new();
    for &one in all {
        if !once.contains(&one) {
            once.push(one);
        }
    }
    once
}

fn text(report: &Report, format: Format) -> Result<String> {
    match format {
        Format::Json => console::json(report),
        Format::Csv => Ok(bench::csv(report)),
        Format::Markdown => Ok(bench::markdown(report)),
    }
}
