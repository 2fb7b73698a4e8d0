//! The camera's ray of a slot, as it lies in memory for integrators that sample.

use super::PathState;
use crate::camera;
use crate::data::{Frame, Launch, Specialisation};
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};

/// Starts a slot's path: with the camera's ray, brought near where the camera is far from the scene. The ray of a slot outside
/// the region meets nothing. `cells` are those of a launch over cells.
#[inline(always)]
pub fn generate<R: Scalar>(frame: &Frame, spec: Specialisation, cells: &[u32], slot: u32, paths: &mut [R::Record]) {
    let pixel = camera::pixel(frame, spec.order, slot);
    let pixel = if spec.launch.has(Launch::CELLS) { camera::in_cell(frame, cells, pixel) } else { pixel };
    let (origin, direction) = camera::ray(frame, spec.launch, pixel);
    let near = Ray::from_afar(origin, direction);
    let path = PathState {
        origin: near.origin,
        direction,
        source_primitive: Hit::<R>::NOTHING,
        weight: V3::splat(glam::Vec3::ONE),
        bounces: 0,
        density: R::splat(0.0),
        beside: (R::splat(0.0), R::splat(0.0)),
        pixel: (frame.left + pixel.x) | ((frame.top + pixel.y) << 16),
    };
    path.store(frame.slots, slot, 0, pixel.inside, paths);
}
