//! The closest hit of a slot's ray, primary, secondary or of a stream.

use super::segment::NOWHERE;
use super::{Found, Path, Segment};
use crate::data::Launch;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::TraceContext;
use crate::traverse::{Closest, Leaf, Method};

/// A slot's ray.
#[inline(always)]
pub fn traced<R: Scalar>(context: &TraceContext<'_>, slot: u32, paths: &[R::Record]) -> Segment<R> {
    if context.base.spec.launch.has(Launch::STREAM) {
        return Segment::load(context.base.frame.slots, slot, paths);
    }
    let path = Path::<R>::current(&context.base, slot, paths);
    let Path { origin, direction, weight, source_primitive, .. } = path;
    // A camera may have no ray at a place of its image.
    let launch = context.base.spec.launch;
    let is_none = launch.has(Launch::KEPT) && weight.greatest().eq(R::splat(0.0));
    let limit = if is_none {
        R::splat(NOWHERE)
    } else if launch.has(Launch::CLIPPED) && is_of_camera(launch) {
        Path::limit(slot, paths)
    } else {
        R::splat(f32::MAX)
    };
    Segment { origin, direction, limit, source_primitive }
}

/// Does a launch follow the camera's rays, which may start far from the scene?
#[inline(always)]
pub(super) fn is_of_camera(launch: Launch) -> bool {
    !launch.has(Launch::SECONDARY | Launch::STREAM)
}

/// A slot's ray at a time, ready for boxes and primitives, and its limit.
#[inline(always)]
pub fn ray<R: Scalar>(context: &TraceContext<'_>, (slot, time): (u32, f32), paths: &[R::Record]) -> (Ray<R>, R) {
    let segment = traced::<R>(context, slot, paths);
    let from_afar = is_of_camera(context.base.spec.launch);
    let source_primitive = R::index(segment.source_primitive);
    (Ray::prepared(source_primitive, segment.origin, segment.direction, from_afar).at(time), segment.limit)
}

/// Traces a slot's ray at a time.
#[inline(always)]
pub fn trace<R: Scalar, M: Method<R>, L: Leaf>(
    context: &TraceContext<'_>,
    of: (u32, f32),
    paths: &[R::Record],
) -> Found<R> {
    let (ray, limit) = ray::<R>(context, of, paths);
    let mut hit = Hit::none(limit);
    M::traverse::<Closest, L>(context, &ray, &mut hit);
    Found::of(context, &ray, &hit)
}
