//! Disks in leaves.

use super::primitives::counts;
use super::{Identity, Meeting, accept, hidden};
use crate::data::{Effects, Primitive};
use crate::geometry::{self, Crossing, intersect_disk};
use crate::ray::{Hit, Ray};
use crate::real::{Mask, Real, Scalar, V3};
use crate::scene::TraceContext;
use crate::traverse::Query;

/// Tests a disk and takes the hit if it is the best so far.
#[inline(always)]
pub fn intersect<Q: Query, R: Real>(
    context: &TraceContext<'_>,
    disk: &Primitive,
    index: u32,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let effects = context.base.spec.effects;
    if !counts::<Q>(effects, disk) {
        return;
    }
    let crossing = single(disk, ray);
    let (number, zero) = (disk.number(), R::splat(0.0));
    let ahead = zero.lt(crossing.t) & crossing.t.le(hit.t);
    // A ray can't meet a plane twice.
    let mut inside = crossing.meets & ahead & !R::equals(number, ray.source_primitive);
    if effects.has(Effects::CULLING) && !Q::ANY && disk.is_culled() {
        inside = inside & crossing.front;
    }
    inside = hidden::met::<Q, R>(context.base.spec, disk, ray, inside);
    if !inside.any() {
        return;
    }
    let (u, v) = if Q::ANY || cfg!(target_arch = "spirv") {
        (zero, zero)
    } else {
        geometry::coordinates(V3::splat(disk.normal()), crossing.place)
    };
    let met = Meeting { inside, t: crossing.t, u, v, scale: R::splat(disk.radius()).reciprocal() };
    accept::<Q, R>(met, Identity::alone(index, disk), hit);
}

#[inline(always)]
fn single<R: Real>(disk: &Primitive, ray: &Ray<R>) -> Crossing<R> {
    let shape = (V3::splat(disk.centre()), V3::splat(disk.normal()), R::splat(disk.radius()));
    intersect_disk(shape, ray.origin, ray.direction)
}

/// Where a ray has hit a disk along its tangents, in radii.
#[inline(always)]
pub fn coordinates<R: Scalar>(disk: &Primitive, ray: &Ray<R>) -> (R, R) {
    let (u, v) = geometry::coordinates(V3::splat(disk.normal()), single(disk, ray).place);
    let scale = R::splat(disk.radius()).reciprocal();
    (u * scale, v * scale)
}
