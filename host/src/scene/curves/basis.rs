//! What curve control points are of: every kind as cubic Bezier curves, one behind the other.

use std::ops::{Add, Mul, Sub};

use crate::choice::choices;

choices! {
    /// What curve the control points of a strand are of.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Basis {
        /// Cubic Bezier curves, of which each begins with the last point of the one before
        Bezier = "bezier",
        /// A uniform cubic B-spline, which goes near its points, and not to the first and the last
        BSpline = "b-spline",
        /// A uniform Catmull-Rom spline, which goes through all of its points
        #[default]
        CatmullRom = "catmull-rom",
        /// Straight lines
        Linear = "linear",
    }
}

/// What is interpolated: places, radii, directions and colours alike.
pub trait Value: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> {}

impl<V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>> Value for V {}

impl Basis {
    /// How many Bezier curves so many points are.
    ///
    /// # Errors
    /// How many points there should be.
    pub fn pieces(self, points: usize) -> Result<usize, &'static str> {
        match self {
            Basis::Bezier if points >= 4 && points % 3 == 1 => Ok(points / 3),
            Basis::Bezier => Err("4 points, or 3 more for each further curve"),
            Basis::BSpline if points >= 4 => Ok(points - 3),
            Basis::BSpline => Err("at least 4 points"),
            Basis::CatmullRom | Basis::Linear if points >= 2 => Ok(points - 1),
            Basis::CatmullRom | Basis::Linear => Err("at least 2 points"),
        }
    }

    /// The points of the Bezier curve of this number, of so many control points.
    pub(super) fn piece<V: Value>(self, number: usize, points: usize, at: impl Fn(usize) -> V) -> [V; 4] {
        match self {
            Basis::Bezier => [0, 1, 2, 3].map(|k| at(3 * number + k)),
            Basis::BSpline => {
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| at(number + k));
                let knot = |a: V, b: V, c: V| (a + b * 4.0 + c) * (1.0 / 6.0);
                [knot(a, b, c), (b * 2.0 + c) * (1.0 / 3.0), (b + c * 2.0) * (1.0 / 3.0), knot(b, c, d)]
            }
            Basis::CatmullRom => {
                let (b, c) = (at(number), at(number + 1));
                // Beyond its ends it goes on as it does between the two points there.
                let a = if number == 0 { b * 2.0 - c } else { at(number - 1) };
                let d = if number + 2 == points { c * 2.0 - b } else { at(number + 2) };
                [b, b + (c - a) * (1.0 / 6.0), c - (d - b) * (1.0 / 6.0), c]
            }
            Basis::Linear => {
                let (a, b) = (at(number), at(number + 1));
                [a, a + (b - a) * (1.0 / 3.0), b - (b - a) * (1.0 / 3.0), b]
            }
        }
    }
}

/// A Bezier curve at a share of its way.
pub fn bezier<V: Value>([a, b, c, d]: [V; 4], share: f64) -> V {
    let rest = 1.0 - share;
    a * (rest * rest * rest)
        + b * (3.0 * rest * rest * share)
        + c * (3.0 * rest * share * share)
        + d * (share * share * share)
}

/// Both halves of a Bezier curve (de Casteljau).
pub fn halves<V: Value>([a, b, c, d]: [V; 4]) -> [[V; 4]; 2] {
    let middle = |a: V, b: V| (a + b) * 0.5;
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
    let all = middle(abc, bcd);
    [[a, ab, abc, all], [all, bcd, cd, d]]
}
