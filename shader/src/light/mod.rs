//! Lights without extent: how they reach a place, and the shadow rays that ask whether they do (thesis 3.1, 3.2). Those with
//! extent, and the choice among all, are in a file of their own.

mod choice;
mod emitter;
mod environment;
mod leaving;
mod moving;
mod tree;
mod viewpoint;

pub use emitter::{Density, EmitterSample, Lighting};
pub(crate) use emitter::{glowing, on_circle};
pub use environment::{Environment, HEADER};
pub use leaving::{Leaving, LeavingDraws};
pub use moving::at_time;
pub use tree::{Chosen, Guide, descend};
pub use viewpoint::Viewpoint;

use crate::data::{Effects, Light, numbers};
use crate::geometry::SurfaceInteraction;
use crate::real::{FAINT, Real, Scalar, V3};

/// A shadow ray stops short of its light by this share, so that a light that lies on a surface is
/// not shadowed by it.
pub(crate) const SHORT: f32 = 1.0 / 16_384.0;

#[inline(always)]
fn is(effects: Effects, light: &Light, feature: u32, kind: u32) -> bool {
    effects.has(feature) && light.position.w == kind
}

/// Where a shadow ray starts, its unit direction and its limit.
#[inline(always)]
pub fn ray_to_light<R: Scalar>(
    effects: Effects,
    light: &Light,
    interaction: &SurfaceInteraction<R>,
) -> (V3<R>, V3<R>, R) {
    let place = V3::<R>::splat(numbers(light.position));
    if is(effects, light, Effects::DIRECTIONAL, Light::DIRECTIONAL) {
        (interaction.offset_ray_origin(place), place, R::splat(f32::MAX))
    } else {
        let origin = interaction.offset_ray_origin(place - interaction.position);
        let (direction, distance) = (place - origin).normalised();
        (origin, direction, distance * R::splat(1.0 - SHORT))
    }
}

/// The light that reaches a point that nothing shadows.
#[derive(Clone, Copy)]
pub struct LightSample<R: Real> {
    /// Unit direction towards the light.
    pub direction: V3<R>,
    /// Linear RGB that arrives.
    pub colour: V3<R>,
}

impl<R: Scalar> LightSample<R> {
    /// A light as seen from `position`.
    #[inline(always)]
    pub fn new(effects: Effects, light: &Light, position: V3<R>) -> Self {
        let place = V3::<R>::splat(numbers(light.position));
        let colour = V3::splat(numbers(light.colour));
        if is(effects, light, Effects::DIRECTIONAL, Light::DIRECTIONAL) {
            return LightSample { direction: place, colour };
        }
        let direction = (place - position).normalised().0;
        let is_ramp = is(effects, light, Effects::RAMP, Light::RAMP);
        if is_ramp || is(effects, light, Effects::SPOT, Light::SPOT) {
            let share = spot(light, direction, is_ramp);
            return LightSample { direction, colour: (colour * share).map(|c| c.flush(FAINT)) };
        }
        LightSample { direction, colour }
    }
}

