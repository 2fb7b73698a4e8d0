//! The disk test: where a ray crosses the plane, and how far from the centre that is.
//!
//! The place relative to the centre is found as a sphere's is ([`super::sphere`]), so it errs by few roundoffs of its length
//! and by what the distance errs: 8 roundoffs of the way from the origin to the centre or to the plane, whichever is longer,
//! over the cosine between the ray and the normal. The place is off the plane by no more than 8 roundoffs of that way, whatever
//! the cosine.

use crate::real::{FAINT, Real, SMALL, V3};

/// Where a ray crosses a disk's plane.
#[derive(Clone, Copy)]
pub struct Crossing<R: Real> {
    /// Does it cross inside the disk?
    pub meets: R::Mask,
    /// Does it come from the side that the normal is on?
    pub front: R::Mask,
    /// The distance in lengths of the ray's direction.
    pub t: R,
    /// The place, relative to the centre.
    pub place: V3<R>,
}

/// The sum of a product each, of which none is subnormal.
#[inline(always)]
fn dot<R: Real>(a: V3<R>, b: V3<R>) -> R {
    let term = |x: R, y: R| (x * y).flush(FAINT);
    term(a.x, b.x) + term(a.y, b.y) + term(a.z, b.z)
}

/// Intersects a ray's line with a disk.
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn intersect_disk<R: Real>(
    (centre, normal, radius): (V3<R>, V3<R>, R),
    origin: V3<R>,
    direction: V3<R>,
) -> Crossing<R> {
    let (from, from_rest) = origin.difference_and_rest(centre);
    let (zero, slope) = (R::splat(0.0), dot(normal, direction));
    let parallel = slope.eq(zero);
    let t = -dot(normal, from).div(R::select(parallel, R::splat(1.0), slope)).flush(FAINT);
    let (step, step_rest) = direction.product_and_rest(t);
    let about = from + step.map(|c| c.flush(FAINT));
    let place = (about + (from_rest + step_rest)).map(|c| c.flush(SMALL));
    let meets = place.dot(place).le(radius * radius) & !parallel;
    Crossing { meets, front: slope.lt(zero), t, place }
}

/// Two unit vectors that are at right angles to a unit vector and to each other (Duff et al., Building an Orthonormal Basis,
/// Revisited, 2017).
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn tangents<R: Real>(n: V3<R>) -> [V3<R>; 2] {
    let one = R::splat(1.0);
    let sign = R::select(n.z.lt(R::splat(0.0)), -one, one);
    let a = -(sign + n.z).reciprocal();
    let b = n.x * n.y * a;
    [V3::new(one + sign * n.x * n.x * a, sign * b, -(sign * n.x)), V3::new(b, sign + n.y * n.y * a, -n.y)]
}

/// Where a place in a disk's plane lies, by its tangents.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn coordinates<R: Real>(normal: V3<R>, place: V3<R>) -> (R, R) {
    let [x, y] = tangents(normal);
    (dot(place, x), dot(place, y))
}
