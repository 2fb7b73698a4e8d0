//! Whether a light reaches what a slot's ray hit (thesis algorithm 3.2).

use super::Path;
use crate::buffer::read;
use crate::data::Light;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::Geometry;
use crate::shade::{Contact, shadow_ray};
use crate::traverse::{Method, Occlusion, step};

/// The light reaches the place.
pub const REACHED: u32 = 0;
/// Something opaque is between.
pub const SHADOWED: u32 = 1;
/// The place faces away from the light, or there is no place: no ray was traced.
pub const FACES_AWAY: u32 = 2;

/// Traces the shadow ray from a slot's hit to light `index`.
#[inline(always)]
pub fn shadow<R: Scalar, M: Method<R>>(
    geometry: &Geometry<'_>, lights: &[Light], slot: u32, index: u32, paths: &[R::Record], hits: &[R::Record],
) -> u32 {
    let (hit, place) = R::load(read(hits, slot));
    if place == Hit::<R>::NOTHING {
        return FACES_AWAY;
    }
    let path = Path::<R>::current(geometry, slot, paths);
    let contact = Contact::new(&read(geometry.triangles, place), hit.y, hit.z, path.direction);
    let light = read(lights, index);
    let (origin, direction, limit) = shadow_ray(geometry.features, &light, &contact);
    if !contact.faces(direction) {
        return FACES_AWAY;
    }
    let mut hit = Hit::none(limit);
    M::traverse::<Occlusion>(geometry, &Ray::leaving(place, origin, direction), &mut hit);
    if step::occluded(&hit) { SHADOWED } else { REACHED }
}
