//! The triangle test of Moeller and Trumbore (1997): cheaper than the watertight one, and not watertight.
//!
//! Weights are triple products over a triangle's own edges from its first vertex. Two neighbours have different
//! first vertices and edges, so they round differently, and a ray at their common edge may miss both. Contraction is
//! allowed: there is no guarantee that it could break.

use super::Candidate;
use super::edge_on::strays;
use super::triangle::sheared;
use crate::real::{Real, V3};

/// As [`intersect_watertight`](super::intersect_watertight), with another scale of depth and weights.
///
/// The direction is taken from the shear, in units of its major component: (x, y, 1) with that axis last.
#[inline(always)]
pub fn intersect_moller_trumbore<R: Real>(a: V3<R>, b: V3<R>, c: V3<R>, (x, y): (R, R), along: R) -> Candidate<R> {
    let (zero, direction) = (R::splat(0.0), V3::new(x, y, R::splat(1.0)));
    let (second, third) = (b - a, c - a);
    let across = direction.cross(third);
    let area = second.dot(across);
    let u = -a.dot(across);
    let around = second.cross(a);
    let v = direction.dot(around);
    let depth = third.dot(around) * along;
    let within = (zero.le(u) & zero.le(v) & (u + v).le(area)) | (u.le(zero) & v.le(zero) & area.le(u + v));
    let ahead = (zero.lt(depth) & zero.lt(area)) | (depth.lt(zero) & area.lt(zero));
    let seen = [sheared(a, (x, y)), sheared(b, (x, y)), sheared(c, (x, y))];
    let strays = strays(seen, [area - u - v, u, v], area);
    Candidate { inside: within & (ahead | strays), strays, front: zero.lt(area * along), depth, u, v, area }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::intersect_watertight;
    use crate::ray::Ray;
    use crate::real::Fast;
    use glam::Vec3;
    use proptest::prelude::*;

    type Test<R> = fn(V3<R>, V3<R>, V3<R>, (R, R), R) -> Candidate<R>;

    fn run<R: Real>(test: Test<R>, t: [[f32; 3]; 3], origin: [f32; 3], direction: [f32; 3]) -> Candidate<R> {
        let v = |p: [f32; 3]| V3::splat(Vec3::from(p));
        let ray = Ray::new(v(origin), v(direction));
        let [a, b, c] = t.map(|p| ray.seen(p.into()));
        test(a, b, c, ray.slopes(), ray.along())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100_000))]

        /// In double precision both tests are the same function: distance, weights, side and sign.
        #[test]
        fn is_the_watertight_test_but_for_rounding(
            t in prop::array::uniform3(prop::array::uniform3(-1f32..1.0)), origin in prop::array::uniform3(-1f32..1.0),
            w in prop::array::uniform2(-0.5f32..1.5),
        ) {
            // A point of the plane, in the triangle or not.
            let at = |k: usize| t[0][k] + w[0] * (t[1][k] - t[0][k]) + w[1] * (t[2][k] - t[0][k]);
            let direction: [f32; 3] = std::array::from_fn(|k| at(k) - origin[k]);
            let want = run::<f64>(intersect_watertight, t, origin, direction);
            let got = run::<f64>(intersect_moller_trumbore, t, origin, direction);
            let edge = got.u.abs().min(got.v.abs()).min((got.area - got.u - got.v).abs());
            prop_assume!(got.area.abs() > 1e-3 && edge > 1e-6);
            prop_assert_eq!((got.inside, !got.inside || got.front == want.front), (want.inside, true));
            if want.inside {
                let scale = got.area / want.area;
                for (got, want) in [(got.depth, want.depth), (got.u, want.u), (got.v, want.v)] {
                    prop_assert!((got - want * scale).abs() < 1e-12, "{got} {want}");
                }
            }
        }
    }

    #[test]
    fn nothing_behind_edge_on_or_degenerate() {
        let flat = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]];
        assert!(run::<Fast>(intersect_moller_trumbore, flat, [0.125, 0.25, 0.75], [0.0, 0.0, -1.0]).inside);
        assert!(!run::<Fast>(intersect_moller_trumbore, flat, [0.125, 0.25, 0.75], [0.0, 0.0, 1.0]).inside);
        assert!(!run::<Fast>(intersect_moller_trumbore, flat, [-0.5, 0.125, 0.0], [1.0, 0.0, 0.0]).inside);
        assert!(!run::<Fast>(intersect_moller_trumbore, [[0.25; 3]; 3], [0.0; 3], [1.0, 1.0, 1.0]).inside);
    }
}
