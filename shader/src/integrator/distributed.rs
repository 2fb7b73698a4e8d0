//! Distributed ray tracing (Cook, Porter and Carpenter, 1984; thesis 3.4.1): Whitted's tree of reflected and refracted rays, where
//! lights have extent and each vertex asks one of them.

use super::sampled::{ScatterContext, Scattered, is_lit, share};
use super::vertex::Vertex;
use super::whitted::counts;
use crate::buffer::read;
use crate::data::{Effects, numbers};
use crate::geometry::SurfaceInteraction;
use crate::light::{EmitterSample, LightSample, Lighting, Viewpoint, glowing};
use crate::material::{
    Bsdf, Channels, ClosureSample, INVERSE_PI, Seen, Specular, Surface, closure, eval_phong, lifted,
};
use crate::real::{FAINT, Scalar, V3};
use crate::sampler::DECISIONS;
use crate::scene::LaunchContext;
use crate::stage::{PathState, ShadowRay};
use crate::texture::{Covering, Place};

/// Adds what the surface emits and its ambient light, asks for the light of one light, and branches.
#[inline(always)]
pub(super) fn at<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
    seen: &Seen<R>,
) -> Scattered<R> {
    let effects = launch.spec.effects;
    let ScatterContext { shading, lighting, physicals, .. } = context;
    let vertex = &vertex.arrived(launch, physicals, seen);
    let covering = seen.covering(launch, shading);
    let surface = Surface::new(launch, shading, seen, &covering);
    let seen = Seen { interaction: lifted(launch, shading, seen), ..*seen };
    let (path, interaction) = (vertex.path, seen.interaction);
    if effects.has(Effects::PHYSICAL) {
        let channels = Channels { weight: path.weight, draw: 0 };
        let closure = closure(launch, context, (&seen, &surface), &covering, channels).base;
        let light = share(launch, &path, shining(launch, lighting, (&seen, &surface), &covering));
        let shadow = light_by_closure(launch, lighting, vertex, (&seen, &closure));
        let draws = vertex.draws.set(path.counts().1);
        let [reflected, passed] = closure.branches(&interaction, (draws.x, draws.y));
        let on = |s: &ClosureSample<R>| vertex.on((&interaction, s.origin), s.direction, s.factor, s.density);
        return branched(launch, light, shadow, (on(&reflected), on(&passed)));
    }
    let light = shining(launch, lighting, (&seen, &surface), &covering);
    let light = share(launch, &path, light);
    let shadow = sampled_light(launch, lighting, vertex, &interaction, &surface);
    if !effects.has(Effects::REFLECTION | Effects::REFRACTION) {
        return Scattered::once(light, shadow, path, false);
    }
    branched(launch, light, shadow, branches(effects, vertex, &interaction, &surface))
}

/// What a surface sends by itself: ambient light and what it emits.
#[inline(always)]
fn shining<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    (seen, surface): (&Seen<R>, &Surface<R>),
    covering: &Covering<R>,
) -> V3<R> {
    let (mut light, effects) = (surface.ambient, launch.spec.effects);
    if effects.has(Effects::EMISSIVE) {
        let emission = read(lighting.emissions, seen.material());
        if emission.shines(seen.interaction.front) {
            let radiance = V3::splat(numbers(emission.radiance));
            let radiance = if effects.has(Effects::TEXTURED) { radiance.times(covering.emission) } else { radiance };
            let place = Place { index: seen.index, weights: seen.interaction.coordinates, count: 0 };
            let radiance = glowing(effects, &lighting.textures, &emission, &place, radiance);
            light = light + lighting.banded(launch, radiance, emission.illuminant()).map(|c| c.flush(FAINT));
        }
    }
    light
}

/// Goes on with those rays that count.
#[inline(always)]
fn branched<R: Scalar>(
    launch: &LaunchContext<'_>,
    light: V3<R>,
    shadow: ShadowRay<R>,
    (reflected, refracted): (PathState<R>, PathState<R>),
) -> Scattered<R> {
    let counts = |path: &PathState<R>| counts(launch, path.bounces, path.weight);
    let (first, second) = (counts(&reflected), counts(&refracted));
    let next = if first { reflected } else { refracted };
    Scattered { other: refracted, waits: first && second, ..Scattered::once(light, shadow, next, first || second) }
}

/// A sample of one light as seen from a vertex.
#[inline(always)]
fn drawn_light<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    vertex: &Vertex<R>,
    view: &Viewpoint<R>,
) -> EmitterSample<R> {
    let number = vertex.path.counts().1;
    let decisions = vertex.draws.set(DECISIONS + number);
    EmitterSample::new(launch, lighting, view, decisions.x, vertex.draws.pair(number))
}

/// The light of one light, by a closure: of one that rays find, what the base scatters alone, since facets send rays of their own.
#[inline(always)]
fn light_by_closure<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    vertex: &Vertex<R>,
    (seen, closure): (&Seen<R>, &Bsdf<'_, R>),
) -> ShadowRay<R> {
    if !is_lit(launch) {
        return ShadowRay::none();
    }
    let interaction = &seen.interaction;
    let view = Viewpoint::on(interaction, closure.normal(), seen.primitive.is_transparent()).at(seen.time);
    let sample = drawn_light(launch, lighting, vertex, &view);
    let value = if sample.density.over.eq(R::splat(0.0)) {
        closure.eval(interaction, sample.direction).value
    } else {
        closure.eval_base(interaction, sample.direction)
    };
    let light = value.times(sample.light).map(|c| c.flush(FAINT));
    let passes = !interaction.receives(sample.direction);
    let origin = if passes { interaction.offset_ray_origin(sample.direction) } else { view.origin };
    vertex.asks(launch, (interaction, origin), &sample, light)
}

/// The light of one light, by Whitted's model over pi.
#[inline(always)]
fn sampled_light<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    vertex: &Vertex<R>,
    interaction: &SurfaceInteraction<R>,
    surface: &Surface<R>,
) -> ShadowRay<R> {
    let (path, effects) = (&vertex.path, launch.spec.effects);
    if !is_lit(launch) {
        return ShadowRay::none();
    }
    let view = Viewpoint::on(interaction, surface.normal, false).at(vertex.found.time);
    let sample = drawn_light(launch, lighting, vertex, &view);
    if !interaction.receives(sample.direction) {
        return ShadowRay::none();
    }
    let incidence = LightSample { direction: sample.direction, colour: sample.light };
    let light = eval_phong(effects, surface, path.direction, &incidence);
    let light = (light * R::splat(INVERSE_PI)).map(|c| c.flush(FAINT));
    vertex.asks(launch, (interaction, view.origin), &sample, light)
}

/// The reflected and the refracted ray; a zero weight is none.
#[inline(always)]
fn branches<R: Scalar>(
    effects: Effects,
    vertex: &Vertex<R>,
    interaction: &SurfaceInteraction<R>,
    surface: &Surface<R>,
) -> (PathState<R>, PathState<R>) {
    let specular = Specular::new(effects, surface, interaction, vertex.path.direction);
    let on = |direction, factor| {
        vertex.on((interaction, specular.leave(interaction, direction)), direction, factor, R::splat(0.0))
    };
    let through = if specular.passes { specular.lens } else { V3::zero() };
    (on(specular.mirrored, specular.mirror), on(specular.refracted, through))
}
