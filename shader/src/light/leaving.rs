//! Light as it leaves a lamp for what casts caustics: where photons start.

use super::choice::{per_area, picked_from_anywhere};
use super::emitter::{covered, drawn_on, group, illuminant};
use super::moving::over_area_at;
use super::{EmitterSample, LightSample, Lighting, Viewpoint, at_time, on_circle};
use crate::buffer::read;
use crate::data::{Effects, Emitter, Light, Primitive, numbers};
use crate::geometry::{SurfaceInteraction, octahedral};
use crate::photon::Casters;
use crate::ray::Ray;
use crate::real::{FAINT, Real, SMALL, Scalar, TINY, V3};
use crate::sampler::unit;
use crate::scene::LaunchContext;
use crate::texture::Place;
use glam::UVec4;

/// A ray that leaves a lamp.
#[derive(Clone, Copy)]
pub struct Leaving<R: Real> {
    /// Where it starts, maybe outside of the scene's cube.
    pub origin: V3<R>,
    /// Its unit direction.
    pub direction: V3<R>,
    /// Radiance times area and solid angle over the density of the ray: linear RGB, or of its sample's wavelengths. Zero if no light
    /// leaves that way.
    pub power: V3<R>,
    /// What it starts on, see [`Ray::source_primitive`].
    pub source_primitive: u32,
    /// The group of the lamp.
    pub group: u32,
}

/// What a ray from a lamp draws.
#[derive(Clone, Copy)]
pub struct LeavingDraws {
    /// The lamp, and the ball around casters that it goes to.
    pub choices: (u32, u32),
    /// The place on the lamp, or the direction from far away.
    pub place: (u32, u32),
    /// The direction to the ball, or the place across it.
    pub aim: (u32, u32),
}

impl LeavingDraws {
    /// From two sets of numbers.
    #[inline(always)]
    pub fn new(decisions: UVec4, set: UVec4) -> Self {
        LeavingDraws { choices: (decisions.x, decisions.y), place: (set.z, set.w), aim: (set.x, set.y) }
    }
}

impl<R: Scalar> Leaving<R> {
    /// No light.
    #[inline(always)]
    fn none() -> Self {
        let direction = V3::splat(glam::Vec3::Z);
        let source_primitive = Ray::<R>::OF_SURFACE;
        Leaving { origin: V3::zero(), direction, power: V3::zero(), source_primitive, group: 0 }
    }

    /// A ray from a lamp to casters, at a time.
    #[inline(always)]
    pub fn new(
        launch: &LaunchContext<'_>,
        lighting: &Lighting<'_>,
        casters: &Casters<'_>,
        draws: LeavingDraws,
        time: f32,
    ) -> Self {
        let (emitter, probability) = picked_from_anywhere::<R>(launch, lighting, draws.choices.0, draws.place);
        if probability.eq(R::splat(0.0)) {
            return Self::none();
        }
        let effects = launch.spec.effects;
        let is_primitive = effects.has(Effects::EMISSIVE) && emitter.light.position.w == Emitter::PRIMITIVE;
        let is_around = effects.has(Effects::ENVIRONMENT) && emitter.light.position.w == Emitter::ENVIRONMENT;
        let light = if is_primitive || is_around { emitter.light } else { at_time::<R>(launch, emitter.light, time) };
        let is_parallel = effects.has(Effects::DIRECTIONAL) && light.position.w == Light::DIRECTIONAL;
        let leaving = if is_primitive {
            Self::from_primitive(launch, lighting, (&emitter, probability), casters, draws, time)
        } else if is_around || is_parallel {
            // Of light from far away it does not matter where it is seen from.
            let view = Viewpoint { origin: casters.middle(), side: 0, time };
            let sample = EmitterSample::of(launch, lighting, (&emitter, probability), &view, draws.place);
            Self::from_afar(&sample, casters, draws)
        } else {
            Self::from_point(effects, (&light, probability), casters, draws)
        };
        let power = lighting.banded(launch, leaving.power, illuminant(launch, lighting, &emitter));
        Leaving { power, group: group(launch, lighting, &emitter), ..leaving }
    }

