//! Which part of a surface scatters a path: the diffuse one, a mirror, or what a lens reflects or lets pass.

use super::{Specular, Surface};
use crate::data::Effects;
use crate::geometry::SurfaceInteraction;
use crate::real::{FAINT, Real, Scalar, V3};

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
}

/// What scatters.
#[derive(Clone, Copy)]
pub struct Lobe<R: Real> {
    /// The direction of a mirror or a lens.
    pub direction: V3<R>,
    /// What it does to light, over its probability.
    pub factor: V3<R>,
    /// Is it the diffuse part? Then direction and factor are unused.
    pub is_diffuse: bool,
}

impl<R: Scalar> Lobes<R> {
    /// Of a surface that is seen along `direction`.
    #[inline(always)]
    pub fn new(effects: Effects, surface: &Surface<R>, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Self {
        let zero = R::splat(0.0);
        let none = Specular {
            mirrored: direction,
            mirror: V3::zero(),
            refracted: direction,
            lens: V3::zero(),
            passes: false,
            is_lens: false,
        };
        let diffuse_only = Lobes { diffuse: STEPS, reflected: STEPS, specular: none };
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
        let over = |steps: i32| R::splat(STEPS as f32).div(R::splat(steps as f32));
        let mirror = (specular.mirror * over(reflected)).map(|c| c.flush(FAINT));
        let lens = (specular.lens * over((rest - reflected).max(1))).map(|c| c.flush(FAINT));
        Lobes { diffuse, reflected: diffuse + reflected, specular: Specular { mirror, lens, ..specular } }
    }

    /// May the diffuse part be chosen?
    #[inline(always)]
    pub fn is_diffuse(&self) -> bool {
        self.diffuse > 0
    }

    /// How likely the diffuse part is chosen.
    #[inline(always)]
    pub fn diffuse_probability(&self) -> R {
        const STEP: f32 = 1.0 / STEPS as f32;
        R::splat(self.diffuse as f32) * R::splat(STEP)
    }

    /// The part that a draw means.
    #[inline(always)]
    pub fn chosen(&self, drawn: u32) -> Lobe<R> {
        let step = (drawn >> 9) as i32;
        let passes = step >= self.reflected;
        Lobe {
            direction: V3::select(passes, self.specular.refracted, self.specular.mirrored),
            factor: V3::select(passes, self.specular.lens, self.specular.mirror),
            is_diffuse: step < self.diffuse,
        }
    }

    /// Where a ray starts that a mirror or a lens scatters.
    #[inline(always)]
    pub fn leave(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> V3<R> {
        self.specular.leave(interaction, direction)
    }
}
