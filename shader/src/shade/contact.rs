//! Where a ray touches a triangle, and how well that place is known.

use crate::data::Triangle;
use crate::real::{Real, SMALL, Scalar, TINY, V3};

/// A place on a surface.
#[derive(Clone, Copy)]
pub struct Contact<R: Real> {
    /// The place, from the triangle's vertices (nearer to the surface than along the ray).
    pub position: V3<R>,
    /// How far it may be off in each coordinate.
    pub error: V3<R>,
    /// The triangle's unit normal, on the viewer's side.
    pub normal: V3<R>,
    /// Does the viewer see the front (counter-clockwise) side?
    pub front: bool,
    /// Weights of the triangle's second and third vertex.
    pub weights: (R, R),
}

/// Roundoffs of a vertex-weighted sum and of what is computed from it when a ray leaves: PBRT-v4's
/// gamma(7) for the sum, and the sheared vertices' own error of the triangle test that the ray meets.
const ROUNDOFFS: f32 = 32.0;

impl<R: Scalar> Contact<R> {
    /// The place with weights `u` and `v` of the second and third vertex, seen along `direction`.
    #[inline(always)]
    pub fn new(triangle: &Triangle, u: R, v: R, direction: V3<R>) -> Self {
        let [a, b, c] = triangle.vertices();
        let (a, b, c) = (V3::<R>::splat(a), V3::<R>::splat(b), V3::<R>::splat(c));
        let w = R::splat(1.0) - u - v;
        let (wa, ub, vc) = (a * w, b * u, c * v);
        let sum = wa.abs() + ub.abs() + vc.abs();
        // Edges below 2^-40 are zero, so that the normal's products do not underflow.
        let edge = |from: V3<R>, to: V3<R>| (to - from).map(|x| x.flush(SMALL));
        let (normal, length) = edge(a, b).cross(edge(a, c)).normalised();
        let normal = V3::select(length.same(R::splat(0.0)), -direction, normal);
        let front = normal.dot(direction).le(R::splat(0.0));
        Contact {
            position: (wa + ub + vc).map(|x| x.flush(TINY)),
            error: sum * (R::splat(ROUNDOFFS) * R::ROUNDOFF),
            normal: V3::select(front, normal, -normal),
            front,
            weights: (u, v),
        }
    }

    /// Is a direction on the viewer's side?
    #[inline(always)]
    pub fn faces(&self, direction: V3<R>) -> bool {
        R::splat(0.0).lt(self.normal.dot(direction))
    }

    /// A start for a ray that leaves towards `direction`: off the surface by the place's error bound
    /// along the normal (PBRT-v4 6.8.6), so that it can't meet the surface again.
    #[inline(always)]
    pub fn leave(&self, direction: V3<R>) -> V3<R> {
        let distance = self.normal.abs().dot(self.error);
        let side = R::select(self.faces(direction), distance, -distance);
        (self.position + self.normal * side).map(|x| x.flush(TINY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intersect::cross;
    use crate::ray::Ray;
    use glam::Vec3;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200_000))]

        /// PBRT's reintersection test: a ray that leaves a triangle does not meet it again,
        /// whatever the triangle's size, shape and place.
        #[test]
        fn leaving_rays_do_not_return(
            t in prop::array::uniform9(-1f32..1.0), log_size in -20f32..0.0, log_place in -20f32..0.0,
            place in prop::array::uniform3(-1f32..1.0), w in prop::array::uniform2(0f32..1.0),
            d in prop::array::uniform3(-1f32..1.0),
        ) {
            let (size, far) = (log_size.exp2() * 0.5, log_place.exp2() * 0.5);
            let vertices: [Vec3; 3] = std::array::from_fn(|k| Vec3::new(
                place[0] * far + t[3 * k] * size, place[1] * far + t[3 * k + 1] * size, place[2] * far + t[3 * k + 2] * size,
            ));
            let (u, v) = if w[0] + w[1] > 1.0 { (1.0 - w[0], 1.0 - w[1]) } else { (w[0], w[1]) };
            let direction = V3::<f32>::new(d[0], d[1], d[2]).normalised().0;
            prop_assume!(direction.abs().greatest() > 0.0);
            let contact = Contact::new(&Triangle::new(vertices, 0, 0, 0), u, v, -direction);
            let origin = contact.leave(direction);
            let ray = Ray::new(origin, direction);
            let [a, b, c] = vertices.map(|p| V3::splat(p) - origin);
            let again = cross(a, b, c, ray.shear, ray.shear.cycle(ray.inverse).z);
            prop_assert!(!again.inside, "meets itself at {}", again.depth / again.area);
        }
    }
}
