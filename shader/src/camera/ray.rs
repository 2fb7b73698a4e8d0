//! The ray through a sample of a pixel.

use super::{Pixel, clip, filter, key, lens, round, stereo};
use crate::data::{Camera, Frame, Launch, numbers};
use crate::real::{Scalar, TINY, V3};
use crate::sampler::{self, Sample};

/// A ray of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay<R> {
    /// Where it starts.
    pub origin: V3<R>,
    /// Its unit direction.
    pub direction: V3<R>,
    /// What of its light counts: nothing where the image shows none.
    pub weight: R,
}

/// The ray through a sample of a pixel. `optics` are tables: [`FILTER_STEPS`](super::FILTER_STEPS) and one numbers of a pixel filter,
/// then the corners of a lens' outline; of use where a launch is [`Launch::FILTERED`] or has a [`Launch::LENS`].
#[inline(always)]
pub fn ray<R: Scalar>(frame: &Frame, launch: Launch, optics: &[u32], pixel: Pixel) -> CameraRay<R> {
    let camera = &frame.camera;
    let (mut right, mut down) = in_pixel(frame, launch, pixel);
    if launch.has(Launch::FILTERED) {
        right = filter::moved(frame, optics, right);
        down = filter::moved(frame, optics, down);
    }
    let (place, eye) = stereo::place(frame, launch, pixel, in_image(frame, pixel, (right, down)));
    if camera.is_round(launch) {
        return clip::started(frame, launch, round::ray(frame, launch, place, eye));
    }
    let (origin, direction) = stereo::moved(frame, launch, eye, plane(camera, launch, place));
    if !frame.has_lens(launch) {
        return clip::started(frame, launch, CameraRay::of(origin, direction));
    }
    let drawn = sampler::set(launch, key(frame, pixel), pixel.sample, 0);
    let aside = lens::place(camera, optics, (drawn.z, drawn.w));
    let over_focus = R::splat(f32::from_bits(camera.across.w));
    // Through the place that the middle of the lens sees sharp.
    let direction = direction - (aside * over_focus).map(|c| c.flush(TINY));
    clip::started(frame, launch, CameraRay::of((origin + aside).map(|c| c.flush(TINY)), direction))
}

/// The same where no camera of the scene needs tables, goes all around, is clipped or has two eyes.
#[inline(always)]
pub fn plain_ray<R: Scalar>(frame: &Frame, launch: Launch, pixel: Pixel) -> CameraRay<R> {
    let (origin, direction) = plane(&frame.camera, launch, in_image(frame, pixel, in_pixel(frame, launch, pixel)));
    CameraRay::of(origin, direction)
}

impl<R: Scalar> CameraRay<R> {
    /// Along a direction of any length, whose light counts.
    #[inline(always)]
    fn of(origin: V3<R>, direction: V3<R>) -> Self {
        CameraRay { origin, direction: direction.normalised().0, weight: R::splat(1.0) }
    }
}

/// Where in its pixel a sample lies, from the left and the top edge in halves of a cell: where its sampler has it ([`sampler::place`]), or
/// in the centre of a cell of a grid of N x N.
#[inline(always)]
fn in_pixel(frame: &Frame, launch: Launch, pixel: Pixel) -> (f32, f32) {
    let samples = if frame.samples == 0 { 1 } else { frame.samples };
    if launch.has(Launch::JITTERED | Launch::RANDOM | Launch::SOBOL) {
        return sampler::place(launch, samples, Sample::new(key(frame, pixel), samples, pixel.sample));
    }
    let middle = |cell: u32| (2 * cell + 1) as f32;
    (middle(pixel.sample % samples), middle(pixel.sample / samples))
}

/// The same from the image's middle, to the right and down. That of an edge is a whole number, so that no division is needed.
#[inline(always)]
fn in_image(frame: &Frame, pixel: Pixel, (from_left, from_top): (f32, f32)) -> (f32, f32) {
    let samples = if frame.samples == 0 { 1 } else { frame.samples };
    let edge = |at: u32, size: u32| ((2 * at * samples) as i32 - (size * samples) as i32) as f32;
    let right = edge(frame.left + pixel.x, frame.width) + from_left;
    let down = edge(frame.top + pixel.y, frame.height) + from_top;
    // By so much the camera shifts all of the image.
    (right + f32::from_bits(frame.camera.right.w), down + f32::from_bits(frame.camera.up.w))
}

