//! Many plants of a few kinds over hills (thesis 4.1): far more triangles than are held in memory.

mod model;
mod plant;

use std::io::{self, Write};

use glam::DVec3;

use super::COMMAND;
use super::circle::turn;
use super::files::Pair;
use super::random::{Random, rough};
use crate::error::{Result, within};
use model::{Model, Places};
use plant::{Part, Plant};

/// Plants of 68 kinds. The same number and seed give the same bytes on every machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ecosystem {
    /// How many, from [`Ecosystem::LEAST`] to [`Ecosystem::MOST`].
    pub plants: u64,
    /// Another seed gives others elsewhere.
    pub seed: u64,
}

/// Squares of the ground along an edge.
const SQUARES: usize = 256;

impl Ecosystem {
    /// Kinds of plants.
    pub const KINDS: usize = 68;
    /// The fewest plants: one of a kind.
    pub const LEAST: u64 = Ecosystem::KINDS as u64;
    /// The most plants: a file of them stays below the size that is read.
    pub const MOST: u64 = 20_000_000;

    fn comment(self) -> String {
        format!("{COMMAND} ecosystem --plants {} --seed {}", self.plants, self.seed)
    }

    /// Refuses a number of plants out of range.
    ///
    /// # Errors
    /// One that names the range.
    pub fn check(self) -> Result<()> {
        within("--plants", &[self.plants], Ecosystem::LEAST..=Ecosystem::MOST)
    }

    /// Writes the plants and the scene: both whole or, but for a fault of the folder in the last instant, none. Returns how many
    /// triangles are seen.
    ///
    /// # Errors
    /// [`Ecosystem::check`]'s, a file that cannot be written or that a person made, or a full disk.
    pub fn write(self, files: &Pair) -> Result<u64> {
        self.check()?;
        files.check_writable()?;
        let comment = self.comment();
        let kinds: Vec<Plant> = (0..Ecosystem::KINDS).map(|kind| self.kind(kind)).collect();
        let places = self.places();
        let of_plants = kinds.iter().zip(&places).map(|(plant, places)| plant.triangles() * places.scales.len());
        let triangles = (of_plants.sum::<usize>() + 2 * SQUARES * SQUARES) as u64;
        let write_model = |out: &mut dyn Write| -> io::Result<()> {
            let mut model = Model::default();
            model.ground(&self.ground());
            for (kind, (plant, places)) in kinds.iter().zip(&places).enumerate() {
                model.plants(kind, plant, places);
            }
            model.write(&comment, out)
        };
        files.write(&write_model, &|out| self.scene(files.list_name(), out)).map(|()| triangles)
    }

    fn kind(self, kind: usize) -> Plant {
        Plant::new(kind, &mut Random::new(self.seed.wrapping_mul(1_000).wrapping_add(kind as u64)))
    }

    /// The ground's edge in metres: a plant has a square metre.
    fn edge(self) -> f64 {
        (self.plants as f64).sqrt()
    }

    fn height(self, x: f64, z: f64) -> f64 {
        let hills = rough(self.seed, DVec3::new(x / 120.0, 0.0, z / 120.0)) * 18.0;
        hills.min(0.06 * self.edge()).max(-0.06 * self.edge())
    }

    fn ground(self) -> Part {
        let half = self.edge() / 2.0;
        let mut ground = Part { colour: [0.10, 0.08, 0.05], ..Part::default() };
        let across = |step: usize| (step as f64 / SQUARES as f64 * 2.0 - 1.0) * half;
        for row in 0..=SQUARES {
            for column in 0..=SQUARES {
                let (x, z) = (across(column), across(row));
                ground.positions.push(DVec3::new(x, self.height(x, z), z).as_vec3());
            }
        }
        for row in 0..SQUARES {
            for column in 0..SQUARES {
                let at = (row * (SQUARES + 1) + column) as u32;
                let below = at + SQUARES as u32 + 1;
                ground.triangles.extend([[at, below, below + 1], [at, below + 1, at + 1]]);
            }
        }
        ground
    }

