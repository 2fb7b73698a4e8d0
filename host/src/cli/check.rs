//! `eyerays check`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use eyerays_bvh::Quality;

use super::console;
use crate::error::{Error, Result};
use crate::pack::Packed;
use crate::scene;

#[derive(Args)]
pub(super) struct Check {
    /// The scene
    scene: PathBuf,
}

impl Check {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let (scene, warnings) = scene::load(&self.scene)?;
        super::warn(&warnings, quiet);
        let named = |e: Error| e.of(&self.scene);
        for camera in &scene.cameras {
            Packed::new(&scene, camera, scene.settings, Quality::Fast).map_err(named)?;
        }
        if !quiet {
            let cameras: Vec<String> = scene.cameras.iter().map(|c| format!("\"{}\"", c.name)).collect();
            console::print_line(format_args!(
                "{}: {}, {}, {}; cameras {}",
                self.scene.display(),
                count(scene.mesh.triangles.len(), "triangle"),
                count(scene.materials.len(), "material"),
                count(scene.lights.len(), "light"),
                cameras.join(", ")
            ))?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn count(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}
