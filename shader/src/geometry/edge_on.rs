//! Where a ray meets a triangle that it sees nearly edge-on.
//!
//! A hit is at the point that the edge functions stand for as weights. Their rounding moves that point within the triangle: by
//! roundoffs of its size where the ray crosses it, but as far as its ends where the ray runs nearly in its plane. Where that point
//! is more than [`ASIDE`] beside the ray ([`strays`]), another is taken: the ray's plane across the wider of two axes cuts edges
//! of the triangle, and the ray passes between these cuts ([`cut`]).
//!
//! So **a hit on a triangle is within [`BOX_PADDING`](crate::data::BOX_PADDING) of it on each axis**. The ray is then in the padded
//! box of the triangle, or of a part of it, at that distance: it enters no later. Therefore no leaf needs to ask a box, and neither the
//! parts that triangles are split into, nor the hierarchy above, nor its order, nor the space in which boxes are tested changes a hit.
//!
//! In roundoffs, with coordinates in [-1, 1]: 16 of a sheared vertex, 8 of `ASIDE`, and at most 18 of the distance (a sum of products
//! of positive weights with depths of at most 2, and two reciprocals) or of two interpolations: 42 in all, on an axis, of 32 of the
//! padding and the 25 of the margin of nodes that their own test leaves.

use super::crossing::Crossed;
use super::triangle::{Candidate, sheared};
use crate::real::{FAINT, Mask, Real, TINY, V3};

/// How far the point of a hit may be beside the ray: 8 roundoffs.
const ASIDE: f32 = 1.0 / (1 << 21) as f32;

/// Is the mean of three sheared vertices by these weights, whose sum is `area`, not on the ray?
#[inline(always)]
pub fn strays<R: Real>(vertices: [(R, R); 3], weights: [R; 3], area: R) -> R::Mask {
    let [(ax, ay), (bx, by), (cx, cy)] = vertices;
    let [wa, wb, wc] = weights;
    let term = |w: R, x: R| (w * x).flush_if_exact(FAINT);
    let x = term(wa, ax) + term(wb, bx) + term(wc, cx);
    let y = term(wa, ay) + term(wb, by) + term(wc, cy);
    let most = area.abs() * R::splat(ASIDE);
    most.lt(x.abs()) | most.lt(y.abs())
}

impl<R: Real> Candidate<R> {
    /// Which of the lanes `inside` of it meet the triangle, and at which distance, given what its weights are to be multiplied by.
    /// `vertices` gives what [`intersect_watertight`](super::intersect_watertight) took: where triangles are seen edge-on, which
    /// is rare, so that making them again costs less than keeping them.
    #[inline(always)]
    pub fn distance(
        &self,
        inside: R::Mask,
        scale: R,
        vertices: impl FnOnce() -> [V3<R>; 3],
        (shear, along): ((R, R), R),
    ) -> (R::Mask, R) {
        let t = self.depth * scale;
        if !(inside & self.strays).any() {
            return (inside, t);
        }
        let [a, b, c] = vertices();
        let cut = cut(a, b, c, shear);
        let t = R::select(self.strays, (cut.depth * along).flush(FAINT), t);
        (inside & (!self.strays | (cut.meets & R::splat(0.0).lt(t))), t)
    }

    /// Where a ray [crosses](super::crosses) the triangle. What crosses it by what the test of crossings takes for zero may be next to it by
    /// this one, or be behind: then its place is looked for, as that of a triangle that is seen edge-on.
    #[inline(always)]
    pub fn passage(&self, crossed: &Crossed<R>, [a, b, c]: [V3<R>; 3], (shear, along): ((R, R), R)) -> Passage<R> {
        let zero = R::splat(0.0);
        let is_unknown = !self.inside | self.area.eq(zero);
        let scale = self.scale(crossed.is & !is_unknown);
        let t = self.depth * scale;
        let is_line = is_unknown | self.strays;
        if !(crossed.is & is_line).any() {
            return Passage { ahead: crossed.is, t, u: self.u, v: self.v, scale };
        }
        let t = R::select(is_line, (cut(a, b, c, shear).depth * along).flush(FAINT), t);
        let (u, v, own) = crossed.weights();
        Passage {
            ahead: crossed.is & (!is_line | zero.lt(t)),
            t,
            u: R::select(is_unknown, u, self.u),
            v: R::select(is_unknown, v, self.v),
            scale: R::select(is_unknown, own, scale),
        }
    }

    /// What distance and weights are to be multiplied by, in lanes that are inside.
    #[inline(always)]
    pub fn scale(&self, inside: R::Mask) -> R {
        // Other lanes divide by one, so that none divides by zero.
        R::select(inside & !self.area.eq(R::splat(0.0)), self.area, R::splat(1.0)).reciprocal()
    }
}

