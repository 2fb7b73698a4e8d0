//! Where triangles stand for a curved surface, light reaches what lies behind their own planes.

use super::Seen;
use crate::data::{Effects, numbers};
use crate::geometry::SurfaceInteraction;
use crate::real::{SMALL, Scalar, V3};
use crate::scene::{LaunchContext, ShadingData};

/// An interaction whose rays start above its triangle, on the smooth surface that the triangle stands for: as far above as the planes
/// through the vertices lie, at right angles to their normals, weighted as the vertices are (Hanika, Hacking the Shadow Terminator,
/// Ray Tracing Gems II, 2021), along the triangle's own normal. Concave surfaces and what lets light pass stay as they are.
#[inline(always)]
pub fn lifted<R: Scalar>(
    launch: &LaunchContext<'_>,
    shading: &ShadingData<'_>,
    seen: &Seen<R>,
) -> SurfaceInteraction<R> {
    let Seen { index, instance, time, primitive, interaction, .. } = *seen;
    if !launch.spec.effects.has(Effects::SMOOTH) || primitive.is_transparent() || interaction.is_curved {
        return interaction;
    }
    let normals = shading.normals(launch, (index, instance, time));
    let (u, v) = interaction.coordinates;
    let [a, b, c] = primitive.vertices();
    let over = |vertex, normal, weight: R| above(&interaction, V3::splat(vertex), V3::splat(numbers(normal))) * weight;
    let sum = over(a, normals.a, R::splat(1.0) - u - v) + over(b, normals.b, u) + over(c, normals.c, v);
    // Less is rounding, of a flat triangle too.
    let is_lifted = interaction.error_offset.lt(sum);
    SurfaceInteraction { lift: R::select(is_lifted, sum, R::splat(0.0)), is_lifted, ..interaction }
}

/// How far a place lies below the plane through a vertex at right angles to its normal, along the triangle's own.
#[inline(always)]
fn above<R: Scalar>(interaction: &SurfaceInteraction<R>, vertex: V3<R>, normal: V3<R>) -> R {
    let normal = V3::select(interaction.front, normal, -normal).map(|c| c.flush(SMALL));
    let from = (interaction.position - vertex).map(|c| c.flush(SMALL));
    let depth = (-from.dot(normal)).max(R::splat(0.0)).flush(SMALL);
    depth * normal.dot(interaction.normal).max(R::splat(0.0)).flush(SMALL)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Frame, Normals, Primitive, Specialisation, pack};
    use crate::ray::Ray;
    use crate::texture::Cone;
    use glam::Vec3;
    use proptest::prelude::*;

    /// A place on a triangle of these vertices and normals, seen from above or below.
    fn lift(
        vertices: [Vec3; 3],
        normals: [Vec3; 3],
        coordinates: (f64, f64),
        from_above: bool,
    ) -> SurfaceInteraction<f64> {
        let primitive = Primitive::triangle(vertices, 0, 0, 0);
        let direction = V3::new(0.0, 0.0, if from_above { -1.0 } else { 1.0 });
        let interaction = SurfaceInteraction::new(Effects(0), &primitive, coordinates, direction);
        let [a, b, c] = normals.map(|n| pack(n, 0));
        let shading = ShadingData { normals: &[Normals { a, b, c }], ..ShadingData::default() };
        let (instance, time, cone) = (u32::MAX, 0.0, Cone::none());
        let seen = Seen { index: 0, instance, time, primitive, interaction, direction, cone };
        let spec = Specialisation { effects: Effects(Effects::SMOOTH), ..Specialisation::default() };
        let frame = Frame::default();
        let launch = LaunchContext::new(&frame, spec, &[], &[]);
        lifted(&launch, &shading, &seen)
    }

    /// Three places on a unit ball about the origin, near the z axis.
    fn on_ball(size: f32) -> [Vec3; 3] {
        [(0.0, 1.0), (-0.866, -0.5), (0.866, -0.5)].map(|(x, y)| Vec3::new(x * size, y * size, 1.0).normalize())
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..Default::default() })]

        /// Never below the ball, and above its middle by no more than the triangle is below it again.
        #[test]
        fn a_place_on_a_balls_triangle_is_lifted_to_the_ball(size in 0.01f32..0.6, u in 0.0..1.0, v in 0.0..1.0) {
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let vertices = on_ball(size);
            let interaction = lift(vertices, vertices, (u, v), true);
            let place = interaction.position + interaction.normal * interaction.lift;
            let (radius, flat) = (place.dot(place).sqrt(), interaction.position.dot(interaction.position).sqrt());
            prop_assert!(radius > 1.0 - 0.2 * (1.0 - flat) - 1e-6, "{radius} over {flat}");
            prop_assert!(radius < 1.0 + 1.2 * (1.0 - flat) + 1e-6, "{radius} over {flat}");
        }
    }

    #[test]
    fn flat_and_concave_triangles_are_not_lifted() {
        let vertices = on_ball(0.3);
        let inside = vertices.map(|n| -n);
        let (flat, up) = (vertices.map(|v| v.with_z(1.0)), [Vec3::Z; 3]);
        assert!(lift(vertices, vertices, (0.3, 0.3), true).is_lifted);
        assert!(!lift(flat, up, (0.3, 0.3), true).is_lifted);
        assert!(!lift(vertices, vertices, (0.3, 0.3), false).is_lifted, "seen from inside");
        assert!(!lift(vertices, inside, (0.3, 0.3), true).is_lifted, "its normals lean inwards");
        assert!(!lift(vertices, vertices, (0.0, 0.0), true).is_lifted, "a vertex is on the surface itself");
    }

    /// It would let light through a sheet from behind.
    #[test]
    fn rays_from_above_that_go_below_their_triangle_may_meet_it() {
        let vertices = on_ball(0.3);
        let interaction = lift(vertices, vertices, (0.3, 0.3), true);
        let (up, down) = (interaction.normal, -interaction.normal);
        assert_eq!([up, down].map(|d| interaction.source_primitive(d)), [0, Ray::<f64>::OF_SURFACE]);
    }
}
