//! What integrators ask of a surface, whatever it is made of.

use crate::geometry::SurfaceInteraction;
use crate::real::{Real, Scalar, V3};
use glam::UVec4;

/// How a surface scatters light that reaches it from some direction.
#[derive(Clone, Copy)]
pub struct Scattering<R: Real> {
    /// What it sends to the viewer over the radiance from there, with the cosine, linear RGB.
    pub value: V3<R>,
    /// The density over solid angle with which [`Closure::sample`] finds that direction.
    pub density: R,
    /// What of the value the diffuse part of the surface scatters.
    pub diffuse: V3<R>,
}

/// A direction in which a path goes on.
#[derive(Clone, Copy)]
pub struct ClosureSample<R: Real> {
    /// Of unit length.
    pub direction: V3<R>,
    /// What of its light counts: the value of its scattering over its density. Zero if none does.
    pub factor: V3<R>,
    /// The density over solid angle; 0 of a direction that could be no other.
    pub density: R,
    /// Where the ray starts.
    pub origin: V3<R>,
    /// What of the factor the diffuse part of the surface scatters.
    pub diffuse: V3<R>,
}

/// A surface as it is seen along a path.
pub trait Closure<R: Scalar> {
    /// May it scatter light of any other direction than those of mirrors and lenses?
    fn is_rough(&self) -> bool;

    /// Is all of what it scatters otherwise scattered widely, so that photons tell of it?
    fn is_wide(&self) -> bool;

    /// Does the first draw of [`Closure::eval_and_sample`] choose a part that scatters widely or not, but not as a mirror or a lens?
    fn chooses_rough(&self, part: u32) -> bool;

    /// How likely that is.
    fn rough_share(&self) -> R;

    /// How much more radiance is on the viewer's side of what it lets pass than on the other.
    fn compression(&self) -> R;

    /// The unit normal that light sees, on the viewer's side.
    fn normal(&self) -> V3<R>;

    /// How it scatters light from a unit direction, towards the light; of mirrors and lenses nothing.
    fn eval(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Scattering<R>;

    /// [`Closure::eval`] of a light's direction, and a direction in which the path goes on, from an interaction with the place where
    /// rays start on the viewer's side: both at once, since most of their instructions are the same, which a kernel then holds once.
    /// A light's direction of zero is none. The first of the draws chooses a part of the surface and the second what its facets do;
    /// `pair` gives two more, if they are asked for, that choose the direction.
    fn eval_and_sample(
        &self,
        at: (&SurfaceInteraction<R>, V3<R>),
        light: V3<R>,
        draws: (u32, u32),
        pair: impl FnOnce() -> UVec4,
    ) -> (Scattering<R>, ClosureSample<R>);

    /// A direction in which the path goes on alone.
    #[inline(always)]
    fn sample(
        &self,
        at: (&SurfaceInteraction<R>, V3<R>),
        draws: (u32, u32),
        pair: impl FnOnce() -> UVec4,
    ) -> ClosureSample<R> {
        self.eval_and_sample(at, V3::zero(), draws, pair).1
    }
}

impl<R: Scalar> Scattering<R> {
    /// Of a direction that counts for nothing.
    #[inline(always)]
    pub fn none() -> Self {
        Scattering { value: V3::zero(), density: R::splat(0.0), diffuse: V3::zero() }
    }
}

impl<R: Scalar> ClosureSample<R> {
    /// The one direction of a mirror or a lens.
    #[inline(always)]
    pub fn only(direction: V3<R>, factor: V3<R>, origin: V3<R>) -> Self {
        ClosureSample { direction, factor, density: R::splat(0.0), origin, diffuse: V3::zero() }
    }
}
