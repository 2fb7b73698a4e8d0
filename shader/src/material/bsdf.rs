//! A physical surface: a matt base below facets that reflect, and let pass what is not reflected.

use super::closure::{Closure, ClosureSample, Scattering};
use super::fresnel::Reflectance;
use super::refraction::{refracted, refracting};
use super::{Ggx, INVERSE_PI, cosine_direction, reflect, refract};
use crate::data::Effects;
use crate::geometry::SurfaceInteraction;
use crate::real::{FAINT, Real, SMALL, Scalar, TINY, V3};
use crate::sampler::unit;
use glam::{UVec4, Vec3};

/// Probabilities of parts are whole steps of this size, so that decisions compare integers.
const STEPS: i32 = 1 << 23;

/// A part that counts at all is chosen at least so often, in steps: what it scatters elsewhere may be more than here.
const LEAST: i32 = STEPS / 8;

/// What happens to light that facets do not reflect and the base does not scatter.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Way(u32);

impl Way {
    /// There is none.
    pub const OPAQUE: Way = Way(0);
    /// It goes on behind a thin wall as if it were mirrored there.
    pub const THIN: Way = Way(1);
    /// It is refracted into a body, or out of it.
    pub const BODY: Way = Way(2);
}

/// Parts of a surface, each linear RGB in [0, 1].
#[derive(Clone, Copy)]
pub struct Layers<R: Real> {
    /// The base's colour.
    pub diffuse: V3<R>,
    /// The colour of what passes.
    pub through: V3<R>,
    /// What facets reflect.
    pub reflectance: Reflectance<R>,
    /// Does the base get only what the facets do not reflect? By Schlick's mean over all directions it sends back as much of it
    /// (Kelemen and Szirmay-Kalos, A Microfacet Based Coupled Specular-Matte BRDF Model, 2001): glTF's own mixture of both, by the
    /// angle to a facet, sends up to a third more light than it gets.
    pub is_coated: bool,
    /// How the rest passes.
    pub way: Way,
    /// How rough the facets lie; zeros for a mirror or a lens.
    pub ggx: Ggx<R>,
}

/// The closure of some layers, in the frame of a surface.
#[derive(Clone, Copy)]
pub struct Bsdf<R: Real> {
    effects: Effects,
    /// The axes of the frame; the third is the shading normal.
    axes: [V3<R>; 3],
    /// Unit direction to the viewer, in the frame.
    viewer: V3<R>,
    layers: Layers<R>,
    is_smooth: bool,
    /// What the base is given that it sends to the viewer.
    under: R,
    /// Steps for the base.
    diffuse: i32,
}

/// What a facet does.
struct Facet<R: Real> {
    /// The colour that it reflects.
    reflected: V3<R>,
    /// The share of light that it does not.
    rest: R,
    /// How likely it is taken for one that reflects.
    probability: R,
}

impl<R: Scalar> Bsdf<R> {
    /// Layers in the frame of unit axes, seen along a unit direction on the third axis' side.
    #[inline(always)]
    pub fn new(effects: Effects, axes: [V3<R>; 3], direction: V3<R>, layers: Layers<R>) -> Self {
        let zero = R::splat(0.0);
        let (is_smooth, one) = (layers.ggx.x.eq(zero), R::splat(1.0));
        let mut bsdf = Bsdf { effects, axes, viewer: V3::zero(), layers, is_smooth, under: one, diffuse: 0 };
        bsdf.viewer = bsdf.local(-direction);
        bsdf.viewer.z = bsdf.viewer.z.max(R::splat(SMALL));
        let facet = bsdf.facet(V3::splat(Vec3::Z));
        let mut base = layers.diffuse;
        if layers.is_coated {
            bsdf.under = facet.rest.div((one - layers.reflectance.mean()).max(R::splat(SMALL)));
            base = base * facet.rest;
        }
        let (own, facets) = (base.greatest(), facet.reflected.greatest() + (layers.through * facet.rest).greatest());
        bsdf.diffuse = steps(own, facets);
        bsdf
    }

    #[inline(always)]
    fn local(&self, v: V3<R>) -> V3<R> {
        let [x, y, z] = self.axes;
        V3::new(x.dot(v), y.dot(v), z.dot(v)).map(|c| c.flush(SMALL))
    }

    #[inline(always)]
    fn world(&self, v: V3<R>) -> V3<R> {
        let [x, y, z] = self.axes;
        let part = |axis: V3<R>, length| (axis * length).map(|c| c.flush(TINY));
        (part(x, v.x) + part(y, v.y) + part(z, v.z)).map(|c| c.flush(TINY)).direction_and_length().0
    }

