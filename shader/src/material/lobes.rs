//! Which part of a surface scatters a path: the diffuse one, a mirror, or what a lens reflects or lets pass.

use super::closure::{Closure, ClosureSample, Scattering};
use super::{INVERSE_PI, Specular, Surface, cosine_direction};
use crate::data::Effects;
use crate::geometry::SurfaceInteraction;
use crate::real::{FAINT, Real, Scalar, V3};
use glam::UVec4;

/// Probabilities are whole steps of this size, so that decisions compare integers.
const STEPS: i32 = 1 << 23;

/// The parts of a surface, each with its probability.
#[derive(Clone, Copy)]
pub struct Lobes<R: Real> {
    /// Steps for the diffuse part.
    diffuse: i32,
    /// Steps for that and what is reflected; the rest is refracted.
    reflected: i32,
    /// Both over their probabilities.
    specular: Specular<R>,
    /// The diffuse part's colour.
    colour: V3<R>,
    /// The shading normal.
    normal: V3<R>,
}

impl<R: Scalar> Lobes<R> {
    /// Of a surface that is seen along `direction`.
    #[inline(always)]
    pub fn new(effects: Effects, surface: &Surface<R>, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Self {
        let (colour, normal) = (surface.diffuse, surface.normal);
        let zero = R::splat(0.0);
        let none = Specular {
            mirrored: direction,
            mirror: V3::zero(),
            refracted: direction,
            lens: V3::zero(),
            passes: false,
            is_lens: false,
            compression: R::splat(1.0),
        };
        let diffuse_only = Lobes { diffuse: STEPS, reflected: STEPS, specular: none, colour, normal };
        if !effects.has(Effects::REFLECTION | Effects::REFRACTION) {
            return diffuse_only;
        }
        let specular = Specular::new(effects, surface, interaction, direction);
        let (own, other) = (surface.diffuse.greatest(), specular.mirror.greatest());
        let other = if specular.is_lens { R::splat(1.0) } else { other };
        if other.eq(zero) {
            return diffuse_only;
        }
        let steps = |share: R, of: i32| (share * R::splat(of as f32)).floor_index();
        let least = if zero.lt(own) { 1 } else { 0 };
        let diffuse = steps(own.div(own + other), STEPS).max(least).min(STEPS - 1);
        let rest = STEPS - diffuse;
        // A lens of one step lets nothing pass.
        let splits = specular.passes && rest > 1;
        let reflected = if splits { steps(specular.mirror.x, rest).max(1).min(rest - 1) } else { rest };
        let over = |steps: i32| R::splat(STEPS as f32).over(R::splat(steps as f32));
        let mirror = (specular.mirror * over(reflected)).map(|c| c.flush(FAINT));
        let lens = (specular.lens * over((rest - reflected).max(1))).map(|c| c.flush(FAINT));
        let specular = Specular { mirror, lens, ..specular };
        Lobes { diffuse, reflected: diffuse + reflected, specular, colour, normal }
    }

    /// How likely the diffuse part is chosen.
    #[inline(always)]
    fn diffuse_probability(&self) -> R {
        const STEP: f32 = 1.0 / STEPS as f32;
        R::splat(self.diffuse as f32) * R::splat(STEP)
    }
}

impl<R: Scalar> Closure<R> for Lobes<R> {
    #[inline(always)]
    fn is_rough(&self) -> bool {
        self.diffuse > 0
    }

    #[inline(always)]
    fn is_wide(&self) -> bool {
        self.diffuse > 0
    }

    #[inline(always)]
    fn chooses_rough(&self, part: u32) -> bool {
        ((part >> 9) as i32) < self.diffuse
    }

    #[inline(always)]
    fn rough_share(&self) -> R {
        self.diffuse_probability()
    }

    #[inline(always)]
    fn compression(&self) -> R {
        self.specular.compression
    }

    #[inline(always)]
    fn normal(&self) -> V3<R> {
        self.normal
    }

    #[inline(always)]
    fn eval(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Scattering<R> {
        let cosine = self.normal.dot(direction);
        if !R::splat(0.0).lt(cosine) || !interaction.receives(direction) {
            return Scattering::none();
        }
        let factor = (cosine * R::splat(INVERSE_PI)).flush(FAINT);
        let value = self.colour * factor;
        Scattering { value, density: self.diffuse_probability() * factor, diffuse: value }
    }

    #[inline(always)]
    fn eval_and_sample(
        &self,
        at: (&SurfaceInteraction<R>, V3<R>),
        light: V3<R>,
        (part, _): (u32, u32),
        pair: impl FnOnce() -> UVec4,
    ) -> (Scattering<R>, ClosureSample<R>) {
        (self.eval(at.0, light), self.chosen(at, part, pair))
    }
}

impl<R: Scalar> Lobes<R> {
    /// See [`Closure::sample`].
    #[inline(always)]
    fn chosen(
        &self,
        (interaction, origin): (&SurfaceInteraction<R>, V3<R>),
        part: u32,
        pair: impl FnOnce() -> UVec4,
    ) -> ClosureSample<R> {
        let step = (part >> 9) as i32;
        if step < self.diffuse {
            let pair = pair();
            let (direction, cosine) = cosine_direction(self.normal, (pair.x, pair.y));
            let probability = self.diffuse_probability();
            // About an interpolated normal a direction may lie below the surface.
            let factor =
                V3::select(interaction.receives(direction), self.colour * probability.reciprocal(), V3::zero());
            let density = probability * cosine * R::splat(INVERSE_PI);
            return ClosureSample { direction, factor, density, origin, diffuse: factor };
        }
        let passes = step >= self.reflected;
        let direction = V3::select(passes, self.specular.refracted, self.specular.mirrored);
        let factor = V3::select(passes, self.specular.lens, self.specular.mirror);
        let origin = self.specular.leave(interaction, direction);
        ClosureSample::only(direction, factor, origin)
    }
}
