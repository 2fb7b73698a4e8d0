//! What integrators that sample have in common: a slot's sum, the light that its last vertex waits for, and where its path goes on.

use crate::background::background;
use crate::buffer::{read, write};
use crate::camera;
use crate::data::{Caustics, Effects, Filling, Finish, Launch, Media, Medium, Physical, Primitive};
use crate::light::{Environment, Lighting};
use crate::material::{Albedos, Seen};
use crate::medium::{Chain, MOST_CROSSINGS};
use crate::photon::{Landed, Photons};
use crate::real::{FAINT, Real, Scalar, V3};
use crate::sampler::Key;
use crate::scene::{LaunchContext, ShadingData};
use crate::stage::{AovSlot, CLEARED, Caught, Contribution, FirstSurface, Found, NON_FINITE, PathState, ShadowRay};
use glam::UVec4;

use super::draws::Draws;
use super::path::{Around, weight};
use super::vertex::Vertex;
use super::{distributed, feature, medium, occlusion, path, photon};

/// The records that the stages of a wave exchange.
pub struct Exchange<'a, R: Scalar> {
    /// [`PathState`]s by record and slot.
    pub paths: &'a mut [R::Record],
    /// [`Found`] by slot.
    pub hits: &'a [R::Record],
    /// Whether the shadow ray of the vertex before arrived, by slot.
    pub shadows: &'a [u32],
    /// [`ShadowRay`]s by record and slot.
    pub segments: &'a mut [R::Record],
    /// Linear RGB by slot; the integer counts shadow rays and holds [`NON_FINITE`].
    pub sums: &'a mut [R::Record],
    /// Are they the camera's rays, before which there are neither sums nor shadow rays?
    pub starts: bool,
    /// The photons of the launch, which are looked through ([`Caustics::GATHERED`]).
    pub photons: Photons<'a>,
    /// [`Landed`] by slot of a launch of photons ([`Caustics::PHOTONS`]).
    pub landed: &'a mut [UVec4],
}

/// What scatters in a scene, and what emits.
#[derive(Clone, Copy)]
pub struct ScatterContext<'a> {
    /// What surfaces look like.
    pub shading: ShadingData<'a>,
    /// How they scatter by microfacets ([`Effects::PHYSICAL`](crate::data::Effects)), by material.
    pub physicals: &'a [Physical],
    /// What they have beside ([`Finishes`](crate::data::Finishes)), likewise.
    pub finishes: &'a [Finish],
    /// What their facets send back ([`Effects::COMPENSATED`](crate::data::Effects)).
    pub albedos: Albedos<'a>,
    /// What emits.
    pub lighting: Lighting<'a>,
    /// What is between surfaces ([`Media::PRESENT`]).
    pub media: &'a [Medium],
    /// Where they are denser ([`Media::GRIDS`]).
    pub grids: &'a [u32],
}

/// Is there any light to sample?
#[inline(always)]
pub(super) fn is_lit(launch: &LaunchContext<'_>) -> bool {
    launch.spec.effects.has(Effects::LIT | Effects::EMISSIVE | Effects::ENVIRONMENT) && launch.frame.emitters > 0
}

/// What comes of it.
pub(super) struct Scattered<R: Real> {
    /// What the vertex adds at once, linear RGB that reaches the pixel.
    pub light: V3<R>,
    /// What it asks for.
    pub shadow: ShadowRay<R>,
    /// Where the path goes on.
    pub next: PathState<R>,
    /// Does it?
    pub goes_on: bool,
    /// The path that waits until then, where paths branch.
    pub other: PathState<R>,
    /// Is there one?
    pub waits: bool,
    /// Is the vertex on a shadow catcher that the camera sees?
    pub catches: bool,
    /// What arbitrary output variables ask of it.
    pub outputs: Outputs<R>,
    /// What it scatters of the light of photons, linear RGB that reaches the pixel.
    pub caustic: V3<R>,
    /// What a photon is there.
    pub landed: Landed,
    /// Is it one?
    pub lands: bool,
}

/// What the film's arbitrary output variables ask of a vertex.
#[derive(Clone, Copy)]
pub(super) struct Outputs<R: Real> {
    /// How the light that it adds at once was found, see [`Contribution`].
    pub found: u32,
    /// The group of the lamp that sends it.
    pub group: u32,
    /// What it tells as the first.
    pub surface: FirstSurface<R>,
}

