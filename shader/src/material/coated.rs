//! A physical surface below what lies on it: a coat, and below that fibres. What a layer scatters of light to the viewer, the layers
//! below it do not get, so that none is made or lost.

use super::bsdf::{Bsdf, Chosen, LEAST, STEPS, steps};
use super::closure::{Closure, ClosureSample, Scattering};
use super::facet::Facet;
use super::{Coat, Hair, Sheen};
use crate::data::Finishes;
use crate::geometry::SurfaceInteraction;
use crate::real::{FAINT, Real, Scalar, V3};
use glam::UVec4;

/// The closure of all layers of a surface.
#[derive(Clone, Copy)]
pub struct Coated<'a, R: Real> {
    finishes: Finishes,
    /// Below the rest.
    pub base: Bsdf<'a, R>,
    coat: Coat<R>,
    sheen: Sheen<R>,
    /// In the place of all of it.
    hair: Hair<R>,
    /// The share of light that gets below the coat.
    below: R,
    /// The share of that which gets below the fibres.
    between: R,
    /// Steps for the coat.
    coat_steps: i32,
    /// Of as many steps for the rest, those for the fibres.
    sheen_steps: i32,
}

/// The layer by which a path is scattered.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Layer(u32);

impl Layer {
    const BASE: Layer = Layer(0);
    const SHEEN: Layer = Layer(1);
    const COAT: Layer = Layer(2);
    const HAIR: Layer = Layer(3);
}

impl<'a, R: Scalar> Coated<'a, R> {
    /// A base without anything on it.
    #[inline(always)]
    pub fn bare(base: Bsdf<'a, R>) -> Self {
        Self::new(Finishes(0), base, (Coat::none(), Sheen::none()))
    }

    /// A base below a coat and fibres, of those that there are.
    #[inline(always)]
    pub fn new(finishes: Finishes, base: Bsdf<'a, R>, (coat, sheen): (Coat<R>, Sheen<R>)) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let below = if finishes.has(Finishes::COATED) { (one - coat.albedo).max(zero) } else { one };
        let fibres = if finishes.has(Finishes::FIBROUS) { sheen.albedo.greatest() } else { zero };
        let between = (one - fibres).max(zero);
        let rest = (between * base.albedo).flush(FAINT);
        let coat_steps = if finishes.has(Finishes::COATED) {
            steps(coat.albedo, (below * (fibres + rest)).flush(FAINT), LEAST)
        } else {
            0
        };
        let sheen_steps = if finishes.has(Finishes::FIBROUS) { steps(fibres, rest, LEAST) } else { 0 };
        Coated { finishes, base, coat, sheen, hair: Hair::none(), below, between, coat_steps, sheen_steps }
    }

    /// Hair in the place of all of it, if there is any.
    #[inline(always)]
    pub fn or_hair(self, hair: Hair<R>) -> Self {
        Coated { hair, ..self }
    }

    #[inline(always)]
    fn is_hair(&self) -> bool {
        self.finishes.has(Finishes::HAIR) && self.hair.is_some
    }

    /// The share of light that gets to the base.
    #[inline(always)]
    fn under(&self) -> R {
        (self.below * self.between).flush(FAINT)
    }

    /// The probabilities of the coat, of fibres and of the base.
    #[inline(always)]
    fn shares(&self) -> (R, R, R) {
        const STEP: f32 = 1.0 / STEPS as f32;
        let share = |steps: i32| R::splat(steps as f32) * R::splat(STEP);
        let rest = share(STEPS - self.coat_steps);
        (share(self.coat_steps), rest * share(self.sheen_steps), rest * share(STEPS - self.sheen_steps))
    }

    /// The layer of a step of [`STEPS`], and the step within it.
    #[inline(always)]
    fn layer(&self, step: i32) -> (Layer, i32) {
        if self.is_hair() {
            return (Layer::HAIR, step);
        }
        if self.finishes.has(Finishes::COATED) && step < self.coat_steps {
            return (Layer::COAT, step);
        }
        let step = if self.finishes.has(Finishes::COATED) { spread::<R>(step, self.coat_steps) } else { step };
        if self.finishes.has(Finishes::FIBROUS) && step < self.sheen_steps {
            return (Layer::SHEEN, step);
        }
        let step = if self.finishes.has(Finishes::FIBROUS) { spread::<R>(step, self.sheen_steps) } else { step };
        (Layer::BASE, step)
    }

    /// Is the direction of a layer's step drawn? That of a mirror and of a lens is not.
    #[inline(always)]
    fn draws(&self, layer: Layer, step: i32) -> bool {
        if self.finishes.has(Finishes::HAIR) && layer == Layer::HAIR {
            return true;
        }
        if self.finishes.has(Finishes::COATED) && layer == Layer::COAT {
            return !self.coat.is_smooth;
        }
        self.finishes.has(Finishes::FIBROUS) && layer == Layer::SHEEN || self.base.draws(step)
    }

    /// Where a layer sends the path.
    #[inline(always)]
    fn choose(&self, layer: Layer, draws: (i32, u32), pair: UVec4) -> Chosen<R> {
        if self.finishes.has(Finishes::HAIR) && layer == Layer::HAIR {
            let to = self.hair.sample(draws.0, draws.1, pair);
            return Chosen { to, reflects: R::splat(0.0).lt(to.z), is_rough: true, facet: Facet::none() };
        }
        if self.finishes.has(Finishes::COATED) && layer == Layer::COAT {
            let to = self.base.local(self.coat.sample(pair));
            return Chosen { to, reflects: true, is_rough: !self.coat.is_smooth, facet: Facet::none() };
        }
        if self.finishes.has(Finishes::FIBROUS) && layer == Layer::SHEEN {
            return Chosen { to: self.sheen.sample(pair), reflects: true, is_rough: true, facet: Facet::none() };
        }
        self.base.choose(draws, pair)
    }

