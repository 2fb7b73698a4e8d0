//! Rays that lie beside each other, in the lanes of values: what a CPU with vectors follows at once. They have one time; rays of
//! several times are followed one by one.

use core::array::from_fn;

use super::segment::NOWHERE;
use super::{Found, Segment, shadow, trace};
use crate::ray::{Hit, Ray};
use crate::real::{Lanes, Scalar, V3};
use crate::scene::TraceContext;
use crate::traverse::lanes::RayLanes;
use crate::traverse::{Closest, Leaf, Occlusion, Query, Together, leaf};

/// Values of lanes that are followed at once.
const VALUES: usize = 4;

/// As many rays as are followed at once.
pub const fn most<S: Scalar, P: Lanes<S>>() -> usize {
    VALUES * P::COUNT as usize
}

/// The closest hits of at most [`most`] rays; `keep` is told each.
#[inline(always)]
pub fn trace_together<S: Scalar, P: Lanes<S> + RayLanes, M: Together, L: Leaf>(
    context: &TraceContext<'_>,
    segments: &[Segment<S>],
    mut keep: impl FnMut(usize, Found<S>),
) {
    let hits = follow::<S, P, M, L, Closest>(context, segments);
    let lanes = P::COUNT as usize;
    for (value, hit) in hits.iter().enumerate() {
        let (u, v) = hit.coordinates();
        let mut i = 0;
        while i < lanes && value * lanes + i < segments.len() {
            let (index, instance) = (P::index_of(hit.primitive_index, i), P::index_of(hit.instance, i));
            let coordinates = (u.lane(i), v.lane(i));
            keep(value * lanes + i, Found { t: hit.t.lane(i), coordinates, index, instance, time: 0.0 });
            i += 1;
        }
    }
}

/// Whether something opaque is before the limit of at most [`most`] rays; `keep` is told each answer.
#[inline(always)]
pub fn shadow_together<S: Scalar, P: Lanes<S> + RayLanes, M: Together, L: Leaf>(
    context: &TraceContext<'_>,
    segments: &[Segment<S>],
    mut keep: impl FnMut(usize, u32),
) {
    let hits = follow::<S, P, M, L, Occlusion>(context, segments);
    let lanes = P::COUNT as usize;
    for i in 0..segments.len() {
        let occluded = P::bits(leaf::occluded(&hits[i / lanes]));
        keep(i, shadow::answer((occluded >> (i % lanes)) & 1 == 1));
    }
}

#[inline(always)]
fn follow<S: Scalar, P: Lanes<S> + RayLanes, M: Together, L: Leaf, Q: Query>(
    context: &TraceContext<'_>,
    segments: &[Segment<S>],
) -> [Hit<P>; VALUES] {
    let lanes = P::COUNT as usize;
    let at = |i: usize| &segments[if i < segments.len() { i } else { 0 }];
    let rays: [Ray<P>; VALUES] = from_fn(|value| {
        let first = value * lanes;
        let vector = |of: fn(&Segment<S>) -> V3<S>| {
            V3::new(P::of(|i| of(at(first + i)).x), P::of(|i| of(at(first + i)).y), P::of(|i| of(at(first + i)).z))
        };
        let source_primitive = P::indices(|i| at(first + i).source_primitive);
        let from_afar = !Q::ANY && trace::is_of_camera(context.base.spec.launch);
        Ray::prepared(source_primitive, vector(|s| s.origin), vector(|s| s.direction), from_afar)
    });
    let limit = |i| if i < segments.len() { at(i).limit } else { S::splat(NOWHERE) };
    let mut hits: [Hit<P>; VALUES] = from_fn(|value| Hit::none(P::of(|i| limit(value * lanes + i))));
    let values = segments.len().div_ceil(lanes);
    M::together::<P, Q, L>(context, &rays[..values], &mut hits[..values]);
    hits
}
