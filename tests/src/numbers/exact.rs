//! A ray against a triangle without any rounding.

use std::cmp::Ordering;

use eyerays_shader::real::Real;
use glam::{DVec3, Vec3};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// Every finite `f32` is a whole multiple of 2^-149.
pub(super) const GRID: i32 = 149;

/// Sheared vertices are off by less than this on each axis; see `geometry::triangle`.
pub const SHEAR: f64 = 16.0 * ROUNDOFF;
/// Half the distance from 1 to the next `f32`.
pub const ROUNDOFF: f64 = <f32 as Real>::ROUNDOFF as f64;

/// A number in steps of the grid.
pub(super) fn steps(x: f32) -> BigInt {
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 23 & 255) as i32, bits & 0x007f_ffff);
    assert!(exponent < 255, "{x} is no finite number");
    let magnitude =
        if exponent == 0 { BigInt::from(fraction) } else { BigInt::from(fraction | 1 << 23) << (exponent - 1) };
    debug_assert_eq!(GRID, 126 + 23);
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

pub(super) type V = [BigInt; 3];

pub(super) fn vector(v: Vec3) -> V {
    v.to_array().map(steps)
}

pub(super) fn minus(a: &V, b: &V) -> V {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

pub(super) fn dot(a: &V, b: &V) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub(super) fn cross(a: &V, b: &V) -> V {
    [&a[1] * &b[2] - &a[2] * &b[1], &a[2] * &b[0] - &a[0] * &b[2], &a[0] * &b[1] - &a[1] * &b[0]]
}

/// Where a line crosses the plane of a triangle.
#[derive(Clone, Debug)]
pub struct Crossing {
    /// Distance in lengths of the direction.
    pub t: BigRational,
    /// Weights of the second and the third vertex.
    pub weights: [BigRational; 2],
    /// Does a ray meet the triangle, an edge or a vertex of it, in front of its origin?
    pub meets: bool,
}

/// Crosses a triangle's plane; none if the line runs along it, or the triangle has none.
pub fn crossing(triangle: [Vec3; 3], origin: Vec3, direction: Vec3) -> Option<Crossing> {
    let (o, d) = (vector(origin), vector(direction));
    let [a, b, c] = triangle.map(|p| minus(&vector(p), &o));
    let normal = cross(&minus(&b, &a), &minus(&c, &a));
    let slope = dot(&normal, &d);
    if slope.is_zero() {
        return None;
    }
    // Volumes that the direction spans with two vertices each; their sum is the slope.
    let weights = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| BigRational::new(dot(&d, &cross(p, q)), slope.clone()));
    let t = BigRational::new(dot(&normal, &a), slope);
    let meets = t.is_positive() && weights.iter().all(|w| !w.is_negative());
    let [_, u, v] = weights;
    Some(Crossing { t, weights: [u, v], meets })
}

/// On which side of a triangle's plane a point lies: greater where the corners run counter-clockwise.
pub fn side(triangle: [Vec3; 3], point: Vec3) -> Ordering {
    let [a, b, c] = triangle.map(vector);
    let normal = cross(&minus(&b, &a), &minus(&c, &a));
    dot(&normal, &minus(&vector(point), &a)).cmp(&BigInt::zero())
}

/// A rational, rounded to the nearest double.
pub fn nearest(x: &BigRational) -> f64 {
    x.to_f64().expect("a rational has a nearest double")
}

/// A triangle in the plane across a ray, in double precision: what the bounds of the kernels' error are made of.
#[derive(Clone, Copy, Debug)]
pub struct Sheared {
    /// Vertices across the ray, the third axis in the direction's greatest component.
    pub vertices: [DVec3; 3],
    /// That component.
    pub major: f64,
}

