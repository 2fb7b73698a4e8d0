//! `eyerays check`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use eyerays_bvh::Quality;

use super::outline::Outline;
use super::reading::{Read, Reading};
use super::{console, plural, progress};
use crate::error::{Error, Result};
use eyerays::job::Job;
use eyerays::scene::Scene;
use eyerays::view::View;

#[derive(Args)]
pub(super) struct Check {
    /// The scene; - reads a TOML scene from standard input
    scene: PathBuf,
    /// Take every warning for an error
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    reading: Reading,
}

impl Check {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let Read { path, scene, warnings, .. } = Read::scene(&self.scene, &[], self.reading.loading(None), quiet)?;
        let named = |e: eyerays::error::Error| e.of(path);
        let quality = scene.hierarchy.as_ref().map_or(Quality::Fast, |kept| kept.quality().quality());
        let pack = || Job::new(&scene, scene.settings, quality);
        let packed = progress::stage("building", quiet, pack).map_err(named)?;
        for camera in &scene.cameras {
            View::new(&packed, camera).map_err(named)?;
        }
        if self.strict && warnings > 0 {
            let fault = format!("{} under --strict; mend what they name, or drop it", plural(warnings, "warning"));
            return Err(Error::file(path, fault));
        }
        if !quiet {
            let cameras: Vec<String> = scene.cameras.iter().map(|c| format!("\"{}\"", c.name)).collect();
            console::print_line(format_args!(
                "{}: {}, {}, {}; cameras {}",
                path.display(),
                primitives(&scene),
                plural(scene.materials.len(), "material"),
                plural(scene.lights.len(), "light"),
                cameras.join(", ")
            ))?;
            console::print(&Outline::of(&scene).to_string())?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// How many there are of every kind of primitive that the scene has.
fn primitives(scene: &Scene) -> String {
    let triangles = scene.own_triangles() + scene.copied_triangles() as usize;
    let counts = [
        (triangles, "triangle"),
        (scene.spheres.len(), "sphere"),
        (scene.disks.len(), "disk"),
        (scene.instances.len(), "instance"),
    ];
    let there = counts.into_iter().filter(|(count, _)| *count > 0);
    there.map(|(count, noun)| plural(count, noun)).collect::<Vec<_>>().join(", ")
}
