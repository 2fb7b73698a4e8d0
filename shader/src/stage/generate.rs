//! The camera's ray of a slot, as it lies in memory for integrators that sample.

use super::PathState;
use crate::camera;
use crate::data::{Frame, Specialisation};
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};

/// Starts a slot's path: with the camera's ray, brought near where the camera is far from the scene. The ray of a slot outside
/// the region meets nothing.
#[inline(always)]
pub fn generate<R: Scalar>(frame: &Frame, spec: Specialisation, slot: u32, paths: &mut [R::Record]) {
    let pixel = camera::pixel(frame, spec.order, slot);
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
