//! Primitives that some rays do not meet, though they are in the way. Rays that start on no primitive are the camera's.

use crate::data::{Effects, Media, Primitive, Specialisation};
use crate::ray::{Hit, Ray};
use crate::real::{Mask, Real};
use crate::traverse::Query;

/// Whose rays a query tells apart from others, by what they start on, and the flags of primitives that those rays do not meet, and that
/// the others do not: a shadow ray of a catcher, or a ray of the camera. Only closest hits of paths are surfaces that are not there.
#[inline(always)]
fn senders<Q: Query, R: Real>(spec: Specialisation) -> (u32, u32, u32) {
    let open = if Q::ANY || !spec.media.has(Media::OPEN) { Primitive::OPEN } else { 0 };
    if Q::ANY {
        let of_all = Primitive::SHADOWLESS | open;
        (Ray::<R>::OF_CATCHER, Primitive::CATCHER | of_all, of_all)
    } else {
        (Hit::<R>::NOTHING, Primitive::UNSEEN | open, Primitive::UNREFLECTED | open)
    }
}

/// Does a ray not meet a primitive, by who sent it? What a GPU asks, whose values are single rays', before any test: once
/// for all kinds, since every kernel holds it.
#[inline(always)]
pub(super) fn is_unmet<Q: Query, R: Real>(spec: Specialisation, primitive: &Primitive, ray: &Ray<R>) -> bool {
    if !cfg!(target_arch = "spirv") || !spec.effects.has(Effects::HIDDEN) {
        return false;
    }
    if Q::OPEN {
        return !primitive.has(Primitive::OPEN);
    }
    let (sender, from_it, from_others) = senders::<Q, R>(spec);
    primitive.has(if R::equals(sender, ray.source_primitive).any() { from_it } else { from_others })
}

/// The lanes of a mask whose rays meet it: what a CPU asks, where few tests come so far.
#[inline(always)]
pub(super) fn met<Q: Query, R: Real>(
    spec: Specialisation,
    primitive: &Primitive,
    ray: &Ray<R>,
    mask: R::Mask,
) -> R::Mask {
    if cfg!(target_arch = "spirv") || !spec.effects.has(Effects::HIDDEN) {
        return mask;
    }
    if Q::OPEN {
        return if primitive.has(Primitive::OPEN) { mask } else { mask & !mask };
    }
    let (sender, from_it, from_others) = senders::<Q, R>(spec);
    if !primitive.has(from_it | from_others) {
        return mask;
    }
    let is_sender = R::equals(sender, ray.source_primitive);
    let of_it = if primitive.has(from_it) { mask & !is_sender } else { mask };
    if primitive.has(from_others) { of_it & is_sender } else { of_it }
}