/// Where a ray crosses a triangle.
#[derive(Clone, Copy)]
pub struct Passage<R: Real> {
    /// In which lanes it does so ahead.
    pub ahead: R::Mask,
    /// The distance.
    pub t: R,
    /// Scaled weight of the second vertex.
    pub u: R,
    /// Scaled weight of the third vertex.
    pub v: R,
    /// What the weights are to be multiplied by.
    pub scale: R,
}

/// Where a ray passes a triangle.
#[derive(Clone, Copy)]
struct Cut<R: Real> {
    /// Does it, within [`ASIDE`]?
    meets: R::Mask,
    /// The distance along the ray's major axis.
    depth: R,
}

/// The place of a triangle that a ray passes, both seen in the plane across the ray where the triangle is next to a line. Its
/// vertices are relative to the ray's origin and their axes cycled, as
/// [`intersect_watertight`](super::intersect_watertight) takes them.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn cut<R: Real>(a: V3<R>, b: V3<R>, c: V3<R>, shear: (R, R)) -> Cut<R> {
    let seen = |p: V3<R>| {
        let (x, y) = sheared(p, shear);
        V3::new(x.flush(TINY), y.flush(TINY), p.z)
    };
    let (a, b, c) = (seen(a), seen(b), seen(c));
    let extent = |a: R, b: R, c: R| a.greater(b).greater(c) - a.lesser(b).lesser(c);
    let wide = extent(a.y, b.y, c.y).le(extent(a.x, b.x, c.x));
    let turned = |p: V3<R>| V3::new(R::select(wide, p.x, p.y), R::select(wide, p.y, p.x), p.z);
    let (a, b, c) = (turned(a), turned(b), turned(c));
    let (first, second, third) = (Edge::cut(a, b), Edge::cut(b, c), Edge::cut(c, a));
    let low = first.lower(second).lower(third);
    let high = first.higher(second).higher(third);
    let (zero, aside) = (R::splat(0.0), R::splat(ASIDE));
    let between = low.y.lt(zero) & zero.lt(high.y);
    let share = (-low.y).div(R::select(between, high.y - low.y, R::splat(1.0)));
    let inner = low.z + ((high.z - low.z) * share).flush(FAINT);
    let depth = R::select(between, inner, R::select(zero.le(low.y), low.z, high.z));
    Cut { meets: low.is & low.y.le(aside) & (-aside).le(high.y), depth }
}

/// Where an edge is cut by the plane in which the first axis is zero.
#[derive(Clone, Copy)]
struct Edge<R: Real> {
    /// Is it?
    is: R::Mask,
    /// The place on the second axis.
    y: R,
    /// The place on the third.
    z: R,
}

impl<R: Real> Edge<R> {
    #[inline(always)]
    fn cut(p: V3<R>, q: V3<R>) -> Self {
        let zero = R::splat(0.0);
        let is = (p.x.le(zero) & zero.le(q.x)) | (q.x.le(zero) & zero.le(p.x));
        let span = p.x - q.x;
        let share = p.x.div(R::select(span.eq(zero) | !is, R::splat(1.0), span));
        let at = |from: R, to: R| from + ((to - from) * share).flush(FAINT);
        Edge { is, y: at(p.y, q.y), z: at(p.z, q.z) }
    }

    /// The lower of two cuts on the second axis.
    #[inline(always)]
    fn lower(self, other: Self) -> Self {
        self.or(other, other.y.lt(self.y))
    }

    /// The higher.
    #[inline(always)]
    fn higher(self, other: Self) -> Self {
        self.or(other, self.y.lt(other.y))
    }