    /// [`Closure::eval`] of a direction, in the base's frame and in the world.
    #[inline(always)]
    fn agreeing(&self, interaction: &SurfaceInteraction<R>, to: V3<R>, direction: V3<R>) -> Scattering<R> {
        if self.is_hair() {
            return self.hair.scattering(to);
        }
        if !self.base.agrees(interaction, to, direction) {
            return Scattering::none();
        }
        let base = self.base.scattering(to);
        if !self.finishes.has(Finishes::COATED | Finishes::FIBROUS) {
            return base;
        }
        let (zero, (coat, fibres, rest)) = (R::splat(0.0), self.shares());
        let under = self.under();
        let (mut value, mut diffuse, mut density) = (base.value * under, base.diffuse * under, base.density * rest);
        if self.finishes.has(Finishes::FIBROUS) && zero.lt(to.z) {
            let likely = self.sheen.density(to).flush(FAINT);
            let sent = self.sheen.albedo * (self.below * likely).flush(FAINT);
            (value, diffuse, density) = (value + sent, diffuse + sent, density + fibres * likely);
        }
        if self.finishes.has(Finishes::COATED) && zero.lt(to.z) {
            let (sent, likely) = self.coat.scattering(direction);
            (value, density) = (value + V3::new(sent, sent, sent), density + coat * likely);
        }
        let flushed = |v: V3<R>| v.map(|c| c.flush(FAINT));
        Scattering { value: flushed(value), density: density.flush(FAINT), diffuse: flushed(diffuse) }
    }

    /// What of the one direction that a mirror or a lens sends the path to counts, over its probability.
    #[inline(always)]
    fn smooth_factor(&self, layer: Layer, chosen: &Chosen<R>) -> V3<R> {
        if !self.finishes.has(Finishes::COATED | Finishes::FIBROUS) {
            return self.base.smooth_factor(&chosen.facet, chosen.reflects);
        }
        let (coat, _, rest) = self.shares();
        if self.finishes.has(Finishes::COATED) && layer == Layer::COAT {
            let sent = self.coat.mirrored().over(coat);
            return V3::new(sent, sent, sent);
        }
        let under = self.under().over(rest);
        (self.base.smooth_factor(&chosen.facet, chosen.reflects) * under).map(|c| c.flush(FAINT))
    }
}

impl<R: Scalar> Closure<R> for Coated<'_, R> {
    #[inline(always)]
    fn is_rough(&self) -> bool {
        let coat = self.finishes.has(Finishes::COATED) && self.coat_steps > 0 && !self.coat.is_smooth;
        let fibres = self.finishes.has(Finishes::FIBROUS) && self.sheen_steps > 0;
        self.is_hair() || !self.base.is_smooth || self.base.matt > 0 || coat || fibres
    }

    #[inline(always)]
    fn is_wide(&self) -> bool {
        let coat = !self.finishes.has(Finishes::COATED) || self.coat_steps == 0 || self.coat.is_wide();
        !self.is_hair() && self.is_rough() && self.base.is_wide() && coat
    }

    #[inline(always)]
    fn chooses_rough(&self, part: u32) -> bool {
        let (layer, step) = self.layer((part >> 9) as i32);
        self.draws(layer, step)
    }

    #[inline(always)]
    fn rough_share(&self) -> R {
        let (zero, (coat, fibres, rest)) = (R::splat(0.0), self.shares());
        let coat = if self.finishes.has(Finishes::COATED) && !self.coat.is_smooth { coat } else { zero };
        let fibres = if self.finishes.has(Finishes::FIBROUS) { fibres } else { zero };
        if self.is_hair() { R::splat(1.0) } else { coat + fibres + rest * self.base.rough_share() }
    }

    #[inline(always)]
    fn compression(&self) -> R {
        self.base.compression()
    }

    #[inline(always)]
    fn normal(&self) -> V3<R> {
        self.base.normal()
    }

    #[inline(always)]
    fn eval(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Scattering<R> {
        self.agreeing(interaction, self.base.local(direction), direction)
    }

    #[inline(always)]
    fn eval_and_sample(
        &self,
        (interaction, _): (&SurfaceInteraction<R>, V3<R>),
        light: V3<R>,
        (part, way): (u32, u32),
        pair: impl FnOnce() -> UVec4,
    ) -> (Scattering<R>, ClosureSample<R>) {
        let (layer, step) = self.layer((part >> 9) as i32);
        // Here, so that a kernel holds it once.
        let pair = if self.draws(layer, step) { pair() } else { UVec4::ZERO };
        let chosen = self.choose(layer, (step, way), pair);
        let is_rough = chosen.is_rough;
        let (mut of_light, mut own) = (Scattering::none(), Scattering::none());
        let (mut to, mut direction) = (self.base.local(light), light);
        let (mut turn, turns) = (0, if is_rough { 2 } else { 1 });
        while turn < turns {
            (of_light, own) = (own, self.agreeing(interaction, to, direction));
            (to, direction) = (chosen.to, self.base.world(chosen.to));
            turn += 1;
        }
        if is_rough {
            (of_light, self.base.rough_sample(interaction, (&chosen, direction), own))
        } else {
            let factor = self.smooth_factor(layer, &chosen);
            (own, self.base.smooth_sample(interaction, chosen, factor))
        }
    }
}

/// A step that is not among the first `taken`, spread over all.
#[inline(always)]
fn spread<R: Scalar>(step: i32, taken: i32) -> i32 {
    let wider = R::splat(STEPS as f32).over(R::splat((STEPS - taken).max(1) as f32));
    (R::splat((step - taken) as f32) * wider).floor_index().min(STEPS - 1)
}
