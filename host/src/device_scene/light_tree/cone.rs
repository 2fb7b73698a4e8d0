//! Where lights shine: a cone around their normals.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::math::{acos, cos, sin};

/// A cone around normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// Of unit length.
    pub axis: DVec3,
    /// Half its angle, in radians.
    pub opening: f64,
    /// Does light go up to a right angle from the normals, and not along them alone?
    pub is_spread: bool,
    /// Does it go along the opposite of each normal, too?
    pub is_two_sided: bool,
}

impl Cone {
    /// Of a flat surface.
    pub fn flat(axis: DVec3, is_two_sided: bool) -> Self {
        Cone { axis, opening: 0.0, is_spread: true, is_two_sided }
    }

    /// Of what shines everywhere.
    pub fn all() -> Self {
        Cone { axis: DVec3::Z, opening: PI, is_spread: true, is_two_sided: false }
    }

    /// The least one around two.
    pub fn with(self, other: Cone) -> Cone {
        let is_spread = self.is_spread || other.is_spread;
        let is_two_sided = self.is_two_sided || other.is_two_sided;
        let (wide, narrow) = if self.opening < other.opening { (other, self) } else { (self, other) };
        let turns = is_two_sided && wide.axis.dot(narrow.axis) < 0.0;
        let toward = if turns { -narrow.axis } else { narrow.axis };
        let between = acos(wide.axis.dot(toward).clamp(-1.0, 1.0));
        let of = |axis, opening| Cone { axis, opening, is_spread, is_two_sided };
        if (between + narrow.opening).min(PI) <= wide.opening {
            return of(wide.axis, wide.opening);
        }
        let opening = (wide.opening + between + narrow.opening) / 2.0;
        let across = (toward - wide.axis * wide.axis.dot(toward)).normalize_or_zero();
        if opening >= PI || across == DVec3::ZERO {
            return of(wide.axis, PI);
        }
        let angle = opening - wide.opening;
        of(wide.axis * cos(angle) + across * sin(angle), opening)
    }

    /// The solid angle that light goes to, what leaves at a slant counting less (PBRT-v4 12.6.3).
    pub fn measure(&self) -> f64 {
        let (opening, reach) = (self.opening, if self.is_spread { FRAC_PI_2 } else { 0.0 });
        let widest = (opening + reach).min(PI);
        let beyond =
            2.0 * widest * sin(opening) - cos(opening - 2.0 * widest) - 2.0 * opening * sin(opening) + cos(opening);
        let measure = 2.0 * PI * (1.0 - cos(opening)) + FRAC_PI_2 * beyond;
        if self.is_two_sided { (2.0 * measure).min(4.0 * PI) } else { measure }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_around_two_has_both_and_no_more_than_it_must() {
        let of = |axis: DVec3, opening| Cone { opening, ..Cone::flat(axis, false) };
        let both = of(DVec3::X, 0.3).with(of(DVec3::Y, 0.1));
        assert!((both.opening - (FRAC_PI_2 + 0.4) / 2.0).abs() < 1e-12);
        assert!((acos(both.axis.x) - (both.opening - 0.3)).abs() < 1e-12);
        assert!((acos(both.axis.y) - (both.opening - 0.1)).abs() < 1e-12);
        let near = DVec3::new(1.0, 0.1, 0.0).normalize();
        assert_eq!(of(DVec3::X, 1.0).with(of(near, 0.5)).opening, 1.0, "that one is within");
        assert_eq!(of(DVec3::X, 0.0).with(of(-DVec3::X, 0.0)).opening, PI);
        let flat = |axis| Cone::flat(axis, true);
        assert_eq!(flat(DVec3::X).with(flat(-DVec3::X)).opening, 0.0, "two sides are those of either");
    }

    #[test]
    fn the_measure_of_a_surface_is_pi_and_of_everything_four_pi() {
        assert!((Cone::flat(DVec3::X, false).measure() - PI).abs() < 1e-12);
        assert!((Cone::all().measure() - 4.0 * PI).abs() < 1e-12);
    }
}
