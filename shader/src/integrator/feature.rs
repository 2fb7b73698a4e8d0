//! What the camera sees first, instead of light: for those who denoise a picture, or put pictures together.

use super::sampled::{ScatterContext, Scattered};
use super::vertex::Vertex;
use crate::buffer::read;
use crate::data::{Effects, Launch, Physical, numbers};
use crate::material::{Seen, Surface};
use crate::real::{FAINT, SMALL, Scalar, V3};
use crate::scene::LaunchContext;
use crate::stage::ShadowRay;
use crate::texture::Covering;

/// The feature that a launch asks for, and no further ray.
#[inline(always)]
pub(super) fn at<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    vertex: &Vertex<R>,
    seen: &Seen<R>,
) -> Scattered<R> {
    let feature = if launch.spec.launch.has(Launch::PLACE) {
        place(launch, seen)
    } else if launch.spec.launch.has(Launch::POSITION) {
        seen.interaction.position
    } else {
        let covering = seen.covering(launch, &context.shading);
        let surface = Surface::new(launch, &context.shading, seen, &covering);
        if launch.spec.launch.has(Launch::NORMAL) {
            surface.normal
        } else {
            albedo(launch, context.physicals, (seen, &surface), &covering)
        }
    };
    Scattered::once(feature.map(|c| c.flush(FAINT)), ShadowRay::none(), vertex.path, false)
}

/// How far in front of the camera's plane a place is, or from the camera where rays go all around; and one more than its primitive's
/// number: what is left of it over 2^16, and how often that fits.
#[inline(always)]
fn place<R: Scalar>(launch: &LaunchContext<'_>, seen: &Seen<R>) -> V3<R> {
    let camera = &launch.frame.camera;
    let vector = |record| V3::<R>::splat(numbers(record));
    let Seen { primitive, interaction, .. } = *seen;
    let from = (interaction.position - vector(camera.eye)).map(|c| c.flush(SMALL));
    let number = primitive.number() + 1;
    let half = |number: u32| R::splat(number as f32);
    let is_round = camera.is_round(launch.spec.launch);
    let depth = if is_round { from.direction_and_length().1 } else { from.dot(vector(camera.forward)) };
    V3::new(depth, half(number & 0xffff), half(number >> 16))
}

/// The share of white light from everywhere that a surface sends on, in linear RGB: a matt surface's colour, what metal reflects, and
/// what glass lets pass.
#[inline(always)]
pub(super) fn albedo<R: Scalar>(
    launch: &LaunchContext<'_>,
    physicals: &[Physical],
    (seen, surface): (&Seen<R>, &Surface<R>),
    covering: &Covering<R>,
) -> V3<R> {
    if launch.spec.effects.has(Effects::PHYSICAL) {
        let material = read(physicals, seen.material());
        if material.has(Physical::IS_PHYSICAL) {
            return launch.banded(V3::splat(numbers(material.base)).times(covering.base));
        }
    }
    let is_glass = !surface.ior.eq(R::splat(0.0));
    let sum = surface.diffuse + V3::select(is_glass, surface.transmission, surface.reflection);
    sum.map(|c| c.min(R::splat(1.0)))
}
