//! Cameras whose rays go all around: no plane holds their image.

use super::{CameraRay, stereo};
use crate::data::{Frame, Launch, Projection, numbers};
use crate::real::turns::cos_sin;
use crate::real::{Real, SMALL, Scalar, V3};

/// The ray through a place of the image, so many halves of a cell from its middle to the right and down, of an eye so far to the right.
#[inline(always)]
pub fn ray<R: Scalar>(frame: &Frame, launch: Launch, (right, down): (f32, f32), eye: f32) -> CameraRay<R> {
    let camera = &frame.camera;
    let (x, y) = (right * frame.angle, -down * frame.angle);
    let ([along, aside, above], is_shown) = match camera.eye.w {
        Projection::EQUIRECTANGULAR => (longitude_latitude(x, y), true),
        Projection::EQUIDISTANT => (equidistant(x, y), is_in_circle(frame, right, down)),
        _ => (equisolid(x, y), is_in_circle(frame, right, down)),
    };
    let part = |record, share: f32| V3::<R>::splat(numbers(record)) * R::splat(share.flush(SMALL));
    let direction = part(camera.forward, along) + part(camera.right, aside) + part(camera.up, above);
    let middle = V3::splat(numbers(camera.eye));
    let origin = if launch.has(Launch::STEREO) {
        // Where it sees all around, an eye turns with the view.
        let (ahead, across) = if camera.eye.w == Projection::EQUIRECTANGULAR { turned(x) } else { (1.0, 0.0) };
        stereo::beside(middle, part(camera.right, ahead * eye) + part(camera.forward, -across * eye))
    } else {
        middle
    };
    CameraRay { origin, direction: direction.normalised().0, weight: R::splat(if is_shown { 1.0 } else { 0.0 }) }
}

/// Is a place within the greatest circle around the image's middle?
#[inline(always)]
fn is_in_circle(frame: &Frame, right: f32, down: f32) -> bool {
    let (width, height) = stereo::size(frame);
    let least = if width < height { width } else { height };
    let radius = (least * frame.samples) as f32;
    right * right + down * down <= radius * radius
}

/// Cosine and sine of an angle in turns, at most one either way.
#[inline(always)]
fn turned(turns: f32) -> (f32, f32) {
    const STEPS: f32 = (1 << 26) as f32;
    cos_sin(((turns * STEPS) as i32 as u32) << 6)
}

/// Shares of the ways forward, right and up, by turns of longitude and latitude.
#[inline(always)]
fn longitude_latitude(x: f32, y: f32) -> [f32; 3] {
    let ((along, aside), (level, above)) = (turned(x), turned(y));
    [level * along, level * aside, above]
}

/// The angle from the middle is the distance in the image, in turns.
#[inline(always)]
fn equidistant(x: f32, y: f32) -> [f32; 3] {
    let distance = Real::sqrt((x * x + y * y).flush(SMALL));
    let (along, sine) = turned(distance);
    let is_middle = distance == 0.0;
    let over = if is_middle { 1.0 } else { distance };
    [along, Real::div(x * sine, over), Real::div(y * sine, over)]
}

/// The sine of half the angle is the distance.
#[inline(always)]
fn equisolid(x: f32, y: f32) -> [f32; 3] {
    let square = (x * x + y * y).flush(SMALL);
    let square = if square < 1.0 { square } else { 1.0 };
    let twice_cosine = 2.0 * Real::sqrt(1.0 - square);
    [1.0 - 2.0 * square, x * twice_cosine, y * twice_cosine]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Camera;
    use glam::Vec3;
    use std::f64::consts::{PI, TAU};

    fn frame(projection: u32, (width, height): (u32, u32), angle: f64) -> Frame {
        let camera = Camera::new(Vec3::Z, Vec3::X, Vec3::Y, -Vec3::Z).projected(projection);
        Frame { camera, width, height, samples: 1, angle: angle as f32, ..Frame::default() }
    }

    /// The solid angle of each pixel of an image twice as wide as high is that of the sphere between its latitudes: together 4 pi.
    #[test]
    fn longitude_and_latitude_go_all_around() {
        let (width, height) = (64u32, 32u32);
        let frame = frame(Projection::EQUIRECTANGULAR, (width, height), 0.5 / f64::from(width));
        let mut sum = V3::<f64>::zero();
        for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
            let (right, down) = (2 * x as i32 + 1 - width as i32, 2 * y as i32 + 1 - height as i32);
            let CameraRay { origin, direction: d, weight } =
                ray::<f64>(&frame, Launch(0), (right as f32, down as f32), 0.0);
            assert_eq!((origin.z, weight), (1.0, 1.0));
            let (longitude, latitude) =
                (f64::from(right) / f64::from(width) * PI, -f64::from(down) / f64::from(height) * PI / 2.0);
            let want = [latitude.cos() * longitude.sin(), latitude.sin(), -latitude.cos() * longitude.cos()];
            assert!((d.x - want[0]).abs() < 1e-6 && (d.y - want[1]).abs() < 1e-6 && (d.z - want[2]).abs() < 1e-6);
            sum = sum + d * latitude.cos();
        }
        assert!(sum.x.abs().max(sum.y.abs()).max(sum.z.abs()) < 1e-4, "opposite ways have as much: {sum:?}");
    }

    /// Angles from the middle, for a full circle of 180 degrees, and nothing beyond.
    #[test]
    fn fisheyes_keep_angles_or_solid_angles() {
        let size = 200u32;
        let half = f64::from(size);
        let (quarter, sine) = (0.25 / half, (PI / 4.0).sin() / half);
        let angle_at = |projection, angle, right: f32, down: f32| {
            let CameraRay { direction: d, weight, .. } =
                ray::<f64>(&frame(projection, (size, size), angle), Launch(0), (right, down), 0.0);
            assert!((d.x * f64::from(-down) - d.y * f64::from(right)).abs() < 1e-4, "no twist: {d:?}");
            (d.x.hypot(d.y).atan2(-d.z), weight)
        };
        for share in [0.0f32, 0.1, 0.5, 0.9, 0.999] {
            for (right, down) in [(1.0f32, 0.0f32), (0.0, -1.0), (0.6, 0.8), (-0.8, 0.6)] {
                let (right, down) = (right * share * size as f32, down * share * size as f32);
                let share = f64::from(share);
                let (angle, weight) = angle_at(Projection::EQUIDISTANT, quarter, right, down);
                assert!((angle - share * TAU / 4.0).abs() < 1e-5 && weight == 1.0, "{share}: {angle}");
                let (angle, weight) = angle_at(Projection::EQUISOLID, sine, right, down);
                let want = 2.0 * ((PI / 4.0).sin() * share).asin();
                assert!((angle - want).abs() < 1e-5 && weight == 1.0, "{share}: {angle} {want}");
            }
        }
        for projection in [Projection::EQUIDISTANT, Projection::EQUISOLID] {
            assert_eq!(angle_at(projection, quarter, 150.0, 140.0).1, 0.0);
        }
    }
}
