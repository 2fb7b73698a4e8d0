//! `eyerays info`.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;
use std::time::Instant;

use clap::Args;
use eyerays_bvh::Statistics;
use serde_json::{Value, json};

use super::choice::choice;
use super::footprint::Footprint;
use super::hush::Hush;
use super::outline::Outline;
use super::reading::{Read, Reading};
use super::{console, progress};
use crate::error::Result;
use eyerays::gpu::{AdapterReport, Cost, adapters};
use eyerays::job::Job;
use eyerays::method::Traversal;
use eyerays::quality::Bvh;

#[derive(Args)]
pub(super) struct Info {
    /// A scene, to tell where its meshes are, its hierarchy's figures and what a GPU runs for it instead; - is a TOML scene from
    /// standard input
    scene: Option<PathBuf>,
    /// Build the hierarchy in this quality only [default: each in turn]
    #[arg(long, value_name = "QUALITY", value_parser = choice::<Bvh>(), requires = "scene")]
    bvh: Option<Bvh>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

impl Info {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        match &self.scene {
            Some(path) => self.scene(path, quiet)?,
            None => self.adapters()?,
        }
        Ok(ExitCode::SUCCESS)
    }

    fn adapters(&self) -> Result<()> {
        let adapters = {
            let _hush = Hush::new();
            adapters()
        };
        if self.json {
            return console::print_json(&json!({ "adapters": adapters }));
        }
        if adapters.is_empty() {
            return console::print("no GPU that Vulkan, Metal or Direct3D 12 can use: renderings run on the CPU\n");
        }
        adapters.iter().try_for_each(|a| console::print(&describe(a)))
    }

    /// Where the meshes are, and the thesis' table 7.1 for every quality of the hierarchy, with its cost and memory.
    fn scene(&self, path: &Path, quiet: bool) -> Result<()> {
        let read = Read::scene(path, &[], self.reading.loading(None), quiet)?;
        let (path, scene) = (read.path, read.unbuilt());
        let outline = Outline::of(&scene);
        let (mut rows, mut cost) = (Vec::new(), None);
        let qualities = self.bvh.as_ref().map_or(&Bvh::OF_HOST[..], std::slice::from_ref);
        for bvh in qualities {
            let pack = || Job::new(&scene, scene.settings, bvh.quality());
            let packed = progress::stage("building", quiet, pack).map_err(|e| e.of(path))?;
            // What a device builds is built here to be told of.
            let (start, statistics) = (Instant::now(), *packed.statistics());
            let build_time = packed.build_time() + start.elapsed();
            let row = Row { bvh: bvh.to_string(), statistics, build_time };
            if !self.json && rows.is_empty() {
                console::print(&format!("{outline}{HEAD}"))?;
            }
            if !self.json {
                console::print(&row.to_string())?;
            }
            rows.push(row.json());
            // The kernels are the same for all, and cutting them takes time.
            if Some(bvh) == qualities.last() {
                let paid = Cost::of(&packed, true, Traversal::default());
                cost = Some((paid, Footprint::of(&scene, &packed)));
            }
        }
        let (cost, footprint) = cost.expect("one quality at least");
        if !self.json {
            return console::print(&format!("{footprint}{}", paid(&cost)));
        }
        let mut json = outline.json();
        json["scene"] = path.display().to_string().into();
        json["hierarchies"] = rows.into();
        json["host"] = footprint.json();
        json["gpu"] = json!({
            "kernels": cost.kernels,
            "scene_bytes": cost.scene.iter().copied().collect::<BTreeMap<_, _>>(),
            "sample_bytes": cost.sample.iter().copied().collect::<BTreeMap<_, _>>(),
            "pixel_bytes": cost.pixel,
        });
        console::print_json(&json)
    }
}

/// What a GPU runs and holds for the scene, in exact precision by the methods of `auto`.
fn paid(cost: &Cost) -> String {
    let mut text = "kernel of a GPU                        instructions  buffers\n".to_owned();
    for kernel in &cost.kernels {
        let name = if kernel.further { format!("+ {}", kernel.name) } else { kernel.name.clone() };
        text += &format!("{name:<38} {:>12}  {}\n", kernel.instructions, kernel.buffers.join(", "));
    }
    let sum = |buffers: &[(&str, u64)]| {
        let list: Vec<String> = buffers.iter().map(|(name, bytes)| format!("{name} {bytes}")).collect();
        list.join(", ")
    };
    text += "+ runs for reflected and refracted rays, once for each wave of them\n";
    text += &format!("bytes of the scene: {}\n", sum(&cost.scene));
    text + &format!("bytes of a sample in flight: {}; of a pixel: picture {}\n", sum(&cost.sample), cost.pixel)
}

const HEAD: &str = "BVH     primitives      nodes     leaves  depth  SAH cost       memory          build\n";

/// A hierarchy's figures.
struct Row {
    bvh: String,
    statistics: Statistics,
    build_time: Duration,
}

impl Row {
    fn json(&self) -> Value {
        let s = &self.statistics;
        json!({
            "bvh": self.bvh, "primitives": s.primitives, "nodes": s.nodes, "leaves": s.leaves,
            "depth": s.depth, "sah_cost": s.sah_cost, "node_bytes": s.node_bytes,
            "primitive_bytes": s.primitive_bytes, "build_ms": self.build_time.as_secs_f64() * 1e3,
        })
    }
}

impl fmt::Display for Row {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = &self.statistics;
        let megabytes = (s.node_bytes + s.primitive_bytes) as f64 / 1e6;
        let milliseconds = self.build_time.as_secs_f64() * 1e3;
        write!(out, "{:<6} {:>11} {:>10} {:>10} {:>6}", self.bvh, s.primitives, s.nodes, s.leaves, s.depth)?;
        writeln!(out, " {:>9.1} {megabytes:>9.1} MB {milliseconds:>11.1} ms", s.sah_cost)
    }
}

fn describe(a: &AdapterReport) -> String {
    let lanes = match a.subgroup {
        (least, most) if least == most => format!("{least}"),
        (least, most) => format!("{least} to {most}"),
    };
    let precisions = if a.exact { "exact and fast" } else { "fast" };
    format!(
        "{} \"{}\" ({}, {})\n  driver             {}\n  precisions         {precisions}\n  SPIR-V passthrough {}\n  \
         subgroup           {lanes} lanes\n  memory             {}\n  largest buffer     {} bytes, {} in a kernel\n  timestamps         {}\n",
        a.index,
        a.name,
        a.kind,
        a.backend,
        a.driver,
        yes(a.passthrough),
        a.memory.map_or("unknown".into(), |bytes| format!("{bytes} bytes")),
        a.max_buffer,
        a.max_binding,
        yes(a.timestamps)
    )
}

fn yes(x: bool) -> &'static str {
    if x { "yes" } else { "no" }
}
