//! Which light a path's vertex samples, where on it, and how likely that is (thesis 3.4.1, 3.4.4).
//!
//! A light is chosen by its power or, of many, by what of it may arrive; a triangle or a disk is then sampled by area, a sphere by
//! the solid angle of its cone, or from inside by area. Densities that are compared by multiple importance sampling are over solid angle as seen from a ray's origin,
//! and a function here gives them for a place whether it was sampled or hit, so that both know the same.

use super::choice::{per_area, per_area_of_hit, picked};
use super::moving::over_area_at;
use super::{Environment, LightSample, SHORT, Viewpoint, at_time};
use crate::buffer::read;
use crate::data::{Aovs, Effects, Emission, Emitter, Light, LightNode, Primitive, Waves, numbers};
use crate::geometry::{SurfaceInteraction, tangents};
use crate::real::{FAINT, Real, SMALL, Scalar, TINY, V3, turns};
use crate::sampler::unit;
use crate::scene::LaunchContext;
use crate::texture::{Place, Textures, opacity as opacity_of};
use glam::UVec4;

/// What emits in a scene.
#[derive(Clone, Copy)]
pub struct Lighting<'a> {
    /// Every light that may be chosen.
    pub emitters: &'a [Emitter],
    /// Those that have a place, where there are many ([`Effects::MANY_LIGHTS`]).
    pub nodes: &'a [LightNode],
    /// What each material emits.
    pub emissions: &'a [Emission],
    /// What it is covered with.
    pub textures: Textures<'a>,
    /// Light from far away ([`Effects::ENVIRONMENT`]), see [`Environment`].
    pub environment: &'a [u32],
    /// What light of single wavelengths does ([`Waves::SPECTRAL`]), see [`SpectrumRow`](crate::data::SpectrumRow).
    pub spectra: &'a [UVec4],
}

impl Lighting<'_> {
    /// What light of a colour, linear RGB, has of each of a sample's wavelengths: of D65, or of an illuminant by the row of its shares
    /// of that.
    #[inline(always)]
    pub fn banded<R: Scalar>(&self, launch: &LaunchContext<'_>, rgb: V3<R>, illuminant: u32) -> V3<R> {
        let light = launch.banded(rgb);
        if !launch.spec.waves.has(Waves::SPECTRAL) || !launch.spec.waves.has(Waves::ILLUMINANTS) || illuminant == 0 {
            return light;
        }
        light.times(launch.bands.row(self.spectra, illuminant)).map(|c| c.flush(FAINT))
    }
}

/// A sample of a light, as seen from a ray's origin.
#[derive(Clone, Copy)]
pub struct EmitterSample<R: Real> {
    /// Unit direction towards it.
    pub direction: V3<R>,
    /// How far a shadow ray goes.
    pub limit: R,
    /// Linear RGB that arrives over the density of the sample; zero if there is nothing to sample.
    pub light: V3<R>,
    /// How likely it was found.
    pub density: Density<R>,
    /// The group of the lamp that it is of ([`Aovs::GROUPS`]); 0 for none.
    pub group: u32,
}

/// A density over solid angle, as a fraction, since the cosine may be almost zero.
#[derive(Clone, Copy)]
pub struct Density<R: Real> {
    /// Over area times the square of the distance, or over solid angle; 0 for a light without extent.
    pub over: R,
    /// The cosine at the light, or 1.
    pub under: R,
}

/// The inverse of the least distance to a light without extent, nearer than which it grows no brighter.
const MOST: f32 = 1.0 / SMALL;

/// Spheres are sampled by solid angle from where the square of the sine of their cone is less: nearer, its rounding counts.
const OUTSIDE: f32 = 1.0 - 1.0 / 4096.0;

