//! Path tracing (thesis 3.4.4; Kajiya, The Rendering Equation, 1986): at each vertex one sample of a light and one of the surface,
//! weighted together by multiple importance sampling (Veach and Guibas 1995).

use super::feature::albedo;
use super::sampled::{Outputs, ScatterContext, Scattered, is_lit, share};
use super::vertex::Vertex;
use super::{medium, photon};
use crate::background::gradient;
use crate::buffer::read;
use crate::data::{Aovs, Caustics, Effects, Finishes, Frame, Launch, Material, Media, Primitive, numbers};
use crate::geometry::SurfaceInteraction;
use crate::light::{Density, EmitterSample, Lighting, Viewpoint, glowing};
use crate::material::{Channels, Closure, Lobes, Scattering, Seen, Surface, closure, lifted};
use crate::photon::Photons;
use crate::ray::Ray;
use crate::real::{FAINT, Real, SMALL, Scalar, V3};
use crate::scene::LaunchContext;
use crate::stage::{Caught, Contribution, FirstSurface, PathState, ShadowRay, Split, brightness};
use crate::texture::{Covering, Place};
use glam::UVec4;

/// Adds what the surface emits, asks for the light of one light, and goes on.
#[inline(always)]
pub(super) fn at<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
    seen: &Seen<R>,
    around: Around<'_>,
) -> Scattered<R> {
    let effects = launch.spec.effects;
    let ScatterContext { shading, physicals, lighting, .. } = context;
    let vertex = &vertex.arrived(launch, physicals, seen);
    let path = vertex.path;
    let is_last = path.bounces > launch.frame.bounces;
    if vertex.after_catcher && seen.primitive.has(Primitive::CATCHER) {
        // What catchers send each other is in the plate.
        return Scattered::once(V3::zero(), ShadowRay::none(), path, false);
    }
    let covering = seen.whole_covering(launch, context, is_last);
    let light = share(launch, &path, emitted(launch, lighting, vertex, seen, &covering));
    let mut outputs = Outputs::of(Contribution::<R>::SURFACE, group(launch, lighting, seen));
    if is_last {
        return Scattered { outputs, ..Scattered::once(light, ShadowRay::none(), path, false) };
    }
    let surface = Surface::new(launch, shading, seen, &covering);
    let surface = if launch.spec.media.has(Media::NESTED) {
        surface.within(medium::around(launch, context, vertex, seen.interaction.front))
    } else {
        surface
    };
    if launch.spec.aovs.has(Aovs::ALBEDO | Aovs::NORMAL) && path.bounces == 0 {
        let albedo = albedo(launch, physicals, (seen, &surface), &covering).map(|c| c.flush(FAINT));
        let normal = surface.normal.map(|c| c.flush(FAINT));
        outputs.surface = FirstSurface { albedo, normal, ..outputs.surface };
    }
    let passes = lets_through(launch, context, seen);
    let seen = if passes { *seen } else { Seen { interaction: lifted(launch, shading, seen), ..*seen } };
    if effects.has(Effects::PHYSICAL) {
        // Drawn before the closure only where that asks for one of them, so that others need not keep them meanwhile.
        let is_dispersive = launch.spec.finishes.has(Finishes::DISPERSIVE);
        let early = if is_dispersive { vertex.decisions() } else { UVec4::ZERO };
        // Of this number nobody else asks the last bits.
        let channels = Channels { weight: path.weight, draw: early.y };
        let closure = closure(launch, context, (&seen, &surface), &covering, channels);
        let decisions = if is_dispersive { early } else { vertex.decisions() };
        let known = Known { light, outputs, passes, decisions, around };
        return scattered(launch, context, vertex, (&seen, &closure), known);
    }
    let interaction = seen.interaction;
    let lobes = Lobes::new(effects, &surface, &interaction, path.direction);
    let known = Known { light, outputs, passes, decisions: vertex.decisions(), around };
    scattered(launch, context, vertex, (&seen, &lobes), known)
}

