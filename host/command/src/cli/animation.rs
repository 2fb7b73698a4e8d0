//! Pictures of an animation: a scene, read again for each of them.

use std::path::Path;

use super::reading::{self, Read, Reading};
use super::sequence::Instant;
use crate::error::{Error, Result};
use eyerays::scene::{Camera, Integrator, Scene, default_camera};

/// A picture of an animation, or of a scene that stands still.
#[derive(Clone, Copy)]
pub(super) struct Moving<'a> {
    pub instant: Option<Instant>,
    /// That of a scene without one, which sees it as its animation begins: framed anew, each picture would be of another size.
    camera: Option<&'a Camera>,
    /// Warnings are given once.
    is_first: bool,
}

/// The scenes of all pictures of an animation.
pub(super) struct Animation<'a> {
    path: &'a Path,
    reading: &'a Reading,
    integrator: Option<Integrator>,
    camera: Option<Camera>,
}

impl<'a> Animation<'a> {
    /// Of a scene that is seen at some instants.
    ///
    /// # Errors
    /// It can't be read, not more than once, or nothing of it moves.
    pub fn new(
        path: &'a Path,
        (reading, integrator): (&'a Reading, Option<Integrator>),
        instants: &[Option<Instant>],
    ) -> Result<Animation<'a>> {
        let still = Animation { path, reading, integrator, camera: None };
        if instants.iter().all(Option::is_none) {
            return Ok(still);
        }
        if reading::is_standard_input(path) {
            return Err(Error::new("--frames and --frame read a scene for each picture: name its file"));
        }
        let start = Read::scene(path, &[], reading.at(Instant::FIRST).still(integrator), true)?.scene;
        if start.animations.is_empty() {
            let fault = "it has no animation, whose pictures --frames and --frame are; leave them out";
            return Err(Error::file(path, fault));
        }
        Ok(Animation { camera: framed(&start), ..still })
    }

    /// Its pictures.
    pub fn pictures<'s>(&'s self, instants: &'s [Option<Instant>]) -> impl Iterator<Item = Moving<'s>> {
        let first = instants.first().copied();
        instants.iter().map(move |&instant| Moving {
            instant,
            camera: self.camera.as_ref(),
            is_first: Some(instant) == first,
        })
    }

    /// The scene as a picture shows it.
    ///
    /// # Errors
    /// It can't be read.
    pub fn read(&self, moving: Moving<'_>, quiet: bool) -> Result<Read<'a>> {
        let at = moving.instant.map(|instant| self.reading.at(instant));
        let reading = at.as_ref().unwrap_or(self.reading);
        self.read_by(reading, moving.camera, quiet || !moving.is_first)
    }

    fn read_by(&self, reading: &Reading, camera: Option<&Camera>, quiet: bool) -> Result<Read<'a>> {
        let mut read = Read::scene(self.path, &[], reading.loading(self.integrator), quiet)?;
        if let Some(camera) = camera {
            read.scene.cameras = vec![camera.clone()];
        }
        Ok(read)
    }

    /// A scene as the pictures before and after show it; none of one without an animation.
    ///
    /// # Errors
    /// It can't be read again.
    pub fn beside(&self, moving: Moving<'_>, scene: &Scene) -> Result<Option<[Scene; 2]>> {
        if scene.animations.is_empty() {
            return Ok(None);
        }
        if reading::is_standard_input(self.path) {
            return Err(Error::new("the layers motion_back and motion_forward read a scene again: name its file"));
        }
        let own = framed(scene);
        let camera = moving.camera.or(own.as_ref());
        let now = moving.instant.unwrap_or(self.reading.instant());
        let beside = |step: f64| {
            let reading = self.reading.at(now.later(step));
            self.read_by(&reading, camera, true).map(|read| read.scene)
        };
        Ok(Some([beside(-1.0)?, beside(1.0)?]))
    }
}

/// The camera that a scene was given for want of one.
fn framed(scene: &Scene) -> Option<Camera> {
    let (width, height) = scene.settings.size;
    let framed = default_camera(scene, f64::from(width) / f64::from(height));
    framed.filter(|camera| scene.cameras == [camera.clone()])
}
