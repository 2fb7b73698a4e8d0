//! Where the light goes that facets do not send on at once: to the base below them, and, scattered between them, out again.
//!
//! What facets lose between them leaves them in all directions alike but for the facets' own directional albedo E, by
//! (1 - E(wo)) (1 - E(wi)) / (pi (1 - Eavg)) (Kulla and Conty, Revisiting Physically Based Shading at Imageworks, 2017), which is
//! reciprocal. A base gets what all of that leaves by the same form.

use super::albedo::{Albedos, FacetAlbedo, GlassAlbedo};
use super::fresnel::Reflectance;
use super::layers::{Layers, Way};
use crate::data::Effects;
use crate::real::{FAINT, Real, SMALL, Scalar, V3};

/// The albedos of some layers, seen from a viewer. Facets are rough.
#[derive(Clone, Copy)]
pub struct Energy<R: Real> {
    facets: FacetAlbedo<R>,
    glass: GlassAlbedo<R>,
    /// The share of facets that refract: 1 of clear glass, 0 where none do.
    bends: R,
    /// What one facet reflects.
    reflectance: Reflectance<R>,
    /// The share of the exact reflectance of a dielectric.
    dielectric: R,
    /// The share of lost light that leaves on the near side, linear RGB.
    pub near: V3<R>,
    /// The share that leaves on the far side.
    pub far: V3<R>,
    /// What facets lose of light to the viewer.
    pub lost: R,
    /// That over the mean loss on the near side, and on the far one.
    over: (R, R),
    /// What is left for a base of light to the viewer.
    pub left: R,
    /// That over its mean.
    left_over: R,
}

impl<R: Scalar> Energy<R> {
    /// Nothing is given back.
    #[inline(always)]
    pub fn none(layers: &Layers<R>) -> Self {
        let (zero, black) = (R::splat(0.0), V3::zero());
        let facets = FacetAlbedo::new(Effects(0), layers.ggx);
        Energy {
            facets,
            glass: facets.glass(R::splat(1.0)),
            bends: zero,
            reflectance: layers.reflectance,
            dielectric: zero,
            near: black,
            far: black,
            lost: zero,
            over: (zero, zero),
            left: zero,
            left_over: zero,
        }
    }

    /// Of layers that are seen from a unit direction of their frame.
    #[inline(always)]
    pub fn new(effects: Effects, albedos: Albedos<'_>, layers: &Layers<R>, viewer: V3<R>) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let black = V3::zero();
        let reflectance = layers.reflectance;
        let facets = FacetAlbedo::new(effects, layers.ggx);
        let glass = facets.glass(reflectance.eta);
        let is_conductor = effects.has(Effects::CONDUCTOR) && reflectance.is_conductor;
        let has_glass = effects.has(Effects::REFRACTION | Effects::THIN);
        let dielectric = if has_glass && !is_conductor { reflectance.glass } else { zero };
        let bends = if effects.has(Effects::REFRACTION) && layers.way == Way::BODY { dielectric } else { zero };
        let partial = Energy { facets, glass, bends, dielectric, ..Self::none(layers) };
        let means = facets.mean(albedos);
        let sum = means.0 + means.1;
        let again = |f: R| (f * f * sum).flush(SMALL).over((one - f * (one - sum)).max(R::splat(SMALL)));
        let mean = if is_conductor { reflectance.mean_colour } else { reflectance.schlick_mean() };
        let reflected = mean.map(|f| again(f.min(one)).min(one));
        let (mean_near, mean_far) = (partial.mean_loss(albedos, means, false), partial.mean_loss(albedos, means, true));
        let passed =
            if has_glass { dielectric * partial.passed(effects, albedos, layers, (mean_near, mean_far)) } else { zero };
        let far = if effects.has(Effects::REFRACTION | Effects::THIN) && layers.way != Way::OPAQUE {
            layers.through * passed
        } else {
            black
        };
        let near = reflected + V3::new(one, one, one) * (dielectric - passed).max(zero);
        let partial = Energy { near, far, ..partial };
        let (lost, spent) = partial.at(effects, albedos, viewer);
        let left = (one - spent).max(zero);
        let greatest = near.greatest();
        let mean_glass =
            if has_glass { reflectance.of_faces(effects, glass.mean(albedos, false).0) * dielectric } else { zero };
        let mirrored = (reflectance.normal * means.0 + reflectance.grazing * means.1).greatest();
        let mean_spent = mirrored + mean_glass + greatest * mean_near;
        let over = |mean: R| lost.over(mean.max(R::splat(SMALL)));
        Energy {
            lost,
            over: (over(mean_near), over(mean_far)),
            left,
            left_over: left.over((one - mean_spent).max(R::splat(SMALL))),
            ..partial
        }
    }