impl<R: Scalar> EmitterSample<R> {
    /// Nothing: along the third axis, without light.
    #[inline(always)]
    pub fn none() -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let density = Density { over: zero, under: one };
        EmitterSample { direction: V3::new(zero, zero, one), limit: -one, light: V3::zero(), density, group: 0 }
    }

    /// Samples one light of all as seen from a place: `choice` draws which, `place` where on it.
    #[inline(always)]
    pub fn new(
        launch: &LaunchContext<'_>,
        lighting: &Lighting<'_>,
        view: &Viewpoint<R>,
        choice: u32,
        place: (u32, u32),
    ) -> Self {
        let (emitter, probability) = picked(launch, lighting, view, choice, place);
        if launch.spec.effects.has(Effects::MANY_LIGHTS) && probability.eq(R::splat(0.0)) {
            return Self::none();
        }
        let sample = Self::of(launch, lighting, (&emitter, probability), view, place);
        let light = lighting.banded(launch, sample.light, illuminant(launch, lighting, &emitter));
        EmitterSample { light, group: group(launch, lighting, &emitter), ..sample }
    }

    /// Samples a light that was chosen with some probability.
    #[inline(always)]
    pub(super) fn of(
        launch: &LaunchContext<'_>,
        lighting: &Lighting<'_>,
        (emitter, probability): (&Emitter, R),
        view: &Viewpoint<R>,
        place: (u32, u32),
    ) -> Self {
        let (effects, origin) = (launch.spec.effects, view.origin);
        if effects.has(Effects::ENVIRONMENT) && emitter.light.position.w == Emitter::ENVIRONMENT {
            return Environment::new(lighting.environment).sample(place, probability);
        }
        if !effects.has(Effects::EMISSIVE) || emitter.light.position.w != Emitter::PRIMITIVE {
            return Self::without_extent(effects, &at_time::<R>(launch, emitter.light, view.time), origin, probability);
        }
        let (index, instance) = (emitter.light.axis.w, emitter.instance());
        let primitive = launch.placed(index, instance, view.time);
        let emission = read(lighting.emissions, primitive.material());
        let per_area = per_area(effects, &emission, emitter, probability);
        let per_area = over_area_at(launch, per_area, (index, instance, view.time));
        let sample = if effects.has(Effects::SPHERE) && primitive.is_sphere() {
            Self::of_sphere(&primitive, (&emission, per_area), origin, place)
        } else {
            Self::of_plane(launch, lighting, (&primitive, emitter), (&emission, per_area), (origin, place))
        };
        if effects.has(Effects::HIDDEN) && primitive.has(Primitive::UNREFLECTED) {
            // No path finds it by chance.
            let density = Density { over: R::splat(0.0), ..sample.density };
            return EmitterSample { density, ..sample };
        }
        sample
    }

    /// A light without extent, by its own intensity and the inverse square of the distance.
    #[inline(always)]
    fn without_extent(effects: Effects, light: &Light, origin: V3<R>, probability: R) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let LightSample { direction, colour } = LightSample::new(effects, light, origin);
        let density = Density { over: zero, under: one };
        if effects.has(Effects::DIRECTIONAL) && light.position.w == Light::DIRECTIONAL {
            let light = (colour * probability.reciprocal()).map(|c| c.flush(FAINT));
            return EmitterSample { direction, limit: R::splat(f32::MAX), light, density, group: 0 };
        }
        let away = (V3::<R>::splat(numbers(light.position)) - origin).map(|c| c.flush(SMALL));
        let distance = away.direction_and_length().1;
        if distance.lt(R::splat(TINY)) {
            return Self::none();
        }
        let inverse = distance.reciprocal().min(R::splat(MOST));
        let light = ((colour * inverse).map(|c| c.flush(FAINT)) * inverse).map(|c| c.flush(FAINT));
        let light = (light * probability.reciprocal()).map(|c| c.flush(FAINT));
        EmitterSample { direction, limit: distance * R::splat(1.0 - SHORT), light, density, group: 0 }
    }

    /// A triangle or a disk.
    #[inline(always)]
    fn of_plane(
        launch: &LaunchContext<'_>,
        lighting: &Lighting<'_>,
        (primitive, emitter): (&Primitive, &Emitter),
        (emission, per_area): (&Emission, R),
        (origin, place): (V3<R>, (u32, u32)),
    ) -> Self {
        let (effects, index) = (launch.spec.effects, emitter.light.axis.w);
        let coordinates = drawn_on(effects, primitive, place);
        let at = SurfaceInteraction::new(effects, primitive, coordinates, V3::zero());
        let sample = Self::of_place((emission, per_area), at.position, at.normal, origin);
        let place = Place { index, weights: coordinates, count: launch.frame.vertices };
        let light = covered(launch, lighting, (primitive, emission), &place, sample.light);
        EmitterSample { light, ..sample }
    }

    /// A place on a surface that emits, sampled by area, with its front's normal.
    #[inline(always)]
    fn of_place((emission, per_area): (&Emission, R), position: V3<R>, normal: V3<R>, origin: V3<R>) -> Self {
        let away = (position - origin).map(|c| c.flush(SMALL));
        let (direction, distance) = away.direction_and_length();
        let facing = -normal.dot(direction).flush(SMALL);
        let is_seen = if emission.sides.x & Emission::TWO_SIDED != 0 {
            !facing.eq(R::splat(0.0))
        } else {
            R::splat(0.0).lt(facing)
        };
        let density = over_area(per_area, away, facing.abs());
        if !is_seen || density.over.eq(R::splat(0.0)) {
            return Self::none();
        }
        let light = density.share_of(V3::splat(numbers(emission.radiance)));
        EmitterSample { direction, limit: distance * R::splat(1.0 - SHORT), light, density, group: 0 }
    }

    #[inline(always)]
    fn of_sphere(sphere: &Primitive, (emission, per_area): (&Emission, R), origin: V3<R>, place: (u32, u32)) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let (centre, radius) = (V3::<R>::splat(sphere.centre()), R::splat(sphere.radius()));
        let cone = Cone::new(centre, radius, origin);
        let (x, y) = on_circle::<R>(place.1);
        let drawn = R::splat(unit(place.0));
        if !cone.is_outside {
            let height = one - (drawn + drawn);
            let across = (drawn * (one - drawn)).sqrt();
            let across = across + across;
            let normal = V3::new(x * across, y * across, height).map(|c| c.flush(TINY));
            return Self::of_place((emission, per_area), centre + normal * radius, normal, origin);
        }
        let (axis, distance) = (centre - origin).map(|c| c.flush(SMALL)).direction_and_length();
        let height = (drawn * cone.height).flush(FAINT);
        let square = (height * (one + one - height)).flush(FAINT);
        let (sine, cosine) = (square.sqrt(), one - height);
        let [right, up] = tangents(axis);
        let across = (right * x + up * y).map(|c| c.flush(TINY));
        let direction = (across * sine + axis * cosine).map(|c| c.flush(TINY));
        let half = (radius * radius - (distance * distance * square).flush(FAINT)).max(zero).sqrt();
        let limit = (distance * cosine - half) * R::splat(1.0 - SHORT);
        let density = cone.density(per_area, radius);
        if density.over.eq(zero) {
            return Self::none();
        }
        let light = density.share_of(V3::splat(numbers(emission.radiance)));
        EmitterSample { direction, limit, light, density, group: 0 }
    }
}

