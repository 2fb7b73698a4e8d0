//! Photons (Jensen 1996) where they meet surfaces, and what those who look for them find.

use super::sampled::Scattered;
use super::vertex::Vertex;
use crate::camera;
use crate::data::{Effects, Launch, Media, Quanta};
use crate::light::{Leaving, LeavingDraws, Lighting};
use crate::material::{Closure, INVERSE_PI, Seen};
use crate::photon::{Casters, Grid, Landed, Photons, key, number, radius, single, widened};
use crate::ray::Ray;
use crate::real::{FAINT, Real, Scalar, V3};
use crate::sampler::{self, DECISIONS};
use crate::scene::LaunchContext;
use crate::stage::{Found, NOWHERE, PathState, ShadowRay};
use glam::UVec4;

/// Starts a slot's photon.
#[inline(always)]
pub fn emit<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    casters: &Casters<'_>,
    slot: u32,
    (paths, hits, landed): (&mut [R::Record], &mut [R::Record], &mut [UVec4]),
) {
    let frame = launch.frame;
    let sample = camera::sample(frame, slot);
    let (key, number) = (key(frame, sample), number(frame, slot));
    let launch = &launch.of_sample(lighting.spectra, camera::common_key(frame), sample);
    let time = camera::common_time(frame, launch.spec.launch, sample);
    if launch.spec.launch.has(Launch::MOVING) {
        Found::<R>::start(time, frame.slots, slot, hits);
    }
    let set = |set| sampler::set(launch.spec.launch, key, number, set);
    let leaving = Leaving::<R>::new(launch, lighting, casters, LeavingDraws::new(set(DECISIONS), set(0)), time);
    // Each has its part of the light of all.
    let part = R::splat(frame.photons as f32).reciprocal();
    let power = (leaving.power * part).map(|c| c.flush(FAINT));
    let goes = R::splat(0.0).lt(power.greatest());
    let path = PathState {
        origin: Ray::from_afar(leaving.origin, leaving.direction).origin,
        direction: leaving.direction,
        source_primitive: leaving.source_primitive,
        weight: power,
        bounces: 0,
        // A photon has no width.
        density: R::splat(1.0),
        pixel: leaving.group,
        unlit: 0,
        beside: (power.greatest(), R::splat(0.0)),
        from: leaving.origin,
        inside: Default::default(),
        gathered: false,
    };
    if launch.spec.media.has(Media::PRESENT) {
        path.store_medium(frame.slots, slot, paths);
    }
    let limit = R::splat(if goes { f32::MAX } else { NOWHERE });
    path.store_within(limit, frame.slots, slot, 0, paths);
    Landed::clear(slot, landed);
}

/// What comes of a photon on a surface: a mirror or a lens sends it on; anything else has it, if it has come by one.
#[inline(always)]
pub(super) fn met<R: Scalar>(
    launch: &LaunchContext<'_>,
    vertex: &Vertex<R>,
    (seen, closure): (&Seen<R>, &impl Closure<R>),
    next: PathState<R>,
    decisions: UVec4,
) -> Scattered<R> {
    let (path, zero) = (vertex.path, R::splat(0.0));
    let interaction = seen.interaction;
    // What a surface mirrors or lets through are no other lamps than those that light it.
    if path.bounces == 0 && !next.is_lit_by(launch.spec.effects, path.pixel) {
        return Scattered::once(V3::zero(), ShadowRay::none(), path, false);
    }
    if closure.chooses_rough(decisions.y) {
        let lands = zero.lt(path.beside.1) && closure.is_wide();
        let power = (path.weight * closure.rough_share().reciprocal()).map(|c| c.flush(FAINT));
        let landed = Landed::new(interaction.position, -path.direction, power, path.bounces);
        return Scattered { landed, lands, ..Scattered::once(V3::zero(), ShadowRay::none(), path, false) };
    }
    let factor = of_power(launch, closure, seen, next.direction);
    let weight = (next.weight * factor).map(|c| c.flush(FAINT));
    let next = PathState { weight, density: path.density, beside: (path.beside.0, R::splat(1.0)), ..next };
    let (next, goes_on) = survives(launch, next, decisions.z);
    Scattered::once(V3::zero(), ShadowRay::none(), next, goes_on && next.bounces <= launch.frame.bounces)
}

/// What a mirror or a lens does to power over what it does to radiance: a lens does not compress it, and an interpolated normal sends it
/// where the surface is seen smaller or larger than where it came from (Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
/// section 5.3).
#[inline(always)]
fn of_power<R: Scalar>(launch: &LaunchContext<'_>, closure: &impl Closure<R>, seen: &Seen<R>, to: V3<R>) -> R {
    /// Bounds of what normals do.
    const MOST: f32 = 16.0;
    const LEAST: f32 = 1.0 / MOST;
    let (one, interaction) = (R::splat(1.0), seen.interaction);
    let passes = !interaction.faces(to);
    let factor = if passes { closure.compression().reciprocal() } else { one };
    if !launch.spec.effects.has(Effects::SMOOTH | Effects::TEXTURED) {
        return factor;
    }
    let cosine = |normal: V3<R>, direction: V3<R>| normal.dot(direction).abs();
    let (flat, own) = (interaction.normal, closure.normal());
    let over = cosine(flat, to) * cosine(own, seen.direction);
    let under = cosine(flat, seen.direction) * cosine(own, to);
    let least = R::splat(FAINT);
    let lean = over.max(least).div(under.max(least)).max(R::splat(LEAST)).min(R::splat(MOST));
    factor * lean
}

