//! The camera's ray of a slot, as it lies in memory.

use super::segment::NOWHERE;
use super::{Path, PathState};
use crate::camera::{self, CameraRay};
use crate::data::{Frame, Launch, Specialisation};
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};

/// Starts a slot's path. The ray of a slot outside the region meets nothing. `cells` are those of a launch over cells, `optics` the
/// tables of cameras that have any.
#[inline(always)]
pub fn generate<R: Scalar>(
    frame: &Frame,
    spec: Specialisation,
    (cells, optics): (&[u32], &[u32]),
    slot: u32,
    paths: &mut [R::Record],
) {
    let pixel = camera::pixel(frame, spec.order, slot);
    let pixel = if spec.launch.has(Launch::CELLS) { camera::in_cell(frame, cells, pixel) } else { pixel };
    let ray = camera::ray(frame, spec.launch, optics, pixel);
    let is_kept = spec.launch.has(Launch::KEPT);
    if is_kept && !spec.launch.has(Launch::CLIPPED) {
        Path::of_camera(ray).store(frame.slots, slot, 0, paths);
        return;
    }
    let CameraRay { origin, direction, weight } = ray;
    // Brought near where the camera is far from the scene; how far it goes is told from there.
    let near = Ray::from_afar(origin, direction);
    let limit = camera::limit(frame, spec.launch, near.origin, direction);
    if is_kept {
        Path::of_camera(CameraRay { origin: near.origin, ..ray }).within(limit).store(frame.slots, slot, 0, paths);
        return;
    }
    let path = PathState {
        origin: near.origin,
        direction,
        source_primitive: Hit::<R>::NOTHING,
        weight: V3::new(weight, weight, weight),
        bounces: 0,
        unlit: 0,
        density: R::splat(0.0),
        beside: (R::splat(0.0), R::splat(0.0)),
        pixel: (frame.left + pixel.x) | ((frame.top + pixel.y) << 16),
    };
    let follows = pixel.inside && !weight.eq(R::splat(0.0));
    let limit = if follows { limit } else { R::splat(NOWHERE) };
    path.store_within(limit, frame.slots, slot, 0, paths);
}