impl<R: Scalar> Outputs<R> {
    /// Of light that was found so, of a group of lamps.
    #[inline(always)]
    pub fn of(found: u32, group: u32) -> Self {
        Outputs { found, group, surface: FirstSurface::none() }
    }
}

impl<R: Scalar> Scattered<R> {
    /// Of a path that does not branch.
    #[inline(always)]
    pub fn once(light: V3<R>, shadow: ShadowRay<R>, next: PathState<R>, goes_on: bool) -> Self {
        let outputs = Outputs::of(Contribution::<R>::SURFACE, 0);
        Scattered {
            light,
            shadow,
            next,
            goes_on,
            other: next,
            waits: false,
            catches: false,
            outputs,
            caustic: V3::zero(),
            landed: Landed::none(),
            lands: false,
        }
    }
}

/// Scatters a slot's path at its hit. Returns whether it has another ray to trace.
#[inline(always)]
pub fn scatter<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    slot: u32,
    exchange: Exchange<'_, R>,
) -> bool {
    let Exchange { paths, hits, shadows, segments, sums, starts, photons, landed } = exchange;
    let slots = launch.frame.slots;
    let (bits, aovs, media) = (launch.spec.launch, launch.spec.aovs, launch.spec.media);
    let path = PathState::<R>::load(slots, slot, 0, paths).unpacked(launch.spec);
    let path = if media.has(Media::PRESENT) { path.with_medium(slots, slot, paths) } else { path };
    let is_photon = launch.spec.caustics.has(Caustics::PHOTONS);
    let outputs = AovSlot::new(launch.frame, launch.spec, slot);
    // What is compiled in comes first, so that without it nothing is left.
    let (sum, mut word, mut caught) = if is_photon || starts {
        (V3::zero(), 0, Caught::nothing())
    } else {
        let (sum, word) = R::load(read(sums, slot));
        let caught = Caught::<R>::load(bits, launch.frame, slot, sums);
        let (arrived, tag) = ShadowRay::<R>::arrived(slots, slot, shadows, segments);
        let arrived = if caught.waits() { V3::zero() } else { arrived };
        if aovs.any() {
            outputs.add(&Contribution::of_shadow_ray(arrived, tag), sums);
        }
        (sum + arrived, word, caught.answered(read(shadows, slot)))
    };
    let after_catcher = bits.has(Launch::CATCHER) && caught.is_some() && path.bounces == 1;
    let found = Found::<R>::load(launch, slot, hits);
    let sample = camera::sample(launch.frame, slot);
    let draws = drawn(launch, (slot, sample), path.pixel);
    // Photons have the wavelengths of all paths of their sample.
    let is_common = launch.spec.caustics.has(Caustics::GATHERED | Caustics::PHOTONS);
    let waves = if is_common { camera::common_key(launch.frame) } else { draws.key };
    let launch = &launch.of_sample(context.lighting.spectra, waves, sample);
    let mut vertex = Vertex { path, found, draws, after_catcher, filling: Filling::default() };
    let mut collides = false;
    if media.has(Media::PRESENT) {
        (vertex, collides) = medium::flown(launch, context, &vertex);
    }
    let path = vertex.path;
    // The ray of a slot outside the image hits nothing.
    let mut scattered = if media.has(Media::PRESENT) && collides {
        if is_photon {
            // What is scattered between surfaces is found by chance.
            Scattered::once(V3::zero(), ShadowRay::none(), path, false)
        } else {
            medium::at(launch, context, &vertex)
        }
    } else if found.is_nothing() {
        let is_clear = bits.has(Launch::CLEAR) && path.bounces == 0;
        word = if is_clear { word | CLEARED } else { word };
        let is_dark = is_clear || after_catcher;
        caught = if after_catcher { caught.open() } else { caught };
        let light = if is_dark { V3::zero() } else { surroundings(launch, &context.lighting, &path) };
        Scattered {
            outputs: Outputs::of(Contribution::<R>::SURROUNDINGS, launch.frame.group),
            ..Scattered::once(share(launch, &path, light), ShadowRay::none(), path, false)
        }
    } else {
        let seen = vertex.met(launch);
        let Seen { primitive, interaction, .. } = seen;
        if media.has(Media::OPEN | Media::NESTED) && medium::is_crossed(launch, context, &vertex, interaction.front) {
            medium::crossed(&vertex, interaction)
        } else if is_hole(launch, &path, &primitive) {
            word = if bits.has(Launch::CLEAR) { word | CLEARED } else { word };
            Scattered::once(V3::zero(), ShadowRay::none(), path, false)
        } else {
            if after_catcher && primitive.has(Primitive::CATCHER) {
                caught = caught.open();
            }
            let around = Around { photons, slot };
            integrated(launch, context, &vertex, &seen, around)
        }
    };
    if is_photon {
        photon::keep(&scattered, slot, landed);
        return follow(launch, slot, &path, scattered, paths);
    }
    if bits.has(Launch::CATCHER) && scattered.catches {
        caught = path::caught(launch, &scattered);
    }
    caught.store(bits, launch.frame, slot, sums);
    scattered.light = launch.rgb(scattered.light);
    scattered.caustic = launch.rgb(scattered.caustic);
    scattered.outputs.surface.albedo = launch.rgb(scattered.outputs.surface.albedo);
    if !media.has(Media::OPEN | Media::GRIDS) {
        // Else it is dimmed first.
        scattered.shadow.light = launch.rgb(scattered.shadow.light);
    }
    if aovs.any() {
        // What is seen through surfaces that are not there is the first.
        let is_first = starts || media.has(Media::OPEN) && path.bounces == 0;
        output(outputs, (is_first, path.bounces), &scattered, sums);
    }
    let (sum, word) = added(sum, word, &scattered);
    let sum = if launch.spec.caustics.has(Caustics::GATHERED) { sum + scattered.caustic } else { sum };
    write(sums, slot, R::store(sum, word));
    scattered.shadow.store(slots, slot, segments);
    if media.has(Media::OPEN | Media::GRIDS) {
        let seed = draws.flight(path.bounces, MOST_CROSSINGS);
        let shadow = ShadowRay { chain: Chain::new(seed.x, seed.y), ..scattered.shadow };
        shadow.store_medium(slots, slot, segments);
    }
    follow(launch, slot, &path, scattered, paths)
}

