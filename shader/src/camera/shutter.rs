//! The time in which the shutter is open (thesis 3.4.7; Cook, Porter and Carpenter, Distributed Ray Tracing, 1984): each sample is of a
//! moment of it.

use super::{CameraRay, Pixel, common_key, key};
use crate::buffer::read;
use crate::data::{Frame, Instance, Launch, numbers};
use crate::real::{Scalar, TINY, V3};
use crate::sampler;

/// When the rays of a sample are: from 0, where the shutter opens, to 1, where it closes. With a rolling shutter each row is exposed for a
/// part of that, from the top to the bottom.
#[inline(always)]
pub fn time(frame: &Frame, pixel: Pixel) -> f32 {
    let row = (frame.top + pixel.y) as f32;
    row * frame.row_delay + frame.exposure * sampler::time(key(frame, pixel), pixel.sample)
}

/// The same where photons tell of light ([`Caustics::GATHERED`](crate::data::Caustics)): all rays of a sample are of one moment, as its photons
/// are. Those have no row.
#[inline(always)]
pub fn common_time(frame: &Frame, launch: Launch, sample: u32) -> f32 {
    if launch.has(Launch::MOVING) { frame.exposure * sampler::time(common_key(frame), sample) } else { 0.0 }
}

/// A ray of a camera that moves, which was made where the shutter opens, at a time: carried on as the camera is.
#[inline(always)]
pub fn panned<R: Scalar>(frame: &Frame, instances: &[Instance], time: f32, ray: CameraRay<R>) -> CameraRay<R> {
    if frame.keys == Frame::STILL {
        return ray;
    }
    let (step, share) = frame.step(time);
    let key = |number: u32| read(instances, frame.keys + number);
    let key = key(step).towards(&key(step + 1), share).transform();
    let from_eye = (ray.origin - V3::splat(numbers(frame.camera.eye))).map(|c| c.flush(TINY));
    let origin = (key.turned(from_eye) + V3::splat(key.translation)).map(|c| c.flush(TINY));
    CameraRay { origin, direction: key.turned(ray.direction).normalised().0, ..ray }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{self, CameraRay};
    use crate::data::{Camera, Order, pack};
    use glam::{UVec4, Vec3};

    /// The record of a camera's key.
    fn key_of(rows: [Vec3; 3], eye: Vec3) -> Instance {
        let row = |row: Vec3, added: f32| pack(row, added.to_bits());
        let [x, y, z] = rows;
        Instance { x: row(x, eye.x), y: row(y, eye.y), z: row(z, eye.z), mesh: UVec4::ZERO }
    }

    #[test]
    fn a_camera_goes_straight_from_key_to_key_and_looks_where_it_is_turned() {
        let eye = Vec3::new(0.5, 0.25, 0.0);
        let camera = Camera::new(eye, Vec3::X * 0.1, Vec3::Y * 0.1, -Vec3::Z);
        let frame = Frame { camera, steps: 2, exposure: 1.0, keys: 1, ..Frame::default() };
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        // A quarter turn to the left, about the y axis, in the second step.
        let turned = [Vec3::Z, Vec3::Y, -Vec3::X];
        let keys = [Instance::NONE, key_of(axes, eye), key_of(axes, Vec3::X), key_of(turned, Vec3::Y)];
        let ray = CameraRay { origin: V3::splat(eye), direction: V3::splat(-Vec3::Z), weight: 1.0f64 };
        let at = |time| {
            let CameraRay { origin: o, direction: d, .. } = panned(&frame, &keys, time, ray);
            ([o.x, o.y, o.z].map(|c| c as f32), [d.x, d.y, d.z].map(|c| c as f32))
        };
        assert_eq!(at(0.0), ([0.5, 0.25, 0.0], [0.0, 0.0, -1.0]));
        assert_eq!(at(0.25), ([0.75, 0.125, 0.0], [0.0, 0.0, -1.0]));
        assert_eq!(at(0.5), ([1.0, 0.0, 0.0], [0.0, 0.0, -1.0]));
        assert_eq!(at(1.0), ([0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]));
        let half = std::f32::consts::FRAC_1_SQRT_2;
        assert_eq!(at(0.75), ([0.5, 0.5, 0.0], [-half, 0.0, -half]));
    }

    /// Of a rolling shutter the rows share the time from the first to the last.
    #[test]
    fn every_row_is_exposed_for_its_part_of_the_time() {
        let whole = Frame {
            width: 4,
            height: 8,
            columns: 4,
            rows: 8,
            across: 1,
            pixel_slots: 64,
            exposure: 1.0,
            ..Frame::default()
        };
        let rolling = Frame { exposure: 0.25, row_delay: 0.75 / 8.0, ..whole };
        for (frame, earliest, lasts) in [(whole, 0.0, 1.0), (rolling, 0.75 / 8.0, 0.25)] {
            for y in 0..8u32 {
                let times = (0..256).map(|sample| {
                    let pixel = Pixel { sample, ..camera::pixel(&frame, Order(0), y / 4 * 32 + y % 4 * 8) };
                    assert_eq!(pixel.y, y);
                    time(&frame, pixel)
                });
                let mut times: Vec<f32> = times.map(|time| time - earliest * y as f32).collect();
                times.sort_by(f32::total_cmp);
                // One in each of 256 parts.
                for (part, time) in times.into_iter().enumerate() {
                    let part = lasts * part as f32 / 256.0;
                    assert!(time >= part - 1e-6 && time < part + lasts / 256.0 + 1e-6, "row {y}: {time} from {part}");
                }
            }
        }
    }
}
