//! Lights without extent, and their reflection: Lambert and Phong (thesis 3.1).

use super::{Contact, Surface, reflect};
use crate::data::{Effects, Light, numbers};
use crate::real::{FAINT, Real, Scalar, V3};

/// A shadow ray stops short of its light by this share, so that a light that lies on a surface is
/// not shadowed by it.
const SHORT: f32 = 1.0 / 16_384.0;

#[inline(always)]
fn is(effects: Effects, light: &Light, feature: u32, kind: u32) -> bool {
    effects.has(feature) && light.position.w == kind
}

/// Where a shadow ray starts, its unit direction and its limit.
#[inline(always)]
pub fn shadow_ray<R: Scalar>(effects: Effects, light: &Light, contact: &Contact<R>) -> (V3<R>, V3<R>, R) {
    let place = V3::<R>::splat(numbers(light.position));
    if is(effects, light, Effects::DIRECTIONAL, Light::DIRECTIONAL) {
        (contact.leave(place), place, R::splat(f32::MAX))
    } else {
        let origin = contact.leave(place - contact.position);
        let (direction, distance) = (place - origin).normalised();
        (origin, direction, distance * R::splat(1.0 - SHORT))
    }
}

/// The light that reaches a point that nothing shadows.
#[derive(Clone, Copy)]
pub struct Incidence<R: Real> {
    /// Unit direction towards the light.
    pub direction: V3<R>,
    /// Linear RGB that arrives.
    pub colour: V3<R>,
}

impl<R: Scalar> Incidence<R> {
    /// A light as seen from `position`.
    #[inline(always)]
    pub fn new(effects: Effects, light: &Light, position: V3<R>) -> Self {
        let place = V3::<R>::splat(numbers(light.position));
        let colour = V3::splat(numbers(light.colour));
        if is(effects, light, Effects::DIRECTIONAL, Light::DIRECTIONAL) {
            return Incidence { direction: place, colour };
        }
        let direction = (place - position).normalised().0;
        if is(effects, light, Effects::SPOT, Light::SPOT) {
            let share = spot(light, direction);
            return Incidence { direction, colour: (colour * share).map(|c| c.flush(FAINT)) };
        }
        Incidence { direction, colour }
    }
}

/// A spot's share: 1 within the inner cone, 0 outside the outer one, a cubic between (in the cosine).
#[inline(always)]
fn spot<R: Scalar>(light: &Light, direction: V3<R>) -> R {
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
    x * x * (R::splat(3.0) - R::splat(2.0) * x)
}

/// Light that a surface sends along `-direction`: Lambert's law and Phong's highlight.
#[inline(always)]
pub fn illuminate<R: Scalar>(
    effects: Effects,
    surface: &Surface<R>,
    direction: V3<R>,
    incidence: &Incidence<R>,
) -> V3<R> {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let cosine = surface.normal.dot(incidence.direction).max(zero).min(one);
    let mut answer = surface.diffuse * cosine;
    if effects.has(Effects::SPECULAR) && zero.lt(cosine) {
        // The light's mirrored direction against the direction to the viewer.
        let mirrored = reflect(-incidence.direction, surface.normal);
        let highlight = (-mirrored.dot(direction)).max(zero).min(one);
        answer = answer + surface.specular * highlight.pow(surface.shininess);
    }
    answer.times(incidence.colour).map(|c| c.flush(FAINT))
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

    fn surface() -> Surface<f64> {
        Surface {
            normal: V3::splat(Vec3::Y),
            ambient: V3::zero(),
            diffuse: V3::splat(Vec3::new(0.5, 0.5, 0.5)),
            specular: V3::splat(Vec3::ONE),
            shininess: 10.0,
            reflection: V3::zero(),
            transmission: V3::zero(),
            ior: 0.0,
        }
    }

    #[test]
    fn lambert_falls_with_the_cosine_and_phong_with_its_power() {
        let view = V3::splat(-Vec3::Y);
        for angle in [0.0f64, 0.3, 1.0, 1.5] {
            let direction = V3::new(angle.sin(), angle.cos(), 0.0);
            let got = illuminate(ALL, &surface(), view, &Incidence { direction, colour: V3::splat(Vec3::X) });
            assert!((got.x - (0.5 * angle.cos() + angle.cos().powi(10))).abs() < 1e-12);
            assert_eq!((got.y, got.z), (0.0, 0.0));
        }
        let below = Incidence { direction: view, colour: V3::splat(Vec3::ONE) };
        assert_eq!(illuminate(ALL, &surface(), view, &below), V3::zero());
    }

    #[test]
    fn a_highlight_is_where_the_light_is_mirrored() {
        let direction = V3::new(0.6, 0.8, 0.0);
        let white = Incidence { direction, colour: V3::splat(Vec3::ONE) };
        let seen = |view: V3<f64>| illuminate(ALL, &surface(), view, &white).x - 0.4;
        assert!((seen(V3::new(0.6, -0.8, 0.0)) - 1.0).abs() < 1e-12, "the mirrored view");
        assert!(seen(V3::new(-0.6, -0.8, 0.0)) < 0.1, "the view along the light");
    }

    #[test]
    fn a_matt_surface_has_no_highlight() {
        let white = Incidence { direction: V3::splat(Vec3::Y), colour: V3::splat(Vec3::ONE) };
        let matt = Effects(Effects::SPECULAR ^ u32::MAX);
        assert_eq!(illuminate(matt, &surface(), V3::splat(-Vec3::Y), &white), V3::splat(Vec3::splat(0.5)));
    }

    fn spot(x: f32) -> f64 {
        let from = V3::<f64>::splat(Vec3::new(x, 0.0, 0.0));
        Incidence::new(ALL, &light(Light::SPOT, Vec3::Y), from).colour.x
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
        let contact = Contact::<f64> {
            position: V3::zero(),
            clearance: 1e-6,
            normal: V3::splat(Vec3::Y),
            front: true,
            weights: (0.0, 0.0),
        };
        let beside = V3::splat(Vec3::new(3.0, 0.0, 0.0));
        let (origin, direction, _) =
            shadow_ray(ALL, &light(Light::POINT, Vec3::new(3.0, 4.0, 0.0)), &Contact { position: beside, ..contact });
        assert!((origin - beside).dot(origin - beside) < 1e-11 && (direction.y - 1.0).abs() < 1e-12);
        // The light lies below the surface, so the ray must leave towards that side.
        let (origin, ..) = shadow_ray(
            ALL,
            &light(Light::POINT, Vec3::Y),
            &Contact { position: V3::splat(Vec3::new(0.0, 2.0, 0.0)), ..contact },
        );
        assert!(origin.y < 2.0, "off the side that the light is on");
        let (origin, direction, limit) = shadow_ray(ALL, &light(Light::POINT, Vec3::Y), &contact);
        assert!(origin.y > 0.0 && (direction.y - 1.0).abs() < 1e-12 && limit < 1.0 && limit > 0.999);
        let (_, direction, limit) = shadow_ray(ALL, &light(Light::DIRECTIONAL, Vec3::Y), &contact);
        assert_eq!((direction, limit), (V3::splat(Vec3::Y), f64::from(f32::MAX)));
    }
}
