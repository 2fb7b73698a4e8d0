//! What paths meet between surfaces (Pharr, Jakob and Humphreys, Physically Based Rendering, 4th edition, chapter 14): a medium dims
//! them on their way, or scatters them there, with one sample of a light and one of the phase function.

use super::path::{may_find_light, survive, weight};
use super::sampled::{Outputs, ScatterContext, Scattered, is_lit, share};
use super::vertex::Vertex;
use crate::buffer::read;
use crate::data::{Filling, Launch, Media, Medium, numbers};
use crate::geometry::SurfaceInteraction;
use crate::light::{EmitterSample, Viewpoint};
use crate::medium::{Chain, Flight, MOST_CROSSINGS, Phase, delta, glow, transmittance};
use crate::ray::Ray;
use crate::real::{FAINT, Scalar, TINY, V3};
use crate::scene::LaunchContext;
use crate::stage::{Contribution, FirstSurface, PathState, Segment, ShadowRay, Split};

/// The vertex that a path comes to, in the medium that it is in (true) or where its ray has hit something: with what of its light
/// counts there, and what is inside of the surface.
// A function of its own on a CPU, where what no scene has would take registers from the rest.
#[cfg_attr(target_arch = "spirv", inline(always))]
#[cfg_attr(not(target_arch = "spirv"), inline(never))]
pub(super) fn flown<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
) -> (Vertex<R>, bool) {
    let (path, mut found) = (vertex.path, vertex.found);
    let is_nothing = found.is_nothing();
    let mut filling = Filling::default();
    if !is_nothing {
        let material = launch.placed(found.index, found.instance, found.time).material();
        filling = Filling(read(context.shading.materials, material).transmission.w);
    }
    // Surfaces around a medium are closed: what meets none of them is outside of all.
    let inside = if is_nothing { path.inside.outside() } else { path.inside };
    let path = PathState { inside, ..path };
    let number = inside.medium(context.media, launch.frame.fog());
    if number == 0 {
        return (Vertex { path, filling, ..*vertex }, false);
    }
    let lead = path.lead();
    let most = if is_nothing { R::splat(f32::MAX) } else { found.t + lead };
    let draws = vertex.draws.flight(path.bounces, inside.crossings());
    let medium = launch.medium(context.media, number);
    let flight = if launch.spec.media.has(Media::GRIDS) && medium.has_grid() {
        let ray = (path.origin - path.direction * lead, path.direction);
        delta(&medium, context.grids, ray, (most, path.weight), Chain::new(draws.x, draws.y))
    } else {
        Flight::new(&medium, most, path.weight, (draws.x, draws.y))
    };
    let weight = path.weight.times(flight.factor).map(|c| c.flush(FAINT));
    if flight.collides {
        // Before the ray's origin, too, which may be nearer to the scene than the way began.
        found.t = flight.distance - lead;
        filling = Filling(number);
    }
    (Vertex { path: PathState { weight, ..path }, found, filling, ..*vertex }, flight.collides)
}

/// Adds what a medium emits where a path collides with it, asks for the light of one light, and goes on.
// A function of its own on a CPU, where what no scene has would take registers from the rest.
#[cfg_attr(target_arch = "spirv", inline(always))]
#[cfg_attr(not(target_arch = "spirv"), inline(never))]
pub(super) fn at<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
) -> Scattered<R> {
    let path = vertex.path;
    let medium = launch.medium(context.media, vertex.filling.medium());
    let albedo = V3::<R>::splat(numbers(medium.albedo));
    let origin = (path.origin + path.direction * vertex.found.t).map(|c| c.flush(TINY));
    let light = if launch.spec.media.has(Media::GLOWING) {
        let absorbed = V3::splat(glam::Vec3::ONE) - albedo;
        let mut light = V3::splat(numbers(medium.emission));
        if launch.spec.media.has(Media::GRIDS) && medium.has_temperature() {
            light = light.times(launch.banded(glow(&medium, context.grids, origin))).map(|c| c.flush(FAINT));
        }
        share(launch, &path, absorbed.times(light).map(|c| c.flush(FAINT)))
    } else {
        V3::zero()
    };
    let surface = FirstSurface { sampled: Split::even(), further: Split::even(), ..FirstSurface::none() };
    let outputs = Outputs { surface, ..Outputs::of(Contribution::<R>::SURFACE, 0) };
    if path.bounces > launch.frame.bounces {
        return Scattered { outputs, ..Scattered::once(light, ShadowRay::none(), path, false) };
    }
    let path = PathState { weight: path.weight.times(albedo).map(|c| c.flush(FAINT)), ..path };
    let vertex = &Vertex { path, ..*vertex };
    let phase = Phase(R::splat(f32::from_bits(medium.albedo.w)));
    let decisions = vertex.decisions();
    let shadow = if is_lit(launch) {
        let view = Viewpoint { origin, side: 0, time: vertex.found.time };
        let pair = vertex.draws.pair(path.bounces);
        let lamp = EmitterSample::new(launch, &context.lighting, &view, decisions.x, pair);
        dimmed(launch, context.media, asked(launch, vertex, phase, origin, &lamp))
    } else {
        ShadowRay::none()
    };
    let (next, goes_on) = survive(launch.frame, scattered(vertex, phase, origin), decisions.z);
    let goes_on = goes_on && (path.bounces < launch.frame.bounces || may_find_light(launch.frame, &next));
    Scattered { outputs, ..Scattered::once(light, shadow, next, goes_on) }
}

