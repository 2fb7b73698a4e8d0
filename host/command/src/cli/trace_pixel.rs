//! `eyerays trace-pixel`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use eyerays_shader::data::Tuning;
use serde_json::json;

use super::choice::choice;
use super::device::tuning;
use super::options::{Effort, View};
use super::reading::{Read, Reading};
use super::steps::Told;
use super::{console, threads};
use crate::error::Result;
use eyerays::choice::Named;
use eyerays::job::Job;
use eyerays::method::{Layout, Method, Traversal};
use eyerays::pick::{Names, pick_by};
use eyerays::render::{Choice, DeviceWish};
use eyerays::scene::{Camera, Scene};
use eyerays::trail::{Aim, Trail, follow};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays trace-pixel scenes/cornell.toml 256 400
  eyerays trace-pixel scenes/cornell.toml 256 400 --method if-if
  eyerays trace-pixel model.glb 20 30 --size 64x64 --method all --json
Distances are in the scene's units, from where the camera's ray starts.";

/// The name that stands for every method.
const ALL: &str = "all";

#[derive(Args)]
pub(super) struct TracePixel {
    /// A scene, as of render; - is a TOML scene from standard input
    scene: PathBuf,
    /// The pixel's column, from 0 at the left
    x: i64,
    /// The pixel's row, from 0 at the top
    y: i64,
    /// Follow this sample of the pixel, from 0 [default: the ray through the pixel's middle]
    #[arg(long, value_name = "N")]
    sample: Option<u32>,
    /// How the ray is followed
    #[arg(long, value_parser = methods(), default_value = Method::Auto.name(), hide_default_value = true)]
    method: Methods,
    /// Stack methods: nodes that wait when a packet parts, 1 to 63
    #[arg(long, value_name = "N", default_value_t = Tuning::default().stack_max())]
    stack_max: u32,
    /// Cut methods: percent of a packet that must want a node for it to stay together
    #[arg(long, value_name = "PERCENT", default_value_t = Tuning::default().cut())]
    cut: u32,
    /// How the hierarchy and its triangles lie in memory
    #[arg(long, value_parser = choice::<Layout>(), default_value_t = Layout::Gathered)]
    layout: Layout,
    /// Threads that build the hierarchy [default: one a core]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    view: View,
    #[command(flatten)]
    effort: Effort,
    #[command(flatten)]
    reading: Reading,
}

/// One method, or all.
#[derive(Debug, Clone, Copy)]
enum Methods {
    One(Method),
    All,
}

/// Reads a method by its name, or all of them.
fn methods() -> impl TypedValueParser<Value = Methods> {
    let of = |method: &Method| {
        let help =
            if *method == Method::Auto { "What a CPU takes for the camera's rays [default]" } else { method.help() };
        PossibleValue::new(method.name()).help(help)
    };
    let all = PossibleValue::new(ALL).help("Each of these methods in turn");
    let names = Method::VARIANTS.iter().map(of).chain([all]);
    PossibleValuesParser::new(names).try_map(|name| match name.as_str() {
        ALL => Ok(Methods::All),
        name => Method::from_name(name).map(Methods::One),
    })
}

impl TracePixel {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let traversal =
            Traversal { tuning: tuning(self.stack_max, self.cut)?, layout: self.layout, ..Traversal::default() };
        let threads = threads::chosen(self.threads)?;
        let choice = Choice { device: DeviceWish::Cpu, threads, traversal, ..Choice::default() };
        let read = Read::scene(&self.scene, &[], self.reading.loading(self.effort.integrator()), quiet)?;
        let (path, size) = (read.path, self.view.settings(&read.scene, &self.effort)?.size);
        let aim = Aim { sample: self.sample, ..Aim::within((self.x, self.y), size)? };
        let (loaded, scene, camera) = self.view.pack_and_keep(read, &self.effort, (&choice, None), quiet)?;
        let pick = pick_by(&loaded.packed, &Names::of(&scene), &camera, aim)?;
        let trails = self.trails(&loaded.packed, (&scene, &camera), aim, traversal)?;
        let scale = loaded.packed.normalisation().scale;
        let told = Told { path, size, aim, camera: &camera, scale, pick: pick.as_ref(), trails: &trails };
        if !self.json {
            console::print(&told.to_string())?;
            return Ok(ExitCode::SUCCESS);
        }
        let (width, height) = size;
        console::print_json(&json!({
            "scene": path.display().to_string(),
            "width": width, "height": height,
            "x": aim.x, "y": aim.y, "sample": aim.sample,
            "camera": camera.name,
            "scale": scale,
            "pick": pick,
            "trails": trails.iter().map(trail_json).collect::<Vec<_>>(),
        }))?;
        Ok(ExitCode::SUCCESS)
    }

    fn trails(
        &self,
        job: &Job,
        (scene, camera): (&Scene, &Camera),
        aim: Aim,
        traversal: Traversal,
    ) -> Result<Vec<Trail>> {
        let methods = match self.method {
            Methods::One(method) => vec![method],
            Methods::All => Method::ALL.to_vec(),
        };
        let of = |method| Ok(follow(job, scene, camera, aim, Traversal { method, ..traversal })?);
        methods.into_iter().map(of).collect()
    }
}

/// The steps with their sums before them.
fn trail_json(trail: &Trail) -> serde_json::Value {
    json!({
        "method": trail.method,
        "packet": trail.packet,
        "visits": trail.visits(),
        "tests": trail.tests(),
        "deepest": trail.deepest(),
        "hit": trail.hit,
        "steps": trail.steps,
    })
}
