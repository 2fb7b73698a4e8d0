//! Primitives that some rays do not meet, though they are in the way. Rays that start on no primitive are the camera's.

use crate::data::{Effects, Primitive};
use crate::ray::{Hit, Ray};
use crate::real::{Mask, Real};
use crate::traverse::Query;

/// Does a ray not meet a primitive, by who sent it? What a GPU asks, whose values are single rays', before any test: once
/// for all kinds, since every kernel holds it.
#[inline(always)]
pub(super) fn is_unmet<Q: Query, R: Real>(effects: Effects, primitive: &Primitive, ray: &Ray<R>) -> bool {
    if !cfg!(target_arch = "spirv") || !effects.has(Effects::HIDDEN) {
        return false;
    }
    if Q::ANY {
        let of_catcher = R::equals(Ray::<R>::OF_CATCHER, ray.source_primitive).any();
        return primitive.has(if of_catcher {
            Primitive::SHADOWLESS | Primitive::CATCHER
        } else {
            Primitive::SHADOWLESS
        });
    }
    let of_camera = R::equals(Hit::<R>::NOTHING, ray.source_primitive).any();
    primitive.has(if of_camera { Primitive::UNSEEN } else { Primitive::UNREFLECTED })
}

/// The lanes of a mask whose rays meet it: what a CPU asks, where few tests come so far.
#[inline(always)]
pub(super) fn met<Q: Query, R: Real>(effects: Effects, primitive: &Primitive, ray: &Ray<R>, mask: R::Mask) -> R::Mask {
    const ANY: u32 = Primitive::UNSEEN | Primitive::UNREFLECTED | Primitive::SHADOWLESS | Primitive::CATCHER;
    if cfg!(target_arch = "spirv") || !effects.has(Effects::HIDDEN) || !primitive.has(ANY) {
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
