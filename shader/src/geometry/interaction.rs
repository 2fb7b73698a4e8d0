//! The point where a ray hits a primitive, and its error bound.

use super::{tangents, unit_of};
use crate::data::{Effects, Primitive};
use crate::ray::Ray;
use crate::real::{Real, SMALL, Scalar, TINY, V3};

/// A point on a surface.
#[derive(Clone, Copy)]
pub struct SurfaceInteraction<R: Real> {
    /// The point, computed from the primitive's record (nearer to the surface than a point along the ray).
    pub position: V3<R>,
    /// How far a ray must start from the surface to be on the right side of it, see [`SurfaceInteraction::offset_ray_origin`].
    pub error_offset: R,
    /// The surface's unit normal, on the viewer's side.
    pub normal: V3<R>,
    /// Does the viewer see the front: a triangle's counter-clockwise side, a sphere's outside, what a disk's normal is on?
    pub front: bool,
    /// Where on the primitive it is, see [`coordinates`](crate::traverse::leaf::coordinates).
    pub coordinates: (R, R),
    /// The primitive's number in the scene.
    pub number: u32,
    /// May a ray that starts there meet the primitive again?
    pub is_curved: bool,
    /// A sphere's radius, else zero.
    pub radius: R,
    /// Does its triangle stand for a curved surface that lies above it?
    pub is_lifted: bool,
    /// How far, else zero; see [`lifted`](crate::material::lifted).
    pub lift: R,
}

/// Bounds the error of a point and of the triangle test of a ray that starts there, in roundoffs times the
/// coordinates involved: gamma(7) for the weighted sum (PBRT-v4 6.8.4), and for the depth of a triangle no
/// thinner than a fifth of its length the error of its vertices (4) and edge functions (9) times that shape.
const ROUNDOFFS: f32 = 64.0;

/// Bounds the error of a point on a sphere, likewise: 4 for the unit normal, and one each for its product with the radius and
/// the sum with the centre.
const SPHERE_ROUNDOFFS: f32 = 8.0;

/// The largest share of a sphere's radius that a ray starts off its surface. The ray knows by its source on which side it is,
/// so a sphere that is not much larger than the roundoff of its coordinates needs no more.
const OFF_SPHERE: f32 = 1.0 / 8.0;

/// A ray whose cosine is less than this would have to go too far along its direction to get as far off the surface.
const GRAZING: f32 = 1.0 / 32.0;

impl<R: Scalar> SurfaceInteraction<R> {
    /// The point at some [`coordinates`](crate::traverse::leaf::coordinates) of a primitive, seen along `direction`.
    // Its parts are chosen one by one: a choice between whole records would cost a scene of triangles alone their copies.
    #[inline(always)]
    pub fn new(effects: Effects, primitive: &Primitive, coordinates: (R, R), direction: V3<R>) -> Self {
        let (position, error_offset, normal);
        // Here, so that smooth shading has it too.
        let first = R::splat(1.0) - coordinates.0 - coordinates.1;
        let is_curved = effects.has(Effects::SPHERE) && primitive.is_sphere();
        if is_curved {
            (position, error_offset, normal) = on_sphere(primitive, coordinates);
        } else if effects.has(Effects::DISK) && primitive.is_disk() {
            (position, error_offset, normal) = on_disk(primitive, coordinates);
        } else {
            (position, error_offset, normal) = on_triangle(primitive, (first, coordinates), direction);
        }
        let front = normal.dot(direction).le(R::splat(0.0));
        SurfaceInteraction {
            position: position.map(|x| x.flush(TINY)),
            error_offset,
            normal: V3::select(front, normal, -normal),
            front,
            coordinates,
            number: primitive.number(),
            is_curved,
            radius: if is_curved { R::splat(primitive.radius()) } else { R::splat(0.0) },
            is_lifted: false,
            lift: R::splat(0.0),
        }
    }

