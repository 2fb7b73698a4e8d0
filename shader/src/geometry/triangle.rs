//! The watertight triangle test (Woop, Benthin and Wald 2013).
//!
//! The vertices are moved to the ray's origin and sheared so that the ray is the third axis; the ray
//! hits the triangle where the plane's origin is not outside any edge. Both windings are accepted, and so is a point on
//! an edge.
//!
//! Why no ray slips between two triangles of an edge or a vertex: a sheared vertex depends on that
//! vertex and the ray alone, so neighbours see the same points. An edge function is the difference of
//! two rounded products; rounding is monotone, so its sign is the exact one or it is zero, and zero
//! counts as inside for both. Thus the sheared points, taken as exact, are covered without a gap, and
//! no higher precision is needed. A contraction to fused multiply-add would break this, which is why
//! it is forbidden in every precision.
//!
//! A triangle that is seen edge-on is a line, and an edge function of zero does not tell which part of its line the ray
//! is at: see [`super::edge_on`], which finds where it is, and says why a hit lies in its triangle's box.
//!
//! A device may take subnormal numbers for zero. Coordinates of at most 4 and multiples of 2^-83 make such a sheared
//! vertex less than 2^-126, and its products less than 2^-124. An edge function above [`SLIGHT`] = 2^-96 has a
//! product above 2^-97, whose neighbours are 2^-121 away: it is the same with them and without. One below counts
//! as zero. So all devices agree, and values are flushed to zero only in candidates.
//!
//! The error of the sheared points: with coordinates in [-1, 1], a difference to the origin
//! errs by 2^-23, the shear by 2^-23 of it thrice: below 16 * 2^-24 in all.

use super::edge_on::strays;
use crate::real::{FAINT, Mask, Real, V3};
#[cfg(not(target_arch = "spirv"))]
use crate::real::{Lanes, Scalar};

/// Where a ray crosses a triangle's plane, before the division. Only `inside` is valid where the ray misses the triangle.
#[derive(Clone, Copy)]
pub struct Candidate<R: Real> {
    /// Does it cross inside the triangle, in front of the origin? Where it [strays](Candidate::strays),
    /// [`Candidate::distance`] must agree.
    pub inside: R::Mask,
    /// Is the point of these weights not on the ray, since the triangle is seen nearly edge-on?
    pub strays: R::Mask,
    /// Is the front (counter-clockwise) side towards the ray? For back-face culling.
    pub front: R::Mask,
    /// Scaled distance along the ray's major axis.
    pub depth: R,
    /// Scaled weight of the second vertex.
    pub u: R,
    /// Scaled weight of the third vertex.
    pub v: R,
    /// The scale.
    pub area: R,
}

/// An edge function of this magnitude or less counts as zero; see the module.
const SLIGHT: f32 = 1.0 / (1u128 << 96) as f32;

/// A scale for edge functions that are not zero, so that the weighted depths of triangles far smaller than the scene do
/// not underflow.
const ENLARGED: f32 = (1u64 << 48) as f32;

/// Intersects a ray with a triangle, whose vertices are relative to the ray's origin. Their axes are cycled
/// ([`Shear::cycle`](crate::ray::Shear::cycle)); `shear` is how far the first two move along the third, and `along` the
/// inverse of the direction's major component.
// A function of its own on the GPU: the build forbids contraction inside such functions.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn intersect_watertight<R: Real>(a: V3<R>, b: V3<R>, c: V3<R>, shear: (R, R), along: R) -> Candidate<R> {
    let (ax, ay) = sheared(a, shear);
    let (bx, by) = sheared(b, shear);
    let (cx, cy) = sheared(c, shear);
    let wa = cx * by - cy * bx;
    let wb = ax * cy - ay * cx;
    let wc = bx * ay - by * ax;
    let (zero, slight) = (R::splat(0.0), R::splat(SLIGHT));
    let above = (-slight).le(wa) & (-slight).le(wb) & (-slight).le(wc);
    let around = above | (wa.le(slight) & wb.le(slight) & wc.le(slight));
    // A ray misses most triangles that it is tested against.
    if !around.any() {
        return Candidate { inside: around, strays: around, front: around, depth: wa, u: wb, v: wc, area: wa };
    }
    let enlarged = |w: R| w.flush_if_exact(SLIGHT) * R::splat(ENLARGED);
    let (wa, wb, wc) = (enlarged(wa), enlarged(wb), enlarged(wc));
    let area = wa + wb + wc;
    let term = |w: R, z: R| (w * z).flush_if_exact(FAINT);
    let depth = (term(wa, a.z) + term(wb, b.z) + term(wc, c.z)) * along;
    let ahead = (zero.lt(depth) & zero.lt(area)) | (depth.lt(zero) & area.lt(zero));
    let front = zero.lt(area * along);
    let strays = strays([(ax, ay), (bx, by), (cx, cy)], [wa, wb, wc], area);
    Candidate { inside: around & (ahead | strays), strays, front, depth, u: wb, v: wc, area }
}