    /// Does anything pass? A constant where no material of the scene lets it.
    #[inline(always)]
    fn passes(&self) -> bool {
        self.effects.has(Effects::THIN | Effects::REFRACTION) && self.layers.way != Way::OPAQUE
    }

    #[inline(always)]
    fn is_thin(&self) -> bool {
        self.effects.has(Effects::THIN) && self.layers.way == Way::THIN
    }

    /// The index of refraction on the viewer's side over that on the other; 1 of a thin wall, which bends nothing.
    #[inline(always)]
    fn eta(&self) -> R {
        if self.is_thin() { R::splat(1.0) } else { self.layers.reflectance.eta }
    }

    /// What a facet of unit normal `h` reflects of light from the unit vector `w`.
    #[inline(always)]
    fn reflected(&self, w: V3<R>, h: V3<R>) -> V3<R> {
        let cosine = w.dot(h).max(R::splat(0.0)).min(R::splat(1.0)).flush(SMALL);
        let has_conductors = self.effects.has(Effects::CONDUCTOR);
        let has_glass = self.effects.has(Effects::REFRACTION);
        self.layers.reflectance.at(has_conductors, has_glass, (w, h, cosine))
    }

    /// A facet of unit normal `h`, seen from the viewer.
    #[inline(always)]
    fn facet(&self, h: V3<R>) -> Facet<R> {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let reflected = self.reflected(self.viewer, h);
        let greatest = reflected.greatest().min(one);
        let rest = rest(reflected);
        let passes = if self.passes() { (self.layers.through.greatest() * rest).flush(FAINT) } else { zero };
        let probability = if zero.lt(passes) { greatest.div(greatest + passes) } else { one };
        Facet { reflected, rest, probability }
    }

    /// What the base sends to the viewer of light from a direction of the frame, with its cosine over pi.
    #[inline(always)]
    fn base(&self, to: V3<R>) -> V3<R> {
        let share =
            if self.layers.is_coated { rest(self.reflected(to, V3::splat(Vec3::Z))) * self.under } else { self.under };
        self.layers.diffuse * (share * (to.z * R::splat(INVERSE_PI))).flush(FAINT)
    }

    /// The probabilities of the base and of the facets.
    #[inline(always)]
    fn shares(&self) -> (R, R) {
        const STEP: f32 = 1.0 / STEPS as f32;
        let share = |steps: i32| R::splat(steps as f32) * R::splat(STEP);
        (share(self.diffuse), share(STEPS - self.diffuse))
    }