/// What a slot draws, whose path is of a pixel, or a photon.
#[inline(always)]
fn drawn(launch: &LaunchContext<'_>, (slot, sample): (u32, u32), pixel: u32) -> Draws {
    let (frame, bits) = (launch.frame, launch.spec.launch);
    if launch.spec.caustics.has(Caustics::PHOTONS) {
        let key = crate::photon::key(frame, sample);
        return Draws { launch: bits, key, sample: crate::photon::number(frame, slot), has_lens: false };
    }
    let key = Key::new((pixel & 0xffff, pixel >> 16), frame.seed);
    Draws { launch: bits, key, sample, has_lens: frame.has_lens(bits) }
}

/// What the integrator that a launch asks for makes of a surface.
#[inline(always)]
fn integrated<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
    seen: &Seen<R>,
    around: Around<'_>,
) -> Scattered<R> {
    let bits = launch.spec.launch;
    if bits.has(Launch::FEATURE) {
        feature::at(launch, context, vertex, seen)
    } else if bits.has(Launch::OCCLUSION) {
        occlusion::at(launch, &context.shading, vertex, seen)
    } else if bits.has(Launch::TREE) {
        distributed::at(launch, context, vertex, seen)
    } else {
        path::at(launch, context, vertex, seen, around)
    }
}

/// Does the camera's ray meet what cuts a hole into the picture?
#[inline(always)]
fn is_hole<R: Scalar>(launch: &LaunchContext<'_>, path: &PathState<R>, primitive: &Primitive) -> bool {
    let is_seen = path.bounces == 0 && !launch.spec.caustics.has(Caustics::PHOTONS);
    launch.spec.effects.has(Effects::HOLDOUT) && is_seen && primitive.has(Primitive::HOLDOUT)
}