/// Origin and direction, of no certain length, of the ray through a place on an image plane.
#[inline(always)]
fn plane<R: Scalar>(camera: &Camera, launch: Launch, (right, down): (f32, f32)) -> (V3<R>, V3<R>) {
    let (eye, forward) = (V3::splat(numbers(camera.eye)), V3::splat(numbers(camera.forward)));
    let (right, up) = (R::splat(right), -R::splat(down));
    let (right, up) = (V3::splat(numbers(camera.right)) * right, V3::splat(numbers(camera.up)) * up);
    if camera.is_parallel(launch) {
        ((eye + right + up).map(|c| c.flush(TINY)), forward)
    } else {
        (eye, forward + right + up)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::frame;
    use super::super::{OUTLINE, pixel};
    use super::*;
    use crate::data::{Order, Projection};
    use crate::sampler::Key;
    use glam::Vec3;

    fn seen(frame: &Frame, launch: Launch, pixel: Pixel) -> (V3<f64>, V3<f64>) {
        let CameraRay { origin, direction, weight } = ray::<f64>(frame, launch, &[], pixel);
        assert_eq!(weight, 1.0);
        (origin, direction)
    }

    #[test]
    fn the_first_pixel_is_top_left_and_samples_surround_its_centre() {
        let one = frame(2, 2, 1, 0, Order(0), 1);
        let regular = Launch(0);
        let (origin, d) = seen(&one, regular, pixel(&one, Order(0), 0));
        assert_eq!((origin.x, origin.y, origin.z), (0.5, 0.0, 0.0));
        assert!((d.x / d.z - 0.5).abs() < 1e-12 && (d.y / d.z + 0.5).abs() < 1e-12, "left and up: {d:?}");
        let four = frame(2, 2, 2, 0, Order(0), 4);
        let grid: Vec<_> = (0..4)
            .map(|sample| seen(&four, regular, pixel(&four, Order(0), sample * four.pixel_slots)).1)
            .map(|d| ((d.x / -d.z * 4.0).round() as i32, (d.y / -d.z * 4.0).round() as i32))
            .collect();
        assert_eq!(grid, [(-3, 3), (-1, 3), (-3, 1), (-1, 1)]);
    }

    #[test]
    fn parallel_rays_start_side_by_side() {
        let camera = Camera::new(Vec3::new(0.5, 0.0, 0.0), Vec3::X * 0.25, Vec3::Y * 0.125, -Vec3::Z);
        let camera = camera.projected(Projection::PARALLEL);
        let two = Frame { camera, ..frame(2, 2, 1, 0, Order(0), 1) };
        let at = |launch| seen(&two, Launch(launch), pixel(&two, Order(0), 1));
        let (origin, d) = at(Launch::PARALLEL);
        assert_eq!((origin.x, origin.y, origin.z), (0.75, 0.125, 0.0));
        assert_eq!((d.x, d.y, d.z), (0.0, 0.0, -1.0));
        assert_eq!(at(0).0.x, 0.5, "where no camera is, none are");
    }

    /// Wherever in the image, and whichever region a launch renders.
    #[test]
    fn a_sample_lies_where_its_sampler_says() {
        for launch in [Launch::JITTERED, Launch::RANDOM, Launch::SOBOL].map(Launch) {
            let whole = frame(12, 7, 3, 0, Order(0), 9);
            let part = Frame { left: 5, top: 2, columns: 4, rows: 4, across: 1, pixel_slots: 32, ..whole };
            for (x, y, sample) in (0..4).flat_map(|x| (0..4).flat_map(move |y| (0..9).map(move |s| (x, y, s)))) {
                let at = |x, y| Pixel { x, y, inside: true, index: 0, sample };
                let (_, d) = seen(&whole, launch, at(x + 5, y + 2));
                let (right, down) = sampler::place(launch, 3, Sample::new(Key::new((x + 5, y + 2), 0), 3, sample));
                let want = [
                    (f64::from(x + 5) + f64::from(right) / 6.0) / 6.0 - 1.0,
                    1.0 - (f64::from(y + 2) + f64::from(down) / 6.0) / 3.5,
                ];
                assert!((d.x / -d.z - want[0]).abs() < 1e-6 && (d.y / -d.z - want[1]).abs() < 1e-6, "{want:?}: {d:?}");
                assert_eq!(seen(&part, launch, at(x, y)).1, d, "in a region");
            }
        }
    }

    /// By a share of the image's width and height: what was at a pixel is now as many pixels further left.
    #[test]
    fn a_shifted_image_is_a_part_of_a_larger_one() {
        let whole = frame(8, 6, 2, 0, Order(0), 4);
        let mut shifted = whole;
        (shifted.camera.right.w, shifted.camera.up.w) = ((2.0f32 * 2.0 * 3.0).to_bits(), (-2.0f32 * 2.0).to_bits());
        let at = |x, y| Pixel { x, y, inside: true, index: 0, sample: 1 };
        for (x, y) in [(0, 1), (4, 5), (2, 3)] {
            let moved = seen(&shifted, Launch(0), at(x, y));
            assert_eq!(moved, seen(&whole, Launch(0), at(x + 3, y - 1)));
        }
    }

    /// Rays of one place of the image, through a square lens of half edge 0.5 aside and 0.25 up, meet in the plane of focus and nowhere else;
    /// those of a focus far away are parallel.
    #[test]
    fn rays_through_a_lens_meet_in_the_plane_of_focus() {
        let corners = [(1.0f32, 1.0f32), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)];
        let mut optics = vec![0; OUTLINE as usize];
        optics.extend(corners.into_iter().flat_map(|(x, y)| [x.to_bits(), y.to_bits()]));
        let one = frame(4, 4, 1, 0, Order(0), 1);
        for (focus, parallel) in [(3.0f64, false), (3.0, true), (f64::INFINITY, false), (f64::INFINITY, true)] {
            let (across, above) = (Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.0, 0.25, 0.0));
            let camera = one.camera.through(across, above, (0, 4), (1.0 / focus) as f32);
            let camera = camera.projected(if parallel { Projection::PARALLEL } else { Projection::PERSPECTIVE });
            let frame = Frame { camera, aperture: 1.0, ..one };
            let launch = Launch(Launch::LENS | Launch::PARALLEL);
            let (mut starts, mut met) = (Vec::new(), Vec::new());
            for sample in 0..64 {
                let at = Pixel { x: 3, y: 1, inside: true, index: 0, sample };
                let CameraRay { origin, direction, .. } = ray::<f64>(&frame, launch.with(Launch::RANDOM), &optics, at);
                // Where its place on the image is, a pinhole's ray starts.
                let pinhole = ray::<f64>(&frame, Launch(launch.0 & !Launch::LENS).with(Launch::RANDOM), &optics, at);
                let from = (origin.x - pinhole.origin.x, origin.y - pinhole.origin.y, origin.z - pinhole.origin.z);
                assert!(from.0.abs() <= 0.5 && from.1.abs() <= 0.25 && from.2 == 0.0, "{from:?}");
                starts.push(from);
                let (d, p) = (direction, pinhole.direction);
                if focus.is_infinite() {
                    met.push((d.x - p.x).abs().max((d.y - p.y).abs()));
                    continue;
                }
                let plane = |origin: f64, d: f64, z: f64| origin + d / -z * focus;
                let apart = [
                    plane(origin.x, d.x, d.z) - plane(pinhole.origin.x, p.x, p.z),
                    plane(origin.y, d.y, d.z) - plane(pinhole.origin.y, p.y, p.z),
                ];
                met.push(apart[0].abs().max(apart[1].abs()));
            }
            assert!(met.iter().all(|&apart| apart < 1e-6), "{focus} {parallel}: {met:?}");
            let spread = |of: &dyn Fn(&(f64, f64, f64)) -> f64| starts.iter().map(of).fold(0.0, f64::max);
            assert!(spread(&|s| s.0) > 0.4 && spread(&|s| -s.1) > 0.2, "all of the lens is used");
        }
    }
}
