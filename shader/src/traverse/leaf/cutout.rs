//! Where triangles are not there: behind a mask, or by chance where they are half transparent.

use crate::buffer::read;
use crate::data::{Effects, Opacity, Primitive};
use crate::ray::Ray;
use crate::real::Real;
use crate::sampler::{hash, unit};
use crate::scene::LaunchContext;
use crate::texture::{Place, Textures, opacity as opacity_of};

/// How opaque materials are ([`Effects::CUTOUT`]).
#[derive(Clone, Copy, Default)]
pub struct Cutout<'a> {
    /// By material.
    pub opacities: &'a [Opacity],
    /// What they are covered with.
    pub textures: Textures<'a>,
}

impl Cutout<'_> {
    /// The lanes of a mask whose rays meet a triangle where it is there, by the weights of its second and third vertex. Where it
    /// is half transparent chance decides, by numbers of the ray, the triangle and the place on it alone, so that no order of visits
    /// changes it, and parallel rays from several places are met each by its own chance.
    #[inline(always)]
    pub fn kept<R: Real>(
        &self,
        launch: &LaunchContext<'_>,
        (triangle, index): (&Primitive, u32),
        (u, v): (R, R),
        ray: &Ray<R>,
        mask: R::Mask,
    ) -> R::Mask {
        let d = ray.direction;
        R::sieve(mask, [u, v, d.x, d.y, d.z], |[u, v, x, y, z]| {
            self.is_there(launch, (triangle, index), (u, v), [x, y, z])
        })
    }

    #[inline(always)]
    fn is_there(
        &self,
        launch: &LaunchContext<'_>,
        (triangle, index): (&Primitive, u32),
        weights: (f32, f32),
        direction: [f32; 3],
    ) -> bool {
        let mask = read(self.opacities, triangle.material()).mask;
        let place = Place { index, weights, count: launch.frame.vertices };
        let effects = launch.spec.effects;
        let mut opacity = f32::from_bits(mask.x) * place.opacity(effects, &self.textures);
        if effects.has(Effects::TEXTURED) && mask.z != 0 {
            opacity *= opacity_of(launch.spec.launch, &self.textures, mask.z, &place);
        }
        let least = f32::from_bits(mask.y);
        if least >= 0.0 {
            return opacity >= least;
        }
        let ([x, y, z], (u, v)) = (direction, weights);
        // Without its sign, since zero has two.
        let bits = |weight: f32| weight.to_bits() << 1;
        let [drawn, ..] = hash([x.to_bits() ^ triangle.number(), y.to_bits() ^ bits(u), z.to_bits() ^ bits(v)]);
        unit(drawn) < opacity
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Frame, Specialisation};
    use crate::real::V3;
    use glam::{UVec4, Vec3};

    /// The share of rays that meet a triangle of some opacity, whose material counts from `least` on as opaque.
    fn met(opacity: f32, least: f32, ray: impl Fn(f32) -> ((f32, f32), V3<f32>)) -> f64 {
        let opacities = [Opacity { mask: UVec4::new(opacity.to_bits(), least.to_bits(), 0, 0) }];
        let cutout = Cutout { opacities: &opacities, ..Cutout::default() };
        let spec = Specialisation::default();
        let frame = Frame::default();
        let launch = LaunchContext::new(&frame, spec, &[], &[]);
        let triangle = Primitive::triangle([Vec3::ZERO, Vec3::X, Vec3::Y], 5, 0, 0);
        let count = 20_000;
        let meets = |i: u32| {
            let (place, direction) = ray(i as f32 / count as f32);
            cutout.kept(&launch, (&triangle, 0), place, &Ray::<f32>::new(V3::zero(), direction), true)
        };
        f64::from((0..count).filter(|&i| meets(i)).count() as u32) / f64::from(count)
    }

    #[test]
    fn masks_decide_by_the_cutoff_and_blends_as_often_as_they_are_opaque() {
        let spread = |x: f32| ((0.2, 0.2), V3::new(2.0 * x, 0.3, -1.0));
        assert_eq!((met(0.49, 0.5, spread), met(0.5, 0.5, spread), met(0.0, 0.0, spread)), (0.0, 1.0, 1.0));
        // Those of a sun too, which comes from one direction.
        let parallel = |x: f32| ((0.3, 0.5 * x), V3::new(0.0, -1.0, 0.0));
        for opacity in [0.0f32, 0.1, 0.5, 0.9, 1.0] {
            for share in [met(opacity, -1.0, spread), met(opacity, -1.0, parallel)] {
                assert!((share - f64::from(opacity)).abs() < 0.015, "{opacity}: {share}");
            }
        }
    }
}