/// A spot's share: 1 within the inner cone, 0 outside the outer one, between (in the cosine) a cubic or the square of a ramp.
#[inline(always)]
fn spot<R: Scalar>(light: &Light, direction: V3<R>, is_ramp: bool) -> R {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let inner = R::splat(f32::from_bits(light.colour.w));
    let outer = R::splat(f32::from_bits(light.axis.w));
    let cosine = -direction.dot(V3::splat(numbers(light.axis)));
    if cosine.lt(outer) {
        return zero;
    }
    if inner.le(cosine) {
        return one;
    }
    let x = (cosine - outer).div(inner - outer).max(zero).min(one);
    if is_ramp { x * x } else { x * x * (R::splat(3.0) - R::splat(2.0) * x) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::pack;
    use glam::Vec3;

    const ALL: Effects = Effects(u32::MAX);

    fn light(kind: u32, position: Vec3) -> Light {
        Light {
            position: pack(position, kind),
            colour: pack(Vec3::new(1.0, 0.5, 0.25), 0.9f32.to_bits()),
            axis: pack(-Vec3::Y, 0.5f32.to_bits()),
        }
    }

    fn share(kind: u32, x: f32) -> f64 {
        let from = V3::<f64>::splat(Vec3::new(x, 0.0, 0.0));
        LightSample::new(ALL, &light(kind, Vec3::Y), from).colour.x
    }

    fn spot(x: f32) -> f64 {
        share(Light::SPOT, x)
    }

    /// KHR_lights_punctual: `saturate(dot * scale + offset)` squared, of `scale = 1 / (cos inner - cos outer)` and
    /// `offset = -cos outer * scale`.
    #[test]
    fn a_spot_of_gltf_fades_by_the_square_of_its_extensions_ramp() {
        let scale = 1.0 / (f64::from(0.9f32) - 0.5);
        for x in [0.0f32, 0.4, 0.5, 0.8, 1.0, 1.5, 1.8] {
            let cosine = 1.0 / (1.0 + f64::from(x).powi(2)).sqrt();
            let ramp = (cosine * scale - 0.5 * scale).clamp(0.0, 1.0);
            assert!((share(Light::RAMP, x) - ramp * ramp).abs() < 1e-6, "{x}");
        }
        assert_ne!(share(Light::RAMP, 1.0), spot(1.0));
    }

    #[test]
    fn a_spot_fades_by_a_cubic_of_its_cosine() {
        for x in [0.5f32, 0.8, 1.0, 1.5] {
            let share = (1.0 / (1.0 + f64::from(x).powi(2)).sqrt() - 0.5) / f64::from(0.9f32 - 0.5);
            assert!((spot(x) - share * share * (3.0 - 2.0 * share)).abs() < 1e-6, "{x}");
        }
    }

    #[test]
    fn a_spot_lights_its_cone_only() {
        assert_eq!(spot(0.0), 1.0, "on the axis");
        assert_eq!(spot(0.4), 1.0, "cosine 0.93 is in the inner cone");
        assert!(spot(1.0) > 0.0 && spot(1.0) < 1.0, "cosine 0.71 is between");
        assert!(spot(1.0) > spot(1.2));
        assert_eq!(spot(1.8), 0.0, "cosine 0.49 is outside");
    }

    #[test]
    fn shadow_rays_end_short_of_a_place_and_never_for_a_direction() {
        let interaction = SurfaceInteraction::<f64> {
            position: V3::zero(),
            error_offset: 1e-6,
            normal: V3::splat(Vec3::Y),
            front: true,
            coordinates: (0.0, 0.0),
            number: 0,
            is_curved: false,
            radius: 0.0,
            is_lifted: false,
            lift: 0.0,
        };
        let beside = V3::splat(Vec3::new(3.0, 0.0, 0.0));
        let (origin, direction, _) = ray_to_light(
            ALL,
            &light(Light::POINT, Vec3::new(3.0, 4.0, 0.0)),
            &SurfaceInteraction { position: beside, ..interaction },
        );
        assert!((origin - beside).dot(origin - beside) < 1e-11 && (direction.y - 1.0).abs() < 1e-12);
        // The light lies below the surface, so the ray must leave towards that side.
        let (origin, ..) = ray_to_light(
            ALL,
            &light(Light::POINT, Vec3::Y),
            &SurfaceInteraction { position: V3::splat(Vec3::new(0.0, 2.0, 0.0)), ..interaction },
        );
        assert!(origin.y < 2.0, "off the side that the light is on");
        let (origin, direction, limit) = ray_to_light(ALL, &light(Light::POINT, Vec3::Y), &interaction);
        assert!(origin.y > 0.0 && (direction.y - 1.0).abs() < 1e-12 && limit < 1.0 && limit > 0.999);
        let (_, direction, limit) = ray_to_light(ALL, &light(Light::DIRECTIONAL, Vec3::Y), &interaction);
        assert_eq!((direction, limit), (V3::splat(Vec3::Y), f64::from(f32::MAX)));
    }
}
