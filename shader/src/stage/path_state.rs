//! The path that a slot follows where integrators sample, and the light that its last vertex may get.

use super::segment::NOWHERE;
use super::{Caught, REACHED, Sample, Segment};
use crate::buffer::{read, write};
use crate::camera;
use crate::data::{Caustics, Effects, Frame, Launch, Media, Specialisation};
use crate::light::Viewpoint;
use crate::medium::{Chain, Inside};
use crate::ray::Ray;
use crate::real::{Real, SMALL, Scalar, V3};
use crate::sampler::Key;
use crate::scene::LaunchContext;
use crate::texture::Cone;

/// Records that a path takes in device memory: those of a [`super::Segment`] first, so that its ray is traced as a stream's.
pub const STATE_RECORDS: u32 = 4;
/// Records of a shadow ray, likewise, with the light that it asks for.
pub const SHADOW_RECORDS: u32 = 3;

/// Records that a path takes where there are media: what it is in, and where it was scattered.
#[inline(always)]
pub fn state_records(media: Media) -> u32 {
    STATE_RECORDS + if media.has(Media::PRESENT) { 1 } else { 0 }
}

/// Records of a shadow ray that may go through surfaces which are not there, or through grids: what it is in.
#[inline(always)]
pub fn shadow_records(media: Media) -> u32 {
    SHADOW_RECORDS + if media.has(Media::OPEN | Media::GRIDS) { 1 } else { 0 }
}

/// Bits of a path's bounces in memory, of which there are at most 65,536; those above are for groups of lamps.
const BOUNCES: u32 = 17;
/// Groups of lamps that surfaces may be unlit by: those without a name, and so many less one with one.
pub const LINKED_GROUPS: u32 = 32 - BOUNCES;

/// A path's next ray, and what of its light counts.
#[derive(Clone, Copy)]
pub struct PathState<R: Real> {
    /// Where it starts.
    pub origin: V3<R>,
    /// Its unit direction.
    pub direction: V3<R>,
    /// The primitive that it starts on, or [`Hit::NOTHING`](crate::ray::Hit::NOTHING).
    pub source_primitive: u32,
    /// What of its light reaches the pixel, linear RGB.
    pub weight: V3<R>,
    /// How often it was scattered.
    pub bounces: u32,
    /// The probability density over solid angle of its direction; 0 if it could be no other: the camera's, a mirror's or a
    /// lens'.
    pub density: R,
    /// The column and, in the upper half, the row of its pixel in the image.
    pub pixel: u32,
    /// A bit for each group of lamps that does not light where it starts ([`Effects::LINKED`]).
    pub unlit: u32,
    /// Where paths branch, how many wait in this slot and how many vertices it has had; elsewhere the width of the path's [`Cone`]
    /// and, where there are many lights, the side of its [`Viewpoint`].
    pub beside: (R, R),
    /// Where it was scattered last, or the camera: its ray may start nearer to the scene, or behind a surface that is not there.
    pub from: V3<R>,
    /// What it is in ([`Media::PRESENT`]).
    pub inside: Inside,
    /// Did photons tell the light that comes to where it was scattered last by mirrors and lenses ([`Caustics::GATHERED`])?
    pub gathered: bool,
}

/// A ray to a sampled light, and the light that arrives if nothing is between.
#[derive(Clone, Copy)]
pub struct ShadowRay<R: Real> {
    /// Its unit direction and how far it goes.
    pub segment: Segment<R>,
    /// Linear RGB that reaches the pixel.
    pub light: V3<R>,
    /// What films with arbitrary output variables remember of it, see [`Contribution::tag`](super::Contribution::tag).
    pub tag: u32,
    /// What it is in where it starts ([`Media::PRESENT`]).
    pub inside: Inside,
    /// How far before the segment it starts: a place outside of the scene's cube.
    pub lead: R,
    /// The numbers that its way through grids draws ([`Media::GRIDS`]).
    pub chain: Chain,
}

impl<R: Scalar> PathState<R> {
    /// The path at a level of a slot: that in hand at level 0, and those that wait above.
    #[inline(always)]
    pub fn load(slots: u32, slot: u32, level: u32, paths: &[R::Record]) -> Self {
        let at = |k| R::load(read(paths, (level * STATE_RECORDS + k) * slots + slot));
        let ((origin, source_primitive), (direction, _), (weight, bounces), (rest, pixel)) =
            (at(0), at(1), at(2), at(3));
        let beside = (rest.y, rest.z);
        PathState {
            origin,
            direction,
            source_primitive,
            weight,
            bounces,
            density: rest.x,
            pixel,
            beside,
            unlit: 0,
            from: origin,
            inside: Inside::default(),
            gathered: false,
        }
    }

    /// What a slot's numbers are drawn from: its pixel, and the sample's number in that.
    #[inline(always)]
    pub fn drawn_by(frame: &Frame, slot: u32, paths: &[R::Record]) -> (Key, u32) {
        let pixel = R::load(read(paths, (STATE_RECORDS - 1) * frame.slots + slot)).1;
        (Key::new((pixel & 0xffff, pixel >> 16), frame.seed), camera::sample(frame, slot))
    }