impl Sheared {
    /// Shears a triangle.
    pub fn new(triangle: [Vec3; 3], origin: Vec3, direction: Vec3) -> Self {
        let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
        let size = d.abs();
        let z = if size.y <= size.x && size.z <= size.x {
            0
        } else if size.z <= size.y {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let vertices = triangle.map(|p| {
            let p = p.as_dvec3() - o;
            DVec3::new(p[x] - d[x] / d[z] * p[z], p[y] - d[y] / d[z] * p[z], p[z])
        });
        Sheared { vertices, major: d[z] }
    }

    /// Twice the signed area.
    fn area(&self) -> f64 {
        let [a, b, c] = self.vertices.map(DVec3::truncate);
        (b - a).perp_dot(c - a)
    }

    /// How far inside its triangle the ray is (outside if negative): the distance to the nearest edge's line. Zero if
    /// the triangle is seen edge-on.
    pub fn depth_inside(&self) -> f64 {
        let area = self.area();
        if area == 0.0 {
            return 0.0;
        }
        let [a, b, c] = self.vertices.map(DVec3::truncate);
        let edge = |p: glam::DVec2, q: glam::DVec2| -(q - p).perp_dot(p) * area.signum() / (q - p).length();
        edge(a, b).min(edge(b, c)).min(edge(c, a))
    }

    /// By how much a computed `t` may be off; see docs/numerics.md for the derivation. Infinite where the triangle is
    /// seen edge-on.
    pub fn t_error(&self) -> f64 {
        let [a, b, c] = self.vertices;
        let area = self.area().abs();
        let normal = (b - a).cross(c - a);
        let slope = (normal.x.abs() + normal.y.abs()) / normal.z.abs();
        let reach = self.vertices.iter().map(|p| p.truncate().abs().max_element()).fold(0.0, f64::max);
        let far = self.vertices.iter().map(|p| p.z.abs()).fold(0.0, f64::max);
        let (least, greatest) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
        let weights = 12.0 * ROUNDOFF * reach * reach * (greatest - least) / area;
        let error = (slope * SHEAR + weights + 8.0 * ROUNDOFF * far) / self.major.abs();
        if error.is_nan() { f64::INFINITY } else { error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAT: [Vec3; 3] = [Vec3::ZERO, Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.0, 0.5, 0.0)];

    #[test]
    fn steps_are_whole() {
        assert_eq!(steps(1.0), BigInt::from(1) << 149);
        assert_eq!(steps(-f32::from_bits(1)), BigInt::from(-1));
        assert_eq!(steps(f32::MIN_POSITIVE), BigInt::from(1) << 23);
    }

    #[test]
    fn a_crossing_is_exact() {
        let hit = crossing(FLAT, Vec3::new(0.125, 0.25, 0.75), Vec3::new(0.0, 0.0, -0.5)).unwrap();
        let found = (nearest(&hit.t), nearest(&hit.weights[0]), nearest(&hit.weights[1]), hit.meets);
        assert_eq!(found, (1.5, 0.25, 0.5, true));
        // A third of a third is no float.
        let third = crossing(FLAT, Vec3::new(0.1, 0.1, 1.0), Vec3::new(0.0, 0.0, -3.0)).unwrap().t;
        assert_eq!(third, BigRational::new(1.into(), 3.into()));
        assert!(crossing(FLAT, Vec3::Z, Vec3::X).is_none());
        assert!(!crossing(FLAT, Vec3::new(0.1, 0.1, 1.0), Vec3::Z).unwrap().meets, "behind");
        assert!(!crossing(FLAT, Vec3::new(0.3, 0.3, 1.0), -Vec3::Z).unwrap().meets, "beside");
    }

    #[test]
    fn a_ray_on_an_edge_meets_and_the_least_step_beside_it_does_not() {
        let below = f32::from_bits(1);
        for (y, meets) in [(0.0, true), (below, true), (-below, false)] {
            assert_eq!(crossing(FLAT, Vec3::new(0.25, y, 1.0), -Vec3::Z).unwrap().meets, meets, "{y:e}");
        }
    }

    #[test]
    fn inside_is_a_distance_across_the_ray() {
        for triangle in [FLAT, [FLAT[0], FLAT[2], FLAT[1]]] {
            let depth =
                |x, y, z: f32| Sheared::new(triangle, Vec3::new(x, y, z), Vec3::new(0.0, 0.0, -z)).depth_inside();
            for z in [1.0, -2.0] {
                assert!((depth(0.125, 0.0625, z) - 0.0625).abs() < 1e-12, "{}", depth(0.125, 0.0625, z));
                assert!((depth(0.125, -0.0625, z) + 0.0625).abs() < 1e-12);
            }
        }
    }
}
