//! Whether a light reaches what a slot's ray hit (thesis algorithm 3.2), or a ray of a stream its end.

use super::{Found, Path, Segment};
use crate::buffer::read;
use crate::data::{Launch, Light};
use crate::geometry::SurfaceInteraction;
use crate::light::{at_time, ray_to_light};
use crate::ray::Hit;
use crate::real::Scalar;
use crate::scene::TraceContext;
use crate::traverse::{Leaf, Method, Occlusion, leaf};

/// The light reaches the place.
pub const REACHED: u32 = 0;
/// Something opaque is between.
pub const SHADOWED: u32 = 1;
/// The place faces away from the light, or there is no place: no ray was traced.
pub const FACES_AWAY: u32 = 2;

/// What asks for shadow rays.
#[derive(Clone, Copy)]
pub struct ShadowInputs<'a, R: Scalar> {
    /// Lights in file order.
    pub lights: &'a [Light],
    /// Paths by level, record and slot, or the stream's rays.
    pub paths: &'a [R::Record],
    /// [`Found`] by slot.
    pub hits: &'a [R::Record],
}

/// The ray from a slot's hit towards light `index`, and whether it is to be traced at all.
#[inline(always)]
pub fn shadow_ray<R: Scalar>(
    context: &TraceContext<'_>,
    asking: ShadowInputs<'_, R>,
    slot: u32,
    index: u32,
) -> (Segment<R>, bool) {
    if context.base.spec.launch.has(Launch::STREAM) {
        return (Segment::load(context.base.frame.slots, slot, asking.paths), true);
    }
    let path = Path::<R>::current(&context.base, slot, asking.paths);
    let found = Found::<R>::load(&context.base, slot, asking.hits);
    if found.is_nothing() {
        let nowhere = Segment {
            origin: path.origin,
            direction: path.direction,
            limit: found.t,
            source_primitive: path.source_primitive,
        };
        return (nowhere, false);
    }
    let primitive = context.base.placed(found.index, found.instance, found.time);
    let effects = context.base.spec.effects;
    let interaction = SurfaceInteraction::new(effects, &primitive, found.coordinates, path.direction);
    let light = at_time::<R>(&context.base, read(asking.lights, index), found.time);
    let (origin, direction, limit) = ray_to_light(effects, &light, &interaction);
    let source_primitive = interaction.source_primitive(direction);
    (Segment { origin, direction, limit, source_primitive }, interaction.faces(direction))
}

/// Traces the shadow ray from a slot's hit to light `index`.
#[inline(always)]
pub fn shadow<R: Scalar, M: Method<R>, L: Leaf>(
    context: &TraceContext<'_>,
    asking: ShadowInputs<'_, R>,
    slot: u32,
    index: u32,
) -> u32 {
    let (segment, faces) = shadow_ray(context, asking, slot, index);
    if !faces {
        return FACES_AWAY;
    }
    let mut hit = Hit::none(segment.limit);
    let time = Found::<R>::time(&context.base, slot, asking.hits);
    M::traverse::<Occlusion, L>(context, &segment.ray().at(time), &mut hit);
    visibility(&hit)
}

/// The answer of a ray that was traced.
#[inline(always)]
pub fn visibility<R: Scalar>(hit: &Hit<R>) -> u32 {
    answer(leaf::occluded(hit))
}

#[inline(always)]
pub(super) fn answer(occluded: bool) -> u32 {
    if occluded { SHADOWED } else { REACHED }
}