/// The group of lamps that a surface is in, where somebody asks for it.
#[inline(always)]
fn group<R: Scalar>(launch: &LaunchContext<'_>, lighting: &Lighting<'_>, seen: &Seen<R>) -> u32 {
    let effects = launch.spec.effects;
    let is_asked = launch.spec.aovs.has(Aovs::GROUPS) || effects.has(Effects::LINKED);
    if !is_asked || !effects.has(Effects::EMISSIVE) {
        return 0;
    }
    read(lighting.emissions, seen.material()).group()
}

/// The groups of lamps that do not light a surface.
#[inline(always)]
fn unlit<R: Scalar>(launch: &LaunchContext<'_>, materials: &[Material], seen: &Seen<R>) -> u32 {
    if launch.spec.effects.has(Effects::LINKED) { read(materials, seen.material()).ambient.w } else { 0 }
}

/// Does a surface send light of its far side to the viewer?
#[inline(always)]
fn lets_through<R: Scalar>(launch: &LaunchContext<'_>, context: &ScatterContext<'_>, seen: &Seen<R>) -> bool {
    seen.primitive.is_transparent()
        || launch.spec.finishes.has(Finishes::HAIR) && seen.primitive.has(Primitive::HAIR)
        || launch.spec.finishes.has(Finishes::TRANSLUCENT) && read(context.finishes, seen.material()).is_translucent()
}

/// The photons of a launch, and the slot that looks for them.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    /// In device memory.
    pub photons: Photons<'a>,
    /// The slot.
    pub slot: u32,
}

/// What is known of a vertex before its closure is asked.
struct Known<'a, R: Real> {
    /// What the surface itself sends, linear RGB that reaches the pixel.
    light: V3<R>,
    /// What arbitrary output variables ask of it.
    outputs: Outputs<R>,
    /// Does the surface send light of its far side to the viewer?
    passes: bool,
    /// See [`Vertex::decisions`].
    decisions: UVec4,
    /// Where photons are found.
    around: Around<'a>,
}

