//! Whether a ray crosses a triangle, decided once for all triangles that meet at an edge or a vertex.
//!
//! A ray through an edge meets both triangles that have it ([`super::triangle`]), so that none is lost. Who counts crossings must count such
//! a place once where the surface is crossed, and twice or not at all where it is only touched. So the ray is thought to be moved across itself,
//! by e on the first axis and by e^2 on the second, for an e as small as one likes (simulation of simplicity, Edelsbrunner and Mücke 1990). An
//! edge function that is not zero keeps its sign, and one that is zero has that of the first power of e that is not. It is zero then
//! only where both ends of the edge are seen at one point, in a triangle that has no area, which is never crossed.
//!
//! All triangles see the same points ([`sheared`]) and the same move, and signs are exact: products are compared with what their rounding
//! took off. So any ray crosses the triangles of a closed mesh an even number of times, as often from either side.
//!
//! Coordinates are at most 8 and below 2^-60 zero; times 2^60 they lie in 1 to 2^63, so that no product and no rest overflows or is
//! subnormal.

use super::triangle::sheared;
use crate::real::{Real, TINY, V3};

/// See the module.
const ENLARGED: f32 = (1u64 << 60) as f32;

/// Whether and where a ray crosses a triangle.
#[derive(Clone, Copy)]
pub struct Crossed<R: Real> {
    /// Does it, ahead or behind?
    pub is: R::Mask,
    /// Edge functions opposite to the vertices, rounded.
    weights: [R; 3],
}

impl<R: Real> Crossed<R> {
    /// Scaled weights of the second and the third vertex, and what they are to be multiplied by.
    #[inline(always)]
    pub fn weights(&self) -> (R, R, R) {
        let [wa, wb, wc] = self.weights;
        let area = wa + wb + wc;
        let none = area.eq(R::splat(0.0));
        (wb, wc, R::select(none, R::splat(0.0), R::select(none, R::splat(1.0), area).reciprocal()))
    }
}

/// Does a ray cross a triangle? Vertices are relative to the ray's origin and their axes cycled, as
/// [`intersect_watertight`](super::intersect_watertight) takes them.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn crosses<R: Real>(a: V3<R>, b: V3<R>, c: V3<R>, shear: (R, R)) -> Crossed<R> {
    let seen = |vertex: V3<R>| {
        let (x, y) = sheared(vertex, shear);
        let enlarged = |x: R| x.flush(TINY) * R::splat(ENLARGED);
        (enlarged(x), enlarged(y))
    };
    let (a, b, c) = (seen(a), seen(b), seen(c));
    let (first, second, third) = (Side::of(c, b), Side::of(a, c), Side::of(b, a));
    let is = (first.left & second.left & third.left) | (first.right & second.right & third.right);
    // Of 2^125 at most; multiplied by this, no sum overflows and no inverse is lost.
    let small = |side: Side<R>| side.size * R::splat(1.0 / ENLARGED);
    Crossed { is, weights: [small(first), small(second), small(third)] }
}

/// On which side of a line through two points the moved ray is; on neither if they are one.
#[derive(Clone, Copy)]
struct Side<R: Real> {
    left: R::Mask,
    right: R::Mask,
    /// The edge function, rounded.
    size: R,
}

impl<R: Real> Side<R> {
    #[inline(always)]
    fn of(p: (R, R), q: (R, R)) -> Self {
        let (one, one_rest) = p.0.product_and_rest(q.1);
        let (other, other_rest) = p.1.product_and_rest(q.0);
        let (level, even) = (one.eq(other), one_rest.eq(other_rest));
        let more = other.lt(one) | (level & other_rest.lt(one_rest));
        let less = one.lt(other) | (level & one_rest.lt(other_rest));
        // The coefficients of e and of e^2.
        let (zero, flat) = (level & even, p.1.eq(q.1));
        let up = q.1.lt(p.1) | (flat & p.0.lt(q.0));
        let down = p.1.lt(q.1) | (flat & q.0.lt(p.0));
        Side { left: more | (zero & up), right: less | (zero & down), size: one - other }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn crosses_at([a, b, c]: [[f32; 2]; 3]) -> bool {
        let vertex = |[x, y]: [f32; 2]| V3::<f32>::new(x, y, 1.0);
        crosses(vertex(a), vertex(b), vertex(c), (0.0, 0.0)).is
    }

    /// Twice the area that the ray and two points span, in steps of 2^-120: exact.
    fn area(p: [f32; 2], q: [f32; 2]) -> i128 {
        let steps = |x: f32| {
            let scaled = f64::from(x) * 2f64.powi(60);
            assert!(scaled.fract() == 0.0, "{x}");
            scaled as i128
        };
        steps(p[0]) * steps(q[1]) - steps(p[1]) * steps(q[0])
    }

    #[test]
    fn a_ray_through_the_inside_crosses_whatever_the_winding() {
        let [a, b, c] = [[-0.5, -0.5], [0.75, -0.5], [0.0, 1.0]];
        assert!(crosses_at([a, b, c]) && crosses_at([a, c, b]));
        let aside = [a, b, c].map(|[x, y]| [x + 2.0, y]);
        assert!(!crosses_at(aside));
    }

    #[test]
    fn a_triangle_without_area_is_never_crossed() {
        for t in [[[0.0, 0.0]; 3], [[-1.0, -1.0], [1.0, 1.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 0.0], [1.0, 0.5]]] {
            assert!(!crosses_at(t) && !crosses_at([t[1], t[0], t[2]]), "{t:?}");
        }
    }

    /// Small whole numbers, so that most of what is degenerate occurs; and numbers of many bits.
    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            (-2i32..3).prop_map(|x| x as f32),
            -1f32..1.0,
            (-2i32..3).prop_map(|x| x as f32 * 2f32.powi(-20) + 0.3)
        ]
        .prop_map(|x| (x * 2f32.powi(30)).round() * 2f32.powi(-30))
    }

    fn point() -> impl Strategy<Value = [f32; 2]> {
        [coordinate(), coordinate()]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200_000))]

        /// Where no edge function is zero, that is all there is to it.
        #[test]
        fn crossings_are_those_of_exact_areas(t in prop::array::uniform3(point())) {
            let [a, b, c] = t;
            let areas = [area(c, b), area(a, c), area(b, a)];
            let inside = areas.iter().all(|&w| w > 0) || areas.iter().all(|&w| w < 0);
            if areas.iter().all(|&w| w != 0) {
                prop_assert_eq!(crosses_at(t), inside);
            } else if areas.iter().any(|&w| w > 0) && areas.iter().any(|&w| w < 0) {
                prop_assert!(!crosses_at(t));
            }
        }

        /// A fan around a hub whose rim is closed is the boundary of nothing but the ray's windings around the rim: any hub gives the same
        /// parity, also one that the ray goes through, or one on the rim.
        #[test]
        fn the_parity_of_a_fan_is_that_of_its_rim(
            rim in prop::collection::vec(point(), 3..9), hubs in prop::array::uniform2(point()), through: bool, on in 0usize..9,
        ) {
            let parity = |hub: [f32; 2]| {
                let crossed = |i: usize| crosses_at([hub, rim[i], rim[(i + 1) % rim.len()]]);
                (0..rim.len()).filter(|&i| crossed(i)).count() % 2
            };
            let other = if through { [0.0, 0.0] } else { hubs[1] };
            prop_assert_eq!(parity(hubs[0]), parity(other));
            prop_assert_eq!(parity(hubs[0]), parity(rim[on % rim.len()]));
        }
    }
}
