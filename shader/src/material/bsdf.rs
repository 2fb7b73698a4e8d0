//! A physical surface: a matt base below facets that reflect, and let pass what is not reflected.

mod branches;

use super::albedo::Albedos;
use super::closure::{ClosureSample, Scattering};
use super::energy::Energy;
use super::facet::{Facet, passes, reflected, rest};
use super::frame::{half, local, world};
use super::layers::{Layers, Way};
use super::refraction::{refracted, refracting};
use super::{INVERSE_PI, cosine_direction, reflect, refract};
use crate::data::{Effects, Finishes};
use crate::geometry::SurfaceInteraction;
use crate::real::{FAINT, Real, SMALL, Scalar, V3};
use crate::sampler::unit;
use glam::{UVec4, Vec3};

/// Probabilities of parts are whole steps of this size, so that decisions compare integers.
pub(super) const STEPS: i32 = 1 << 23;

/// A part that counts at all is chosen at least so often, in steps: what it scatters elsewhere may be more than here.
pub(super) const LEAST: i32 = STEPS / 8;

/// The same of what comes out from between facets, which is about as much in all directions.
const LEAST_LOST: i32 = STEPS / 64;

/// The closure of some layers, in the frame of a surface.
#[derive(Clone, Copy)]
pub struct Bsdf<'a, R: Real> {
    effects: Effects,
    finishes: Finishes,
    albedos: Albedos<'a>,
    /// The axes of the frame; the third is the shading normal.
    axes: [V3<R>; 3],
    /// Unit direction to the viewer, in the frame.
    pub(super) viewer: V3<R>,
    layers: Layers<R>,
    pub(super) is_smooth: bool,
    /// Where light goes that rough facets do not send on at once ([`Effects::COMPENSATED`]).
    energy: Energy<R>,
    /// What the base is given that it sends to the viewer.
    under: R,
    /// Steps for what is matt: the base, and what comes out from between facets.
    pub(super) matt: i32,
    /// Of these steps, those for the far side.
    far: i32,
    /// About what all of it scatters of light to the viewer.
    pub(super) albedo: R,
}

