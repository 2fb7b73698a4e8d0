//! `eyerays generate`.

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use clap::Args;

use super::console;
use crate::error::Result;
use crate::generate::{Files, Kind, Recipe};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays generate hall --triangles 300000 -o hall.obj
  eyerays render hall.toml --camera view1 -o hall.png
  eyerays generate forest --triangles 75000 --seed 7 -o scenes/forest.obj
Writes FILE.obj, its materials to FILE.mtl, and to FILE.toml a scene with lights and the cameras view1 to view5.
The same kind, triangles and seed give the same bytes on every machine.";

#[derive(Args)]
pub(super) struct Generate {
    /// What to make
    #[arg(value_enum)]
    kind: Kind,
    /// Exactly so many triangles, 6000 to 20000000
    #[arg(long, value_name = "N")]
    triangles: u64,
    /// Another seed gives another scene of the kind
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// The mesh, .obj; an .mtl and a .toml of the same name come beside it [default: KIND.obj here]
    #[arg(short, long, value_name = "FILE")]
    output: Option<OsString>,
}

impl Generate {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let Generate { kind, triangles, seed, .. } = *self;
        let recipe = Recipe { kind, triangles, seed };
        recipe.check()?;
        let output = self.output.clone().unwrap_or_else(|| format!("{}.obj", kind.name()).into());
        let files = Files::beside(Path::new(&output))?;
        recipe.write(&files)?;
        if !quiet {
            let [mesh, materials, scene] = files.paths().map(|path| path.display());
            let name = kind.name();
            console::say(format_args!("{mesh}, {materials}, {scene}: {name} of {triangles} triangles, seed {seed}"));
        }
        Ok(ExitCode::SUCCESS)
    }
}
