//! The camera's ray of a slot, as it lies in memory.

use super::segment::NOWHERE;
use super::{Found, Path, PathState};
use crate::camera::{self, CameraRay};
use crate::data::{Caustics, Frame, Instance, Launch, Media, Specialisation};
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};

/// What cameras read.
#[derive(Clone, Copy)]
pub struct CameraTables<'a> {
    /// The cells of a launch over cells.
    pub cells: &'a [u32],
    /// Of their filters and lenses.
    pub optics: &'a [u32],
    /// Of those that move their keys, beside copies of meshes.
    pub instances: &'a [Instance],
}

/// Starts a slot's path, and the time of its rays where anything moves. The ray of a slot outside the region meets nothing.
#[inline(always)]
pub fn generate<R: Scalar>(
    frame: &Frame,
    spec: Specialisation,
    CameraTables { cells, optics, instances }: CameraTables<'_>,
    slot: u32,
    (paths, hits): (&mut [R::Record], &mut [R::Record]),
) {
    let pixel = camera::pixel(frame, spec.order, slot);
    let pixel = if spec.launch.has(Launch::CELLS) { camera::in_cell(frame, cells, pixel) } else { pixel };
    let mut ray = camera::ray::<R>(frame, spec.launch, optics, pixel);
    if spec.launch.has(Launch::MOVING | Launch::PANNED) {
        let time = if spec.caustics.has(Caustics::GATHERED) {
            (frame.top + pixel.y) as f32 * frame.row_delay + camera::common_time(frame, spec.launch, pixel.sample)
        } else {
            camera::time(frame, pixel)
        };
        if spec.launch.has(Launch::PANNED) {
            ray = camera::panned(frame, instances, time, ray);
        }
        if spec.launch.has(Launch::MOVING) {
            Found::<R>::start(time, frame.slots, slot, hits);
        }
    }
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
    let follows = pixel.inside && !weight.eq(R::splat(0.0));
    // In a medium the ray of a slot outside must not go on either.
    let weight = if spec.media.has(Media::PRESENT) && !follows { R::splat(0.0) } else { weight };
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
        from: origin,
        inside: frame.inside(),
        gathered: false,
    };
    if spec.media.has(Media::PRESENT) {
        path.store_medium(frame.slots, slot, paths);
    }
    let limit = if follows { limit } else { R::splat(NOWHERE) };
    path.store_within(limit, frame.slots, slot, 0, paths);
}