/// The light of one light, and the next ray, by a surface's closure.
#[inline(always)]
fn scattered<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
    (seen, closure): (&Seen<R>, &impl Closure<R>),
    Known { light, mut outputs, passes, decisions, around }: Known<'_, R>,
) -> Scattered<R> {
    let interaction = seen.interaction;
    let bounces = vertex.path.bounces;
    let ScatterContext { shading, lighting, media, .. } = context;
    let view = Viewpoint::on(&interaction, closure.normal(), passes).at(seen.time);
    let caustics = launch.spec.caustics;
    let is_asked = !caustics.has(Caustics::PHOTONS) && is_lit(launch) && closure.is_rough();
    let unlit = unlit(launch, shading.materials, seen);
    let lamp = if is_asked {
        let lamp = EmitterSample::new(launch, lighting, &view, decisions.x, vertex.draws.pair(bounces));
        let lights = PathState { unlit, ..vertex.path }.is_lit_by(launch.spec.effects, lamp.group);
        if lights { lamp } else { EmitterSample::none() }
    } else {
        EmitterSample::none()
    };
    let (at, draws) = ((&interaction, view.origin), (decisions.y, decisions.w));
    let (arriving, sample) = closure.eval_and_sample(at, lamp.direction, draws, || vertex.draws.set(bounces + 1));
    if caustics.has(Caustics::PHOTONS) {
        let next = vertex.on((&interaction, sample.origin), sample.direction, sample.factor, sample.density);
        let next = PathState { unlit, ..next };
        return photon::met(launch, vertex, (seen, closure), next, decisions);
    }
    if launch.spec.aovs.has(Aovs::LOBES) && bounces == 0 {
        let passes = |direction| !interaction.receives(direction);
        let sampled = Split::new(arriving.value, arriving.diffuse, passes(lamp.direction));
        let further = Split::new(sample.factor, sample.diffuse, passes(sample.direction));
        outputs.surface = FirstSurface { sampled, further, ..outputs.surface };
    }
    let catches = vertex.catches(launch, &seen.primitive);
    // A catcher gets all of the light that is sampled, and none that chance finds.
    let lamp = if catches { EmitterSample { density: EmitterSample::<R>::none().density, ..lamp } } else { lamp };
    let mut shadow = if is_asked {
        sampled_light(launch, vertex, (&interaction, &view), &lamp, arriving)
    } else {
        ShadowRay::none()
    };
    shadow = medium::dimmed(launch, media, shadow);
    if catches {
        shadow.segment.source_primitive = Ray::<R>::OF_CATCHER;
    }
    let next = vertex.on((&interaction, sample.origin), sample.direction, sample.factor, sample.density);
    let is_wide = launch.spec.launch.has(Launch::MIPMAPPED) && sample.density.eq(R::splat(0.0));
    let width = if is_wide { seen.cone.width } else { R::splat(0.0) };
    // What a lamp's density depends on that the path finds.
    let side = if launch.spec.effects.has(Effects::MANY_LIGHTS) { view.side } else { 0 };
    let is_told = caustics.has(Caustics::GATHERED) && closure.is_wide() && !catches;
    let is_straight = caustics.has(Caustics::GATHERED) && sample.density.eq(R::splat(0.0));
    let gathered = if is_straight { vertex.path.gathered } else { is_told };
    let next = PathState { beside: (width, R::splat(side as f32)), unlit, gathered, ..next };
    let (next, goes_on) = survive(launch.frame, next, decisions.z);
    // The last ray finds only what emits.
    let goes_on = goes_on && (bounces < launch.frame.bounces || may_find_light(launch.frame, &next));
    let light = if catches { V3::zero() } else { light };
    let caustic = if is_told {
        let path = vertex.path;
        let light = photon::gathered(launch, &around.photons, (around.slot, path.bounces), (seen, closure));
        share(launch, &PathState { bounces: bounces + 1, ..path }, light)
    } else {
        V3::zero()
    };
    Scattered { catches, outputs, caustic, ..Scattered::once(light, shadow, next, goes_on) }
}

/// What a vertex on a shadow catcher asks for: a sampled light, and the surroundings along the next ray.
#[inline(always)]
pub(super) fn caught<R: Scalar>(launch: &LaunchContext<'_>, scattered: &Scattered<R>) -> Caught<R> {
    let sky = if scattered.goes_on { unsampled(launch, &scattered.next) } else { V3::zero() };
    Caught::under_way(brightness(scattered.shadow.light), brightness(sky))
}

/// What a ray that meets nothing sees of the surroundings, if that is no light that is sampled.
#[inline(always)]
fn unsampled<R: Scalar>(launch: &LaunchContext<'_>, path: &PathState<R>) -> V3<R> {
    let effects = launch.spec.effects;
    if effects.has(Effects::ENVIRONMENT) || !path.is_lit_by(effects, launch.frame.group) {
        return V3::zero();
    }
    share(launch, path, launch.banded(gradient(effects, launch.frame, path.direction)))
}

/// Does a ray pass near the box of all that emits? By axes that separate them (Gottschalk, Lin and Manocha, OBBTree, 1996),
/// without a division.
#[inline(always)]
pub(super) fn may_find_light<R: Scalar>(frame: &Frame, path: &PathState<R>) -> bool {
    // More than all rounding of the coordinates, which lie in [-1, 1] and are flushed below 2^-40.
    const MARGIN: f32 = 1.0 / (1 << 20) as f32;
    let (zero, d) = (R::splat(0.0), path.direction.map(|c| c.flush(SMALL)));
    let half =
        V3::<R>::splat(numbers(frame.lamps_half)) + V3::new(R::splat(MARGIN), R::splat(MARGIN), R::splat(MARGIN));
    let from = (path.origin - V3::splat(numbers(frame.lamps))).map(|c| c.flush(SMALL));
    let leaves = |from: R, half: R, d: R| half.lt(from.abs()) && zero.le(from * d);
    let (size, way) = (from.cross(d).abs(), d.abs());
    let beside = |size: R, a: R, b: R| (a + b + R::splat(MARGIN)).lt(size);
    !(leaves(from.x, half.x, d.x)
        || leaves(from.y, half.y, d.y)
        || leaves(from.z, half.z, d.z)
        || beside(size.x, half.y * way.z, half.z * way.y)
        || beside(size.y, half.z * way.x, half.x * way.z)
        || beside(size.z, half.x * way.y, half.y * way.x))
}

