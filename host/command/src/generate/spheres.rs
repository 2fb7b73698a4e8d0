//! A scene of spheres: their list, and a scene file that shows it.

use std::io::{self, Write};

use glam::DVec3;

use super::files::Pair;
use super::obj::decimal;
use super::{COMMAND, flake};
use crate::error::{Result, within};

/// A coordinate's and a radius' steps a unit: of the smallest radius there are thousands.
const STEPS: f64 = 1e8;

/// A flake of spheres over a ground. The same number gives the same bytes on every machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spheres {
    /// Exactly so many, from [`Spheres::LEAST`] to [`Spheres::MOST`].
    pub count: u64,
}

impl Spheres {
    /// The fewest spheres.
    pub const LEAST: u64 = 1;
    /// The most spheres: a list of them stays below the size that is read.
    pub const MOST: u64 = 20_000_000;

    /// The comment that begins every file of it.
    fn comment(self) -> String {
        format!("# {COMMAND} spheres --count {}\n", self.count)
    }

    /// Refuses a number of spheres out of range.
    ///
    /// # Errors
    /// One that names the range.
    pub fn check(self) -> Result<()> {
        within("--count", &[self.count], Spheres::LEAST..=Spheres::MOST)
    }

    /// Writes the list and the scene: both whole or, but for a fault of the folder in the last instant, none.
    ///
    /// # Errors
    /// [`Spheres::check`]'s, a file that cannot be written or that a person made, or a full disk.
    pub fn write(self, files: &Pair) -> Result<()> {
        self.check()?;
        files.check_writable()?;
        let comment = self.comment();
        files.write(&|out| out.write_all(comment.as_bytes()).and_then(|()| self.list(out)), &|out| {
            out.write_all(comment.as_bytes()).and_then(|()| scene(files.list_name(), out))
        })
    }

    fn list(self, out: &mut dyn Write) -> io::Result<()> {
        let mut text = String::new();
        // The largest sphere stands on the ground.
        for ball in flake::balls(DVec3::Y, 1.0, self.count) {
            for number in ball.center.to_array() {
                decimal(&mut text, number, STEPS);
                text.push(' ');
            }
            decimal(&mut text, ball.radius, STEPS);
            text.push('\n');
            out.write_all(text.as_bytes())?;
            text.clear();
        }
        Ok(())
    }
}

/// Five views as the other generated scenes have: all of it, from above, a side, near a branch, and along the ground.
fn scene(list: &str, out: &mut dyn Write) -> io::Result<()> {
    let scene = include_str!("spheres.toml");
    writeln!(out, "{scene}\n[[mesh]]\nfile = \"{}\"\nmaterial = \"flake\"", list.replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays::scene_io;

    fn write(folder: &std::path::Path, count: u64) -> Pair {
        let pair = Pair::beside(&folder.join("flake.toml")).unwrap();
        Spheres { count }.write(&pair).unwrap();
        pair
    }

    #[test]
    fn the_scene_holds_the_spheres_and_a_disk_to_stand_on() {
        let place = tempfile::tempdir().unwrap();
        for count in [1, 10, 1_000] {
            let pair = write(place.path(), count);
            let (scene, warnings) = scene_io::load(pair.paths()[0]).unwrap();
            assert!(warnings.is_empty(), "{warnings:?}");
            assert_eq!((scene.spheres.len() as u64, scene.disks.len(), scene.mesh.triangles.len()), (count, 1, 0));
            assert_eq!((scene.cameras.len(), scene.lights.len()), (5, 3));
            for (ball, sphere) in flake::balls(DVec3::Y, 1.0, count).zip(&scene.spheres) {
                assert!(ball.center.distance(sphere.center.as_dvec3()) < 1e-6);
                assert!((ball.radius - f64::from(sphere.radius)).abs() < 1e-7);
                assert_ne!(scene.materials[sphere.material as usize].name, "default");
            }
        }
    }

    #[test]
    fn no_view_is_from_inside_a_sphere_or_below_the_ground() {
        let place = tempfile::tempdir().unwrap();
        let (scene, _) = scene_io::load(write(place.path(), 10_000).paths()[0]).unwrap();
        for camera in &scene.cameras {
            let near = scene.spheres.iter().map(|s| s.center.distance(camera.eye) - s.radius).reduce(f32::min).unwrap();
            assert!(near > 0.05 && camera.eye.y > 0.0, "{}: {near}", camera.name);
        }
    }

    #[test]
    fn a_number_out_of_range_and_names_that_are_no_scene_are_refused() {
        for count in [0, Spheres::MOST + 1] {
            assert!(Spheres { count }.check().unwrap_err().to_string().contains("1 to 20000000"));
        }
        for name in ["-", "", "flake", "flake.obj", "a\nb.toml", "a\\b.toml", "..toml"] {
            assert!(Pair::beside(std::path::Path::new(name)).is_err(), "{name:?}");
        }
        assert_eq!(Pair::beside("a.xyzr".as_ref()), Pair::beside("a.toml".as_ref()));
    }
}