    #[inline(always)]
    fn or(self, other: Self, beyond: R::Mask) -> Self {
        let takes = other.is & (!self.is | beyond);
        Edge { is: self.is | other.is, y: R::select(takes, other.y, self.y), z: R::select(takes, other.z, self.z) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::intersect_watertight;
    use crate::ray::Ray;
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;

    fn cut_of(t: [[f32; 3]; 3]) -> Option<f32> {
        let [a, b, c] = t.map(|[x, y, z]| V3::<f32>::new(x, y, z));
        let cut = cut(a, b, c, (0.0, 0.0));
        cut.meets.then_some(cut.depth)
    }

    #[test]
    fn a_ray_that_runs_past_the_ends_of_a_line_does_not_meet_it() {
        for turn in [0, 1] {
            let at = |x: f32, z: f32| if turn == 0 { [x, 0.0, z] } else { [0.0, x, z] };
            assert_eq!(cut_of([at(1.0, 1.0), at(2.0, 2.0), at(3.0, 3.0)]), None);
            assert_eq!(cut_of([at(-1.0, 1.0), at(-2.0, 2.0), at(-3.0, 3.0)]), None);
            // Between its ends it does, at once where it enters and leaves.
            assert_eq!(cut_of([at(-1.0, 1.0), at(1.0, 3.0), at(3.0, 5.0)]), Some(2.0));
        }
    }

    #[test]
    fn a_ray_between_two_edges_meets_the_place_between() {
        // The plane x = 0 cuts it at (y, z) = (-1e-3, 1) and (3e-3, 5).
        let t = [[-1.0, -1e-3, 1.0], [1.0, -1e-3, 1.0], [0.0, 3e-3, 5.0]];
        let depth = cut_of(t).expect("it is inside");
        assert!((depth - 2.0).abs() < 1e-5, "{depth}");
        let aside = t.map(|[x, y, z]| [x, y + 2e-3, z]);
        assert_eq!(cut_of(aside), None);
    }

    fn distance(t: [Vec3; 3], ray: &Ray<f32>) -> Option<(f32, bool)> {
        let vertices = t.map(|p| ray.seen(p));
        let [a, b, c] = vertices;
        let x = intersect_watertight(a, b, c, ray.slopes(), ray.along());
        let (inside, t) = x.distance(x.inside, x.scale(x.inside), || vertices, (ray.slopes(), ray.along()));
        inside.then_some((t, x.strays))
    }

    /// How far a place is from a triangle on the axis where it is farthest, or a little more.
    fn aside(t: [Vec3; 3], p: DVec3) -> f64 {
        let [a, b, c] = t.map(Vec3::as_dvec3);
        let off = |q: DVec3| (p - q).abs().max_element();
        let edge = |a: DVec3, b: DVec3| {
            let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            off(if share.is_nan() { a } else { a + (b - a) * share })
        };
        let least = edge(a, b).min(edge(b, c)).min(edge(c, a));
        let n = (b - a).cross(c - a);
        let within = [(a, b), (b, c), (c, a)].iter().all(|&(a, b)| (b - a).cross(p - a).dot(n) >= 0.0);
        if within && n.length_squared() > 0.0 {
            least.min(off(p - n * (n.dot(p - a) / n.length_squared())))
        } else {
            least
        }
    }

    #[test]
    fn how_far_a_place_is_aside() {
        let t = [Vec3::ZERO, Vec3::X, Vec3::Y];
        assert_eq!(aside(t, DVec3::new(0.25, 0.25, -0.5)), 0.5);
        assert_eq!(aside(t, DVec3::new(-0.25, 0.25, 0.0)), 0.25);
        assert_eq!(aside(t, DVec3::new(3.0, -1.0, 0.5)), 2.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig { max_global_rejects: 1 << 24, ..ProptestConfig::with_cases(400_000) })]

        /// Whatever the triangle's size and shape and however flat the ray sees it: more than the padding and the margin of nodes leave
        /// is never asked for.
        #[test]
        fn a_hit_is_within_the_padding_of_its_triangle(
            t in prop::array::uniform3(prop::array::uniform3(-1f32..1.0)), size in -18f32..0.0, thin in prop_oneof![Just(0f32), -22f32..0.0],
            from in prop::array::uniform3(-1f32..1.0), weights in prop::array::uniform2(0f32..1.0), tilt in prop_oneof![Just(-60f32), -28f32..0.0],
            towards in prop::array::uniform2(-1f32..1.0), axis in 0usize..4,
        ) {
            let mut t = t.map(Vec3::from);
            let middle = t[0];
            // Thin, small, and often flat along an axis.
            let along = t[1] - t[0];
            t[2] = t[0] + along * towards[0] + (t[2] - t[0]) * thin.exp2();
            t = t.map(|p| (middle + (p - middle) * size.exp2()).clamp(Vec3::NEG_ONE, Vec3::ONE));
            if axis < 3 { let level = t[0][axis]; t.iter_mut().for_each(|p| p[axis] = level) }
            let aim = t[0] + (t[1] - t[0]) * weights[0] + (t[2] - t[0]) * weights[1] * (1.0 - weights[0]);
            // A place nearly in the triangle's plane, from where the ray comes.
            let edges = (t[1] - t[0]).normalize_or_zero() * towards[0] + (t[2] - t[0]).normalize_or_zero() * towards[1];
            let origin = (aim + edges + (Vec3::from(from) - aim) * tilt.exp2()).clamp(Vec3::NEG_ONE, Vec3::ONE);
            prop_assume!(origin != aim);
            let ray = Ray::<f32>::new(V3::splat(origin), V3::splat(aim - origin));
            let Some((found, strays)) = distance(t, &ray) else { return Ok(()) };
            let d = DVec3::new(ray.direction.x.into(), ray.direction.y.into(), ray.direction.z.into());
            let off = aside(t, origin.as_dvec3() + d * f64::from(found)) * f64::from(1u32 << 24);
            prop_assert!(off <= 42.0, "{off} roundoffs, strays: {strays}");
        }
    }
}