/// The radiance that a surface itself sends to the path, by the weight of the strategy that found it.
#[inline(always)]
fn emitted<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    vertex: &Vertex<R>,
    seen: &Seen<R>,
    covering: &Covering<R>,
) -> V3<R> {
    let effects = launch.spec.effects;
    let is_lit = vertex.path.is_lit_by(effects, group(launch, lighting, seen));
    // Photons bring no light along, and of light that they tell of, chance counts for nothing.
    if launch.spec.caustics.has(Caustics::PHOTONS) {
        return V3::zero();
    }
    if !effects.has(Effects::EMISSIVE) || !is_lit || vertex.path.is_told(launch.spec.caustics) {
        return V3::zero();
    }
    let Seen { primitive, interaction, .. } = *seen;
    let emission = read(lighting.emissions, primitive.material());
    if emission.radiance.w == 0 || !emission.shines(interaction.front) {
        return V3::zero();
    }
    let (radiance, own) = (V3::splat(numbers(emission.radiance)), vertex.path.density);
    let radiance = if effects.has(Effects::TEXTURED) {
        radiance.times(covering.emission).map(|c| c.flush(FAINT))
    } else {
        radiance
    };
    let place = Place { index: seen.index, weights: interaction.coordinates, count: launch.frame.vertices };
    let radiance = glowing(effects, &lighting.textures, &emission, &place, radiance);
    let radiance = lighting.banded(launch, radiance, emission.illuminant());
    if own.eq(R::splat(0.0)) {
        return radiance;
    }
    if vertex.after_catcher {
        return V3::zero();
    }
    let view = vertex.path.view().at(seen.time);
    let place = (&interaction, seen.index, seen.instance);
    let other = Density::of_hit(launch, lighting, (&primitive, &emission), place, &view);
    (radiance * weight(launch.spec.launch, Launch::BY_SURFACE, other.over, own * other.under)).map(|c| c.flush(FAINT))
}

/// The light of one light, by the same weights, which the surface scatters.
#[inline(always)]
fn sampled_light<R: Scalar>(
    launch: &LaunchContext<'_>,
    vertex: &Vertex<R>,
    (interaction, view): (&SurfaceInteraction<R>, &Viewpoint<R>),
    sample: &EmitterSample<R>,
    Scattering { value, density, .. }: Scattering<R>,
) -> ShadowRay<R> {
    let (effects, zero) = (launch.spec.effects, R::splat(0.0));
    let mut light = value.times(sample.light).map(|c| c.flush(FAINT));
    if !sample.density.over.eq(zero) {
        let own = density * sample.density.under;
        let share = weight(launch.spec.launch, Launch::BY_LIGHT, own.flush(FAINT), sample.density.over);
        light = (light * share).map(|c| c.flush(FAINT));
    }
    let passes = effects.has(Effects::PHYSICAL) && !interaction.receives(sample.direction);
    let origin = if passes { interaction.offset_ray_origin(sample.direction) } else { view.origin };
    vertex.asks(launch, (interaction, origin), sample, light)
}

/// What a sample counts whose own density is in the proportion `own` to that of the other strategy: all of it where its strategy,
/// which `alone` names, is the only one, and nothing where the other is.
#[inline(always)]
pub(super) fn weight<R: Scalar>(launch: Launch, alone: u32, other: R, own: R) -> R {
    /// Beyond this proportion a sample counts for nothing.
    const MOST: f32 = (1u64 << 40) as f32;
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    if launch.has(Launch::BY_SURFACE | Launch::BY_LIGHT) {
        return if launch.has(alone) { one } else { zero };
    }
    let own_is_none = own.flush(FAINT).eq(zero);
    let ratio = other.div(R::select(own_is_none, one, own)).min(R::splat(MOST));
    let ratio = R::select(own_is_none, R::splat(MOST), ratio);
    let ratio = if launch.has(Launch::BALANCED) { ratio } else { (ratio * ratio).flush(FAINT) };
    (one + ratio).reciprocal()
}

