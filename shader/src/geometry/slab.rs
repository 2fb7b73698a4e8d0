//! The box test (slabs): conservative, so rounding never loses a box.

use crate::ray::Ray;
use crate::real::{Real, V3};

/// Where a ray is inside a box.
#[derive(Clone, Copy, Debug)]
pub struct Span<R: Real> {
    /// Where it enters, at least 0. A zero may have either sign.
    pub near: R,
    /// Where it leaves.
    pub far: R,
}

/// Intersects a ray with a box, given by its corners. The ray hits it before `limit` where
/// `near <= far` and `near <= limit`.
///
/// Ize, Robust BVH Ray Traversal (2013): with a correctly rounded reciprocal each bound errs by less
/// than gamma(3), so a far bound widened by 1 + 2 gamma(3) loses no box; 8 roundoffs cover it.
/// Every step is monotone in the box: a larger box never gives a later near or an earlier far.
/// The far bound that is returned is the widened one.
#[inline(always)]
pub fn slab<R: Real>(least: V3<R>, greatest: V3<R>, ray: &Ray<R>) -> Span<R> {
    let a = (least - ray.origin).times(ray.inverse);
    let b = (greatest - ray.origin).times(ray.inverse);
    let widen = R::splat(1.0) + R::splat(8.0) * R::ROUNDOFF;
    let (enter, leave) = (a.lesser(b), a.greater(b));
    let near = enter.x.greater(enter.y).greater(enter.z.greater(R::splat(0.0)));
    Span { near, far: leave.x.lesser(leave.y).lesser(leave.z) * widen }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn meets(least: [f32; 3], greatest: [f32; 3], origin: [f32; 3], direction: [f32; 3]) -> bool {
        let v = |a: [f32; 3]| V3::<f32>::splat(Vec3::from(a));
        let span = slab(v(least), v(greatest), &Ray::new(v(origin), v(direction)));
        span.near <= span.far
    }

    #[test]
    fn each_axis_and_sign() {
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let (mut from, mut to) = ([0.0; 3], [0.0; 3]);
                from[axis] = -0.75 * sign;
                to[axis] = sign;
                assert!(meets([-0.25; 3], [0.25; 3], from, to), "towards, axis {axis}");
                to[axis] = -sign;
                assert!(!meets([-0.25; 3], [0.25; 3], from, to), "away, axis {axis}");
                from[(axis + 1) % 3] = 0.5;
                to[axis] = sign;
                assert!(!meets([-0.25; 3], [0.25; 3], from, to), "beside, axis {axis}");
                // Inside by a triangle's padding, the nearest that geometry lies to a face.
                from[(axis + 1) % 3] = 0.25 - crate::data::BOX_PADDING;
                assert!(meets([-0.25; 3], [0.25; 3], from, to), "along a face, axis {axis}");
            }
        }
    }

    #[test]
    fn entry_and_exit_are_distances() {
        let v = |x, y, z| V3::<f32>::new(x, y, z);
        let ray = Ray::new(v(-1.0, 0.0, 0.0), v(0.5, 0.0, 0.0));
        let span = slab(v(-0.5, -0.5, -0.5), v(0.5, 0.5, 0.5), &ray);
        assert_eq!(span.near, 1.0);
        assert!(span.far >= 3.0 && span.far < 3.00001);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100_000))]

        /// A ray aimed at a point of the box, often at corners and faces, never misses it.
        #[test]
        fn aimed_rays_never_miss(
            a in prop::array::uniform3(-1f32..1.0), b in prop::array::uniform3(-1f32..1.0),
            from in prop::array::uniform3(-1f32..1.0), corner in prop::array::uniform3(0u8..3),
        ) {
            let least: [f32; 3] = std::array::from_fn(|k| a[k].min(b[k]));
            let greatest: [f32; 3] = std::array::from_fn(|k| a[k].max(b[k]));
            let target: [f64; 3] = std::array::from_fn(|k| match corner[k] {
                0 => f64::from(least[k]),
                1 => f64::from(greatest[k]),
                _ => f64::from(least[k]) / 2.0 + f64::from(greatest[k]) / 2.0,
            });
            // The rounded direction misses the corner by rounding; the box is padded as a triangle's is.
            let direction: [f32; 3] = std::array::from_fn(|k| (target[k] - f64::from(from[k])) as f32);
            prop_assume!(direction.iter().any(|d| *d != 0.0));
            let pad = crate::data::BOX_PADDING;
            prop_assert!(meets(least.map(|c| c - pad), greatest.map(|c| c + pad), from, direction));
        }

        /// Culling relies on this: a larger box is entered no later and left no sooner.
        #[test]
        fn monotone_in_the_box(
            a in prop::array::uniform6(-1f32..1.0), grow in prop::array::uniform6(0f32..0.1),
            from in prop::array::uniform3(-1f32..1.0), to in prop::array::uniform3(-1f32..1.0),
        ) {
            let v = |x: f32, y: f32, z: f32| V3::<f32>::new(x, y, z);
            let (p, q) = (v(a[0], a[1], a[2]), v(a[3], a[4], a[5]));
            let ray = Ray::new(v(from[0], from[1], from[2]), v(to[0], to[1], to[2]));
            let inner = slab(p.min(q), p.max(q), &ray);
            let outer = slab(p.min(q) - v(grow[0], grow[1], grow[2]), p.max(q) + v(grow[3], grow[4], grow[5]), &ray);
            prop_assert!(outer.near <= inner.near && outer.far >= inner.far);
        }
    }
}
