//! `eyerays generate`.

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};

use super::{console, plural};
use crate::error::{Error, Result};
use crate::generate::{Ecosystem, Files, Kind, Pair, Recipe, Spheres};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays generate hall --triangles 300000 -o hall.obj
  eyerays render hall.toml --camera view1 -o hall.png
  eyerays generate forest --triangles 75000 --seed 7 -o scenes/forest.obj
  eyerays generate spheres --count 1000000 -o flake.toml
  eyerays generate ecosystem --plants 365000 -o plants.toml
Writes FILE.obj, its materials to FILE.mtl, and to FILE.toml a scene with lights and the cameras view1 to view5.
Spheres go to FILE.xyzr, with such a scene in FILE.toml; plants to FILE.glb, a mesh each of 68 kinds and where it stands.
The same kind, number and seed give the same bytes on every machine.";

#[derive(Args)]
pub(super) struct Generate {
    /// What to make
    #[arg(value_enum)]
    kind: What,
    /// Exactly so many triangles, 6000 to 20000000
    #[arg(long, value_name = "N", required_unless_present_any = ["count", "plants"])]
    triangles: Option<u64>,
    /// Exactly so many spheres, 1 to 20000000; of spheres, instead of --triangles
    #[arg(long, value_name = "N", conflicts_with_all = ["triangles", "seed"])]
    count: Option<u64>,
    /// So many plants, 68 to 20000000, each of some 4200 triangles; of an ecosystem, instead of --triangles
    #[arg(long, value_name = "N", conflicts_with_all = ["triangles", "count"])]
    plants: Option<u64>,
    /// Another seed gives another scene of the kind [default: 1]
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// The mesh, .obj; an .mtl and a .toml of the same name come beside it. Of spheres, the scene, .toml; an .xyzr comes
    /// beside it; of plants, a .glb [default: KIND.obj, spheres.toml or ecosystem.toml here]
    #[arg(short, long, value_name = "FILE")]
    output: Option<OsString>,
}

#[derive(Clone, Copy)]
enum What {
    Mesh(Kind),
    Spheres,
    Ecosystem,
}

impl ValueEnum for What {
    fn value_variants<'a>() -> &'a [Self] {
        &[What::Mesh(Kind::Hall), What::Mesh(Kind::Forest), What::Mesh(Kind::Cathedral), What::Spheres, What::Ecosystem]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            What::Mesh(kind) => kind.to_possible_value(),
            What::Spheres => Some(PossibleValue::new("spheres").help("Haines' sphere flake over a disk")),
            What::Ecosystem => Some(
                PossibleValue::new("ecosystem").help("Plants over hills, far more of them than memory holds apart"),
            ),
        }
    }
}

impl Generate {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        match (self.kind, self.triangles, self.count, self.plants) {
            (What::Mesh(kind), Some(triangles), None, None) => self.mesh(kind, triangles, quiet)?,
            (What::Spheres, None, Some(count), None) => self.spheres(count, quiet)?,
            (What::Ecosystem, None, None, Some(plants)) => self.ecosystem(plants, quiet)?,
            (What::Mesh(_), ..) => return Err(Error::new("--count and --plants are of others: give --triangles")),
            (What::Spheres, ..) => return Err(Error::new("--triangles and --plants are of others: give --count")),
            (What::Ecosystem, ..) => return Err(Error::new("--triangles and --count are of others: give --plants")),
        }
        Ok(ExitCode::SUCCESS)
    }

    fn mesh(&self, kind: Kind, triangles: u64, quiet: bool) -> Result<()> {
        let seed = self.seed.unwrap_or(1);
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
        Ok(())
    }

    fn spheres(&self, count: u64, quiet: bool) -> Result<()> {
        let spheres = Spheres { count };
        spheres.check()?;
        let files = Pair::beside(Path::new(self.output.as_deref().unwrap_or("spheres.toml".as_ref())))?;
        spheres.write(&files)?;
        if !quiet {
            let [scene, list] = files.paths().map(|path| path.display());
            console::say(format_args!("{scene}, {list}: flake of {}", plural(count as usize, "sphere")));
        }
        Ok(())
    }

    fn ecosystem(&self, plants: u64, quiet: bool) -> Result<()> {
        let seed = self.seed.unwrap_or(1);
        let ecosystem = Ecosystem { plants, seed };
        ecosystem.check()?;
        let files = Pair::of("glb", Path::new(self.output.as_deref().unwrap_or("ecosystem.toml".as_ref())))?;
        let triangles = ecosystem.write(&files)?;
        if !quiet {
            let [scene, model] = files.paths().map(|path| path.display());
            let plants = plural(plants as usize, "plant");
            console::say(format_args!("{scene}, {model}: {plants} of {triangles} triangles in all, seed {seed}"));
        }
        Ok(())
    }
}