    /// The same with what it is in, which lies behind the records of all slots.
    #[inline(always)]
    pub fn with_medium(self, slots: u32, slot: u32, paths: &[R::Record]) -> Self {
        let (from, inside) = R::load(read(paths, STATE_RECORDS * slots + slot));
        PathState { from, inside: Inside(inside), ..self }
    }

    /// Keeps that.
    #[inline(always)]
    pub fn store_medium(&self, slots: u32, slot: u32, paths: &mut [R::Record]) {
        write(paths, STATE_RECORDS * slots + slot, R::store(self.from, self.inside.0));
    }

    /// How far before its ray's origin its way began.
    #[inline(always)]
    pub fn lead(&self) -> R {
        if self.inside.crossings() > 0 {
            return R::splat(0.0);
        }
        (self.origin - self.from).map(|c| c.flush(SMALL)).direction_and_length().1
    }

    /// As it lies in memory: where some surfaces are not lit by all lamps, with groups above its bounces, and where photons tell of caustics,
    /// with a side below zero if they have.
    #[inline(always)]
    pub fn packed(self, spec: Specialisation) -> Self {
        let is_linked = spec.effects.has(Effects::LINKED);
        let bounces = if is_linked { self.bounces | self.unlit << BOUNCES } else { self.bounces };
        let is_told = spec.caustics.has(Caustics::GATHERED) && self.gathered;
        let beside = if is_told { (self.beside.0, -(self.beside.1 + R::splat(1.0))) } else { self.beside };
        PathState { bounces, beside, ..self }
    }

    /// As it was before.
    #[inline(always)]
    pub fn unpacked(self, spec: Specialisation) -> Self {
        let is_linked = spec.effects.has(Effects::LINKED);
        let unlit = if is_linked { self.bounces >> BOUNCES } else { 0 };
        let bounces = if is_linked { self.bounces & ((1 << BOUNCES) - 1) } else { self.bounces };
        let gathered = spec.caustics.has(Caustics::GATHERED) && self.beside.1.lt(R::splat(0.0));
        let beside = if gathered { (self.beside.0, -self.beside.1 - R::splat(1.0)) } else { self.beside };
        PathState { bounces, unlit, beside, gathered, ..self }
    }

    /// Did photons tell the light that it finds, which has come by mirrors and lenses alone?
    #[inline(always)]
    pub fn is_told(&self, caustics: Caustics) -> bool {
        caustics.has(Caustics::GATHERED) && self.gathered && self.density.eq(R::splat(0.0))
    }

    /// Does a group of lamps light where it starts?
    #[inline(always)]
    pub fn is_lit_by(&self, effects: Effects, group: u32) -> bool {
        !effects.has(Effects::LINKED) || (self.unlit >> group) & 1 == 0
    }

    /// Paths that wait in this slot, and vertices that it has had, where paths branch.
    #[inline(always)]
    pub fn counts(&self) -> (u32, u32) {
        (self.beside.0.to_f32() as u32, self.beside.1.to_f32() as u32)
    }

    /// With others, each below 2^24, which are numbers of single precision.
    #[inline(always)]
    pub fn with_counts(self, pending: u32, vertex: u32) -> Self {
        PathState { beside: (R::splat(pending as f32), R::splat(vertex as f32)), ..self }
    }

    /// From where it sees lights, where it does not branch.
    #[inline(always)]
    pub fn view(&self) -> Viewpoint<R> {
        Viewpoint { origin: self.from, side: self.beside.1.to_f32() as u32, time: 0.0 }
    }

    /// How wide it is after a distance. Where paths branch, each begins as narrow as the camera's. One that chance has led has no
    /// width: its light is a mean over many anyhow, and coarse texels, which reach over the borders of an atlas, would change that
    /// mean; lamps that are sampled have their finest texels, too.
    #[inline(always)]
    pub fn cone(&self, launch: &LaunchContext<'_>, distance: R, sample: u32) -> Cone<R> {
        if !launch.spec.launch.has(Launch::MIPMAPPED) || !self.density.eq(R::splat(0.0)) {
            return Cone::none();
        }
        let start = if self.bounces == 0 {
            Cone::confused(launch, distance, sample)
        } else if launch.spec.launch.has(Launch::TREE) {
            Cone::none()
        } else {
            Cone { width: self.beside.0 }
        };
        start.after(launch, distance, sample)
    }

    /// Keeps it at a level, to be traced.
    #[inline(always)]
    pub fn store(&self, slots: u32, slot: u32, level: u32, paths: &mut [R::Record]) {
        self.store_within(R::splat(f32::MAX), slots, slot, level, paths);
    }

