//! Mirrors and lenses (thesis 3.3): reflection, Snell's law, Fresnel's equations.
//!
//! `d` is a unit direction of travel, `n` the unit normal on the side it comes from.

use crate::real::{Real, SMALL, Scalar, V3};

/// The mirrored direction, thesis equation 3.1: `r = d + 2 (-d.n) n`.
#[inline(always)]
pub fn reflect<R: Scalar>(d: V3<R>, n: V3<R>) -> V3<R> {
    d + n * (R::splat(-2.0) * d.dot(n))
}

/// Light that passes an interface.
#[derive(Clone, Copy)]
pub struct Refraction<R: Real> {
    /// Is there no refraction (total internal reflection)?
    pub total: bool,
    /// The direction inside, of unit length up to rounding.
    pub direction: V3<R>,
    /// Cosine of the angle of incidence.
    pub cos_in: R,
    /// Cosine of the angle of refraction.
    pub cos_out: R,
}

/// The refracted direction, thesis equation 3.3, with `eta` the index of refraction on the near side
/// over that on the far side: `t = eta (d - n (d.n)) - n sqrt(1 - eta^2 (1 - (d.n)^2))`.
#[inline(always)]
pub fn refract<R: Scalar>(d: V3<R>, n: V3<R>, eta: R) -> Refraction<R> {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let cos_in = (-d.dot(n)).max(zero).min(one);
    let squared = one - eta * eta * (one - cos_in * cos_in);
    let total = squared.lt(zero);
    let cos_out = squared.max(zero).sqrt();
    let direction = (d + n * cos_in) * eta - n * cos_out;
    Refraction { total, direction, cos_in, cos_out }
}

/// The difference of two numbers over their sum; 1 where both are zero, as the cosines of grazing light are, which is all reflected.
#[inline(always)]
pub(super) fn ratio<R: Scalar>(a: R, b: R) -> R {
    let sum = (a + b).flush(SMALL);
    let none = sum.eq(R::splat(0.0));
    R::select(none, R::splat(1.0), (a - b).flush(SMALL).over(R::select(none, R::splat(1.0), sum)))
}

/// The reflected share of unpolarised light, Fresnel's equations for a dielectric; `eta` as in [`refract`].
#[inline(always)]
pub fn fresnel<R: Scalar>(at: &Refraction<R>, eta: R) -> R {
    let one = R::splat(1.0);
    if at.total {
        return one;
    }
    let across = ratio(eta * at.cos_in, at.cos_out);
    let along = ratio(at.cos_in, eta * at.cos_out);
    (across * across + along * along) * R::splat(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type V = V3<f64>;
    const N: V = V { x: 0.0, y: 1.0, z: 0.0 };

    fn towards(angle: f64) -> V {
        V::new(angle.sin(), -angle.cos(), 0.0)
    }

    #[test]
    fn mirrored_about_the_normal() {
        let r = reflect(towards(0.5), N);
        assert!((r.x - 0.5f64.sin()).abs() < 1e-15 && (r.y - 0.5f64.cos()).abs() < 1e-15);
    }

    #[test]
    fn normal_incidence_reflects_four_percent_of_glass() {
        for eta in [1.5, 1.0 / 1.5] {
            let at = refract(towards(0.0), N, eta);
            assert!((fresnel(&at, eta) - 0.04).abs() < 1e-15);
            assert_eq!((at.direction.x, at.direction.y), (0.0, -1.0));
        }
    }

    #[test]
    fn nothing_is_reflected_at_brewsters_angle_along_the_plane() {
        let eta = 1.0 / 1.5;
        let at = refract(towards(1.5f64.atan()), N, eta);
        let across = (eta * at.cos_in - at.cos_out) / (eta * at.cos_in + at.cos_out);
        assert!((fresnel(&at, eta) - across * across / 2.0).abs() < 1e-15);
    }

    #[test]
    fn total_reflection_begins_at_the_critical_angle() {
        let critical = (1.0 / 1.5f64).asin();
        let below = refract(towards(critical - 1e-6), N, 1.5);
        let above = refract(towards(critical + 1e-6), N, 1.5);
        assert!(!below.total && above.total);
        assert!(fresnel(&below, 1.5) > 0.98 && fresnel(&above, 1.5) == 1.0);
    }

    #[test]
    fn grazing_light_is_all_reflected() {
        let at = refract(towards(std::f64::consts::FRAC_PI_2), N, 1.0);
        assert!(fresnel(&at, 1.0) <= 1.0 && fresnel(&at, 1.0) >= 0.0);
    }

    proptest! {
        #[test]
        fn snells_law(angle in 0.0f64..1.57, ior in 1.0f64..3.0, leaving: bool) {
            let eta = if leaving { ior } else { 1.0 / ior };
            let at = refract(towards(angle), N, eta);
            prop_assert_eq!(at.total, eta * angle.sin() > 1.0);
            if !at.total {
                let t = at.direction;
                prop_assert!((t.dot(t) - 1.0).abs() < 1e-12);
                prop_assert!((t.x - eta * angle.sin()).abs() < 1e-12, "bent by the wrong amount");
                prop_assert!(t.y <= 0.0 && t.z == 0.0, "on the far side, in the plane of incidence");
            }
            let share = fresnel(&at, eta);
            prop_assert!((0.0..=1.0).contains(&share));
        }

        /// Reciprocity: the same share is reflected from the other side at the refracted angle.
        #[test]
        fn fresnel_is_the_same_from_both_sides(angle in 0.0f64..1.5, ior in 1.01f64..3.0) {
            let inwards = refract(towards(angle), N, 1.0 / ior);
            let outwards = refract(inwards.direction, N, ior);
            prop_assume!(!outwards.total);
            prop_assert!((fresnel(&inwards, 1.0 / ior) - fresnel(&outwards, ior)).abs() < 1e-9);
        }
    }
}
