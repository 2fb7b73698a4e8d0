//! What a facet does with light.

use super::layers::{Layers, Way};
use crate::data::Effects;
use crate::real::{FAINT, Real, SMALL, Scalar, V3};

/// A facet, seen from somewhere.
pub struct Facet<R: Real> {
    /// The colour that it reflects.
    pub reflected: V3<R>,
    /// The share of light that it does not.
    pub rest: R,
    /// How likely it is taken for one that reflects.
    pub probability: R,
}

impl<R: Scalar> Facet<R> {
    /// One that does nothing.
    #[inline(always)]
    pub fn none() -> Self {
        Facet { reflected: V3::zero(), rest: R::splat(0.0), probability: R::splat(0.0) }
    }

    /// Of unit normal `h`, seen from the unit direction `viewer`.
    #[inline(always)]
    pub fn new(effects: Effects, layers: &Layers<R>, viewer: V3<R>, h: V3<R>) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let reflected = reflected(effects, layers, viewer, h);
        let greatest = reflected.greatest().min(one);
        let rest = rest(reflected);
        let passes = if passes(effects, layers) { (layers.through.greatest() * rest).flush(FAINT) } else { zero };
        let probability = if zero.lt(passes) { greatest.flush(FAINT).over(greatest + passes) } else { one };
        Facet { reflected, rest, probability }
    }
}

/// Does anything pass? A constant where no material of the scene lets it.
#[inline(always)]
pub fn passes<R: Scalar>(effects: Effects, layers: &Layers<R>) -> bool {
    effects.has(Effects::THIN | Effects::REFRACTION) && layers.way != Way::OPAQUE
}

/// What a facet of unit normal `h` reflects of light from the unit vector `w`.
#[inline(always)]
pub fn reflected<R: Scalar>(effects: Effects, layers: &Layers<R>, w: V3<R>, h: V3<R>) -> V3<R> {
    let cosine = w.dot(h).max(R::splat(0.0)).min(R::splat(1.0)).flush(SMALL);
    layers.reflectance.at(effects, (w, h, cosine))
}

/// The share of light that is not reflected.
#[inline(always)]
pub fn rest<R: Scalar>(reflected: V3<R>) -> R {
    (R::splat(1.0) - reflected.greatest().min(R::splat(1.0))).flush(FAINT)
}
