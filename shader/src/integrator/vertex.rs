//! Where a path has come to: what it meets there, what it asks for, and how it goes on.

use super::draws::Draws;
use super::sampled::share;
use crate::buffer::read;
use crate::data::{Effects, Filling, Launch, Physical, Primitive};
use crate::geometry::SurfaceInteraction;
use crate::light::EmitterSample;
use crate::material::{Seen, transmittance};
use crate::medium::Inside;
use crate::real::{FAINT, Real, Scalar, V3};
use crate::sampler::DECISIONS;
use crate::scene::LaunchContext;
use crate::stage::{Contribution, Found, PathState, Segment, ShadowRay};
use glam::UVec4;

/// What is known where a slot's ray has hit something.
#[derive(Clone, Copy)]
pub(super) struct Vertex<R: Real> {
    pub path: PathState<R>,
    /// What it came to.
    pub found: Found<R>,
    pub draws: Draws,
    /// Did the path start on a shadow catcher, as its first vertex? Of the light of that, catchers tell no more than what is shadowed.
    pub after_catcher: bool,
    /// What is inside of the surface ([`Media::PRESENT`](crate::data::Media)).
    pub filling: Filling,
}

impl<R: Scalar> Vertex<R> {
    /// What is hit.
    #[inline(always)]
    pub fn met(&self, launch: &LaunchContext<'_>) -> Seen<R> {
        let (Found { t, coordinates, index, instance, time }, direction) = (self.found, self.path.direction);
        let primitive = launch.placed(index, instance, time);
        let interaction = SurfaceInteraction::new(launch.spec.effects, &primitive, coordinates, direction);
        let cone = self.path.cone(launch, t, self.draws.sample);
        Seen { index, instance, time, primitive, interaction, direction, cone }
    }

    /// With what of the path has come through the body whose inside it hits.
    #[inline(always)]
    pub fn arrived(&self, launch: &LaunchContext<'_>, physicals: &[Physical], seen: &Seen<R>) -> Self {
        if !launch.spec.effects.has(Effects::ABSORBING) || seen.interaction.front {
            return *self;
        }
        let material = read(physicals, seen.material());
        let left = transmittance(launch, &material, self.found.t);
        let weight = self.path.weight.times(left).map(|c| c.flush(FAINT));
        Vertex { path: PathState { weight, ..self.path }, ..*self }
    }

    /// The numbers that decide what comes of it.
    #[inline(always)]
    pub fn decisions(&self) -> UVec4 {
        self.draws.set(DECISIONS + self.path.bounces)
    }

    /// Asks for `light` of a sampled light, which this vertex scatters once more, from `origin` on.
    #[inline(always)]
    pub fn asks(
        &self,
        launch: &LaunchContext<'_>,
        (interaction, origin): (&SurfaceInteraction<R>, V3<R>),
        sample: &EmitterSample<R>,
        light: V3<R>,
    ) -> ShadowRay<R> {
        let EmitterSample { direction, limit, .. } = *sample;
        let segment = Segment { origin, direction, limit, source_primitive: interaction.source_primitive(direction) };
        let path = PathState { bounces: self.path.bounces + 1, ..self.path };
        let tag = if launch.spec.aovs.any() { Contribution::<R>::tag(sample.group, path.bounces) } else { 0 };
        let inside = self.inside(interaction, direction);
        ShadowRay { segment, light: share(launch, &path, light), tag, inside, ..ShadowRay::none() }
    }

    /// What a ray is in that leaves the surface towards a direction.
    #[inline(always)]
    fn inside(&self, interaction: &SurfaceInteraction<R>, direction: V3<R>) -> Inside {
        let inside = self.path.inside.scattered();
        if interaction.receives(direction) { inside } else { inside.across(interaction.front, self.filling.medium()) }
    }

    /// Is it on a shadow catcher that the camera sees?
    #[inline(always)]
    pub fn catches(&self, launch: &LaunchContext<'_>, primitive: &Primitive) -> bool {
        launch.spec.launch.has(Launch::CATCHER) && self.path.bounces == 0 && primitive.has(Primitive::CATCHER)
    }

    /// The path that goes on from here: `factor` of its light counts, `density` is that of its direction.
    #[inline(always)]
    pub fn on(
        &self,
        (interaction, origin): (&SurfaceInteraction<R>, V3<R>),
        direction: V3<R>,
        factor: V3<R>,
        density: R,
    ) -> PathState<R> {
        PathState {
            origin,
            direction,
            source_primitive: interaction.source_primitive(direction),
            weight: self.path.weight.times(factor).map(|c| c.flush(FAINT)),
            bounces: self.path.bounces + 1,
            density,
            from: origin,
            inside: self.inside(interaction, direction),
            gathered: false,
            ..self.path
        }
    }
}
