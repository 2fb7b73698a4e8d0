//! A physical surface: a matt base below facets that reflect, and let pass what is not reflected.

mod branches;

use super::albedo::Albedos;
use super::closure::{Closure, ClosureSample, Scattering};
use super::energy::Energy;
use super::facet::{Facet, passes, reflected, rest};
use super::layers::{Layers, Way};
use super::refraction::{refracted, refracting};
use super::{INVERSE_PI, cosine_direction, reflect, refract};
use crate::data::Effects;
use crate::geometry::SurfaceInteraction;
use crate::real::{FAINT, Real, SMALL, Scalar, TINY, V3};
use crate::sampler::unit;
use glam::{UVec4, Vec3};

/// Probabilities of parts are whole steps of this size, so that decisions compare integers.
const STEPS: i32 = 1 << 23;

/// A part that counts at all is chosen at least so often, in steps: what it scatters elsewhere may be more than here.
const LEAST: i32 = STEPS / 8;

/// The same of what comes out from between facets, which is about as much in all directions.
const LEAST_LOST: i32 = STEPS / 64;

/// The closure of some layers, in the frame of a surface.
#[derive(Clone, Copy)]
pub struct Bsdf<'a, R: Real> {
    effects: Effects,
    albedos: Albedos<'a>,
    /// The axes of the frame; the third is the shading normal.
    axes: [V3<R>; 3],
    /// Unit direction to the viewer, in the frame.
    viewer: V3<R>,
    layers: Layers<R>,
    is_smooth: bool,
    /// Where light goes that rough facets do not send on at once ([`Effects::COMPENSATED`]).
    energy: Energy<R>,
    /// What the base is given that it sends to the viewer.
    under: R,
    /// Steps for what is matt: the base, and what comes out from between facets.
    matt: i32,
    /// Of these steps, those for the far side.
    far: i32,
}

impl<'a, R: Scalar> Bsdf<'a, R> {
    /// Layers in the frame of unit axes, seen along a unit direction on the third axis' side.
    #[inline(always)]
    pub fn new(effects: Effects, albedos: Albedos<'a>, axes: [V3<R>; 3], direction: V3<R>, layers: Layers<R>) -> Self {
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
        let least = if zero.lt(base.greatest()) { LEAST } else { LEAST_LOST };
        let matt = steps(base.greatest() + near + far, facets, least);
        let share = far.over((base.greatest() + near + far).max(R::splat(SMALL)));
        let far = (share * R::splat(matt as f32)).floor_index();
        Bsdf { effects, albedos, axes, viewer, layers, is_smooth, energy, under, matt, far }
    }

    #[inline(always)]
    fn local(&self, v: V3<R>) -> V3<R> {
        local(self.axes, v)
    }