/// Russian roulette: a path of little weight ends, or goes on for those that ended. Does it go on?
#[inline(always)]
pub(super) fn survive<R: Scalar>(frame: &Frame, next: PathState<R>, decision: u32) -> (PathState<R>, bool) {
    /// Probabilities are whole steps of this size, so that decisions compare integers.
    const STEPS: u32 = 1 << 23;
    let greatest = next.weight.greatest();
    if !R::splat(0.0).lt(greatest) {
        return (next, false);
    }
    if next.bounces <= frame.roulette || R::splat(1.0).le(greatest) {
        return (next, true);
    }
    let steps = ((greatest * R::splat(STEPS as f32)).floor_index()).max(1);
    let raised = R::splat(STEPS as f32).over(R::splat(steps as f32));
    let weight = (next.weight * raised).map(|c| c.flush(FAINT));
    (PathState { weight, ..next }, (decision >> 9) < steps as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::pack;
    use bytemuck::Zeroable;
    use glam::Vec3;
    use proptest::prelude::*;

    fn finds(lamps: (Vec3, Vec3), origin: Vec3, direction: Vec3) -> bool {
        let frame = Frame { lamps: pack(lamps.0, 0), lamps_half: pack(lamps.1, 0), ..Zeroable::zeroed() };
        let of = |v: Vec3| V3::<f32>::new(v.x, v.y, v.z);
        let path = PathState {
            origin: of(origin),
            direction: of(direction.normalize()),
            source_primitive: 0,
            weight: V3::zero(),
            bounces: 0,
            unlit: 0,
            density: 0.0,
            pixel: 0,
            beside: (0.0, 0.0),
            from: V3::zero(),
            inside: Default::default(),
            gathered: false,
        };
        may_find_light(&frame, &path)
    }

    fn place() -> impl Strategy<Value = Vec3> {
        (-1f32..1.0, -1f32..1.0, -1f32..1.0).prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 5000, failure_persistence: None, ..Default::default() })]

        /// A ray to a place in the box is always taken to find it: thin boxes, too, and from inside.
        #[test]
        fn no_lamp_is_overlooked(middle in place(), half in place(), flat in 0..4usize, from in place(), at in place()) {
            let mut half = half.abs() * 0.3;
            if flat < 3 {
                half[flat] = 0.0;
            }
            let target = middle + at * half;
            prop_assume!(target.distance(from) > 1e-3);
            prop_assert!(finds((middle, half), from, target - from));
        }

        /// A ray that misses the box by far is not: as the slabs of its axes, in double precision, tell.
        #[test]
        fn a_ray_that_passes_by_finds_none(middle in place(), half in place(), from in place(), d in place()) {
            prop_assume!(d.length() > 0.01);
            let (half, d) = (half.abs() * 0.3, d.normalize());
            let (mut near, mut far) = (0f64, f64::INFINITY);
            for axis in 0..3 {
                let (from, d) = (f64::from(from[axis] - middle[axis]), f64::from(d[axis]));
                let half = f64::from(half[axis]) + 1e-3;
                let (a, b) = ((-half - from) / d, (half - from) / d);
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
            prop_assert_eq!(near <= far || !finds((middle, half), from, d), true);
        }
    }

    #[test]
    fn without_lamps_none_is_found() {
        assert!(!finds((Vec3::ZERO, Vec3::splat(-1.0)), Vec3::splat(0.5), Vec3::X));
        assert!(finds((Vec3::ZERO, Vec3::splat(1e9)), Vec3::splat(0.5), Vec3::X));
    }
}