/// What a path gets from beyond the scene, by the weight of the strategy that found it.
#[inline(always)]
fn surroundings<R: Scalar>(launch: &LaunchContext<'_>, lighting: &Lighting<'_>, path: &PathState<R>) -> V3<R> {
    let (effects, frame) = (launch.spec.effects, launch.frame);
    let is_told = effects.has(Effects::ENVIRONMENT) && path.is_told(launch.spec.caustics);
    if launch.spec.launch.has(Launch::FEATURE) || !path.is_lit_by(effects, frame.group) || is_told {
        return V3::zero();
    }
    let seen = launch.banded(background(effects, frame, lighting.environment, path.direction, path.bounces == 0));
    if !effects.has(Effects::ENVIRONMENT) || path.density.eq(R::splat(0.0)) {
        return seen;
    }
    let environment = Environment::new(lighting.environment);
    let other = environment.density(path.direction, R::splat(frame.environment));
    let own = path.density * other.under;
    (seen * weight(launch.spec.launch, Launch::BY_SURFACE, other.over, own)).map(|c| c.flush(FAINT))
}

/// Keeps where a slot goes on. Does it?
#[inline(always)]
fn follow<R: Scalar>(
    launch: &LaunchContext<'_>,
    slot: u32,
    path: &PathState<R>,
    scattered: Scattered<R>,
    paths: &mut [R::Record],
) -> bool {
    if launch.spec.launch.has(Launch::TREE) {
        return branch(launch.frame.slots, slot, path, scattered, paths);
    }
    if scattered.goes_on {
        if launch.spec.media.has(Media::PRESENT) {
            scattered.next.store_medium(launch.frame.slots, slot, paths);
        }
        scattered.next.packed(launch.spec).store(launch.frame.slots, slot, 0, paths);
    }
    scattered.goes_on
}

/// Depth first: one branch is taken in hand and the other waits; at a leaf of the tree the last that waits is taken.
#[inline(always)]
fn branch<R: Scalar>(
    slots: u32,
    slot: u32,
    path: &PathState<R>,
    scattered: Scattered<R>,
    paths: &mut [R::Record],
) -> bool {
    let (mut next, (mut pending, vertex)) = (scattered.next, path.counts());
    if scattered.waits {
        pending += 1;
        scattered.other.store(slots, slot, pending, paths);
    }
    if !scattered.goes_on {
        if pending == 0 {
            return false;
        }
        next = PathState::load(slots, slot, pending, paths);
        pending -= 1;
    }
    next.with_counts(pending, vertex + 1).store(slots, slot, 0, paths);
    true
}

/// Adds a vertex' light to the film's arbitrary output variables, which start with what the first vertex tells.
#[inline(always)]
fn output<R: Scalar>(
    outputs: AovSlot,
    (starts, bounces): (bool, u32),
    scattered: &Scattered<R>,
    sums: &mut [R::Record],
) {
    let Outputs { found, group, surface } = &scattered.outputs;
    if starts {
        outputs.start(surface, sums);
    }
    if is_finite(scattered.light) {
        let light = Contribution { light: scattered.light, bounces, group: *group, found: *found };
        outputs.add(&light, sums);
    }
    if R::splat(0.0).lt(scattered.caustic.greatest()) {
        let found = Contribution::<R>::SURFACE;
        outputs.add(&Contribution { light: scattered.caustic, bounces: bounces + 1, group: 0, found }, sums);
    }
}

/// Are all channels finite?
#[inline(always)]
fn is_finite<R: Scalar>(v: V3<R>) -> bool {
    v.x.is_finite() && v.y.is_finite() && v.z.is_finite()
}

/// A sum with a vertex' light, and the count of its shadow rays. What is not finite is left out and flagged.
#[inline(always)]
fn added<R: Scalar>(sum: V3<R>, word: u32, scattered: &Scattered<R>) -> (V3<R>, u32) {
    let (light, asked) = (scattered.light, scattered.shadow.light);
    let word = if scattered.shadow.asks() { word + 1 } else { word };
    let word = if is_finite(light) && is_finite(asked) { word } else { word | NON_FINITE };
    (if is_finite(light) { sum + light } else { sum }, word)
}

/// Light that a path brings to its pixel: what was scattered more than once is at most [`Frame::clamp`](crate::data::Frame::clamp),
/// and what is below 2^-100 is zero.
#[inline(always)]
pub(super) fn share<R: Scalar>(launch: &LaunchContext<'_>, path: &PathState<R>, light: V3<R>) -> V3<R> {
    let light = path.weight.times(light).map(|c| c.flush(FAINT));
    let (most, greatest) = (R::splat(launch.frame.clamp), light.greatest());
    if path.bounces < 2 || launch.frame.clamp == 0.0 || greatest.le(most) {
        return light;
    }
    (light * most.div(greatest)).map(|c| c.flush(FAINT))
}
