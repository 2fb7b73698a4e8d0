//! For integrators that branch: facets by rays of their own, and the base by itself.

use super::{Bsdf, ClosureSample};
use crate::geometry::SurfaceInteraction;
use crate::real::{FAINT, Scalar, V3};
use glam::Vec3;

impl<R: Scalar> Bsdf<'_, R> {
    /// What is matt alone scatters, see [`Closure::eval`](crate::material::Closure::eval).
    #[inline(always)]
    pub fn eval_base(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> V3<R> {
        let to = self.local(direction);
        let is_lit = R::splat(0.0).lt(to.z) && interaction.receives(direction);
        if is_lit { self.matt(to).0 } else { V3::zero() }
    }

    /// The ray that a facet reflects, and that which passes it; a factor of zero is none. The draws choose the facet.
    #[inline(always)]
    pub fn branches(&self, interaction: &SurfaceInteraction<R>, draws: (u32, u32)) -> [ClosureSample<R>; 2] {
        let up = V3::splat(Vec3::Z);
        let h = if self.is_smooth { up } else { self.layers.ggx.visible(self.viewer, draws) };
        let facet = self.facet(h);
        let to = self.leaving(h, true);
        let reflected = self.branch(interaction, to, true, facet.reflected * self.shadowing(to, h));
        if !self.passes() {
            return [reflected, ClosureSample { factor: V3::zero(), ..reflected }];
        }
        let to = self.leaving(h, false);
        let eta = self.eta();
        let factor = facet.rest * eta * eta * self.shadowing(V3::new(to.x, to.y, -to.z), h);
        [reflected, self.branch(interaction, to, false, self.layers.through * factor)]
    }

    /// The share of what a facet sends to a direction on this side, or mirrored there, that other facets let pass.
    #[inline(always)]
    fn shadowing(&self, to: V3<R>, h: V3<R>) -> R {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        if self.is_smooth || !zero.lt(to.z) {
            return one;
        }
        let (mirrored, likely) = self.layers.ggx.reflected(self.viewer, to, h);
        mirrored.div(R::select(likely.eq(zero), one, likely))
    }

    #[inline(always)]
    fn branch(
        &self,
        interaction: &SurfaceInteraction<R>,
        to: V3<R>,
        reflects: bool,
        factor: V3<R>,
    ) -> ClosureSample<R> {
        let direction = self.world(to);
        let is_right = R::splat(0.0).lt(to.z) == reflects && self.agrees(interaction, to, direction);
        let factor = V3::select(is_right, factor.map(|c| c.flush(FAINT)), V3::zero());
        ClosureSample::only(direction, factor, self.leave(interaction, direction))
    }
}