    /// From far away, of light that is told as a radiance over its density, or as what arrives.
    #[inline(always)]
    fn from_afar(sample: &EmitterSample<R>, casters: &Casters<'_>, draws: LeavingDraws) -> Self {
        /// Further than across the scene's cube.
        const AWAY: f32 = 4.0;
        let direction = -sample.direction;
        let (place, density) = casters.place(direction, draws.choices.1, draws.aim);
        let power = (sample.light * density.reciprocal()).map(|c| c.flush(FAINT));
        Leaving {
            origin: (place - direction * R::splat(AWAY)).map(|c| c.flush(TINY)),
            direction,
            power,
            ..Self::none()
        }
    }

    /// From a light without extent that has a place.
    #[inline(always)]
    fn from_point(
        effects: Effects,
        (light, probability): (&Light, R),
        casters: &Casters<'_>,
        draws: LeavingDraws,
    ) -> Self {
        let origin = V3::<R>::splat(numbers(light.position));
        let (direction, density) = casters.direction(origin, draws.choices.1, draws.aim);
        let LightSample { colour, .. } = LightSample::new(effects, light, origin + direction);
        let over = (probability * density).reciprocal();
        Leaving { origin, direction, power: (colour * over).map(|c| c.flush(FAINT)), ..Self::none() }
    }

    /// From a place on a surface that emits, each as likely.
    #[inline(always)]
    fn from_primitive(
        launch: &LaunchContext<'_>,
        lighting: &Lighting<'_>,
        (emitter, probability): (&Emitter, R),
        casters: &Casters<'_>,
        draws: LeavingDraws,
        time: f32,
    ) -> Self {
        let effects = launch.spec.effects;
        let (index, instance) = (emitter.light.axis.w, emitter.instance());
        let primitive = launch.placed(index, instance, time);
        let emission = read(lighting.emissions, primitive.material());
        let per_area =
            over_area_at(launch, per_area(effects, &emission, emitter, probability), (index, instance, time));
        let is_hidden = effects.has(Effects::HIDDEN) && primitive.has(Primitive::UNREFLECTED);
        let is_sphere = effects.has(Effects::SPHERE) && primitive.is_sphere();
        let coordinates: (R, R) =
            if is_sphere { on_sphere(draws.place) } else { drawn_on(effects, &primitive, draws.place) };
        let at = SurfaceInteraction::new(effects, &primitive, coordinates, V3::zero());
        let (direction, density) = casters.direction(at.position, draws.choices.1, draws.aim);
        let cosine = at.normal.dot(direction).flush(SMALL);
        let shines = emission.shines(R::splat(0.0).lt(cosine));
        // A density of zero is of a triangle that has no area, or of a lamp that nobody chooses.
        let density = per_area * density;
        if is_hidden || !shines || density.lt(R::splat(FAINT)) {
            return Self::none();
        }
        let radiance = V3::splat(numbers(emission.radiance));
        let place = Place { index, weights: coordinates, count: launch.frame.vertices };
        let light =
            if is_sphere { radiance } else { covered(launch, lighting, (&primitive, &emission), &place, radiance) };
        let power = (light * cosine.abs().div(density)).map(|c| c.flush(FAINT));
        let origin = at.offset_ray_origin(direction);
        Leaving { origin, direction, power, source_primitive: at.source_primitive(direction), group: 0 }
    }
}

/// The octahedral coordinates of a direction, each as likely.
#[inline(always)]
fn on_sphere<R: Scalar>(place: (u32, u32)) -> (R, R) {
    let (one, drawn) = (R::splat(1.0), R::splat(unit(place.0)));
    let across = (drawn * (one - drawn)).max(R::splat(0.0)).sqrt();
    let across = across + across;
    let (x, y) = on_circle::<R>(place.1);
    let normal = V3::new(x * across, y * across, one - (drawn + drawn)).map(|c| c.flush(TINY));
    let (u, v, scale) = octahedral(normal);
    let over = scale.reciprocal();
    ((u * over).flush(TINY), (v * over).flush(TINY))
}
