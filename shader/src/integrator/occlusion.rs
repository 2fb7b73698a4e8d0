//! Ambient occlusion (thesis 3.4.2): how much of a white sky a surface sees, as far as it looks.

use super::sampled::Scattered;
use super::vertex::Vertex;
use crate::material::{Seen, Surface, cosine_direction, lifted};
use crate::real::{Scalar, V3};
use crate::scene::{LaunchContext, ShadingData};
use crate::stage::{Segment, ShadowRay};

/// Asks along one direction of the cosine's density.
#[inline(always)]
pub(super) fn at<R: Scalar>(
    launch: &LaunchContext<'_>,
    shading: &ShadingData<'_>,
    vertex: &Vertex<R>,
    seen: &Seen<R>,
) -> Scattered<R> {
    let covering = seen.covering(launch, shading);
    let interaction = lifted(launch, shading, seen);
    let surface = Surface::new(launch, shading, seen, &covering);
    let (direction, _) = cosine_direction(surface.normal, vertex.draws.pair(0));
    let mut shadow = ShadowRay::none();
    // A direction about an interpolated normal may lie below the surface, where nothing is seen.
    if interaction.receives(direction) {
        let segment = Segment {
            origin: interaction.scattered_ray_origin(direction),
            direction,
            limit: R::splat(launch.frame.reach),
            source_primitive: interaction.source_primitive(direction),
        };
        shadow = ShadowRay { segment, light: vertex.path.weight, ..ShadowRay::none() };
    }
    Scattered::once(V3::zero(), shadow, vertex.path, false)
}