impl<R: Scalar> Density<R> {
    /// That a ray from a place would have been sampled which found an emitter at an interaction.
    #[inline(always)]
    pub fn of_hit(
        launch: &LaunchContext<'_>,
        lighting: &Lighting<'_>,
        (primitive, emission): (&Primitive, &Emission),
        (at, index, instance): (&SurfaceInteraction<R>, u32, u32),
        view: &Viewpoint<R>,
    ) -> Self {
        let (effects, origin) = (launch.spec.effects, view.origin);
        let per_area = per_area_of_hit(launch, lighting, (primitive, emission), view);
        let per_area = over_area_at(launch, per_area, (index, instance, view.time));
        if effects.has(Effects::SPHERE) && primitive.is_sphere() {
            let (centre, radius) = (V3::<R>::splat(primitive.centre()), R::splat(primitive.radius()));
            let cone = Cone::new(centre, radius, origin);
            if cone.is_outside {
                return cone.density(per_area, radius);
            }
        }
        let away = (at.position - origin).map(|c| c.flush(SMALL));
        over_area(per_area, away, at.normal.dot(away.direction_and_length().0).flush(SMALL).abs())
    }

    /// A radiance over the density.
    #[inline(always)]
    pub(super) fn share_of(&self, radiance: V3<R>) -> V3<R> {
        let share = self.under.div(self.over).flush(FAINT);
        (radiance * share).map(|c| c.flush(FAINT))
    }
}

/// The density of a place that was sampled by area, so far away.
#[inline(always)]
fn over_area<R: Scalar>(per_area: R, away: V3<R>, cosine: R) -> Density<R> {
    Density { over: (per_area * away.dot(away)).flush(FAINT), under: cosine }
}

/// The cone in which a sphere is seen.
struct Cone<R: Real> {
    is_outside: bool,
    /// One less the cosine of half its angle.
    height: R,
}

impl<R: Scalar> Cone<R> {
    #[inline(always)]
    fn new(centre: V3<R>, radius: R, origin: V3<R>) -> Self {
        let one = R::splat(1.0);
        let away = (centre - origin).map(|c| c.flush(SMALL));
        let (square, own) = (away.dot(away), (radius * radius).flush(FAINT));
        let is_outside = own.lt(square * R::splat(OUTSIDE));
        let sine = own.div(R::select(is_outside, square, own)).flush(FAINT);
        Cone { is_outside, height: sine.over(one + (one - sine).sqrt()) }
    }

    /// The sphere is chosen as its area is, and each direction of the cone is as likely.
    #[inline(always)]
    fn density(&self, per_area: R, radius: R) -> Density<R> {
        // 4 pi r^2 of area over 2 pi h of solid angle.
        let two = R::splat(2.0);
        Density { over: (two * (per_area * radius).flush(FAINT) * radius).flush(FAINT), under: self.height }
    }
}

