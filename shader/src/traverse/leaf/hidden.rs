//! Primitives that some rays do not meet, though they are in the way.

use crate::data::{Effects, Primitive};
use crate::ray::{Hit, Ray};
use crate::real::Real;
use crate::traverse::Query;

/// The lanes of a mask whose rays meet a primitive by who sent them. Rays that start on no primitive are the camera's.
#[inline(always)]
pub(super) fn met<Q: Query, R: Real>(effects: Effects, primitive: &Primitive, ray: &Ray<R>, mask: R::Mask) -> R::Mask {
    const ANY: u32 = Primitive::UNSEEN | Primitive::UNREFLECTED | Primitive::SHADOWLESS | Primitive::CATCHER;
    if !effects.has(Effects::HIDDEN) || !primitive.has(ANY) {
        return mask;
    }
    let mut met = mask;
    if Q::ANY {
        if primitive.has(Primitive::SHADOWLESS) {
            met = met & !met;
        }
        if primitive.has(Primitive::CATCHER) {
            met = met & !R::equals(Ray::<R>::OF_CATCHER, ray.source_primitive);
        }
        return met;
    }
    let of_camera = R::equals(Hit::<R>::NOTHING, ray.source_primitive);
    if primitive.has(Primitive::UNSEEN) {
        met = met & !of_camera;
    }
    if primitive.has(Primitive::UNREFLECTED) {
        met = met & of_camera;
    }
    met
}
