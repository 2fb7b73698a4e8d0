//! The closest hit of a slot's ray, primary, secondary or of a stream.

use super::{Path, Segment};
use crate::camera;
use crate::data::Launch;
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};
use crate::scene::TraceContext;
use crate::traverse::{Closest, Method, step};

/// A slot's ray.
#[inline(always)]
pub fn traced<R: Scalar>(geometry: &TraceContext<'_>, slot: u32, paths: &[R::Record]) -> Segment<R> {
    if geometry.base.spec.launch.has(Launch::STREAM) {
        return Segment::load(geometry, slot, paths);
    }
    let path = Path::<R>::current(&geometry.base, slot, paths);
    let is_secondary = geometry.base.spec.launch.has(Launch::SECONDARY);
    Segment {
        origin: if is_secondary { path.origin } else { camera::approach(path.origin, path.direction) },
        direction: path.direction,
        limit: R::splat(f32::MAX),
        source_primitive: path.source_primitive,
    }
}

/// What is kept of a ray's hit: (t, u, v) and the triangle index, or [`Hit::NOTHING`].
#[inline(always)]
pub fn found<R: Scalar>(geometry: &TraceContext<'_>, ray: &Ray<R>, hit: &Hit<R>) -> R::Record {
    let (u, v) = step::weights(geometry, ray, hit);
    record(V3::new(hit.t, u, v), hit.triangle_index)
}

/// (t, u, v) and the triangle index, as they lie in memory.
#[inline(always)]
pub(super) fn record<R: Scalar>(place: V3<R>, triangle_index: u32) -> R::Record {
    R::store(place, triangle_index)
}

/// Traces a slot's ray; returns what [`found`] does.
#[inline(always)]
pub fn trace<R: Scalar, M: Method<R>>(geometry: &TraceContext<'_>, slot: u32, paths: &[R::Record]) -> R::Record {
    let segment = traced::<R>(geometry, slot, paths);
    let mut hit = Hit::none(segment.limit);
    let ray = segment.ray();
    M::traverse::<Closest>(geometry, &ray, &mut hit);
    found(geometry, &ray, &hit)
}
