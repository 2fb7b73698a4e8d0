//! What an interface reflects of unpolarised light, by the cosine of the angle of incidence.

use super::optics::ratio;
use super::{fresnel, refract};
use crate::data::Effects;
use crate::real::{Real, SMALL, Scalar, V3};
#[cfg(not(target_arch = "spirv"))]
use glam::Vec3;

/// A facet's reflectance.
#[derive(Clone, Copy)]
pub struct Reflectance<R: Real> {
    /// At normal incidence, linear RGB in [0, 1]; of a conductor the refractive part of its index.
    pub normal: V3<R>,
    /// At grazing angles; of a conductor the absorbing part.
    pub grazing: V3<R>,
    /// Is it a conductor?
    pub is_conductor: bool,
    /// Of a conductor the mean over all directions of a hemisphere by their cosine, linear RGB; see [`conductor_mean`].
    pub mean_colour: V3<R>,
    /// A share of the exact reflectance of glass that is added.
    pub glass: R,
    /// The index of refraction on the near side of the glass over that on the far side.
    pub eta: R,
    /// Does the glass have two faces, as a pane?
    pub has_two_faces: bool,
}

impl<R: Scalar> Reflectance<R> {
    /// Of light along the unit vector `-w` at a facet of unit normal `h`, whose cosine is given. Linear RGB.
    #[inline(always)]
    pub fn at(&self, effects: Effects, (w, h, cosine): (V3<R>, V3<R>, R)) -> V3<R> {
        if effects.has(Effects::CONDUCTOR) && self.is_conductor {
            return conductors(cosine, self.normal, self.grazing);
        }
        let share = self.normal + (self.grazing - self.normal) * schlick(cosine);
        if effects.has(Effects::REFRACTION | Effects::THIN) && R::splat(0.0).lt(self.glass) {
            let exact = self.glass * self.of_faces(effects, glass(w, h, self.eta));
            return share + V3::new(exact, exact, exact);
        }
        share
    }

    /// What all faces of the glass reflect, where one reflects a share of light: of two f + (1 - f)^2 (f + f^3 + ...).
    #[inline(always)]
    pub fn of_faces(&self, effects: Effects, share: R) -> R {
        if effects.has(Effects::THIN) && self.has_two_faces {
            (share + share).over(R::splat(1.0) + share)
        } else {
            share
        }
    }

    /// The greatest channel's mean over all directions of a hemisphere by their cosine, of what is no conductor. That of the glass'
    /// share is Schlick's, too.
    #[inline(always)]
    pub fn mean(&self, effects: Effects) -> R {
        let one = R::splat(1.0);
        let root = (one - self.eta).over(one + self.eta);
        let normal = self.normal.greatest() + self.glass * self.of_faces(effects, (root * root).flush(SMALL));
        let grazing = self.grazing.greatest() + self.glass;
        normal + (grazing - normal) * R::splat(MEAN)
    }

    /// The mean of Schlick's share, linear RGB.
    #[inline(always)]
    pub fn schlick_mean(&self) -> V3<R> {
        self.normal + (self.grazing - self.normal) * R::splat(MEAN)
    }
}

/// A fifth power's mean over all directions of a hemisphere by their cosine.
const MEAN: f32 = 1.0 / 21.0;

/// The mean reflectance of a conductor over all directions of a hemisphere by their cosine, linear RGB; within 1e-5.
#[cfg(not(target_arch = "spirv"))]
pub fn conductor_mean(eta: Vec3, k: Vec3) -> Vec3 {
    // By the midpoint rule over the square of the cosine, in double precision.
    const STEPS: u32 = 512;
    let of = |eta: f32, k: f32| {
        let cosine = |i: u32| ((f64::from(i) + 0.5) / f64::from(STEPS)).sqrt();
        let sum: f64 = (0..STEPS).map(|i| conductor(cosine(i), f64::from(eta), f64::from(k))).sum();
        (sum / f64::from(STEPS)) as f32
    };
    Vec3::new(of(eta.x, k.x), of(eta.y, k.y), of(eta.z, k.z))
}

/// How far reflectance has come from that at normal incidence to that at grazing angles (Schlick, An Inexpensive BRDF Model for
/// Physically-based Rendering, 1994).
#[inline(always)]
pub(super) fn schlick<R: Scalar>(cosine: R) -> R {
    /// The fifth power of anything larger is normal.
    const LEAST: f32 = 1.0 / (1 << 20) as f32;
    let x = (R::splat(1.0) - cosine).flush(LEAST);
    let square = x * x;
    square * square * x
}

/// Of glass, see [`fresnel`].
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn glass<R: Scalar>(w: V3<R>, h: V3<R>, eta: R) -> R {
    fresnel(&refract(-w, h, eta), eta)
}

/// [`conductor`] by channel.
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn conductors<R: Scalar>(cosine: R, eta: V3<R>, k: V3<R>) -> V3<R> {
    // Each channel in turn becomes the first, so that a kernel holds the equations once.
    let (mut eta, mut k, mut all) = (eta, k, V3::zero());
    let mut channel = 0;
    while channel < 3 {
        all = V3::new(all.y, all.z, conductor(cosine, eta.x, k.x));
        eta = V3::new(eta.y, eta.z, eta.x);
        k = V3::new(k.y, k.z, k.x);
        channel += 1;
    }
    all
}

