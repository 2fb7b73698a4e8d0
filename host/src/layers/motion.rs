//! Where what a picture shows was in the picture before, and where it is in the one after.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::surface::{Finder, Place};
use crate::error::{Error, Result};
use crate::picture::Picture;
use crate::scene::{Camera, ObjectNumbers, Scene};
use crate::view::Region;

/// What a picture shows, and what those before and after it do.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    /// What it is of.
    pub scene: &'a Scene,
    /// From where it is seen.
    pub camera: &'a Camera,
    /// The same scene and camera in the pictures before and after, for who asks how things move.
    pub neighbours: Option<[(&'a Scene, &'a Camera); 2]>,
}

impl<'a> Shown<'a> {
    /// A scene that is seen by its first camera, without pictures before and after.
    pub fn of(scene: &'a Scene) -> Self {
        Shown { scene, camera: &scene.cameras[0], neighbours: None }
    }
}

/// The way of what each pixel of a window shows to where it is in another picture of the same scene, in pixels to the right and down. What
/// is infinitely far away moves with the camera alone; what no ray of the other camera leads to has no way, which is zero.
///
/// # Errors
/// The other scene has other objects.
pub(super) fn ways(
    (scene, camera): (&Scene, &Camera),
    (other, turned): (&Scene, &Camera),
    (window, size): (Region, (u32, u32)),
    (positions, places): (&Picture, &[Place]),
) -> Result<Picture> {
    let [own, others] = [scene, other].map(|of| (Finder::of(of), ObjectNumbers::of(of)));
    if own.1.count() != others.1.count() {
        return Err(Error::new("the picture before or after has other objects: its motion can't be told"));
    }
    let way = |i: usize, place: &Place| {
        let at = Vec3::from(positions.pixels[i]).as_dvec3();
        let Some(primitive) = place.primitive else {
            let middle = DVec2::new(
                f64::from(window.x + i as u32 % window.width) + 0.5,
                f64::from(window.y + i as u32 / window.width) + 0.5,
            );
            let far = camera.way_through(middle, size)?;
            return Some(turned.seen_along(far, size)? - camera.seen_along(far, size)?);
        };
        let there = own.1.within(primitive).and_then(|of| others.1.number(of));
        let moved = there.map_or(DVec3::ZERO, |there| own.0.moved((primitive, at), (&others.0, there)));
        Some(turned.seen_at(at + moved, size)? - camera.seen_at(at, size)?)
    };
    let ways = places.par_iter().enumerate().map(|(i, place)| {
        let DVec2 { x, y } = way(i, place).unwrap_or(DVec2::ZERO);
        [x as f32, y as f32, 0.0]
    });
    Picture::from_pixels(positions.width, positions.height, ways.collect())
}