    /// [`Closure::eval`] of a unit direction in the frame.
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
        let (facet, (base, facets)) = (self.facet(h), self.shares());
        let (mut value, mut density) = (self.base(to), base * (to.z * R::splat(INVERSE_PI)));
        if !self.is_smooth {
            let (mirrored, likely) = self.layers.ggx.reflected(self.viewer, to, h);
            value = value + facet.reflected * mirrored;
            density = density + facets * facet.probability * likely;
        }
        Scattering { value: value.map(|c| c.flush(FAINT)), density: density.flush(FAINT) }
    }

    #[inline(always)]
    fn on_that_side(&self, to: V3<R>) -> Scattering<R> {
        let (eta, mirrored) = (self.eta(), V3::new(to.x, to.y, -to.z));
        let h = if self.is_thin() { half(self.viewer, mirrored) } else { refracting(self.viewer, to, eta) };
        if h.z.eq(R::splat(0.0)) {
            return Scattering::none();
        }
        let facet = self.facet(h);
        let (passed, likely) = if self.is_thin() {
            self.layers.ggx.reflected(self.viewer, mirrored, h)
        } else {
            refracted(self.layers.ggx, self.viewer, to, h, eta)
        };
        let value = self.layers.through * (facet.rest * passed);
        let density = self.shares().1 * (R::splat(1.0) - facet.probability) * likely;
        Scattering { value: value.map(|c| c.flush(FAINT)), density: density.flush(FAINT) }
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
        let facets = self.shares().1;
        if reflects {
            let over = (facets * facet.probability).reciprocal();
            return (facet.reflected * over).map(|c| c.flush(FAINT));
        }
        let eta = self.eta();
        let over = (facets * (R::splat(1.0) - facet.probability)).reciprocal();
        (self.layers.through * (facet.rest * eta * eta * over)).map(|c| c.flush(FAINT))
    }

    /// Is a direction of the frame on its side of the surface, too?
    #[inline(always)]
    fn agrees(&self, interaction: &SurfaceInteraction<R>, local: V3<R>, world: V3<R>) -> bool {
        R::splat(0.0).lt(local.z) == interaction.faces(world)
    }

    #[inline(always)]
    fn smooth_sample(&self, interaction: &SurfaceInteraction<R>, way: R) -> ClosureSample<R> {
        let up = V3::splat(Vec3::Z);
        let facet = self.facet(up);
        let reflects = way.lt(facet.probability);
        let mut to = self.leaving(up, reflects);
        let mut direction = self.world(to);
        if reflects && !interaction.faces(direction) {
            // An interpolated normal may mirror a ray into its own surface; the triangle's normal does not.
            let seen = self.world(self.viewer);
            direction = reflect(-seen, interaction.normal);
            to.z = R::splat(1.0);
        }
        let agrees = self.agrees(interaction, to, direction);
        let factor = V3::select(agrees, self.smooth_factor(&facet, reflects), V3::zero());
        ClosureSample { direction, factor, density: R::splat(0.0), origin: self.leave(interaction, direction) }
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

/// For integrators that branch: facets by rays of their own, and the base by itself.
impl<R: Scalar> Bsdf<R> {
    /// What the base alone scatters, see [`Closure::eval`].
    #[inline(always)]
    pub fn eval_base(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> V3<R> {
        let to = self.local(direction);
        let is_lit = R::splat(0.0).lt(to.z) && interaction.faces(direction);
        if is_lit { self.base(to) } else { V3::zero() }
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
        ClosureSample { direction, factor, density: R::splat(0.0), origin: self.leave(interaction, direction) }
    }
}

impl<R: Scalar> Closure<R> for Bsdf<R> {
    #[inline(always)]
    fn is_rough(&self) -> bool {
        !self.is_smooth || self.diffuse > 0
    }

    #[inline(always)]
    fn eval(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Scattering<R> {
        let to = self.local(direction);
        if self.agrees(interaction, to, direction) { self.scattering(to) } else { Scattering::none() }
    }

    #[inline(always)]
    fn sample(
        &self,
        (interaction, _): (&SurfaceInteraction<R>, V3<R>),
        (part, way): (u32, u32),
        pair: impl FnOnce() -> UVec4,
    ) -> ClosureSample<R> {
        let (is_diffuse, way) = (((part >> 9) as i32) < self.diffuse, R::splat(unit(way)));
        if self.is_smooth && !is_diffuse {
            return self.smooth_sample(interaction, way);
        }
        let (pair, zero) = (pair(), R::splat(0.0));
        let mut reflects = true;
        let to = if is_diffuse {
            let up = V3::<R>::splat(Vec3::Z);
            cosine_direction(up, (pair.x, pair.y)).0.map(|c| c.flush(SMALL))
        } else {
            let h = self.layers.ggx.visible(self.viewer, (pair.x, pair.y));
            reflects = way.lt(self.facet(h).probability);
            self.leaving(h, reflects)
        };
        let (Scattering { value, density }, direction) = (self.scattering(to), self.world(to));
        // Between facets light may leave on the wrong side, whose density is of other ways to get there.
        let is_right = zero.lt(to.z) == reflects;
        let counts = is_right && zero.lt(density) && self.agrees(interaction, to, direction);
        let over = R::select(counts, density, R::splat(1.0)).reciprocal();
        let factor = V3::select(counts, (value * over).map(|c| c.flush(FAINT)), V3::zero());
        ClosureSample { direction, factor, density, origin: interaction.offset_ray_origin(direction) }
    }
}

/// The share of light that is not reflected.
#[inline(always)]
fn rest<R: Scalar>(reflected: V3<R>) -> R {
    (R::splat(1.0) - reflected.greatest().min(R::splat(1.0))).flush(FAINT)
}

/// The unit vector between two others.
#[inline(always)]
fn half<R: Scalar>(a: V3<R>, b: V3<R>) -> V3<R> {
    (a + b).map(|c| c.flush(SMALL)).direction_and_length().0.map(|c| c.flush(SMALL))
}

/// Steps for the base, given what it and the facets scatter.
// A clamp holds a panic, which a kernel can't have.
#[allow(clippy::manual_clamp)]
#[inline(always)]
fn steps<R: Scalar>(base: R, facets: R) -> i32 {
    let zero = R::splat(0.0);
    if base.eq(zero) {
        return 0;
    }
    if facets.eq(zero) {
        return STEPS;
    }
    (base.div(base + facets) * R::splat(STEPS as f32)).floor_index().max(LEAST).min(STEPS - LEAST)
}
