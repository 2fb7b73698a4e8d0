//! The ray a slot follows, and those it will follow later.

use crate::buffer::{read, write};
use crate::camera::{self, CameraRay};
use crate::data::Launch;
use crate::ray::Hit;
use crate::real::{Real, Scalar, V3};
use crate::scene::LaunchContext;

/// Records a path takes in device memory.
pub const RECORDS: u32 = 3;

/// A ray with its share of the pixel. A slot's memory holds the ray in hand at level 0 and, at the
/// levels above, refracted rays that wait for the reflected ones before them.
#[derive(Clone, Copy)]
pub struct Path<R: Real> {
    /// Where it starts.
    pub origin: V3<R>,
    /// Its unit direction.
    pub direction: V3<R>,
    /// What of its light reaches the pixel, linear RGB.
    pub weight: V3<R>,
    /// How often it was reflected or refracted.
    pub bounces: u32,
    /// Rays that wait in this slot.
    pub pending: u32,
    /// The primitive that it starts on, or [`Hit::NOTHING`].
    pub source_primitive: u32,
}

impl<R: Scalar> Path<R> {
    /// That of a ray of the camera.
    #[inline(always)]
    pub fn of_camera(ray: CameraRay<R>) -> Self {
        let CameraRay { origin, direction, weight } = ray;
        let weight = V3::new(weight, weight, weight);
        Path { origin, direction, weight, bounces: 0, pending: 0, source_primitive: Hit::<R>::NOTHING }
    }

    /// The slot's ray: the camera's in the first wave, which keeps none in memory unless it is [`Launch::KEPT`].
    #[inline(always)]
    pub fn current(launch: &LaunchContext<'_>, slot: u32, paths: &[R::Record]) -> Self {
        if launch.spec.launch.has(Launch::SECONDARY | Launch::KEPT) {
            let path = Self::load(launch.frame.slots, slot, 0, paths);
            let is_of_camera = launch.spec.launch.has(Launch::CLIPPED) && !launch.spec.launch.has(Launch::SECONDARY);
            return if is_of_camera { Path { bounces: 0, ..path } } else { path };
        }
        let pixel = camera::pixel(launch.frame, launch.spec.order, slot);
        Self::of_camera(camera::plain_ray(launch.frame, launch.spec.launch, pixel))
    }

    /// A ray of the camera that goes so far, as it is kept ([`Launch::CLIPPED`]): the limit has the place of its bounces.
    #[inline(always)]
    pub fn within(self, limit: R) -> Self {
        Path { bounces: limit.to_f32().to_bits(), ..self }
    }

    /// How far a slot's ray of the camera goes that was kept so.
    #[inline(always)]
    pub fn limit(slot: u32, paths: &[R::Record]) -> R {
        R::splat(f32::from_bits(R::load(read(paths, slot)).1))
    }

    /// The path at a level of a slot. Levels lie apart, so that neighbouring slots load neighbours.
    #[inline(always)]
    pub fn load(slots: u32, slot: u32, level: u32, paths: &[R::Record]) -> Self {
        let at = |k| R::load(read(paths, (level * RECORDS + k) * slots + slot));
        let ((origin, bounces), (direction, pending), (weight, source_primitive)) = (at(0), at(1), at(2));
        Path { origin, direction, weight, bounces, pending, source_primitive }
    }

    /// Keeps the path at a level of a slot.
    #[inline(always)]
    pub fn store(&self, slots: u32, slot: u32, level: u32, paths: &mut [R::Record]) {
        let at = |k| (level * RECORDS + k) * slots + slot;
        write(paths, at(0), R::store(self.origin, self.bounces));
        write(paths, at(1), R::store(self.direction, self.pending));
        write(paths, at(2), R::store(self.weight, self.source_primitive));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn paths_at_every_level_of_every_slot_lie_apart() {
        let (slots, levels) = (5, 3);
        let path = |n: u32| {
            let v = |k: u32| V3::<f32>::splat(Vec3::splat((10 * n + k) as f32));
            Path { origin: v(0), direction: v(1), weight: v(2), bounces: n, pending: n + 1, source_primitive: n + 2 }
        };
        let mut memory = vec![f32::store(V3::zero(), 0); (levels * RECORDS * slots) as usize];
        let all = || (0..slots).flat_map(|slot| (0..levels).map(move |level| (slot, level)));
        for (slot, level) in all() {
            path(slot * levels + level).store(slots, slot, level, &mut memory);
        }
        for (slot, level) in all() {
            let (got, want) = (Path::<f32>::load(slots, slot, level, &memory), path(slot * levels + level));
            assert_eq!((got.origin, got.direction, got.weight), (want.origin, want.direction, want.weight));
            let words = |p: &Path<f32>| (p.bounces, p.pending, p.source_primitive);
            assert_eq!(words(&got), words(&want));
        }
    }
}
