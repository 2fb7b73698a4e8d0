//! What is between surfaces dims the light of a shadow ray, whose way may lead through surfaces that are not there.

use super::segment::NOWHERE;
use super::{Found, PathState, REACHED, Segment, ShadowRay};
use crate::buffer::{read, write};
use crate::data::{Filling, Material, Media, Medium};
use crate::geometry::SurfaceInteraction;
use crate::medium::{MOST_CROSSINGS, ratio, transmittance};
use crate::ray::Hit;
use crate::real::{FAINT, Scalar, V3};
use crate::scene::TraceContext;
use crate::traverse::{ClosestOpen, Leaf, Method};
use glam::UVec4;

/// What tells how much light gets through.
#[derive(Clone, Copy)]
pub struct TransmitInputs<'a, R: Scalar> {
    /// [`PathState`]s by record and slot.
    pub paths: &'a [R::Record],
    /// Whether each slot's ray arrived.
    pub shadows: &'a [u32],
    /// What surfaces are filled with.
    pub materials: &'a [Material],
    /// Media by their numbers.
    pub media: &'a [Medium],
    /// Where they are denser.
    pub grids: &'a [u32],
    /// What light of single wavelengths does, see [`SpectrumRow`](crate::data::SpectrumRow).
    pub spectra: &'a [UVec4],
}

/// Multiplies the light of a slot's shadow ray, which lies in memory as a [`ShadowRay`], with what gets through.
#[inline(always)]
pub fn transmit<R: Scalar, M: Method<R>, L: Leaf>(
    context: &TraceContext<'_>,
    TransmitInputs { paths, shadows, materials, media, grids, spectra }: TransmitInputs<'_, R>,
    (slot, time): (u32, f32),
    segments: &mut [R::Record],
) {
    let (frame, effects) = (context.base.frame, context.base.spec.effects);
    let (light, tag) = R::load(read(segments, 2 * frame.slots + slot));
    if read(shadows, slot) != REACHED || !R::splat(0.0).lt(light.greatest()) {
        return;
    }
    let segment = Segment::<R>::load(context.base.frame.slots, slot, segments);
    let (mut inside, lead, chain) = ShadowRay::<R>::medium(frame.slots, slot, segments);
    let Segment { mut origin, mut source_primitive, direction, limit: mut left } = segment;
    let is_open = context.base.spec.media.has(Media::OPEN);
    // Its pixel is that of the path that goes on, or has ended here.
    let (key, sample) = PathState::<R>::drawn_by(frame, slot, paths);
    let launch = context.base.of_sample(spectra, key, sample);
    let mut light = light;
    let mut before = lead;
    let mut crossings = 0;
    while crossings <= MOST_CROSSINGS {
        let ray = Segment { origin, direction, limit: left, source_primitive }.ray().at(time);
        let mut hit = Hit::none(if is_open { left } else { R::splat(NOWHERE) });
        M::traverse::<ClosestOpen, L>(context, &ray, &mut hit);
        let found = Found::<R>::of(context, &ray, &hit);
        let is_end = found.is_nothing();
        let distance = if is_end { left } else { found.t };
        let number = inside.medium(media, frame.fog());
        if number != 0 {
            let medium = launch.medium(media, number);
            let through = if context.base.spec.media.has(Media::GRIDS) && medium.has_grid() {
                let from = origin - direction * before;
                ratio(&medium, grids, (from, direction), distance + before, chain.further(crossings))
            } else {
                transmittance(&medium, distance + before)
            };
            light = light.times(through).map(|c| c.flush(FAINT));
        }
        if is_end {
            break;
        }
        let primitive = context.base.placed(found.index, found.instance, found.time);
        let interaction = SurfaceInteraction::new(effects, &primitive, found.coordinates, direction);
        let filling = Filling(read(materials, primitive.material()).transmission.w);
        inside = inside.across(interaction.front, filling.medium());
        origin = interaction.offset_ray_origin(direction);
        source_primitive = interaction.source_primitive(direction);
        left = left - found.t;
        before = R::splat(0.0);
        crossings += 1;
    }
    // A way without an end to count is one without light.
    let light = launch.rgb(V3::select(crossings <= MOST_CROSSINGS, light, V3::zero()));
    write(segments, 2 * frame.slots + slot, R::store(light, tag));
}