/// Of a conductor with the complex index `eta + i k` in a vacuum, each at most 2^10 (Lagarde, Memo on Fresnel Equations, 2013).
#[inline(always)]
fn conductor<R: Scalar>(cosine: R, eta: R, k: R) -> R {
    let (zero, one, half) = (R::splat(0.0), R::splat(1.0), R::splat(0.5));
    let (eta, k) = (eta.flush(SMALL), k.flush(SMALL));
    let square = (cosine * cosine).flush(SMALL);
    let sine = (one - square).flush(SMALL);
    let product = (eta * k).flush(SMALL);
    let difference = (eta * eta - k * k - sine).flush(SMALL);
    let sum = (difference * difference + (product + product) * (product + product)).sqrt();
    let a = ((sum + difference) * half).max(zero).flush(SMALL).sqrt();
    let (near, twice) = (sum + square, (a + a) * cosine);
    let across = ratio(near, twice);
    let (near, twice) = (sum * square + sine * sine, twice * sine);
    (across + across * ratio(near, twice)) * half
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The equations as they are derived, in complex numbers.
    fn complex(cosine: f64, eta: f64, k: f64) -> f64 {
        let times = |(a, b): (f64, f64), (c, d): (f64, f64)| (a * c - b * d, a * d + b * c);
        let over = |(a, b): (f64, f64), (c, d): (f64, f64)| {
            let square = c * c + d * d;
            ((a * c + b * d) / square, (b * c - a * d) / square)
        };
        let root = |(a, b): (f64, f64)| {
            let size = a.hypot(b);
            (((size + a) / 2.0).sqrt(), ((size - a) / 2.0).max(0.0).sqrt().copysign(b))
        };
        let index = (eta, k);
        let sine = over((1.0 - cosine * cosine, 0.0), times(index, index));
        let inside = root((1.0 - sine.0, -sine.1));
        let minus = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0, a.1 - b.1);
        let plus = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
        let (near, far) = ((cosine, 0.0), times(index, inside));
        let across = over(minus(near, far), plus(near, far));
        let (near, far) = (times(index, near), inside);
        let along = over(minus(near, far), plus(near, far));
        (across.0.powi(2) + across.1.powi(2) + along.0.powi(2) + along.1.powi(2)) / 2.0
    }

    #[test]
    fn conductors_reflect_as_complex_numbers_say() {
        for (eta, k) in [(0.143, 3.983), (1.442, 1.603), (0.2, 3.91), (2.9, 3.1), (1.5, 0.0), (1.0, 0.5)] {
            for i in 0..=100 {
                let cosine = f64::from(i) / 100.0;
                let (got, want) = (conductor(cosine, eta, k), complex(cosine, eta, k));
                assert!((got - want).abs() < 1e-9, "{eta} + {k}i at {cosine}: {got}, not {want}");
                let single = f64::from(conductor(cosine as f32, eta as f32, k as f32));
                assert!((single - want).abs() < 1e-5, "{eta} + {k}i at {cosine}: {single}, not {want}");
            }
        }
    }

    fn at(r: &Reflectance<f64>, cosine: f64) -> V3<f64> {
        let w = V3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        r.at(Effects(u32::MAX), (w, V3::splat(Vec3::Z), cosine))
    }

    /// By Fresnel's equations for an index of 1.5 at 0, 60 and 80 degrees.
    #[test]
    fn a_pane_of_two_faces_lets_less_pass_than_one() {
        let black = V3::splat(Vec3::ZERO);
        let of = |has_two_faces| Reflectance::<f64> {
            normal: black,
            grazing: black,
            is_conductor: false,
            mean_colour: black,
            glass: 1.0,
            eta: 1.0 / 1.5,
            has_two_faces,
        };
        for (degrees, one, two) in [(0.0f64, 0.960, 0.923), (60.0, 0.911, 0.836), (80.0, 0.612, 0.441)] {
            let passed = |has_two_faces| 1.0 - at(&of(has_two_faces), degrees.to_radians().cos()).x;
            assert!((passed(false) - one).abs() < 6e-4 && (passed(true) - two).abs() < 6e-4, "{degrees}");
        }
    }

    /// Gold is yellow, and everything is white at grazing angles.
    #[test]
    fn reflectance_turns_white_where_light_grazes() {
        let of = |normal, grazing, is_conductor| Reflectance::<f64> {
            normal: V3::splat(normal),
            grazing: V3::splat(grazing),
            is_conductor,
            mean_colour: V3::splat(Vec3::ZERO),
            glass: 0.0,
            eta: 1.0,
            has_two_faces: false,
        };
        let gold = of(Vec3::new(0.143, 0.375, 1.442), Vec3::new(3.983, 2.386, 1.603), true);
        let seen = at(&gold, 1.0);
        assert!(seen.x > 0.95 && seen.x > seen.y && seen.y > seen.z && seen.z < 0.5, "{seen:?}");
        let plastic = of(Vec3::splat(0.04), Vec3::ONE, false);
        assert!((at(&plastic, 1.0).x - 0.04).abs() < 1e-9);
        for r in [gold, plastic] {
            assert!(at(&r, 0.0).x > 0.999 && at(&r, 0.0).z > 0.999);
        }
        let glass = Reflectance { glass: 1.0, eta: 1.0 / 1.5, ..of(Vec3::ZERO, Vec3::ZERO, false) };
        assert!((at(&glass, 1.0).y - 0.04).abs() < 1e-12);
    }
}
