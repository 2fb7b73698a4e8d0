//! What is nearer or farther than a camera shows.

use super::CameraRay;
use crate::data::{Frame, Launch, numbers};
use crate::real::{SMALL, Scalar, TINY, V3};

/// A ray from where the camera starts to see.
#[inline(always)]
pub(super) fn started<R: Scalar>(frame: &Frame, launch: Launch, ray: CameraRay<R>) -> CameraRay<R> {
    if !launch.has(Launch::CLIPPED) || frame.near == 0.0 {
        return ray;
    }
    let step = R::splat(frame.near) * slant(frame, launch, ray.direction);
    CameraRay { origin: ray.origin + (ray.direction * step).map(|c| c.flush(TINY)), ..ray }
}

/// How far a ray of the camera goes that starts at a place on its way.
#[inline(always)]
pub fn limit<R: Scalar>(frame: &Frame, launch: Launch, origin: V3<R>, direction: V3<R>) -> R {
    if !launch.has(Launch::CLIPPED) || frame.farthest == 0.0 {
        return R::splat(f32::MAX);
    }
    let from = (origin - V3::splat(numbers(frame.camera.eye))).map(|c| c.flush(SMALL));
    let along = if frame.camera.is_round(launch) { direction } else { V3::splat(numbers(frame.camera.forward)) };
    let left = R::splat(frame.farthest) - from.dot(along);
    left.max(R::splat(0.0)) * slant(frame, launch, direction)
}

/// How much longer a ray's way is than the distance from the camera's plane.
#[inline(always)]
fn slant<R: Scalar>(frame: &Frame, launch: Launch, direction: V3<R>) -> R {
    /// Beyond the slant of a field of view of 179.9 degrees and a lens.
    const LEAST: f32 = 1.0 / 65536.0;
    if frame.camera.is_round(launch) {
        return R::splat(1.0);
    }
    direction.dot(V3::splat(numbers(frame.camera.forward))).max(R::splat(LEAST)).reciprocal()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Camera, Projection};
    use glam::Vec3;

    /// Along the view, whatever the slant; where rays go all around, along the ray.
    #[test]
    fn a_ray_starts_and_ends_at_the_planes_of_a_camera() {
        let camera = Camera::new(Vec3::new(0.25, 0.0, 0.5), Vec3::X, Vec3::Y, -Vec3::Z);
        let frame = Frame { camera, near: 0.25, farthest: 1.5, ..Frame::default() };
        let around = Frame { camera: camera.projected(Projection::EQUIRECTANGULAR), ..frame };
        let launch = Launch(Launch::CLIPPED | Launch::ROUND);
        for slope in [0.0, 0.5, -3.0] {
            let direction = V3::<f64>::new(slope, 0.0, -1.0).normalised().0;
            let from = V3::splat(Vec3::new(0.25, 0.0, 0.5));
            let ray = CameraRay { origin: from, direction, weight: 1.0 };
            let near = started(&frame, launch, ray).origin;
            let far = near + direction * limit(&frame, launch, near, direction);
            assert!((near.z - 0.25).abs() < 1e-9 && (far.z + 1.0).abs() < 1e-9, "{slope}: {near:?} {far:?}");
            let near = started(&around, launch, ray).origin;
            let all = 0.25 + limit(&around, launch, near, direction);
            assert!((all - 1.5).abs() < 1e-9 && ((near - from).dot(direction) - 0.25).abs() < 1e-9);
        }
        let none = Launch(0);
        assert_eq!(limit(&frame, none, V3::zero(), V3::new(0.0, 0.0, -1.0)), f64::from(f32::MAX));
    }
}