/// The light of a lamp that a phase function scatters at a place, by the weights of multiple importance sampling.
#[inline(always)]
fn asked<R: Scalar>(
    launch: &LaunchContext<'_>,
    vertex: &Vertex<R>,
    phase: Phase<R>,
    origin: V3<R>,
    lamp: &EmitterSample<R>,
) -> ShadowRay<R> {
    let path = vertex.path;
    let density = phase.density(path.direction.dot(lamp.direction));
    let mut light = (lamp.light * density).map(|c| c.flush(FAINT));
    if !lamp.density.over.eq(R::splat(0.0)) {
        let own = (density * lamp.density.under).flush(FAINT);
        light = (light * weight(launch.spec.launch, Launch::BY_LIGHT, own, lamp.density.over)).map(|c| c.flush(FAINT));
    }
    let EmitterSample { direction, limit, .. } = *lamp;
    let segment = Segment { origin, direction, limit, source_primitive: Ray::<R>::OF_SURFACE };
    let bounces = path.bounces + 1;
    let tag = if launch.spec.aovs.any() { Contribution::<R>::tag(lamp.group, bounces) } else { 0 };
    let light = share(launch, &PathState { bounces, ..path }, light);
    ShadowRay { segment, light, tag, inside: path.inside.scattered(), ..ShadowRay::none() }.brought_near()
}

/// The path that goes on as a phase function scatters it at a place.
#[inline(always)]
fn scattered<R: Scalar>(vertex: &Vertex<R>, phase: Phase<R>, origin: V3<R>) -> PathState<R> {
    let path = vertex.path;
    let draws = vertex.draws.set(path.bounces + 1);
    let (direction, density) = phase.sample(path.direction, (draws.x, draws.y));
    PathState {
        // It may be outside of the scene's cube.
        origin: Ray::from_afar(origin, direction).origin,
        from: origin,
        direction,
        source_primitive: Ray::<R>::OF_SURFACE,
        bounces: path.bounces + 1,
        density,
        inside: path.inside.scattered(),
        unlit: 0,
        gathered: false,
        beside: (R::splat(0.0), R::splat(0.0)),
        ..path
    }
}

/// The light of a shadow ray behind the medium that it starts in, which is all that it goes through unless surfaces are not there: then
/// a stage of its own follows.
#[inline(always)]
pub(super) fn dimmed<R: Scalar>(launch: &LaunchContext<'_>, media: &[Medium], ray: ShadowRay<R>) -> ShadowRay<R> {
    if !launch.spec.media.has(Media::PRESENT) || launch.spec.media.has(Media::OPEN | Media::GRIDS) {
        return ray;
    }
    let number = ray.inside.medium(media, launch.frame.fog());
    if number == 0 || !ray.asks() {
        return ray;
    }
    let left = transmittance(&launch.medium(media, number), ray.segment.limit + ray.lead);
    ShadowRay { light: ray.light.times(left).map(|c| c.flush(FAINT)), ..ray }
}

/// Is the surface that a path has met, from its front or from its back, not there: by itself, or since what is there is the same on both
/// sides of it?
#[inline(always)]
pub(super) fn is_crossed<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
    front: bool,
) -> bool {
    let media = launch.spec.media;
    if media.has(Media::OPEN) && vertex.filling.is_open() {
        return true;
    }
    if !media.has(Media::NESTED) || vertex.filling.medium() == 0 {
        return false;
    }
    let (before, after) = sides(launch, context, vertex, front);
    before == after
}

/// The media on this side of the surface that a path has met, and on the far one, by their numbers.
#[inline(always)]
fn sides<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
    front: bool,
) -> (u32, u32) {
    let (inside, fog) = (vertex.path.inside, launch.frame.fog());
    let beyond = inside.across(front, vertex.filling.medium());
    (inside.medium(context.media, fog), beyond.medium(context.media, fog))
}

/// The index of refraction around the body whose surface a path has met.
#[inline(always)]
pub(super) fn around<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
    front: bool,
) -> R {
    let (before, after) = sides(launch, context, vertex, front);
    let number = if front { before } else { after };
    if number == 0 || vertex.filling.medium() == 0 {
        return R::splat(1.0);
    }
    R::splat(f32::from_bits(read(context.media, number - 1).emission.w))
}

/// Goes straight on through a surface that is not there, as if nothing were.
// A function of its own on a CPU, where what no scene has would take registers from the rest.
#[cfg_attr(target_arch = "spirv", inline(always))]
#[cfg_attr(not(target_arch = "spirv"), inline(never))]
pub(super) fn crossed<R: Scalar>(vertex: &Vertex<R>, interaction: SurfaceInteraction<R>) -> Scattered<R> {
    let path = vertex.path;
    let inside = path.inside.across(interaction.front, vertex.filling.medium());
    let is_open = vertex.filling.is_open();
    let next = PathState {
        origin: interaction.offset_ray_origin(path.direction),
        source_primitive: interaction.source_primitive(path.direction),
        inside: inside.crossed(),
        // Light that is sampled does not get through a surface that is there for others.
        density: if is_open { path.density } else { R::splat(0.0) },
        // Nor does a photon that has come so far alone lie there as light that was sampled.
        beside: if is_open { path.beside } else { (path.beside.0, R::splat(1.0)) },
        ..path
    };
    let goes_on = inside.crossings() < MOST_CROSSINGS && R::splat(0.0).lt(path.weight.greatest());
    Scattered::once(V3::zero(), ShadowRay::none(), next, goes_on)
}
