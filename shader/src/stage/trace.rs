//! The closest hit of a slot's ray, primary or secondary.

use super::Path;
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};
use crate::scene::Geometry;
use crate::traverse::{Closest, Method};

/// Traces a slot's ray; returns (t, u, v) and the slot of the triangle, or [`Hit::NOTHING`].
#[inline(always)]
pub fn trace<R: Scalar, M: Method<R>>(geometry: &Geometry<'_>, slot: u32, paths: &[R::Record]) -> R::Record {
    let path = Path::<R>::current(geometry, slot, paths);
    let mut hit = Hit::none(R::splat(f32::MAX));
    M::traverse::<Closest>(geometry, &Ray::leaving(path.leaves, path.origin, path.direction), &mut hit);
    R::store(V3::new(hit.t, hit.u, hit.v), hit.slot)
}
