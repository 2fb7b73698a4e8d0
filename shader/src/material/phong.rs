//! The illumination model of thesis chapter 3.1: Lambert and Phong.

use super::{Surface, reflect};
use crate::data::Effects;
use crate::light::LightSample;
use crate::real::{FAINT, Scalar, V3};

/// Light that a surface sends along `-direction`: Lambert's law and Phong's highlight.
#[inline(always)]
pub fn eval_phong<R: Scalar>(
    effects: Effects,
    surface: &Surface<R>,
    direction: V3<R>,
    light: &LightSample<R>,
) -> V3<R> {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let cosine = surface.normal.dot(light.direction).max(zero).min(one);
    let mut answer = surface.diffuse * cosine;
    if effects.has(Effects::SPECULAR) && zero.lt(cosine) {
        // The light's mirrored direction against the direction to the viewer.
        let mirrored = reflect(-light.direction, surface.normal);
        let highlight = (-mirrored.dot(direction)).max(zero).min(one);
        answer = answer + surface.specular * highlight.pow(surface.shininess);
    }
    answer.times(light.colour).map(|c| c.flush(FAINT))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const ALL: Effects = Effects(u32::MAX);

    fn surface() -> Surface<f64> {
        Surface {
            around: 1.0,
            even_normal: V3::splat(Vec3::Y),
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
            let got = eval_phong(ALL, &surface(), view, &LightSample { direction, colour: V3::splat(Vec3::X) });
            assert!((got.x - (0.5 * angle.cos() + angle.cos().powi(10))).abs() < 1e-12);
            assert_eq!((got.y, got.z), (0.0, 0.0));
        }
        let below = LightSample { direction: view, colour: V3::splat(Vec3::ONE) };
        assert_eq!(eval_phong(ALL, &surface(), view, &below), V3::zero());
    }

    #[test]
    fn a_highlight_is_where_the_light_is_mirrored() {
        let direction = V3::new(0.6, 0.8, 0.0);
        let white = LightSample { direction, colour: V3::splat(Vec3::ONE) };
        let seen = |view: V3<f64>| eval_phong(ALL, &surface(), view, &white).x - 0.4;
        assert!((seen(V3::new(0.6, -0.8, 0.0)) - 1.0).abs() < 1e-12, "the mirrored view");
        assert!(seen(V3::new(-0.6, -0.8, 0.0)) < 0.1, "the view along the light");
    }

    #[test]
    fn a_matt_surface_has_no_highlight() {
        let white = LightSample { direction: V3::splat(Vec3::Y), colour: V3::splat(Vec3::ONE) };
        let matt = Effects(Effects::SPECULAR ^ u32::MAX);
        assert_eq!(eval_phong(matt, &surface(), V3::splat(-Vec3::Y), &white), V3::splat(Vec3::splat(0.5)));
    }
}