    /// The same, to be traced so far.
    #[inline(always)]
    pub fn store_within(&self, limit: R, slots: u32, slot: u32, level: u32, paths: &mut [R::Record]) {
        let PathState { origin, direction, source_primitive, .. } = *self;
        let at = |k| (level * STATE_RECORDS + k) * slots + slot;
        Segment { origin, direction, limit, source_primitive }.store(slots, at(0), paths);
        write(paths, at(2), R::store(self.weight, self.bounces));
        write(paths, at(3), R::store(V3::new(self.density, self.beside.0, self.beside.1), self.pixel));
    }
}

impl<R: Scalar> ShadowRay<R> {
    /// One that asks for nothing.
    #[inline(always)]
    pub fn none() -> Self {
        let direction = V3::splat(glam::Vec3::Z);
        let segment = Segment { origin: V3::zero(), direction, limit: R::splat(NOWHERE), source_primitive: 0 };
        ShadowRay {
            segment,
            light: V3::zero(),
            tag: 0,
            inside: Inside::default(),
            lead: R::splat(0.0),
            chain: Chain::new(0, 0),
        }
    }

    /// Does it ask for something?
    #[inline(always)]
    pub fn asks(&self) -> bool {
        R::splat(0.0).lt(self.light.greatest())
    }

    /// Keeps a slot's ray. One that asks for nothing arrives, with no light: not even with what infinite light leaves of none.
    #[inline(always)]
    pub fn store(&self, slots: u32, slot: u32, segments: &mut [R::Record]) {
        let asks = self.asks();
        let limit = if asks { self.segment.limit } else { R::splat(NOWHERE) };
        Segment { limit, ..self.segment }.store(slots, slot, segments);
        write(segments, 2 * slots + slot, R::store(V3::select(asks, self.light, V3::zero()), self.tag));
    }

    /// One that starts somewhere in a medium, maybe far from the scene: from where it comes close to that.
    #[inline(always)]
    pub fn brought_near(self) -> Self {
        let Segment { origin, direction, limit, .. } = self.segment;
        let near = Ray::from_afar(origin, direction).origin;
        let lead = (near - origin).map(|c| c.flush(SMALL)).direction_and_length().1;
        ShadowRay { segment: Segment { origin: near, limit: limit - lead, ..self.segment }, lead, ..self }
    }

    /// Keeps what a slot's ray is in, behind the records of all slots.
    #[inline(always)]
    pub fn store_medium(&self, slots: u32, slot: u32, segments: &mut [R::Record]) {
        let (a, b) = self.chain.numbers();
        let rest = V3::new(self.lead, R::splat(a), R::splat(b));
        write(segments, SHADOW_RECORDS * slots + slot, R::store(rest, self.inside.0));
    }

    /// That, how far before its segment it starts, and the numbers that it draws.
    #[inline(always)]
    pub fn medium(slots: u32, slot: u32, segments: &[R::Record]) -> (Inside, R, Chain) {
        let (rest, inside) = R::load(read(segments, SHADOW_RECORDS * slots + slot));
        (Inside(inside), rest.x, Chain::of(rest.y.to_f32(), rest.z.to_f32()))
    }

    /// The light of a slot's ray that nothing was in the way of, else zero; and its tag.
    #[inline(always)]
    pub fn arrived(slots: u32, slot: u32, shadows: &[u32], segments: &[R::Record]) -> (V3<R>, u32) {
        let (light, tag) = R::load(read(segments, 2 * slots + slot));
        (if read(shadows, slot) == REACHED { light } else { V3::zero() }, tag)
    }
}

/// What a slot has summed before its last vertex, with the light that this waited for.
#[inline(always)]
pub fn sampled<R: Scalar>(
    frame: &Frame,
    launch: Launch,
    slot: u32,
    (sums, shadows, segments): (&[R::Record], &[u32], &[R::Record]),
) -> Sample<R> {
    let (sum, word) = R::load(read(sums, slot));
    let caught = Caught::<R>::load(launch, frame, slot, sums);
    if caught.waits() {
        return Sample { light: sum, word, caught: caught.answered(read(shadows, slot)) };
    }
    Sample { light: sum + ShadowRay::<R>::arrived(frame.slots, slot, shadows, segments).0, word, caught }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn arrives(light: V3<f32>) -> V3<f32> {
        let mut segments = [Default::default(); SHADOW_RECORDS as usize];
        ShadowRay { light, ..ShadowRay::none() }.store(1, 0, &mut segments);
        ShadowRay::arrived(1, 0, &[REACHED], &segments).0
    }

    #[test]
    fn a_shadow_ray_that_asks_for_nothing_brings_nothing() {
        let light = V3::splat(Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(arrives(light), light);
        for none in [0.0, f32::NAN] {
            assert_eq!(arrives(V3::new(none, 0.0, 0.0)), V3::zero());
            assert_eq!(arrives(V3::new(0.0, none, 0.0)), V3::zero());
            assert_eq!(arrives(V3::new(none, none, none)), V3::zero());
        }
    }
}