impl<'a, R: Scalar> Bsdf<'a, R> {
    /// Layers in the frame of unit axes, seen along a unit direction on the third axis' side.
    #[inline(always)]
    pub fn new(
        (effects, finishes): (Effects, Finishes),
        albedos: Albedos<'a>,
        axes: [V3<R>; 3],
        direction: V3<R>,
        layers: Layers<R>,
    ) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let is_smooth = layers.ggx.x.eq(zero);
        let own = local(axes, -direction);
        let viewer = V3::new(own.x, own.y, own.z.max(R::splat(SMALL)));
        let facet = Facet::new(effects, &layers, viewer, V3::splat(Vec3::Z));
        let is_compensated = effects.has(Effects::COMPENSATED) && !is_smooth;
        let energy =
            if is_compensated { Energy::new(effects, albedos, &layers, viewer) } else { Energy::none(&layers) };
        let left = if is_compensated { energy.left } else { facet.rest };
        let base = if layers.is_coated { layers.diffuse * left } else { layers.diffuse };
        let under = if layers.is_coated {
            facet.rest.over((one - layers.reflectance.mean(effects)).max(R::splat(SMALL)))
        } else {
            one
        };
        let facets = facet.reflected.greatest() + (layers.through * facet.rest).greatest();
        let (near, far) = ((energy.near * energy.lost).greatest(), (energy.far * energy.lost).greatest());
        let beyond = if finishes.has(Finishes::TRANSLUCENT) {
            (if layers.is_coated { layers.beyond * left } else { layers.beyond }).greatest()
        } else {
            zero
        };
        let (base, far) = (base.greatest() + beyond, far + beyond);
        let least = if zero.lt(base) { LEAST } else { LEAST_LOST };
        let sum = base + near + (far - beyond);
        let matt = steps(sum, facets, least);
        let share = far.over(sum.max(R::splat(SMALL)));
        let far = (share * R::splat(matt as f32)).floor_index();
        let albedo = (sum + facets).min(one);
        Bsdf { effects, finishes, albedos, axes, viewer, layers, is_smooth, energy, under, matt, far, albedo }
    }

    #[inline(always)]
    pub(super) fn local(&self, v: V3<R>) -> V3<R> {
        local(self.axes, v)
    }

    #[inline(always)]
    pub(super) fn world(&self, v: V3<R>) -> V3<R> {
        world(self.axes, v)
    }

    /// The unit normal that light sees, on the viewer's side.
    #[inline(always)]
    pub fn normal(&self) -> V3<R> {
        self.axes[2]
    }

    /// Does the base send light to its far side?
    #[inline(always)]
    fn is_translucent(&self) -> bool {
        self.finishes.has(Finishes::TRANSLUCENT) && R::splat(0.0).lt(self.layers.beyond.greatest())
    }

    /// Does light that rough facets lose come out from between them?
    #[inline(always)]
    fn is_compensated(&self) -> bool {
        self.effects.has(Effects::COMPENSATED) && !self.is_smooth
    }

    #[inline(always)]
    fn passes(&self) -> bool {
        passes(self.effects, &self.layers)
    }

    /// Of what lets light pass: is it a thin wall? A constant where no material of the scene bends light.
    #[inline(always)]
    fn is_thin(&self) -> bool {
        self.effects.has(Effects::THIN) && (!self.effects.has(Effects::REFRACTION) || self.layers.way == Way::THIN)
    }

    /// The index of refraction on the viewer's side over that on the other; 1 of a thin wall, which bends nothing.
    #[inline(always)]
    fn eta(&self) -> R {
        if self.is_thin() { R::splat(1.0) } else { self.layers.reflectance.eta }
    }

    /// How much more radiance is on the viewer's side of what passes than on the other.
    #[inline(always)]
    pub(super) fn compression(&self) -> R {
        self.eta() * self.eta()
    }

    /// Are its facets mirrors or lenses, or so rough that they scatter widely?
    #[inline(always)]
    pub(super) fn is_wide(&self) -> bool {
        self.is_smooth || self.layers.ggx.is_wide()
    }

    /// The probability of a part that is no mirror and no lens.
    #[inline(always)]
    pub(super) fn rough_share(&self) -> R {
        let (near, far, _) = self.shares();
        if self.is_smooth { near + far } else { R::splat(1.0) }
    }

    /// A facet of unit normal `h`, seen from the viewer.
    #[inline(always)]
    fn facet(&self, h: V3<R>) -> Facet<R> {
        Facet::new(self.effects, &self.layers, self.viewer, h)
    }

    /// What comes out from between facets to the viewer, over the cosine and 1 / pi, of light from a direction of the frame on this
    /// side; and the share of that light which the base is given and sends there.
    #[inline(always)]
    fn under(&self, to: V3<R>) -> (V3<R>, R) {
        if self.is_compensated() {
            let (out, left) = self.energy.near_side(self.effects, self.albedos, to);
            return (out, if self.layers.is_coated { left } else { R::splat(1.0) });
        }
        let up = V3::splat(Vec3::Z);
        let share = if self.layers.is_coated {
            rest(reflected(self.effects, &self.layers, to, up)) * self.under
        } else {
            self.under
        };
        (V3::zero(), share)
    }

    /// What the base and what comes out from between facets send to the viewer of light from a direction of the frame on this side,
    /// with its cosine over pi; and what of that the base does.
    #[inline(always)]
    fn matt(&self, to: V3<R>) -> (V3<R>, V3<R>) {
        let cosine = (to.z * R::splat(INVERSE_PI)).flush(FAINT);
        let (out, share) = self.under(to);
        if self.is_compensated() {
            let base = self.layers.diffuse * share;
            return ((base + out) * cosine, base * cosine);
        }
        let base = self.layers.diffuse * (share * cosine).flush(FAINT);
        (base, base)
    }

    /// What the base sends through itself to the viewer of light from a direction on the far side, whose mirrored one is given, with
    /// its cosine over pi.
    #[inline(always)]
    fn through_base(&self, mirrored: V3<R>) -> V3<R> {
        let cosine = (mirrored.z * R::splat(INVERSE_PI)).flush(FAINT);
        self.layers.beyond * (self.under(mirrored).1 * cosine).flush(FAINT)
    }

    /// The probabilities of what is matt, on this side and on the far one, and of the facets.
    #[inline(always)]
    fn shares(&self) -> (R, R, R) {
        const STEP: f32 = 1.0 / STEPS as f32;
        let share = |steps: i32| R::splat(steps as f32) * R::splat(STEP);
        (share(self.matt - self.far), share(self.far), share(STEPS - self.matt))
    }

    /// How light from a unit direction of the frame is scattered.
    #[inline(always)]
    pub(super) fn scattering(&self, to: V3<R>) -> Scattering<R> {
        let zero = R::splat(0.0);
        if zero.lt(to.z) {
            self.on_this_side(to)
        } else if to.z.lt(zero) && (self.passes() && !self.is_smooth || self.is_translucent()) {
            self.on_that_side(to)
        } else {
            Scattering::none()
        }
    }

    #[inline(always)]
    fn on_this_side(&self, to: V3<R>) -> Scattering<R> {
        let h = half(self.viewer, to);
        let (facet, (matt, _, facets)) = (self.facet(h), self.shares());
        let ((mut value, base), mut density) = (self.matt(to), matt * (to.z * R::splat(INVERSE_PI)));
        if !self.is_smooth {
            let (mirrored, likely) = self.layers.ggx.reflected(self.viewer, to, h);
            value = value + facet.reflected * mirrored;
            density = density + facets * facet.probability * likely;
        }
        let diffuse = base.map(|c| c.flush(FAINT));
        Scattering { value: value.map(|c| c.flush(FAINT)), density: density.flush(FAINT), diffuse }
    }

    #[inline(always)]
    fn on_that_side(&self, to: V3<R>) -> Scattering<R> {
        let (eta, mirrored) = (self.eta(), V3::new(to.x, to.y, -to.z));
        let (_, matt, facets) = self.shares();
        let (mut value, mut density, mut diffuse) = (V3::zero(), R::splat(0.0), V3::zero());
        let cosine = (mirrored.z * R::splat(INVERSE_PI)).flush(FAINT);
        if self.is_translucent() {
            diffuse = self.through_base(mirrored);
            (value, density) = (diffuse, matt * cosine);
        }
        let is_rough = self.passes() && !self.is_smooth;
        if self.effects.has(Effects::COMPENSATED) && is_rough {
            value = value + self.energy.far_side(self.albedos, to) * (eta * eta * cosine);
            density = matt * cosine;
        }
        let h = if !is_rough {
            V3::zero()
        } else if self.is_thin() {
            half(self.viewer, mirrored)
        } else {
            refracting(self.viewer, to, eta)
        };
        if !h.z.eq(R::splat(0.0)) {
            let facet = self.facet(h);
            let (passed, likely) = if self.is_thin() {
                self.layers.ggx.reflected(self.viewer, mirrored, h)
            } else {
                refracted(self.layers.ggx, self.viewer, to, h, eta)
            };
            value = value + self.layers.through * (facet.rest * passed);
            density = density + facets * (R::splat(1.0) - facet.probability) * likely;
        }
        Scattering { value: value.map(|c| c.flush(FAINT)), density: density.flush(FAINT), diffuse }
    }

    /// Where a facet of normal `h` sends the path, in the frame: along its mirrored or its refracted ray.
    #[inline(always)]
    fn leaving(&self, h: V3<R>, reflects: bool) -> V3<R> {
        let mirrored = reflect(-self.viewer, h);
        if reflects || !self.passes() {
            return mirrored.map(|c| c.flush(SMALL));
        }
        let passed = if self.is_thin() {
            V3::new(mirrored.x, mirrored.y, -mirrored.z)
        } else {
            refract(-self.viewer, h, self.eta()).direction
        };
        passed.map(|c| c.flush(SMALL))
    }

    /// What a mirror or a lens lets count, over its probability.
    #[inline(always)]
    pub(super) fn smooth_factor(&self, facet: &Facet<R>, reflects: bool) -> V3<R> {
        let facets = self.shares().2;
        if reflects {
            let over = (facets * facet.probability).reciprocal();
            return (facet.reflected * over).map(|c| c.flush(FAINT));
        }
        let eta = self.eta();
        let over = (facets * (R::splat(1.0) - facet.probability)).reciprocal();
        (self.layers.through * (facet.rest * eta * eta * over)).map(|c| c.flush(FAINT))
    }

    /// How it scatters light from a unit direction of the world.
    #[inline(always)]
    pub fn eval(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Scattering<R> {
        let to = self.local(direction);
        if self.agrees(interaction, to, direction) { self.scattering(to) } else { Scattering::none() }
    }

    /// Is a direction of the frame on its side of the surface, too?
    #[inline(always)]
    pub(super) fn agrees(&self, interaction: &SurfaceInteraction<R>, local: V3<R>, world: V3<R>) -> bool {
        R::splat(0.0).lt(local.z) == interaction.receives(world)
    }

    /// Is the direction of a step drawn? That of a mirror and of a lens is not.
    #[inline(always)]
    pub(super) fn draws(&self, step: i32) -> bool {
        step < self.matt || !self.is_smooth
    }

    /// Chooses what is matt or a facet by a step of [`STEPS`], what a facet does by a number, and the direction by a pair.
    #[inline(always)]
    pub(super) fn choose(&self, (step, way): (i32, u32), pair: UVec4) -> Chosen<R> {
        let up = V3::<R>::splat(Vec3::Z);
        if step < self.matt {
            let near = cosine_direction(up, (pair.x, pair.y)).0.map(|c| c.flush(SMALL));
            let is_near = step >= self.far;
            let to = V3::new(near.x, near.y, R::select(is_near, near.z, -near.z));
            return Chosen { to, reflects: is_near, is_rough: true, facet: Facet::none() };
        }
        let h = if self.is_smooth { up } else { self.layers.ggx.visible(self.viewer, (pair.x, pair.y)) };
        let facet = self.facet(h);
        let reflects = R::splat(unit(way)).lt(facet.probability);
        Chosen { to: self.leaving(h, reflects), reflects, is_rough: !self.is_smooth, facet }
    }

    /// Along the ray of a mirror or a lens, of which a factor counts.
    #[inline(always)]
    pub(super) fn smooth_sample(
        &self,
        interaction: &SurfaceInteraction<R>,
        Chosen { mut to, reflects, .. }: Chosen<R>,
        factor: V3<R>,
    ) -> ClosureSample<R> {
        let mut direction = self.world(to);
        if reflects && !interaction.faces(direction) {
            // An interpolated normal may mirror a ray into its own surface; the triangle's normal does not.
            let seen = self.world(self.viewer);
            direction = reflect(-seen, interaction.normal);
            to.z = R::splat(1.0);
        }
        let agrees = self.agrees(interaction, to, direction);
        let factor = V3::select(agrees, factor, V3::zero());
        ClosureSample::only(direction, factor, self.leave(interaction, direction))
    }

    /// Along a direction whose scattering is known.
    #[inline(always)]
    pub(super) fn rough_sample(
        &self,
        interaction: &SurfaceInteraction<R>,
        (chosen, direction): (&Chosen<R>, V3<R>),
        Scattering { value, density, diffuse }: Scattering<R>,
    ) -> ClosureSample<R> {
        let zero = R::splat(0.0);
        // Between facets light may leave on the wrong side, whose density is of other ways to get there.
        let counts = zero.lt(chosen.to.z) == chosen.reflects && zero.lt(density);
        let over = R::select(counts, density, R::splat(1.0)).reciprocal();
        let of_sample = |part: V3<R>| V3::select(counts, (part * over).map(|c| c.flush(FAINT)), V3::zero());
        let origin = interaction.scattered_ray_origin(direction);
        ClosureSample { direction, factor: of_sample(value), density, origin, diffuse: of_sample(diffuse) }
    }

    /// Where a ray starts whose direction could be no other: glass magnifies a step beside its own line; a mirror has corners to
    /// escape through.
    #[inline(always)]
    fn leave(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> V3<R> {
        if self.passes() && !self.is_thin() {
            interaction.offset_ray_origin_along(direction)
        } else {
            interaction.offset_ray_origin(direction)
        }
    }
}

/// Where a path goes on.
pub(super) struct Chosen<R: Real> {
    /// In the frame.
    pub to: V3<R>,
    /// Is it meant for this side of the surface?
    pub reflects: bool,
    /// Could it be another direction? Else a mirror or a lens sends it there.
    pub is_rough: bool,
    /// Which, unless it is of what is matt.
    pub facet: Facet<R>,
}

/// Steps for what is matt, given what it and the facets scatter.
// A clamp holds a panic, which a kernel can't have.
#[allow(clippy::manual_clamp)]
#[inline(always)]
pub(super) fn steps<R: Scalar>(matt: R, facets: R, least: i32) -> i32 {
    let zero = R::splat(0.0);
    if matt.eq(zero) {
        return 0;
    }
    if facets.eq(zero) {
        return STEPS;
    }
    (matt.over((matt + facets).max(R::splat(FAINT))) * R::splat(STEPS as f32))
        .floor_index()
        .max(least)
        .min(STEPS - LEAST)
}
