//! `eyerays info`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use eyerays_bvh::{Quality, Statistics};
use serde_json::json;

use super::console;
use crate::error::Result;
use crate::gpu::{AdapterReport, adapters};
use crate::pack::Packed;
use crate::scene;

#[derive(Args)]
pub(super) struct Info {
    /// A scene, to tell its hierarchy's figures instead
    scene: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
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
        let adapters = adapters();
        if self.json {
            return console::print_json(&json!({ "adapters": adapters }));
        }
        if adapters.is_empty() {
            return console::print("no GPU that Vulkan, Metal or Direct3D 12 can use: renderings run on the CPU\n");
        }
        adapters.iter().try_for_each(|a| console::print(&describe(a)))
    }

    /// The thesis' table 7.1, for every quality of the hierarchy, with its cost and memory.
    fn scene(&self, path: &Path, quiet: bool) -> Result<()> {
        let (scene, warnings) = scene::load(path)?;
        super::warn(&warnings, quiet || self.json);
        let mut rows = Vec::new();
        for (name, quality) in [("fast", Quality::Fast), ("medium", Quality::Medium), ("high", Quality::High)] {
            let packed = Packed::new(&scene, &scene.cameras[0], scene.settings, quality)?;
            rows.push((name, packed.statistics, packed.build_time));
        }
        if self.json {
            let rows: Vec<_> = rows
                .iter()
                .map(|(name, s, time)| {
                    json!({
                        "bvh": name, "triangles": s.triangles, "nodes": s.nodes, "leaves": s.leaves,
                        "depth": s.depth, "sah_cost": s.sah_cost, "node_bytes": s.node_bytes,
                        "triangle_bytes": s.triangle_bytes, "build_ms": time.as_secs_f64() * 1e3,
                    })
                })
                .collect();
            return console::print_json(&json!({ "scene": path.display().to_string(), "hierarchies": rows }));
        }
        let mut text = "BVH     triangles     nodes    leaves  depth  SAH cost    memory     build\n".to_owned();
        for (name, statistics, time) in &rows {
            text += &row(name, statistics, time.as_secs_f64());
        }
        console::print(&text)
    }
}

fn row(name: &str, s: &Statistics, seconds: f64) -> String {
    format!(
        "{name:<6}{:>11}{:>10}{:>10}{:>7}{:>10.1}{:>7.1} MB{:>7.1} ms\n",
        s.triangles,
        s.nodes,
        s.leaves,
        s.depth,
        s.sah_cost,
        (s.node_bytes + s.triangle_bytes) as f64 / 1e6,
        seconds * 1e3
    )
}

fn describe(a: &AdapterReport) -> String {
    let lanes = match a.subgroup {
        (least, most) if least == most => format!("{least}"),
        (least, most) => format!("{least} to {most}"),
    };
    let precisions = if a.exact { "exact and fast" } else { "fast" };
    format!(
        "{} \"{}\" ({}, {})\n  driver             {}\n  precisions         {precisions}\n  SPIR-V passthrough {}\n  \
         subgroup           {lanes} lanes\n  largest buffer     {} bytes, {} in a kernel\n  timestamps         {}\n",
        a.index,
        a.name,
        a.kind,
        a.backend,
        a.driver,
        yes(a.passthrough),
        a.max_buffer,
        a.max_binding,
        yes(a.timestamps)
    )
}

fn yes(x: bool) -> &'static str {
    if x { "yes" } else { "no" }
}
