//! Which part of a surface scatters a path: the diffuse one, a mirror, or what a lens reflects or lets pass.

use super::{Surface, fresnel, mirrored, refract};
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
    mirrored: V3<R>,
    mirror: V3<R>,
    refracted: V3<R>,
    lens: V3<R>,
    is_lens: bool,
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
    /// Is it a lens' part?
    pub is_lens: bool,
}

impl<R: Scalar> Lobes<R> {
    /// Of a surface that is seen along `direction`.
    #[inline(always)]
    pub fn new(effects: Effects, surface: &Surface<R>, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let diffuse_only = Lobes {
            diffuse: STEPS,
            reflected: STEPS,
            mirrored: direction,
            mirror: V3::zero(),
            refracted: direction,
            lens: V3::zero(),
            is_lens: false,
        };
        if !effects.has(Effects::REFLECTION | Effects::REFRACTION) {
            return diffuse_only;
        }
        let diffuse = surface.diffuse.greatest();
        let is_lens = effects.has(Effects::REFRACTION) && !surface.ior.eq(zero);
        let specular = if is_lens { one } else { surface.reflection.greatest() };
        let total = diffuse + specular;
        if specular.eq(zero) {
            return diffuse_only;
        }
        let steps = |share: R, of: i32| (share * R::splat(of as f32)).floor_index();
        let mut of_diffuse = steps(diffuse.div(total), STEPS);
        if zero.lt(diffuse) {
            of_diffuse = of_diffuse.max(1);
        }
        let rest = (STEPS - of_diffuse).max(1);
        of_diffuse = STEPS - rest;
        let mirrored = mirrored(direction, interaction, surface);
        let over = |steps: i32| R::splat(STEPS as f32).div(R::splat(steps as f32));
        if !is_lens {
            let mirror = surface.reflection * over(rest);
            return Lobes { diffuse: of_diffuse, reflected: STEPS, mirrored, mirror, ..diffuse_only };
        }
        let eta = interaction.relative_ior(surface.ior);
        let at = refract(direction, surface.normal, eta);
        let share = fresnel(&at, eta);
        let refracted = at.direction.normalised().0;
        // An interpolated normal may refract a ray back out.
        let passes = !at.total && !interaction.faces(refracted);
        let reflected = if passes { steps(share, rest).max(1).min(rest - 1) } else { rest };
        let mirror = (V3::new(share, share, share) * over(reflected)).map(|c| c.flush(FAINT));
        // Radiance is compressed into the narrower cones of a denser body.
        let through = (one - share) * eta * eta;
        let lens = (surface.transmission * (through * over((rest - reflected).max(1)))).map(|c| c.flush(FAINT));
        Lobes { diffuse: of_diffuse, reflected: of_diffuse + reflected, mirrored, mirror, refracted, lens, is_lens }
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
            direction: V3::select(passes, self.refracted, self.mirrored),
            factor: V3::select(passes, self.lens, self.mirror),
            is_diffuse: step < self.diffuse,
            is_lens: self.is_lens,
        }
    }
}
