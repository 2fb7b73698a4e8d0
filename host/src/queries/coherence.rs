//! Whether rays come so that neighbours go the same way, as those of a camera: a CPU follows these in packets, and others each by itself.

use glam::Vec3;

use crate::stream::StreamRay;

/// Fewer rays have no neighbours to speak of.
const LEAST: usize = 64;
/// Rays that are asked.
const ASKED: usize = 512;
/// How much nearer neighbours are to each other than any rays are.
const NEARER: f32 = 16.0;

/// Do they?
pub(super) fn are_coherent(count: usize, ray: impl Fn(usize) -> StreamRay) -> bool {
    if count < LEAST {
        return false;
    }
    // Anywhere among them, at no steps that rows of a picture have, too.
    let place = |asked: usize| asked.wrapping_mul(0x9e37_79b1) % (count - 1);
    let is_beside = |asked: usize| {
        let (of, next, other) = (ray(place(asked)), ray(place(asked) + 1), ray(place(asked + ASKED)));
        NEARER * distance(&of, &next) <= distance(&of, &other)
    };
    // Rows end, and some rays of any two go the same way.
    4 * (0..ASKED).filter(|&asked| is_beside(asked)).count() >= 3 * ASKED
}

/// How differently two rays go: by where they start, in the scene's cube, and by their directions.
fn distance(a: &StreamRay, b: &StreamRay) -> f32 {
    let along = |ray: &StreamRay| ray.direction.try_normalize().unwrap_or(Vec3::ZERO);
    (a.origin - b.origin).length() + (along(a) - along(b)).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(origin: Vec3, direction: Vec3) -> StreamRay {
        StreamRay { origin, direction, limit: 1.0, source_primitive: StreamRay::NOWHERE }
    }

    fn of_camera(i: usize) -> StreamRay {
        let at = |x: usize| x as f32 / 256.0 - 0.5;
        ray(Vec3::ZERO, Vec3::new(at(i % 256), at(i / 256), -1.0))
    }

    #[test]
    fn those_of_a_camera_do_and_shuffled_ones_do_not() {
        let count = 1 << 16;
        assert!(are_coherent(count, of_camera));
        assert!(!are_coherent(count, |i| of_camera(i * 40_503 % count)));
        assert!(!are_coherent(3, of_camera));
        // All the same; and none at all.
        assert!(are_coherent(count, |_| ray(Vec3::ONE, Vec3::X)));
        assert!(!are_coherent(count, |_| ray(Vec3::NAN, Vec3::NAN)));
    }
}