/// Where on a triangle or a disk a pair of draws means, each place as likely.
#[inline(always)]
pub(super) fn drawn_on<R: Scalar>(effects: Effects, primitive: &Primitive, place: (u32, u32)) -> (R, R) {
    if effects.has(Effects::DISK) && primitive.is_disk() {
        let (x, y) = on_circle::<R>(place.1);
        let reach = R::splat(unit(place.0)).sqrt();
        return (x * reach, y * reach);
    }
    in_triangle(R::splat(unit(place.0)), R::splat(unit(place.1)))
}

/// Light from a place on a triangle or a disk, as its opacity, the colours of its vertices and its map leave it.
#[inline(always)]
pub(super) fn covered<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    (primitive, emission): (&Primitive, &Emission),
    place: &Place<R>,
    light: V3<R>,
) -> V3<R> {
    let (effects, mut light) = (launch.spec.effects, light);
    if effects.has(Effects::CUTOUT) && primitive.is_triangle() && primitive.is_cutout() {
        light = (light * opacity(launch, &lighting.textures, emission, place)).map(|c| c.flush(FAINT));
    }
    light = glowing(effects, &lighting.textures, emission, place, light);
    if !effects.has(Effects::TEXTURED) || emission.sides.y == 0 {
        return light;
    }
    let texel = lighting.textures.at(launch.spec.launch, emission.sides.y, place, R::splat(0.0)).1;
    light.times(texel.colour).map(|c| c.flush(FAINT))
}

/// The row of the spectrum that a light has, where some have one of their own; 0 for that of D65.
#[inline(always)]
pub(super) fn illuminant(launch: &LaunchContext<'_>, lighting: &Lighting<'_>, emitter: &Emitter) -> u32 {
    if !launch.spec.waves.has(Waves::SPECTRAL) || !launch.spec.waves.has(Waves::ILLUMINANTS) {
        return 0;
    }
    if !launch.spec.effects.has(Effects::EMISSIVE) || emitter.light.position.w != Emitter::PRIMITIVE {
        return emitter.light.illuminant();
    }
    read(lighting.emissions, launch.primitive(emitter.light.axis.w).material()).illuminant()
}

/// The group that a light is in, where somebody asks for it.
#[inline(always)]
pub(super) fn group(launch: &LaunchContext<'_>, lighting: &Lighting<'_>, emitter: &Emitter) -> u32 {
    if !launch.spec.aovs.has(Aovs::GROUPS) && !launch.spec.effects.has(Effects::LINKED) {
        return 0;
    }
    if !launch.spec.effects.has(Effects::EMISSIVE) || emitter.light.position.w != Emitter::PRIMITIVE {
        return emitter.group();
    }
    read(lighting.emissions, launch.primitive(emitter.light.axis.w).material()).group()
}

/// How often a place on a triangle that is not opaque everywhere is there to send out light.
#[inline(always)]
fn opacity<R: Scalar>(launch: &LaunchContext<'_>, textures: &Textures<'_>, emission: &Emission, place: &Place<R>) -> R {
    let (effects, zero, one) = (launch.spec.effects, R::splat(0.0), R::splat(1.0));
    let mut opacity = place.opacity(effects, textures);
    if effects.has(Effects::TEXTURED) && emission.sides.z != 0 {
        opacity = opacity * opacity_of(launch.spec.launch, textures, emission.sides.z, place);
    }
    let factor = R::splat(f32::from_bits(emission.sides.w));
    if factor.lt(zero) { R::select((-factor).le(opacity), one, zero) } else { opacity * factor }
}

/// What a material emits, by the colours of vertices where they count.
#[inline(always)]
pub(crate) fn glowing<R: Scalar>(
    effects: Effects,
    textures: &Textures<'_>,
    emission: &Emission,
    place: &Place<R>,
    light: V3<R>,
) -> V3<R> {
    if !effects.has(Effects::GLOWING_COLOURS) || emission.sides.x & Emission::COLOURED == 0 {
        return light;
    }
    light.times(place.colour(effects, textures)).map(|c| c.flush(FAINT))
}

/// The cosine and the sine of a drawn angle.
#[inline(always)]
pub(crate) fn on_circle<R: Scalar>(drawn: u32) -> (R, R) {
    let (x, y) = turns::cos_sin(drawn);
    (R::splat(x), R::splat(y))
}

/// Weights of a triangle's second and third vertex (Heitz, A Low-Distortion Map Between Triangle and Square, 2019).
#[inline(always)]
fn in_triangle<R: Scalar>(u: R, v: R) -> (R, R) {
    let half = R::splat(0.5);
    if u.lt(v) { (u * half, v - u * half) } else { (u - v * half, v * half) }
}
