//! Scenes to measure with, made on the spot: a hall, a forest and a cathedral of any number of triangles, and a flake of any
//! number of spheres, and plants over hills.
//!
//! The first three stand in for Conference, Fairy Forest and Sibenik, which are not ours to ship. The same kind, number and
//! seed give the same bytes on every machine, since nothing but `+ - * /` and the square root makes them.

mod cathedral;
mod circle;
mod document;
mod ecosystem;
mod files;
mod flake;
mod forest;
mod frame;
mod hall;
mod model;
mod obj;
mod patch;
mod random;
mod shape;
mod spheres;

#[cfg(test)]
mod tests;

pub use ecosystem::Ecosystem;
pub use files::{Files, Pair};
pub use spheres::Spheres;

use std::io::Write;

use clap::ValueEnum;

use crate::error::{Error, Result, within};
use crate::output::write_error;
use model::Model;

/// Which scene to make.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// A closed room of regular furniture, as Conference
    Hall,
    /// An open clearing around one detailed figure, as Fairy Forest
    Forest,
    /// A nave of columns, arches and vaults, as Sibenik
    Cathedral,
}

/// What makes a scene what it is: the same recipe gives the same files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Recipe {
    /// Which scene.
    pub kind: Kind,
    /// Exactly so many, from [`Kind::LEAST`] to [`Kind::MOST`].
    pub triangles: u64,
    /// Another seed gives another scene of the kind.
    pub seed: u64,
}

impl Kind {
    /// The fewest triangles. Below about 16000 smaller things are left out.
    pub const LEAST: u64 = 6_000;
    /// The most triangles: an OBJ of them stays below the size that is read.
    pub const MOST: u64 = 20_000_000;

    /// As the command line calls it.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Hall => "hall",
            Kind::Forest => "forest",
            Kind::Cathedral => "cathedral",
        }
    }

    /// What is cut into so many triangles; of few, the least of its pieces are left out.
    fn model(self, triangles: u64, seed: u64) -> Model {
        let (mut model, least): (Model, &[&str]) = match self {
            Kind::Hall => (hall::model(seed), &hall::LEAST),
            Kind::Forest => (forest::model(seed), &forest::LEAST),
            Kind::Cathedral => (cathedral::model(seed), &cathedral::LEAST),
        };
        model.fit(triangles, least);
        model
    }
}

impl Recipe {
    /// The comment that begins every file of it.
    fn comment(&self) -> String {
        let Recipe { kind, triangles, seed } = self;
        format!("# {COMMAND} {} --triangles {triangles} --seed {seed}\n", kind.name())
    }

    /// Refuses a number of triangles out of range.
    ///
    /// # Errors
    /// One that names the range.
    pub fn check(&self) -> Result<()> {
        within("--triangles", &[self.triangles], Kind::LEAST..=Kind::MOST)
    }

    /// Writes the mesh to `files`, and its materials and a scene beside it: all whole or, but for a fault of the
    /// folder in the last instant, none.
    ///
    /// # Errors
    /// [`Recipe::check`]'s, files that are not to be replaced or can not be, or a full disk.
    pub fn write(&self, files: &Files) -> Result<()> {
        self.check()?;
        files.check_writable()?;
        let model = self.kind.model(self.triangles, self.seed);
        let comment = self.comment();
        let head = |out: &mut dyn Write| out.write_all(comment.as_bytes());
        files.write(
            &|out| head(out).and_then(|()| obj::write_mesh(&model, self.triangles, files.materials_name(), out)),
            &|out| head(out).and_then(|()| obj::write_materials(&model, out)),
            &|out| head(out).and_then(|()| document::write_scene(&model, files.mesh_name(), out)),
        )
    }
}

/// What a generated file begins with, as a comment.
const COMMAND: &str = "eyerays generate";

/// An error of a writer.
fn fault(error: std::io::Error) -> Error {
    write_error(&error)
}
