//! The lens of a camera (thesis 3.4.6): places on its outline's inside, which a plane of focus is seen through.

use super::FILTER_STEPS;
use crate::buffer::read;
use crate::data::{Camera, numbers};
use crate::real::{SMALL, Scalar, TINY, V3};
use crate::sampler;

/// Where the corners of outlines begin among the tables of cameras: two numbers each, shares of the lens' radii, and of each outline the
/// first corner once more at its end.
pub const OUTLINE: u32 = FILTER_STEPS + 1;
/// The most corners of an outline.
pub const MOST_CORNERS: u32 = 255;

/// A place on a lens from its middle, by a pair of drawn numbers: as likely as any other. Each two corners that follow one another make a
/// triangle with the middle, all of equal area.
#[inline(always)]
pub fn place<R: Scalar>(camera: &Camera, optics: &[u32], (a, b): (u32, u32)) -> V3<R> {
    // The upper eight bits of a product of 24 and 8 are the triangle, the others a share of its edge.
    let (first, corners) = (camera.above.w >> 8, camera.above.w & 0xff);
    let along = (a >> 8).wrapping_mul(corners);
    let (corner, share) = (OUTLINE + 2 * (first + (along >> 24)), R::splat(sampler::unit(along << 8)));
    let number = |i: u32| R::splat(f32::from_bits(read(optics, corner + i)));
    let outwards = R::splat(sampler::unit(b)).sqrt();
    let between = |from: R, to: R| ((from + (to - from) * share) * outwards).flush(SMALL);
    let (right, up) = (between(number(0), number(2)), between(number(1), number(3)));
    let (across, above) = (V3::splat(numbers(camera.across)), V3::splat(numbers(camera.above)));
    (across * right + above * up).map(|c| c.flush(TINY))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Means of moments over a right triangle, whose middle is none of its own: 1 / 3 and 1 / 6 of its edges and their squares.
    #[test]
    fn places_are_even_over_the_outline() {
        let camera = Camera::default().through(Vec3::X * 2.0, Vec3::Y, (0, 4), 1.0);
        // A square on its corner: |x| / 2 + |y| <= 1.
        let corners = [(1.0f32, 0.0f32), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0)];
        let mut optics = vec![0; OUTLINE as usize];
        optics.extend(corners.into_iter().flat_map(|(x, y)| [x.to_bits(), y.to_bits()]));
        let edge = 512u32;
        let drawn = |i: u32| (2 * i + 1) << 22;
        let (mut sum, mut squares) = ([0.0; 2], [0.0; 2]);
        for (a, b) in (0..edge).flat_map(|a| (0..edge).map(move |b| (a, b))) {
            let at: V3<f64> = place(&camera, &optics, (drawn(a), drawn(b)));
            assert!(at.x.abs() / 2.0 + at.y.abs() <= 1.0 + 1e-6 && at.z == 0.0, "{at:?}");
            for (axis, value) in [at.x, at.y].into_iter().enumerate() {
                sum[axis] += value;
                squares[axis] += value * value;
            }
        }
        let count = f64::from(edge * edge);
        assert!(sum.iter().all(|sum| (sum / count).abs() < 1e-6), "{sum:?}");
        // The mean of x squared over |x| + |y| <= 1 is 1/6.
        assert!(
            (squares[0] / count - 4.0 / 6.0).abs() < 1e-4 && (squares[1] / count - 1.0 / 6.0).abs() < 1e-4,
            "{squares:?}"
        );
    }
}
