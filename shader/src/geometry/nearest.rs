//! Where a triangle is nearest to a point.
//!
//! The place is the nearest of four: one on each edge, and the foot of the point where that is inside. Each is a mean of the vertices, so
//! that no distance is below the triangle's by more than rounding, however thin it is. An edge or a height that is shorter than a roundoff of the scene's cube is
//! left to others, which are as near but for that; so no quotient or square is lost.

use crate::real::{FAINT, Real, SMALL, Scalar, TINY, V3};

/// A place of a triangle, by its distance from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest<R> {
    /// The square of the distance.
    pub square: R,
    /// The weights of the second and the third vertex there.
    pub weights: (R, R),
}

/// The place of a triangle that is nearest to a point. Coordinates of vertices are in [-1, 1], the point's at most [`FARTHEST`].
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn nearest<R: Scalar>(a: V3<R>, b: V3<R>, c: V3<R>, point: V3<R>) -> Nearest<R> {
    let edge = |from: V3<R>, to: V3<R>| (to - from).map(|x| x.flush(SMALL));
    let from = |vertex: V3<R>| (vertex - point).map(|x| x.flush(TINY));
    let (ab, bc, ca) = (edge(a, b), edge(b, c), edge(c, a));
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let (near_ab, at_ab) = on_edge(from(a), ab);
    let (near_bc, at_bc) = on_edge(from(b), bc);
    let (near_ca, at_ca) = on_edge(from(c), ca);
    let mut best = Nearest { square: near_ab, weights: (at_ab, zero) };
    best = best.or(Nearest { square: near_bc, weights: (one - at_bc, at_bc) });
    best = best.or(Nearest { square: near_ca, weights: (zero, one - at_ca) });
    best.or(foot(from(a), ab, -ca))
}

/// A point's coordinates are at most so far from the middle of the scene's cube: farther ones see the cube as if they were here, but for less
/// than they lose by rounding.
pub const FARTHEST: f32 = 4096.0;

impl<R: Scalar> Nearest<R> {
    /// The nearer of two.
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        let is_other = other.square.lt(self.square);
        let either = |a, b| R::select(is_other, b, a);
        let (v, w) = (either(self.weights.0, other.weights.0), either(self.weights.1, other.weights.1));
        Nearest { square: either(self.square, other.square), weights: (v, w) }
    }
}

/// The square of a roundoff of the cube, half of it; what is below has no length.
#[inline(always)]
fn nothing<R: Real>() -> R {
    R::ROUNDOFF * R::ROUNDOFF
}

/// The square of the distance of zero from an edge, and which share of the way along it the place is.
#[inline(always)]
fn on_edge<R: Scalar>(from: V3<R>, along: V3<R>) -> (R, R) {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let square = along.dot(along);
    let is_point = square.lt(nothing());
    let share = (-from.dot(along)).flush(FAINT).over(R::select(is_point, one, square)).flush(TINY);
    let share = R::select(is_point, zero, share.max(zero).min(one));
    (square_of(from + along * share), share)
}

/// The foot of zero in a triangle, by its first vertex and the edges from there to the others; infinitely far where it is not inside.
#[inline(always)]
fn foot<R: Scalar>(from: V3<R>, ab: V3<R>, ac: V3<R>) -> Nearest<R> {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let away = Nearest { square: R::splat(f32::MAX), weights: (zero, zero) };
    let cross = |a: V3<R>, b: V3<R>| a.cross(b).map(|x| x.flush(TINY));
    let normal = cross(ab, ac);
    if normal.abs().greatest().lt(nothing()) {
        return away;
    }
    let whole = normal.dot(normal).reciprocal();
    let share = |turned: V3<R>| (normal.dot(turned).flush(FAINT) * whole).flush(TINY);
    let (v, w) = (share(cross(ac, from)), share(cross(from, ab)));
    if v.lt(zero) | w.lt(zero) | one.lt(v + w) {
        return away;
    }
    Nearest { square: square_of(from + ab * v + ac * w), weights: (v, w) }
}

#[inline(always)]
fn square_of<R: Real>(place: V3<R>) -> R {
    let place = place.map(|x| x.flush(TINY));
    place.dot(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;

    fn number<R: Scalar>(p: DVec3) -> V3<R> {
        V3::splat(p.as_vec3())
    }

    /// The least distance by the three edges and the plane, in double precision, of places that a search refines: no case by case.
    fn searched([a, b, c]: [DVec3; 3], point: DVec3) -> f64 {
        let at = |v: f64, w: f64| (a + (b - a) * v + (c - a) * w).distance(point);
        // The distance is convex in the weights, so nested halving of an interval finds the least.
        let least = |f: &dyn Fn(f64) -> f64| {
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..100 {
                let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if f(left) < f(right) { high = right } else { low = left }
            }
            f((low + high) / 2.0).min(f(0.0)).min(f(1.0))
        };
        least(&|v| least(&|w| at(v, w * (1.0 - v))))
    }

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![
            (-2i32..3).prop_map(|x| f64::from(x) / 2.0),
            -1f64..1.0,
            (-2i32..3).prop_map(|x| f64::from(x) * 1e-6)
        ]
    }

    fn place() -> impl Strategy<Value = DVec3> {
        [coordinate(), coordinate(), coordinate()].prop_map(|p| DVec3::from(p).as_vec3().as_dvec3())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        /// Whatever the triangle, also without an area or a length: within some roundoffs of what lies apart.
        #[test]
        fn it_is_the_least_distance_of_any_place(t in prop::array::uniform3(place()), point in place(), far in 0..12i32) {
            let point = (point * 2f64.powi(far)).as_vec3().as_dvec3();
            let expected = searched(t, point);
            let [a, b, c] = t.map(number::<f32>);
            let found = nearest(a, b, c, number(point));
            let error = (f64::from(found.square).sqrt() - expected).abs();
            let size = 1.0 + point.length();
            prop_assert!(error <= 16.0 * 2f64.powi(-24) * size, "{} and {expected}", found.square.sqrt());
            let (v, w) = (f64::from(found.weights.0), f64::from(found.weights.1));
            prop_assert!(v >= 0.0 && w >= 0.0 && v + w <= 1.0 + 1e-6);
            let at = t[0] + (t[1] - t[0]) * v + (t[2] - t[0]) * w;
            prop_assert!((at.distance(point) - expected).abs() <= 16.0 * 2f64.powi(-24) * size);
        }

        /// In double precision, far closer.
        #[test]
        fn double_precision_is_far_closer(t in prop::array::uniform3(place()), point in place()) {
            let [a, b, c] = t.map(number::<f64>);
            let found = nearest(a, b, c, number(point)).square.sqrt();
            prop_assert!((found - searched(t, point)).abs() <= 1e-12, "{found} {}", searched(t, point));
        }
    }

    #[test]
    fn corners_edges_and_faces_are_met_by_their_weights() {
        let [a, b, c] = [Vec3::ZERO, Vec3::X, Vec3::Y].map(V3::<f32>::splat);
        let at = |x, y, z| nearest(a, b, c, V3::splat(Vec3::new(x, y, z)));
        assert_eq!(at(0.25, 0.25, 0.5), Nearest { square: 0.25, weights: (0.25, 0.25) });
        assert_eq!(at(-1.0, -1.0, 0.0), Nearest { square: 2.0, weights: (0.0, 0.0) });
        assert_eq!(at(1.0, 1.0, 0.0), Nearest { square: 0.5, weights: (0.5, 0.5) });
        assert_eq!(at(0.0, 3.0, 0.0), Nearest { square: 4.0, weights: (0.0, 1.0) });
    }
}