    /// What a ray that leaves towards `direction` starts on, see [`Ray::source_primitive`]. One that leaves for what is behind its
    /// triangle from above starts on none.
    #[inline(always)]
    pub fn source_primitive(&self, direction: V3<R>) -> u32 {
        if self.is_lifted && !self.faces(direction) {
            return Ray::<R>::OF_SURFACE;
        }
        let goes_inside = self.is_curved && self.faces(direction) != self.front;
        if goes_inside { self.number | Ray::<R>::INSIDE } else { self.number }
    }

    /// The index of refraction on the viewer's side over that on the other, of a body of index `ior` in a vacuum.
    #[inline(always)]
    pub fn relative_ior(&self, ior: R) -> R {
        if self.front { R::splat(1.0).div(ior) } else { ior }
    }

    /// Is a direction on the viewer's side?
    #[inline(always)]
    pub fn faces(&self, direction: V3<R>) -> bool {
        R::splat(0.0).lt(self.normal.dot(direction))
    }

    /// The origin of a ray that leaves towards `direction`: off the surface along the normal (PBRT-v4
    /// 6.8.6), so that it can't hit a neighbour in the same plane. The primitive itself is skipped by
    /// its number, see [`SurfaceInteraction::source_primitive`].
    #[inline(always)]
    pub fn offset_ray_origin(&self, direction: V3<R>) -> V3<R> {
        let side = R::select(self.faces(direction), self.error_offset, -self.error_offset);
        (self.position + self.normal * side).map(|x| x.flush(TINY))
    }

    /// May it scatter light of the viewer's side from there? A triangle that stands for a curved surface gets light from behind its
    /// own plane, too.
    #[inline(always)]
    pub fn receives(&self, direction: V3<R>) -> bool {
        self.is_lifted || self.faces(direction)
    }

    /// The origin of a ray that what is rough scatters towards `direction`: as [`SurfaceInteraction::offset_ray_origin`], but from the
    /// curved surface that a triangle stands for.
    #[inline(always)]
    pub fn scattered_ray_origin(&self, direction: V3<R>) -> V3<R> {
        if self.is_lifted {
            let above = self.normal * (self.error_offset + self.lift);
            return (self.position + above).map(|x| x.flush(TINY));
        }
        self.offset_ray_origin(direction)
    }

    /// As [`SurfaceInteraction::offset_ray_origin`], but offset along the unit direction itself, unless that grazes the surface: a ray that is
    /// offset sideways sees another point, which lenses magnify. Through a sphere the way to the far side is twice its radius
    /// times the cosine: a step of more than half of it counts as grazing, since it might end beyond.
    #[inline(always)]
    pub fn offset_ray_origin_along(&self, direction: V3<R>) -> V3<R> {
        let cosine = self.normal.dot(direction).abs();
        let mut grazes = cosine.lt(R::splat(GRAZING));
        if self.is_curved {
            let steep = cosine.max(R::splat(GRAZING));
            grazes |= (steep * steep * self.radius).lt(self.error_offset);
        }
        let step = self.error_offset.div(R::select(grazes, R::splat(1.0), cosine));
        let along = (self.position + direction * step).map(|x| x.flush(TINY));
        V3::select(grazes, self.offset_ray_origin(direction), along)
    }
}

/// The unit normal of a triangle's front, and twice its area.
#[inline(always)]
pub(crate) fn across<R: Scalar>([a, b, c]: [V3<R>; 3]) -> (V3<R>, R) {
    // Edges below 2^-40 are zero, so that the normal's products do not underflow.
    let edge = |from: V3<R>, to: V3<R>| (to - from).map(|x| x.flush(SMALL));
    edge(a, b).cross(edge(a, c)).normalised()
}