    /// The mean of what facets lose that are seen from one side.
    #[inline(always)]
    fn mean_loss(&self, albedos: Albedos<'_>, (a, b): (R, R), is_far: bool) -> R {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let mirrors = (one - a - b).max(zero);
        if !zero.lt(self.bends) {
            return mirrors;
        }
        let (reflected, passed) = self.glass.mean(albedos, is_far);
        let glass = (one - reflected - passed).max(zero);
        mirrors + (glass - mirrors) * self.bends
    }

    /// The share of what glass loses that leaves on its far side: what a smooth interface lets pass, and less where the far side
    /// loses less, so that both ways are alike but for the compression of radiance.
    #[inline(always)]
    fn passed(&self, effects: Effects, albedos: Albedos<'_>, layers: &Layers<R>, (near, far): (R, R)) -> R {
        let (zero, one, eta) = (R::splat(0.0), R::splat(1.0), layers.reflectance.eta);
        let outside = self.glass.passed(albedos);
        if layers.way != Way::BODY {
            return one - layers.reflectance.of_faces(effects, one - outside);
        }
        let over = (eta * eta).reciprocal();
        let passed = R::select(one.lt(eta), outside * over, outside);
        let balance = far.div(R::select(zero.lt(near), near, one)).min(one);
        passed * R::select(zero.lt(near), balance, zero)
    }

    /// What facets lose of light from a unit direction on the near side, and what of it they send on there in all, of the channel
    /// of which that is most. A pane's mean over facets is taken for what a facet of the mean reflectance would reflect, which is at
    /// least that, so that no light is made.
    #[inline(always)]
    fn at(&self, effects: Effects, albedos: Albedos<'_>, w: V3<R>) -> (R, R) {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let (a, b) = self.facets.reflected(albedos, w);
        let (mut lost, mut spent) =
            ((one - a - b).max(zero), (self.reflectance.normal * a + self.reflectance.grazing * b).greatest());
        if zero.lt(self.dielectric) {
            let (reflected, passed) = self.glass.shares(albedos, w.z, false);
            let glass = (one - reflected - passed).max(zero);
            lost = lost + (glass - lost) * self.bends;
            spent = spent + self.reflectance.of_faces(effects, reflected) * self.dielectric;
        }
        (lost, spent + lost * self.near.greatest())
    }

    /// What comes out again on the near side, over the cosine and 1 / pi, of light from a unit direction there; and what is left for
    /// a base, likewise.
    #[inline(always)]
    pub fn near_side(&self, effects: Effects, albedos: Albedos<'_>, to: V3<R>) -> (V3<R>, R) {
        let (lost, spent) = self.at(effects, albedos, to);
        let left = (R::splat(1.0) - spent).max(R::splat(0.0));
        (self.near * (self.over.0 * lost).flush(FAINT), (left * self.left_over).flush(FAINT))
    }

    /// What comes out again of light from a unit direction on the far side, but for the compression of radiance.
    #[inline(always)]
    pub fn far_side(&self, albedos: Albedos<'_>, to: V3<R>) -> V3<R> {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let (a, b) = self.facets.reflected(albedos, V3::new(to.x, to.y, -to.z));
        let mut lost = (one - a - b).max(zero);
        if zero.lt(self.bends) {
            let (reflected, passed) = self.glass.shares(albedos, -to.z, true);
            lost = lost + ((one - reflected - passed).max(zero) - lost) * self.bends;
        }
        self.far * (self.over.1 * lost).flush(FAINT)
    }
}
