//! Distributed ray tracing (Cook, Porter and Carpenter, 1984; thesis 3.4.1): Whitted's tree of reflected and refracted rays, where
//! lights have extent and each vertex asks one of them.

use super::sampled::{ScatterContext, Scattered, Vertex, share};
use super::whitted::counts;
use crate::buffer::read;
use crate::data::{Effects, Maps, numbers};
use crate::geometry::SurfaceInteraction;
use crate::light::{EmitterSample, LightSample, Lighting};
use crate::material::{INVERSE_PI, Specular, Surface, eval_phong};
use crate::real::{FAINT, Scalar, V3};
use crate::sampler::DECISIONS;
use crate::scene::LaunchContext;
use crate::stage::{PathState, ShadowRay};

/// Adds what the surface emits and its ambient light, asks for the light of one light, and branches.
#[inline(always)]
pub(super) fn at<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
) -> Scattered<R> {
    let (path, effects) = (vertex.path, launch.spec.effects);
    let ScatterContext { shading, lighting, .. } = context;
    let seen = vertex.met(launch);
    let (primitive, interaction) = (seen.primitive, seen.interaction);
    let covering = seen.covering(launch, shading, Maps::BASE);
    let surface = Surface::new(effects, shading, &seen, &covering);
    let mut light = surface.ambient;
    if effects.has(Effects::EMISSIVE) {
        let emission = read(lighting.emissions, primitive.material());
        if emission.shines(interaction.front) {
            let radiance = V3::splat(numbers(emission.radiance));
            let radiance = if effects.has(Effects::TEXTURED) { radiance.times(covering.emission) } else { radiance };
            light = light + radiance.map(|c| c.flush(FAINT));
        }
    }
    let light = share(launch, &path, light);
    let shadow = sampled_light(launch, lighting, vertex, &interaction, &surface);
    if !effects.has(Effects::REFLECTION | Effects::REFRACTION) {
        return Scattered::once(light, shadow, path, false);
    }
    let (reflected, refracted) = branches(effects, vertex, &interaction, &surface);
    let counts = |path: &PathState<R>| counts(launch, path.bounces, path.weight);
    let (first, second) = (counts(&reflected), counts(&refracted));
    Scattered {
        light,
        shadow,
        next: if first { reflected } else { refracted },
        goes_on: first || second,
        other: refracted,
        waits: first && second,
    }
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
    if !effects.has(Effects::LIT | Effects::EMISSIVE | Effects::ENVIRONMENT) || launch.frame.emitters == 0 {
        return ShadowRay::none();
    }
    let number = path.counts().1;
    let (decisions, places) = (vertex.draws.set(DECISIONS + number), vertex.draws.set(number));
    let origin = interaction.offset_ray_origin(interaction.normal);
    let sample = EmitterSample::new(launch, lighting, origin, decisions.x, (places.z, places.w));
    if !interaction.faces(sample.direction) {
        return ShadowRay::none();
    }
    let incidence = LightSample { direction: sample.direction, colour: sample.light };
    let light = eval_phong(effects, surface, path.direction, &incidence);
    let light = (light * R::splat(INVERSE_PI)).map(|c| c.flush(FAINT));
    vertex.asks(launch, (interaction, origin), &sample, light)
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
