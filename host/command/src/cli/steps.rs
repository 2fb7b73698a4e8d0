//! The steps of a ray as text.

use std::fmt::{self, Display, Formatter};
use std::path::Path;

use crate::error::printable;
use eyerays::pick::Pick;
use eyerays::scene::Camera;
use eyerays::trail::{Aim, Trail};

/// What a pixel shows, and the steps of its ray by some methods.
pub(super) struct Told<'a> {
    pub path: &'a Path,
    pub size: (u32, u32),
    pub aim: Aim,
    pub camera: &'a Camera,
    /// What kernels multiply lengths by.
    pub scale: f64,
    pub pick: Option<&'a Pick>,
    pub trails: &'a [Trail],
}

impl Display for Told<'_> {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let (Aim { x, y, sample }, (width, height)) = (self.aim, self.size);
        let through = sample.map_or_else(|| "the middle".to_owned(), |sample| format!("sample {sample}"));
        let (scene, camera) = (self.path.display().to_string(), printable(&self.camera.name));
        writeln!(out, "{}: {through} of pixel {x},{y} of {width}x{height}, camera \"{camera}\"", printable(&scene))?;
        match self.pick {
            Some(pick) => write!(out, "{pick}")?,
            None => writeln!(out, "sees nothing")?,
        }
        writeln!(out, "  kernels   have lengths times {}", self.scale)?;
        self.trails.iter().try_for_each(|trail| write!(out, "\n{trail}"))
    }
}
