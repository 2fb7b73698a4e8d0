//! The crossings of a stream's rays with triangles, one after the other.

use super::{Found, Segment};
use crate::ray::Hit;
use crate::real::Scalar;
use crate::scene::TraceContext;
use crate::traverse::{Closest, Crossings, Method, leaf};

/// The next crossing of ray `slot` past the one that is told of it, or past a distance where that is none: below zero before the first. The
/// last is followed by none at the ray's end, and that by itself.
#[inline(always)]
pub fn cross<R: Scalar, M: Method<R>>(
    context: &TraceContext<'_>,
    (slot, before): (u32, Found<R>),
    stream: &[R::Record],
) -> Found<R> {
    let segment = Segment::<R>::load(context.base.frame.slots, slot, stream);
    let number = if before.is_nothing() {
        Hit::<R>::NOTHING
    } else {
        context.base.placed(before.index, before.instance, 0.0).number()
    };
    let ray = segment.ray().past(before.t, number);
    let mut hit = Hit::none(segment.limit);
    M::traverse::<Closest, Crossings>(context, &ray, &mut hit);
    let coordinates = leaf::crossing_weights(context, &ray, &hit);
    Found { t: hit.t, coordinates, index: hit.primitive_index, instance: hit.instance, time: 0.0 }
}
