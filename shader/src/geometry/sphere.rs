//! The sphere test, by roots that do not cancel (Haines, Günther and Akenine-Möller, Precision Improvements for Ray/Sphere
//! Intersection, Ray Tracing Gems, 2019).
//!
//! The quadratic equation is not solved for the ray's origin, from where the square of a distance and its difference to the
//! square of the radius lose all digits of a small sphere far away. It is solved for a place on the ray close to the centre,
//! which is found by exact differences and products: any distance along the ray will do for that place, so the rounding of
//! the distance costs nothing. What remains is a chord of the size of the sphere.
//!
//! The errors, in roundoffs u = 2^-24. The place relative to the centre errs by 4 u of its length, for its sum is of one
//! rounded difference and what both roundings took off. Thus the square of the chord errs by less than 16 u of the radius'
//! square: a ray is taken for a hit or a miss wrongly only where that square is so small. A root errs by 2 u of its distance
//! and of the radius, and by 16 u of the radius' square over the chord, or by 4 roots of u of the radius where the chord is
//! shorter. A hit lies in the sphere's own box: its distance to the centre is the radius but for 8 u of it, and u of its
//! distance along the ray.
//!
//! A device may take subnormal numbers for zero. Coordinates relative to the centre below 2^-40 are zero, which moves places by
//! less than 2^-39 and the chord's square by less than 2^-39 of the radius. Components of directions below 2^-60 are zero, so
//! no product of the two is subnormal. Directions are shorter than 2^62, so that their square has a reciprocal.

#[cfg(not(target_arch = "spirv"))]
use crate::real::Lanes;
use crate::real::{FAINT, Mask, Real, SMALL, Scalar, TINY, V3};

/// Where a ray's line passes through a sphere. Distances are in lengths of the ray's direction.
#[derive(Clone, Copy)]
pub struct Chord<R: Real> {
    /// Does the line meet the sphere? Else the rest is the line's nearest place to the centre, unless that is far outside.
    pub meets: R::Mask,
    /// The distance of a place close to the centre.
    pub base: R,
    /// That place, relative to the centre.
    pub place: V3<R>,
    /// From there to where the line enters.
    pub near: R,
    /// From there to where it leaves.
    pub far: R,
}

/// More than what rounding moves a place by that was found without the rests, in scenes within [-1, 1].
const BESIDE: f32 = 1.0 / (1 << 19) as f32;

/// Intersects a ray's line with a sphere.
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn intersect_sphere<R: Real>(centre: V3<R>, radius: R, origin: V3<R>, direction: V3<R>) -> Chord<R> {
    let (from, from_rest) = origin.difference_and_rest(centre);
    let from = from.map(|c| c.flush(SMALL));
    let inverse = direction.dot(direction).reciprocal();
    let base = -(from.dot(direction) * inverse).flush(FAINT);
    let (step, step_rest) = direction.product_and_rest(base);
    let about = from + step.map(|c| c.flush(FAINT));
    let reach = radius + R::splat(BESIDE);
    // A ray that enters a sphere's box often misses the sphere.
    let seen = about.map(|c| c.flush(SMALL));
    let close = seen.dot(seen).le(reach * reach);
    let zero = R::splat(0.0);
    if !close.any() {
        return Chord { meets: close, base, place: about, near: zero, far: zero };
    }
    let place = (about + (from_rest + step_rest)).map(|c| c.flush(SMALL));
    let along = place.dot(direction);
    let middle = (along * inverse).flush(FAINT);
    let square = radius * radius - place.dot(place) + (along * middle).flush(FAINT);
    // A root takes a subnormal for zero.
    let half = (square.max(zero) * inverse).sqrt();
    Chord { meets: close & zero.le(square), base, place, near: -middle - half, far: half - middle }
}

/// A direction's octahedral coordinates in [-1, 1] (Meyer et al., On Floating-Point Normal Vectors, 2010): continuous over a
/// sphere, and of a few sums. As (u, v, scale), to be multiplied.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn octahedral<R: Real>(v: V3<R>) -> (R, R, R) {
    let (size, zero) = (v.abs(), R::splat(0.0));
    let below = v.z.lt(zero);
    let folded = |own: R, size: R| {
        let turned = size + R::select(below, -v.z, zero);
        R::select(own.lt(zero), -turned, turned)
    };
    (folded(v.x, size.x), folded(v.y, size.y), size.x + size.y + size.z)
}

/// The unit vector of octahedral coordinates.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn unit_of<R: Scalar>(u: R, v: R) -> V3<R> {
    let (one, zero) = (R::splat(1.0), R::splat(0.0));
    let (x, y) = (u.abs(), v.abs());
    let z = one - x - y;
    let folded = z.lt(zero);
    let signed = |own: R, size: R| R::select(own.lt(zero), -size, size);
    let (x, y) = (R::select(folded, one - y, x), R::select(folded, one - x, y));
    V3::new(signed(u, x), signed(v, y), z).map(|c| c.flush(TINY)).normalised().0
}

#[cfg(not(target_arch = "spirv"))]
impl<R: Real> Chord<R> {
    /// One of the lanes.
    #[inline(always)]
    pub(crate) fn lane<S: Scalar>(&self, i: usize) -> Chord<S>
    where
        R: Lanes<S>,
    {
        Chord {
            meets: (R::bits(self.meets) >> i) & 1 == 1,
            base: self.base.lane(i),
            place: V3::new(self.place.x.lane(i), self.place.y.lane(i), self.place.z.lane(i)),
            near: self.near.lane(i),
            far: self.far.lane(i),
        }
    }
}