    /// Where each kind stands: kinds come in patches, each plant turned and of its own size.
    fn places(self) -> Vec<Places> {
        let mut all: Vec<Places> = (0..Ecosystem::KINDS).map(|_| Places::default()).collect();
        let mut random = Random::new(self.seed);
        let half = self.edge() / 2.0;
        for plant in 0..self.plants {
            let (x, z) = (random.within(-half, half), random.within(-half, half));
            // One of each, and then by what grows there.
            let kinds = Ecosystem::KINDS as f64;
            let patch = (rough(self.seed ^ 77, DVec3::new(x / 40.0, 3.0, z / 40.0)) + 1.0) * kinds;
            let any = (patch + random.within(0.0, 9.0)) as usize;
            let kind = if plant < Ecosystem::LEAST { plant as usize } else { any % Ecosystem::KINDS };
            let places = &mut all[kind];
            let (cosine, sine) = turn(random.unit() / 2.0);
            let size = random.within(0.5, 1.5) * (0.6 + kind as f64 / kinds);
            let y = self.height(x, z) - 0.02;
            places.translations.push([x, y, z].map(|c| c as f32));
            places.rotations.push([0.0, sine as f32, 0.0, cosine as f32]);
            places.scales.push([size as f32; 3]);
        }
        all
    }

    /// A sun in a pale sky, and views from above, from a hill and from among the plants.
    fn scene(self, model: &str, out: &mut dyn Write) -> io::Result<()> {
        let (edge, above) = (self.edge(), self.height(0.0, 0.0));
        writeln!(out, "# {}\n", self.comment())?;
        writeln!(out, "[render]\nsize = [1920, 1080]\nspp = 16\nbounces = 3\nintegrator = \"path\"")?;
        writeln!(out, "\n[background]\nhorizon = [0.80, 0.86, 0.92]\nzenith = [0.30, 0.48, 0.78]")?;
        writeln!(out, "\n[[light]]\nkind = \"directional\"\ndirection = [-0.5, -0.7, -0.4]\ncolor = [2.6, 2.4, 2.0]")?;
        let reach = 0.5 * edge;
        let views = [
            ("above", [0.0, 0.45 * edge + above, 0.62 * edge], [0.0, above, 0.0], 45.0),
            ("hill", [0.0, self.height(0.0, 0.45 * edge) + 9.0, 0.45 * edge], [0.0, above, 0.45 * edge - reach], 50.0),
            ("among", [2.0, self.height(2.0, 2.0) + 1.7, 2.0], [-8.0, self.height(-8.0, -12.0) + 0.6, -12.0], 60.0),
        ];
        for (name, eye, target, fov) in views {
            writeln!(out, "\n[[camera]]\nname = \"{name}\"\neye = {eye:?}\ntarget = {target:?}\nfov = {fov:?}")?;
        }
        writeln!(out, "\n[[mesh]]\nfile = \"{}\"", model.replace('"', "\\\""))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays::scene_io::{self, Instancing, Loading};

    #[test]
    fn the_scene_holds_every_plant_and_a_mesh_each_kind() {
        let place = tempfile::tempdir().unwrap();
        let pair = Pair::of("glb", &place.path().join("plants.toml")).unwrap();
        let ecosystem = Ecosystem { plants: 300, seed: 3 };
        let triangles = ecosystem.write(&pair).unwrap();
        let loading = Loading { instancing: Instancing::Always, ..Loading::default() };
        let (scene, warnings) = scene_io::load_as(pair.paths()[0], loading).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!((scene.primitives(), scene.cameras.len()), (triangles, 3));
        // A kind of which one plant stands has no instance.
        let (kinds, instances) = (scene.shared.len(), scene.instances.len());
        assert!((1..=Ecosystem::KINDS).contains(&kinds) && (200..=300).contains(&instances), "{instances} of {kinds}");
        for camera in &scene.cameras {
            let height = ecosystem.height(camera.eye.x.into(), camera.eye.z.into());
            assert!(f64::from(camera.eye.y) > height + 1.0, "{} is above the ground", camera.name);
        }
        for plants in [0, Ecosystem::MOST + 1] {
            assert!(Ecosystem { plants, seed: 1 }.check().unwrap_err().to_string().contains("68 to 20000000"));
        }
    }
}