/// Russian roulette by what is left of its power. Does it go on?
#[inline(always)]
fn survives<R: Scalar>(launch: &LaunchContext<'_>, next: PathState<R>, decision: u32) -> (PathState<R>, bool) {
    let share = next.weight.greatest().div(next.beside.0.max(R::splat(FAINT)));
    let scaled = PathState { weight: V3::new(share, share, share), ..next };
    let (kept, goes_on) = super::path::survive(launch.frame, scaled, decision);
    let raised = kept.weight.x.div(share.max(R::splat(FAINT)));
    (PathState { weight: (next.weight * raised).map(|c| c.flush(FAINT)), ..next }, goes_on)
}

/// Keeps a slot's photon.
#[inline(always)]
pub(super) fn keep<R: Real>(scattered: &Scattered<R>, slot: u32, landed: &mut [UVec4]) {
    if scattered.lands {
        scattered.landed.store(slot, landed);
    }
}

/// Light that comes by mirrors and glass and that a surface scatters to the path, of the photons around (Jensen 1996, equation 5).
#[inline(always)]
pub(super) fn gathered<R: Scalar>(
    launch: &LaunchContext<'_>,
    photons: &Photons<'_>,
    (slot, bounces): (u32, u32),
    (seen, closure): (&Seen<R>, &impl Closure<R>),
) -> V3<R> {
    /// Photons of other surfaces are further off the plane than this share of the radius.
    const FLAT: f32 = 0.25;
    /// Light that grazes counts no more than so much over the cosine.
    const GRAZING: f32 = 1.0 / 64.0;
    let frame = launch.frame;
    let pixel_slots = if frame.pixel_slots == 0 { 1 } else { frame.pixel_slots };
    let sample = slot / pixel_slots;
    let reach = radius(frame, frame.sample + sample);
    let grid = Grid::new(frame, sample, reach);
    let interaction = seen.interaction;
    let place = single(interaction.position);
    let normal = interaction.normal;
    let per_area = Real::div(INVERSE_PI, reach * reach);
    let mut sums = Sums::default();
    let mut search = grid.around(place, photons);
    while search.goes_on() {
        let (next, number, at, is_own) = search.step(frame, &grid, photons);
        search = next;
        if !is_own {
            continue;
        }
        let from = widened::<R>(at - place);
        let off = normal.dot(from).abs();
        if R::splat(reach * reach).lt(from.dot(from)) || R::splat(reach * FLAT).lt(off) {
            continue;
        }
        let landed = Landed::load(number, at, photons.records);
        if frame.bounces < landed.bounces + bounces {
            continue;
        }
        let towards = widened::<R>(landed.towards);
        let value = closure.eval(&interaction, towards).value;
        let cosine = normal.dot(towards).abs().max(R::splat(GRAZING));
        let share = R::splat(per_area).div(cosine);
        let power = (widened::<R>(landed.power) * share).map(|c| c.flush(FAINT));
        sums = sums.plus(power.times(value));
    }
    sums.light()
}

/// Light that is summed without an order, in quanta as a film has them.
#[derive(Clone, Copy, Default)]
struct Sums {
    red: Quanta,
    green: Quanta,
    blue: Quanta,
}

impl Sums {
    /// Bits behind the point of a quantum, and before it.
    const FRACTION: u32 = 40;
    const MOST: u32 = 31;

    #[inline(always)]
    fn plus<R: Scalar>(self, light: V3<R>) -> Self {
        let quanta = |c: R| Quanta::of(c.to_f32(), Self::FRACTION, Self::MOST);
        Sums {
            red: self.red.plus(quanta(light.x)),
            green: self.green.plus(quanta(light.y)),
            blue: self.blue.plus(quanta(light.z)),
        }
    }

    #[inline(always)]
    fn light<R: Scalar>(self) -> V3<R> {
        let light = V3::<R>::new(number_of(self.red), number_of(self.green), number_of(self.blue));
        light.map(|c| c.flush(FAINT))
    }
}

/// Quanta as a number that is at least 0, by halves of words, which every device converts exactly.
#[inline(always)]
fn number_of<R: Scalar>(Quanta(a, b, c, _): Quanta) -> R {
    /// The worth of a unit of each word: 2^-40, 2^-8 and 2^24.
    const UNITS: (f32, f32, f32) = (1.0 / (1u64 << 40) as f32, 1.0 / 256.0, (1 << 24) as f32);
    let word = |word: u32, unit: f32| {
        let (high, low) = (R::splat((word >> 16) as f32), R::splat((word & 0xffff) as f32));
        (high * R::splat(65_536.0) + low) * R::splat(unit)
    };
    word(c, UNITS.2) + word(b, UNITS.1) + word(a, UNITS.0)
}
