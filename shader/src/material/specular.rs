//! What mirrors and glass do to a ray (thesis 3.3), for integrators that sample.

use super::{Surface, fresnel, mirrored, refract};
use crate::data::Effects;
use crate::geometry::SurfaceInteraction;
use crate::real::{FAINT, Real, Scalar, V3};

/// A mirrored and a refracted direction, each with what it does to light.
#[derive(Clone, Copy)]
pub struct Specular<R: Real> {
    /// Unit direction.
    pub mirrored: V3<R>,
    /// A mirror's colour, or what a lens reflects.
    pub mirror: V3<R>,
    /// Unit direction inside.
    pub refracted: V3<R>,
    /// What passes, of use where anything does.
    pub lens: V3<R>,
    /// Does anything pass?
    pub passes: bool,
    /// Is it a lens?
    pub is_lens: bool,
    /// How much more radiance is on the viewer's side of a lens than on the other.
    pub compression: R,
}

impl<R: Scalar> Specular<R> {
    /// Of a surface that is seen along `direction`.
    #[inline(always)]
    pub fn new(effects: Effects, surface: &Surface<R>, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Self {
        let mirrored = mirrored(direction, interaction, surface);
        let is_lens = effects.has(Effects::REFRACTION) && !surface.ior.eq(R::splat(0.0));
        if !is_lens {
            let (refracted, lens, compression) = (direction, V3::zero(), R::splat(1.0));
            let mirror = surface.reflection;
            return Specular { mirrored, mirror, refracted, lens, passes: false, is_lens, compression };
        }
        let eta = interaction.relative_ior(surface.ior);
        let at = refract(direction, surface.normal, eta);
        let share = fresnel(&at, eta);
        let refracted = at.direction.normalised().0;
        // An interpolated normal may refract a ray back out.
        let passes = !at.total && !interaction.faces(refracted);
        // Radiance is compressed into the narrower cones of a denser body.
        let through = (R::splat(1.0) - share) * eta * eta;
        let lens = (surface.transmission * through).map(|c| c.flush(FAINT));
        let mirror = V3::new(share, share, share);
        Specular { mirrored, mirror, refracted, lens, passes, is_lens, compression: eta * eta }
    }

    /// Where a ray starts in one of the directions: a lens' on its own line, since glass magnifies a step beside it; a mirror has
    /// corners to escape through.
    #[inline(always)]
    pub fn leave(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> V3<R> {
        if self.is_lens {
            interaction.offset_ray_origin_along(direction)
        } else {
            interaction.offset_ray_origin(direction)
        }
    }
}
