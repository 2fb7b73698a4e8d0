//! Lines against spheres and disks without any rounding, but for that of the last quotient to double precision.

use glam::Vec3;
use num_bigint::BigInt;
use num_traits::{ToPrimitive, Zero};

use super::exact::{GRID, cross, dot, minus, steps, vector};

/// The double nearest to a whole number of steps, of which the product of so many numbers has each.
fn double(steps: &BigInt, factors: i32) -> f64 {
    steps.to_f64().expect("a whole number has a nearest double") * 2f64.powi(-GRID * factors)
}

/// Where a line passes a sphere. Each number is off by less than two roundoffs of double precision.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// The square of half the chord; negative beside the sphere, by the squares of the line's distance and the radius.
    pub square: f64,
    /// The distance to the middle of the chord, in lengths of the direction.
    pub middle: f64,
    /// The length of the direction.
    pub length: f64,
    /// The distance from the origin to the centre.
    pub way: f64,
}

impl Passage {
    /// Passes a sphere by a line. The direction is not zero.
    pub fn of(centre: Vec3, radius: f32, origin: Vec3, direction: Vec3) -> Self {
        let (r, d, to) = (steps(radius), vector(direction), minus(&vector(centre), &vector(origin)));
        let across = cross(&to, &d);
        let dd = dot(&d, &d);
        let square = &r * &r * &dd - dot(&across, &across);
        let length_squared = double(&dd, 2);
        Passage {
            square: double(&square, 4) / length_squared,
            middle: double(&dot(&to, &d), 2) / length_squared,
            length: length_squared.sqrt(),
            way: double(&dot(&to, &to), 2).sqrt(),
        }
    }

    /// Half the chord in lengths of the direction, if the square errs by `error`: zero for none.
    pub fn half(&self, error: f64) -> f64 {
        (self.square + error).max(0.0).sqrt() / self.length
    }
}

/// Where a line crosses a disk's plane.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// The distance in lengths of the direction.
    pub t: f64,
    /// How far from the centre that is.
    pub from_centre: f64,
    /// The sine of the angle between the line and the plane.
    pub slope: f64,
    /// The length of the direction.
    pub length: f64,
    /// The distance from the origin to the centre.
    pub way: f64,
}

impl Crossing {
    /// Crosses the plane through a centre by a line; none if it runs along it.
    pub fn of(centre: Vec3, normal: Vec3, origin: Vec3, direction: Vec3) -> Option<Self> {
        let (n, d, to) = (vector(normal), vector(direction), minus(&vector(centre), &vector(origin)));
        let (height, slope) = (dot(&n, &to), dot(&n, &d));
        if slope.is_zero() {
            return None;
        }
        // The place relative to the centre, times the slope.
        let place = [0, 1, 2].map(|k| &d[k] * &height - &to[k] * &slope);
        let (length, steep) = (double(&dot(&d, &d), 2).sqrt(), double(&slope, 2));
        let upright = double(&dot(&n, &n), 2).sqrt();
        Some(Crossing {
            t: double(&height, 2) / steep,
            from_centre: place.map(|p| double(&p, 3) / steep).into_iter().map(|p| p * p).sum::<f64>().sqrt(),
            slope: (steep / length / upright).abs(),
            length,
            way: double(&dot(&to, &to), 2).sqrt(),
        })
    }
}

/// How far a place is from a centre, but for a roundoff of double precision.
pub fn distance(centre: Vec3, place: Vec3) -> f64 {
    let to = minus(&vector(centre), &vector(place));
    double(&dot(&to, &to), 2).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chord_of_three_four_five() {
        let passage = Passage::of(Vec3::new(0.5, 0.25, 0.0), 0.3125, Vec3::new(0.0, 0.0, 0.0), Vec3::X * 0.5);
        assert_eq!((passage.square, passage.middle, passage.length), (0.1875 * 0.1875, 1.0, 0.5));
        assert_eq!((passage.half(0.0), passage.way), (0.375, 0.3125f64.sqrt()));
        let beside = Passage::of(Vec3::Y, 0.5, Vec3::ZERO, Vec3::Z);
        assert_eq!((beside.square, beside.half(0.0), beside.half(1.0)), (-0.75, 0.0, 0.5));
    }

    /// Where double precision alone would see nothing but rounding.
    #[test]
    fn the_least_step_beside_a_tangent_is_seen() {
        let (radius, below) = (1e-6, f32::from_bits(1e-6f32.to_bits() - 1));
        let at = |height: f32| Passage::of(Vec3::ZERO, radius, Vec3::new(-1.0, height, 0.0), Vec3::X).square;
        let step = f64::from(radius).powi(2) - f64::from(below).powi(2);
        assert_eq!((at(radius), at(below)), (0.0, step));
        assert!(at(f32::from_bits(radius.to_bits() + 1)) < 0.0);
    }

    #[test]
    fn a_plane_is_crossed_where_it_is() {
        let (centre, normal) = (Vec3::new(0.0, 0.0, -1.0), Vec3::Z);
        let crossing = Crossing::of(centre, normal, Vec3::ZERO, Vec3::new(0.75, 0.0, -1.0)).unwrap();
        assert_eq!((crossing.t, crossing.from_centre, crossing.length), (1.0, 0.75, 1.25));
        assert_eq!((crossing.slope, crossing.way), (0.8, 1.0));
        assert!(Crossing::of(centre, normal, Vec3::ZERO, Vec3::Y).is_none());
    }
}
