//! Images of two eyes in one: beside each other, or one below the other.

use super::Pixel;
use crate::data::{Frame, Launch, Stereo, numbers};
use crate::real::{Scalar, TINY, V3};

/// The size of an eye's image.
#[inline(always)]
pub(super) fn size(frame: &Frame) -> (u32, u32) {
    match frame.camera.forward.w {
        Stereo::BESIDE => (frame.width / 2, frame.height),
        Stereo::BELOW => (frame.width, frame.height / 2),
        _ => (frame.width, frame.height),
    }
}

/// A place of the image, in halves of a cell from its middle to the right and down, as one of the image of its pixel's eye; and how far
/// that eye is to the right, in lengths of the camera's vector.
#[inline(always)]
pub(super) fn place(frame: &Frame, launch: Launch, pixel: Pixel, (right, down): (f32, f32)) -> ((f32, f32), f32) {
    if !launch.has(Launch::STEREO) || frame.camera.forward.w == Stereo::NONE {
        return ((right, down), 0.0);
    }
    let (width, height) = size(frame);
    let samples = if frame.samples == 0 { 1 } else { frame.samples };
    let is_beside = frame.camera.forward.w == Stereo::BESIDE;
    let is_left = if is_beside { frame.left + pixel.x < width } else { frame.top + pixel.y < height };
    let (own, eye) = if is_left { (1.0, -frame.eyes) } else { (-1.0, frame.eyes) };
    let half = (if is_beside { width } else { height } * samples) as f32 * own;
    (if is_beside { (right + half, down) } else { (right, down + half) }, eye)
}

/// The origin and direction of a ray through an image plane, seen by an eye.
#[inline(always)]
pub(super) fn moved<R: Scalar>(
    frame: &Frame,
    launch: Launch,
    eye: f32,
    (origin, direction): (V3<R>, V3<R>),
) -> (V3<R>, V3<R>) {
    if !launch.has(Launch::STEREO) {
        return (origin, direction);
    }
    let right = V3::<R>::splat(numbers(frame.camera.right));
    let towards = if eye < 0.0 { frame.converging } else { -frame.converging };
    let direction = direction + (right * R::splat(towards)).map(|c| c.flush(TINY));
    (beside(origin, right * R::splat(eye)), direction)
}

/// A place aside of another.
#[inline(always)]
pub(super) fn beside<R: Scalar>(place: V3<R>, aside: V3<R>) -> V3<R> {
    (place + aside.map(|c| c.flush(TINY))).map(|c| c.flush(TINY))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Camera;
    use glam::Vec3;

    fn frame(stereo: u32) -> Frame {
        let camera = Camera::new(Vec3::ZERO, Vec3::X * 0.5, Vec3::Y, -Vec3::Z).seen_by(stereo);
        Frame { camera, width: 8, height: 6, samples: 2, eyes: 0.25, converging: 0.0625, ..Frame::default() }
    }

    /// Each half is an image of its own, whose middle is half a half away from that of all.
    #[test]
    fn each_eye_has_half_the_image() {
        let at = |x, y| Pixel { x, y, inside: true, index: 0, sample: 0 };
        let launch = Launch(Launch::STEREO);
        let found = |stereo, x, y, from| place(&frame(stereo), launch, at(x, y), from);
        assert_eq!(found(Stereo::BESIDE, 3, 5, (-1.0, 7.0)), ((7.0, 7.0), -0.25));
        assert_eq!(found(Stereo::BESIDE, 4, 5, (1.0, 7.0)), ((-7.0, 7.0), 0.25));
        assert_eq!(found(Stereo::BELOW, 7, 2, (3.0, -1.0)), ((3.0, 5.0), -0.25));
        assert_eq!(found(Stereo::BELOW, 7, 3, (3.0, 1.0)), ((3.0, -5.0), 0.25));
        assert_eq!(found(Stereo::NONE, 3, 5, (-1.0, 7.0)), ((-1.0, 7.0), 0.0));
        assert_eq!([Stereo::BESIDE, Stereo::BELOW].map(|stereo| size(&frame(stereo))), [(4, 6), (8, 3)]);
    }

    /// Through the middles of their images both look at one place, at the distance of their convergence: eyes over converging.
    #[test]
    fn both_eyes_look_at_one_place() {
        let (frame, launch) = (frame(Stereo::BESIDE), Launch(Launch::STEREO));
        let ahead = (V3::<f64>::zero(), V3::new(0.0, 0.0, -1.0));
        let met = [-0.25, 0.25].map(|eye| {
            let (origin, direction) = moved(&frame, launch, eye, ahead);
            origin + direction * 4.0
        });
        assert_eq!((met[0].x, met[1].x, met[0].z), (0.0, 0.0, -4.0));
        assert_eq!(moved(&frame, launch, 0.25, ahead).0.x, 0.125);
    }
}