/// Position, error offset and the front's normal of a point on a triangle.
#[inline(always)]
fn on_triangle<R: Scalar>(triangle: &Primitive, (first, (u, v)): (R, (R, R)), direction: V3<R>) -> (V3<R>, R, V3<R>) {
    let [a, b, c] = triangle.vertices();
    let (a, b, c) = (V3::<R>::splat(a), V3::<R>::splat(b), V3::<R>::splat(c));
    let position = a * first + b * u + c * v;
    let reach = a.abs().max(b.abs()).max(c.abs());
    let span = (a - position).abs().max((b - position).abs()).max((c - position).abs());
    let (normal, length) = across([a, b, c]);
    let normal = V3::select(length.eq(R::splat(0.0)), -direction, normal);
    // The position's error across the surface grows with its coordinates along the normal; the triangle
    // test's error grows with the triangle's extent in every direction.
    let error_offset = (normal.abs().dot(reach) + span.greatest()) * (R::splat(ROUNDOFFS) * R::ROUNDOFF);
    (position, error_offset, normal)
}

/// The same on a sphere.
#[inline(always)]
fn on_sphere<R: Scalar>(sphere: &Primitive, (u, v): (R, R)) -> (V3<R>, R, V3<R>) {
    let (centre, radius) = (V3::<R>::splat(sphere.centre()), R::splat(sphere.radius()));
    let normal = unit_of(u, v);
    let reach = centre.abs().greatest() + radius;
    let error_offset = (reach * (R::splat(SPHERE_ROUNDOFFS) * R::ROUNDOFF)).min(radius * R::splat(OFF_SPHERE));
    (centre + normal * radius, error_offset, normal)
}

