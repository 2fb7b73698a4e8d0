//! Whether rays come so that neighbours go the same way, as those of a camera: a CPU follows these in packets, and others each by itself.

use std::ops::Range;

use glam::DVec3;

use crate::batch::{Ray, RayBlock, Rays};

/// Fewer rays have no neighbours to speak of.
const LEAST: usize = 64;
/// Rays that are asked.
const ASKED: usize = 512;
/// How much nearer neighbours are to each other than any rays are.
const NEARER: f64 = 16.0;

/// Do they? `scale` is what one unit of theirs is in the scene's cube.
pub(super) fn are_coherent(rays: &impl Rays, range: Range<usize>, scale: f64) -> bool {
    let count = range.len();
    if count < LEAST {
        return false;
    }
    let mut block = RayBlock::default();
    // Anywhere among them, at no steps that rows of a picture have, too.
    let mut pair = |asked: usize| {
        let first = range.start + asked.wrapping_mul(0x9e37_79b1) % (count - 1);
        rays.fill(first..first + 2, &mut block);
        [block.ray(0), block.ray(1)]
    };
    let mut is_beside = |asked: usize| {
        let ([of, next], [other, _]) = (pair(asked), pair(asked + ASKED));
        NEARER * distance(&of, &next, scale) <= distance(&of, &other, scale)
    };
    // Rows end, and some rays of any two go the same way.
    4 * (0..ASKED).filter(|&asked| is_beside(asked)).count() >= 3 * ASKED
}

/// How differently two rays go: by where they start and by their directions.
fn distance(a: &Ray, b: &Ray, scale: f64) -> f64 {
    let along = |ray: &Ray| ray.direction.try_normalize().unwrap_or(DVec3::ZERO);
    (a.origin - b.origin).length() * scale + (along(a) - along(b)).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_camera(i: usize) -> Ray {
        let at = |x: usize| x as f64 / 256.0 - 0.5;
        Ray::new(DVec3::ZERO, DVec3::new(at(i % 256), at(i / 256), -1.0))
    }

    #[test]
    fn those_of_a_camera_do_and_shuffled_ones_do_not() {
        let count = 1 << 16;
        assert!(are_coherent(&of_camera, 0..count, 1.0));
        assert!(!are_coherent(&|i: usize| of_camera(i * 40_503 % count), 0..count, 1.0));
        assert!(!are_coherent(&of_camera, 0..3, 1.0));
        // All the same; and none at all.
        assert!(are_coherent(&|_: usize| Ray::new(DVec3::ONE, DVec3::X), 0..count, 1.0));
        assert!(!are_coherent(&|_: usize| Ray::new(DVec3::NAN, DVec3::NAN), 0..count, 1.0));
    }
}
