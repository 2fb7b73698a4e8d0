//! From where lights are chosen.

use crate::geometry::SurfaceInteraction;
use crate::real::{Real, Scalar, V3};

/// A place, and the side of it that light may come from.
#[derive(Clone, Copy, Debug)]
pub struct Viewpoint<R: Real> {
    /// Where it is.
    pub origin: V3<R>,
    /// A normal in steps of 1/127, a byte for each component from 1 on, so that paths keep it as a number below 2^24 and every
    /// strategy knows the same; 0 where light comes from both sides.
    pub side: u32,
    /// When it is, see [`Ray::time`](crate::ray::Ray::time).
    pub time: f32,
}

/// The byte of a component of 0 is between this and one less.
const MIDDLE: f32 = 128.0;
const STEPS: f32 = 127.0;

impl<R: Scalar> Viewpoint<R> {
    /// Where rays start that a surface scatters, whose shading normal is given. Light from behind the plane of a triangle reaches
    /// only a curved surface, and never one from behind its shading normal.
    #[inline(always)]
    pub fn on(interaction: &SurfaceInteraction<R>, normal: V3<R>, passes: bool) -> Self {
        let origin = interaction.scattered_ray_origin(interaction.normal);
        Self::new(origin, if interaction.is_lifted { normal } else { interaction.normal }, passes)
    }

    /// On an opaque surface, or on one that lets light pass.
    #[inline(always)]
    pub fn new(origin: V3<R>, normal: V3<R>, passes: bool) -> Self {
        let byte = |c: R| {
            let steps = (c.max(R::splat(-1.0)).min(R::splat(1.0)) * R::splat(STEPS) + R::splat(MIDDLE)).floor_index();
            (steps as u32) & 0xff
        };
        let side = byte(normal.x) | (byte(normal.y) << 8) | (byte(normal.z) << 16);
        Viewpoint { origin, side: if passes { 0 } else { side }, time: 0.0 }
    }

    /// The same at a time.
    #[inline(always)]
    pub fn at(self, time: f32) -> Self {
        Viewpoint { time, ..self }
    }

    /// Its normal, to a hundredth.
    #[inline(always)]
    pub(super) fn normal(&self) -> V3<R> {
        const ZERO: f32 = MIDDLE - 0.5;
        const STEP: f32 = 1.0 / STEPS;
        let number = |shift: u32| {
            let byte = (self.side >> shift) & 0xff;
            (R::splat(byte as f32) - R::splat(ZERO)) * R::splat(STEP)
        };
        V3::new(number(0), number(8), number(16))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_side_is_a_number_of_single_precision_and_its_normal(x in -1f32..1.0, y in -1f32..1.0, z in -1f32..1.0) {
            let normal = Vec3::new(x, y, z);
            prop_assume!(normal.length() > 1e-3);
            let normal = normal.normalize();
            let view = Viewpoint::<f32>::new(V3::zero(), V3::splat(normal), false);
            prop_assert!(view.side > 0 && view.side as f32 as u32 == view.side && view.side < 1 << 24);
            let V3 { x, y, z } = view.normal();
            prop_assert!(Vec3::new(x, y, z).distance(normal) < 0.01);
        }
    }

    #[test]
    fn every_axis_has_a_side_and_what_light_passes_has_none() {
        for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
            let V3 { x, y, z } = Viewpoint::<f32>::new(V3::zero(), V3::splat(axis), false).normal();
            assert!(Vec3::new(x, y, z).distance(axis) < 0.01, "{axis}");
            assert_eq!(Viewpoint::<f32>::new(V3::zero(), V3::splat(axis), true).side, 0);
        }
    }
}