/// The same on a disk.
#[inline(always)]
fn on_disk<R: Scalar>(disk: &Primitive, (u, v): (R, R)) -> (V3<R>, R, V3<R>) {
    let (centre, normal) = (V3::<R>::splat(disk.centre()), V3::<R>::splat(disk.normal()));
    let radius = R::splat(disk.radius());
    let [x, y] = tangents(normal);
    let reach = normal.abs().dot(centre.abs()) + radius + radius;
    // Whatever is below 2^-60 is zero, so that no product is subnormal.
    let term = |tangent: V3<R>, along: R| tangent.map(|c| c.flush(TINY)) * along.flush(TINY);
    let across = term(x, u) + term(y, v);
    let position = centre + across.map(|c| c.flush(TINY)) * radius;
    (position, reach * (R::splat(ROUNDOFFS) * R::ROUNDOFF), normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::intersect_watertight;
    use crate::ray::Ray;
    use glam::Vec3;
    use proptest::prelude::*;

    fn meets<R: Scalar>(vertices: [Vec3; 3], origin: V3<R>, direction: V3<R>) -> bool {
        let ray = Ray::new(origin, direction);
        let [a, b, c] = vertices.map(|p| ray.seen(p));
        let x = intersect_watertight(a, b, c, ray.slopes(), ray.along());
        x.distance(x.inside, x.scale(x.inside), || [a, b, c], (ray.slopes(), ray.along())).0
    }

    /// Rays from a point on `vertices` towards `d` and towards directions that graze the surface more.
    fn leave_every_way(
        vertices: [Vec3; 3],
        (u, v): (f32, f32),
        d: [f32; 3],
        others: &[[Vec3; 3]],
    ) -> Result<(), TestCaseError> {
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let direction = V3::<f32>::new(d[0], d[1], d[2]).normalised().0;
        let interaction =
            SurfaceInteraction::new(Effects(0), &Primitive::triangle(vertices, 0, 0, 0), (u, v), -direction);
        for graze in [1.0, 1e-2, 1e-4, 1e-6] {
            let across = interaction.normal * interaction.normal.dot(direction);
            let direction = (direction - across + across * graze).normalised().0;
            if interaction.faces(direction) {
                for origin in [interaction.offset_ray_origin(direction), interaction.offset_ray_origin_along(direction)]
                {
                    for other in others {
                        prop_assert!(!meets(*other, origin, direction), "graze {graze}");
                    }
                }
            }
        }
        Ok(())
    }

    /// On a triangle that faces up the z axis.
    fn flat_seen_along(direction: V3<f64>) -> SurfaceInteraction<f64> {
        let flat = Primitive::triangle([Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| v * 0.5), 0, 0, 0);
        SurfaceInteraction::new(Effects(0), &flat, (0.25, 0.25), direction)
    }

    #[test]
    fn leaves_on_the_side_that_the_direction_is_on() {
        let interaction = flat_seen_along(V3::new(0.6, 0.0, -0.8));
        for (z, side) in [(1.0, 1.0), (-1.0, -1.0)] {
            let direction = V3::new(0.6, 0.0, 0.8 * z);
            assert_eq!(interaction.faces(direction), z > 0.0);
            let off = interaction.offset_ray_origin(direction) - interaction.position;
            assert_eq!((off.x, off.y, off.z), (0.0, 0.0, side * interaction.error_offset));
        }
    }

    /// A steep direction offsets along itself, a flatter one along the normal.
    #[test]
    fn leaves_along_its_direction_unless_that_grazes() {
        let interaction = flat_seen_along(V3::splat(-Vec3::Z));
        let off = |cosine: f64| {
            let direction = V3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
            (interaction.offset_ray_origin_along(direction) - interaction.position).x / interaction.error_offset
        };
        assert!((off(0.04) - (1.0f64 - 0.0016).sqrt() / 0.04).abs() < 0.1);
        assert_eq!(off(0.03), 0.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig { max_global_rejects: 1 << 20, ..ProptestConfig::with_cases(200_000) })]

        /// A ray that leaves a quad hits neither half again, whatever its size and position; the plane
        /// lies on a coordinate (often 0), where the point itself has no error across it.
        #[test]
        fn leaving_rays_do_not_meet_coplanar_neighbours(
            corner in prop::array::uniform2(-1f32..1.0), size in prop::array::uniform2(0.0625f32..1.0),
            log_size in -16f32..0.0, height in prop_oneof![Just(0f32), -1f32..1.0], axis in 0usize..3,
            w in prop::array::uniform2(0f32..1.0), d in prop::array::uniform3(-1f32..1.0),
        ) {
            prop_assume!(size[0] / size[1] < 5.0 && size[1] / size[0] < 5.0);
            let scale = log_size.exp2();
            let at = |i: f32, j: f32| {
                let mut p = [height; 3];
                p[(axis + 1) % 3] = (corner[0] + i * size[0] * scale).clamp(-1.0, 1.0);
                p[(axis + 2) % 3] = (corner[1] + j * size[1] * scale).clamp(-1.0, 1.0);
                Vec3::from(p)
            };
            let halves = [[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)], [at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]];
            let flat = |t: &[Vec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).length() < 0.02 * scale * scale;
            prop_assume!(!halves.iter().any(flat));
            leave_every_way(halves[0], (w[0], w[1]), d, &halves)?;
        }

        /// The same for a triangle of any orientation: PBRT's reintersection test.
        #[test]
        fn leaving_rays_do_not_return(
            t in prop::array::uniform9(-1f32..1.0), log_size in -16f32..0.0, log_place in -20f32..0.0,
            place in prop::array::uniform3(-1f32..1.0), w in prop::array::uniform2(0f32..1.0),
            d in prop::array::uniform3(-1f32..1.0),
        ) {
            let (size, far) = (log_size.exp2() * 0.5, log_place.exp2() * 0.5);
            let vertices: [Vec3; 3] = std::array::from_fn(|k| Vec3::new(
                place[0] * far + t[3 * k] * size, place[1] * far + t[3 * k + 1] * size, place[2] * far + t[3 * k + 2] * size,
            ));
            let [e, f] = [vertices[1] - vertices[0], vertices[2] - vertices[0]];
            let longest = e.length().max(f.length()).max((e - f).length());
            prop_assume!(e.cross(f).length() > 0.2 * longest * longest);
            leave_every_way(vertices, (w[0], w[1]), d, &[vertices])?;
        }
    }
}