/// A vertex, relative to the ray's origin and its axes cycled, in the plane across the ray.
#[inline(always)]
pub fn sheared<R: Real>(p: V3<R>, (x, y): (R, R)) -> (R, R) {
    (p.x - x * p.z, p.y - y * p.z)
}

#[cfg(not(target_arch = "spirv"))]
impl<R: Real> Candidate<R> {
    /// One of the lanes that are inside.
    #[inline(always)]
    pub(crate) fn lane<S: Scalar>(&self, i: usize) -> Candidate<S>
    where
        R: Lanes<S>,
    {
        let holds = |mask| (R::bits(mask) >> i) & 1 == 1;
        let (strays, front) = (holds(self.strays), holds(self.front));
        let (depth, area) = (self.depth.lane(i), self.area.lane(i));
        Candidate { inside: true, strays, front, depth, u: self.u.lane(i), v: self.v.lane(i), area }
    }
}

/// A generous bound on the relative error of a product and a quotient.
const ABOUT: f32 = 1.0 + 1.0 / (1 << 20) as f32;

impl<R: Real> Candidate<R> {
    /// Is it inside, and may it lie before `limit`? A cheap test, so that few are divided.
    #[inline(always)]
    pub fn nearer(&self, limit: R) -> R::Mask {
        self.inside & (self.strays | self.depth.abs().le(self.area.abs() * limit * R::splat(ABOUT)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use glam::Vec3;
    use proptest::prelude::*;

    type V = V3<f32>;

    fn hit(t: [[f32; 3]; 3], origin: [f32; 3], direction: [f32; 3]) -> Option<(f32, f32, f32, bool)> {
        let v = |p: [f32; 3]| V::splat(Vec3::from(p));
        let ray = Ray::new(v(origin), v(direction));
        let [a, b, c] = t.map(|p| ray.seen(p.into()));
        let shear = ray.slopes();
        let x = intersect_watertight(a, b, c, shear, ray.along());
        let (inside, t) = x.distance(x.inside, x.scale(x.inside), || [a, b, c], (shear, ray.along()));
        inside.then(|| (t, x.u / x.area, x.v / x.area, x.front))
    }

    const FLAT: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]];

    #[test]
    fn distance_weights_and_side() {
        // Counter-clockwise seen from +z, so a ray down the z axis meets the front.
        let (t, u, v, front) = hit(FLAT, [0.125, 0.25, 0.75], [0.0, 0.0, -0.5]).unwrap();
        assert_eq!((t, u, v, front), (1.5, 0.25, 0.5, true));
        let (t, u, v, front) = hit(FLAT, [0.125, 0.25, -0.75], [0.0, 0.0, 1.0]).unwrap();
        assert_eq!((t, u, v, front), (0.75, 0.25, 0.5, false));
    }

    #[test]
    fn the_same_along_every_axis() {
        for shift in 0..3 {
            let turn = |p: [f32; 3]| -> [f32; 3] { std::array::from_fn(|k| p[(k + 3 - shift) % 3]) };
            let (t, u, v, front) = hit(FLAT.map(turn), turn([0.125, 0.25, 0.75]), turn([0.0, 0.0, -1.0])).unwrap();
            assert_eq!((t, u, v, front), (0.75, 0.25, 0.5, true), "axes turned by {shift}");
        }
    }

    #[test]
    fn nothing_behind_beside_or_edge_on() {
        assert!(hit(FLAT, [0.125, 0.25, 0.75], [0.0, 0.0, 1.0]).is_none());
        assert!(hit(FLAT, [0.5, 0.25, 0.75], [0.0, 0.0, -1.0]).is_none());
        assert!(hit(FLAT, [-0.125, 0.25, 0.75], [0.0, 0.0, -1.0]).is_none());
        assert!(hit(FLAT, [0.125, -0.25, 0.75], [0.0, 0.0, -1.0]).is_none());
        assert!(hit(FLAT, [-0.5, 0.125, 0.0], [1.0, 0.0, 0.0]).is_none());
        assert!(hit([[0.25; 3]; 3], [0.0; 3], [1.0, 1.0, 1.0]).is_none());
    }

    #[test]
    fn edges_and_vertices_are_inside_for_both_windings() {
        let [a, b, c] = FLAT;
        for triangle in [[a, b, c], [a, c, b]] {
            for (x, y) in [(0.25, 0.0), (0.0, 0.25), (0.25, 0.25), (0.0, 0.0), (0.5, 0.0), (0.0, 0.5)] {
                for z in [0.75, -0.75] {
                    assert!(hit(triangle, [x, y, z], [0.0, 0.0, -z]).is_some(), "{x} {y} from {z}");
                }
            }
        }
    }

    fn fan_hits(hub: [f32; 3], rim: &[[f32; 3]], origin: [f32; 3], direction: [f32; 3]) -> usize {
        (0..rim.len()).filter(|&i| hit([hub, rim[i], rim[(i + 1) % rim.len()]], origin, direction).is_some()).count()
    }

    proptest! {
        #![proptest_config(ProptestConfig { max_global_rejects: 1 << 20, ..ProptestConfig::with_cases(200_000) })]

        /// A closed fan around a hub, and rays aimed at the hub, at spokes and into its triangles.
        #[test]
        fn no_ray_slips_through_a_fan(
            spokes in 3usize..12, hub in prop::array::uniform3(-0.01f32..0.01), tilt in -0.3f32..0.3,
            origin in prop::array::uniform3(-0.9f32..0.9), phase in 0f32..6.2, along in 0f32..0.5, spoke in 0usize..12,
        ) {
            let rim: Vec<[f32; 3]> = (0..spokes).map(|k| {
                let angle = phase + std::f32::consts::TAU * k as f32 / spokes as f32;
                [0.7 * angle.cos(), 0.7 * angle.sin(), tilt * (3.0 * angle).sin()]
            }).collect();
            let origin = [origin[0] * 0.3, origin[1] * 0.3, 0.8 + origin[2] * 0.1];
            let end = rim[spoke % spokes];
            let aim: [f32; 3] = std::array::from_fn(|k| hub[k] + along * (end[k] - hub[k]));
            let direction: [f32; 3] = std::array::from_fn(|k| aim[k] - origin[k]);
            prop_assert!(fan_hits(hub, &rim, origin, direction) >= 1);
            let at_hub: [f32; 3] = std::array::from_fn(|k| hub[k] - origin[k]);
            prop_assert!(fan_hits(hub, &rim, origin, at_hub) >= 1);
        }

        /// A triangle that is seen edge-on is a line, and is not met where that line goes on beside it.
        #[test]
        fn edge_on_triangles_are_not_longer_than_they_are(
            origin in prop::array::uniform3(-0.5f32..0.5), direction in prop::array::uniform3(-1f32..1.0),
            across in prop::array::uniform3(-1f32..1.0), t in prop::array::uniform3(0.0625f32..0.5),
            s in prop::array::uniform3(0.0009765625f32..0.5),
        ) {
            let [o, d, e] = [origin, direction, across].map(|v| Vec3::from(v).as_dvec3());
            prop_assume!(d.length() > 0.25 && d.cross(e).length() > 0.25 * d.length());
            // All vertices lie on one side of the ray, in a plane with it.
            let corner = |i: usize| (o + f64::from(t[i]) * d + f64::from(s[i]) * e).as_vec3().to_array();
            prop_assert!(hit([corner(0), corner(1), corner(2)], origin, direction).is_none());
        }

        /// The distance equals that of the plane in double precision, within the sheared points' error.
        #[test]
        fn distance_is_that_of_the_plane(
            t in prop::array::uniform9(-1f32..1.0), w in prop::array::uniform2(0.0625f32..0.45),
            origin in prop::array::uniform3(-1f32..1.0),
        ) {
            let tri = [[t[0], t[1], t[2]], [t[3], t[4], t[5]], [t[6], t[7], t[8]]];
            let d = |p: [f32; 3]| glam::DVec3::new(p[0].into(), p[1].into(), p[2].into());
            let (a, b, c, o) = (d(tri[0]), d(tri[1]), d(tri[2]), d(origin));
            let normal = (b - a).cross(c - a);
            prop_assume!(normal.length() > 0.05);
            let p = a + (b - a) * f64::from(w[0]) + (c - a) * f64::from(w[1]);
            let dir = (p - o).as_vec3();
            let slope = normal.dot(dir.as_dvec3()) / normal.length() / f64::from(dir.length());
            prop_assume!(slope.abs() > 0.1 && dir.length() > 0.05);
            let exact = normal.dot(a - o) / normal.dot(dir.as_dvec3());
            let (got, u, v, front) = hit(tri, origin, dir.to_array()).expect("a ray aimed well inside hits");
            prop_assert!((f64::from(got) - exact).abs() < 2e-4, "{got} {exact}");
            prop_assert!((u - w[0]).abs() < 1e-3 && (v - w[1]).abs() < 1e-3);
            prop_assert_eq!(front, slope < 0.0);
        }
    }
}