    #[inline(always)]
    fn world(&self, v: V3<R>) -> V3<R> {
        let [x, y, z] = self.axes;
        // Components of the frame are flushed below 2^-40 and those of its axes below 2^-60: no product is subnormal.
        (x * v.x + y * v.y + z * v.z).map(|c| c.flush(TINY)).renormalised()
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

    /// A facet of unit normal `h`, seen from the viewer.
    #[inline(always)]
    fn facet(&self, h: V3<R>) -> Facet<R> {
        Facet::new(self.effects, &self.layers, self.viewer, h)
    }

    /// What the base and what comes out from between facets send to the viewer of light from a direction of the frame on this side,
    /// with its cosine over pi; and what of that the base does.
    #[inline(always)]
    fn matt(&self, to: V3<R>) -> (V3<R>, V3<R>) {
        let cosine = (to.z * R::splat(INVERSE_PI)).flush(FAINT);
        if self.effects.has(Effects::COMPENSATED) && !self.is_smooth {
            let (out, left) = self.energy.near_side(self.effects, self.albedos, to);
            let left = if self.layers.is_coated { left } else { R::splat(1.0) };
            let base = self.layers.diffuse * left;
            return ((base + out) * cosine, base * cosine);
        }
        let up = V3::splat(Vec3::Z);
        let share = if self.layers.is_coated {
            rest(reflected(self.effects, &self.layers, to, up)) * self.under
        } else {
            self.under
        };
        let base = self.layers.diffuse * (share * cosine).flush(FAINT);
        (base, base)
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
    fn scattering(&self, to: V3<R>) -> Scattering<R> {
        let zero = R::splat(0.0);
        if zero.lt(to.z) {
            self.on_this_side(to)
        } else if to.z.lt(zero) && self.passes() && !self.is_smooth {
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
        let (mut value, mut density) = (V3::zero(), R::splat(0.0));
        if self.effects.has(Effects::COMPENSATED) {
            let cosine = (mirrored.z * R::splat(INVERSE_PI)).flush(FAINT);
            (value, density) = (self.energy.far_side(self.albedos, to) * (eta * eta * cosine), matt * cosine);
        }
        let h = if self.is_thin() { half(self.viewer, mirrored) } else { refracting(self.viewer, to, eta) };
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
        Scattering { value: value.map(|c| c.flush(FAINT)), density: density.flush(FAINT), diffuse: V3::zero() }
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
    fn smooth_factor(&self, facet: &Facet<R>, reflects: bool) -> V3<R> {
        let facets = self.shares().2;
        if reflects {
            let over = (facets * facet.probability).reciprocal();
            return (facet.reflected * over).map(|c| c.flush(FAINT));
        }
        let eta = self.eta();
        let over = (facets * (R::splat(1.0) - facet.probability)).reciprocal();
        (self.layers.through * (facet.rest * eta * eta * over)).map(|c| c.flush(FAINT))
    }

    /// [`Closure::eval`] of a direction, in the frame and in the world.
    #[inline(always)]
    fn agreeing(&self, interaction: &SurfaceInteraction<R>, to: V3<R>, direction: V3<R>) -> Scattering<R> {
        if self.agrees(interaction, to, direction) { self.scattering(to) } else { Scattering::none() }
    }

    /// Is a direction of the frame on its side of the surface, too?
    #[inline(always)]
    fn agrees(&self, interaction: &SurfaceInteraction<R>, local: V3<R>, world: V3<R>) -> bool {
        R::splat(0.0).lt(local.z) == interaction.receives(world)
    }

    /// Chooses what is matt or a facet, by the draws of [`Closure::sample`].
    #[inline(always)]
    fn choose(&self, (part, way): (u32, u32), pair: impl FnOnce() -> UVec4) -> Chosen<R> {
        let (step, up) = ((part >> 9) as i32, V3::<R>::splat(Vec3::Z));
        let is_matt = step < self.matt;
        // Here, so that a kernel holds it once.
        let pair = if is_matt || !self.is_smooth { pair() } else { UVec4::ZERO };
        if is_matt {
            let near = cosine_direction(up, (pair.x, pair.y)).0.map(|c| c.flush(SMALL));
            let is_near = step >= self.far;
            let to = V3::new(near.x, near.y, R::select(is_near, near.z, -near.z));
            return Chosen { to, reflects: is_near, is_matt: true, facet: Facet::none() };
        }
        let h = if self.is_smooth { up } else { self.layers.ggx.visible(self.viewer, (pair.x, pair.y)) };
        let facet = self.facet(h);
        let reflects = R::splat(unit(way)).lt(facet.probability);
        Chosen { to: self.leaving(h, reflects), reflects, is_matt: false, facet }
    }

    /// Along the ray of a mirror or a lens.
    #[inline(always)]
    fn smooth_sample(&self, interaction: &SurfaceInteraction<R>, chosen: &Chosen<R>) -> ClosureSample<R> {
        let Chosen { mut to, reflects, ref facet, .. } = *chosen;
        let mut direction = self.world(to);
        if reflects && !interaction.faces(direction) {
            // An interpolated normal may mirror a ray into its own surface; the triangle's normal does not.
            let seen = self.world(self.viewer);
            direction = reflect(-seen, interaction.normal);
            to.z = R::splat(1.0);
        }
        let agrees = self.agrees(interaction, to, direction);
        let factor = V3::select(agrees, self.smooth_factor(facet, reflects), V3::zero());
        ClosureSample::only(direction, factor, self.leave(interaction, direction))
    }

    /// Along a direction whose scattering is known.
    #[inline(always)]
    fn rough_sample(
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

impl<R: Scalar> Closure<R> for Bsdf<'_, R> {
    #[inline(always)]
    fn is_rough(&self) -> bool {
        !self.is_smooth || self.matt > 0
    }

    #[inline(always)]
    fn normal(&self) -> V3<R> {
        self.axes[2]
    }

    #[inline(always)]
    fn eval(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Scattering<R> {
        self.agreeing(interaction, self.local(direction), direction)
    }

    #[inline(always)]
    fn eval_and_sample(
        &self,
        (interaction, _): (&SurfaceInteraction<R>, V3<R>),
        light: V3<R>,
        draws: (u32, u32),
        pair: impl FnOnce() -> UVec4,
    ) -> (Scattering<R>, ClosureSample<R>) {
        let chosen = self.choose(draws, pair);
        let is_rough = chosen.is_matt || !self.is_smooth;
        let (mut of_light, mut own) = (Scattering::none(), Scattering::none());
        let (mut to, mut direction) = (self.local(light), light);
        let (mut turn, turns) = (0, if is_rough { 2 } else { 1 });
        while turn < turns {
            (of_light, own) = (own, self.agreeing(interaction, to, direction));
            (to, direction) = (chosen.to, self.world(chosen.to));
            turn += 1;
        }
        if is_rough {
            (of_light, self.rough_sample(interaction, (&chosen, direction), own))
        } else {
            (own, self.smooth_sample(interaction, &chosen))
        }
    }
}

/// What [`Bsdf::choose`] chose.
struct Chosen<R: Real> {
    /// In the frame.
    to: V3<R>,
    /// Is it meant for this side of the surface?
    reflects: bool,
    /// Is it of what is matt?
    is_matt: bool,
    /// Else the facet that sends the path there.
    facet: Facet<R>,
}

/// The unit vector between two others.
#[inline(always)]
fn half<R: Scalar>(a: V3<R>, b: V3<R>) -> V3<R> {
    (a + b).map(|c| c.flush(SMALL)).direction_and_length().0.map(|c| c.flush(SMALL))
}

/// Steps for what is matt, given what it and the facets scatter.
// A clamp holds a panic, which a kernel can't have.
#[allow(clippy::manual_clamp)]
#[inline(always)]
fn steps<R: Scalar>(matt: R, facets: R, least: i32) -> i32 {
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

/// A vector in the frame of unit axes.
#[inline(always)]
fn local<R: Scalar>([x, y, z]: [V3<R>; 3], v: V3<R>) -> V3<R> {
    V3::new(x.dot(v), y.dot(v), z.dot(v)).map(|c| c.flush(SMALL))
}
