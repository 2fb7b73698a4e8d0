//! Spheres in leaves.

use super::primitives::counts;
use super::{Identity, Meeting, accept, hidden};
#[cfg(not(target_arch = "spirv"))]
use crate::bvh8::{MOST, Sphere4};
use crate::data::{Effects, Primitive};
use crate::geometry::{Chord, intersect_sphere, octahedral};
use crate::ray::{Hit, Ray};
#[cfg(not(target_arch = "spirv"))]
use crate::real::Lanes;
use crate::real::{FAINT, Mask, Real, Scalar, V3};
use crate::scene::TraceContext;
use crate::traverse::Query;

/// Which end of a chord a ray hits.
struct End<R: Real> {
    /// Does it hit any?
    hit: R::Mask,
    /// Is it the far one, from inside?
    far: R::Mask,
    /// The distance.
    t: R,
}

/// The nearest end that is ahead, but of the sphere that the ray starts on none, or the far one if it goes through its
/// inside: it always meets that, as a chord that rounding has lost has its ends in one place.
#[inline(always)]
fn end<R: Real>(chord: &Chord<R>, number: u32, ray: &Ray<R>) -> End<R> {
    let zero = R::splat(0.0);
    let (leaves, inside) =
        (R::equals(number, ray.source_primitive), R::equals(number | Ray::<R>::INSIDE, ray.source_primitive));
    let near = chord.base + chord.near;
    let far = inside | near.le(zero);
    let t = R::select(far, chord.base + chord.far, near);
    End { hit: inside | (chord.meets & zero.lt(t) & !leaves), far, t }
}

/// Tests a sphere and takes the hit if it is the best so far.
#[inline(always)]
pub fn intersect<Q: Query, R: Real>(
    context: &TraceContext<'_>,
    sphere: &Primitive,
    index: u32,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    if !counts::<Q>(context.base.spec.effects, sphere) {
        return;
    }
    let chord = single(sphere, ray);
    accept_chord::<Q, R>(context, sphere, index, &chord, ray, hit);
}

#[inline(always)]
fn single<R: Real>(sphere: &Primitive, ray: &Ray<R>) -> Chord<R> {
    intersect_sphere(V3::splat(sphere.centre()), R::splat(sphere.radius()), ray.origin, ray.direction)
}

/// The octahedral coordinates of the normal where a ray has hit a sphere.
#[inline(always)]
pub fn coordinates<R: Scalar>(sphere: &Primitive, ray: &Ray<R>) -> (R, R) {
    let chord = single(sphere, ray);
    let (u, v, size) = octahedral(place(&chord, end(&chord, sphere.number(), ray).far, ray));
    let scale = size_or_one(true, size).reciprocal();
    (u * scale, v * scale)
}

/// What the octahedral coordinates are divided by. A place next to the centre of a sphere that is next to nothing has no
/// size, and there any normal will do: that of the coordinates (0, 0).
#[inline(always)]
fn size_or_one<R: Real>(inside: R::Mask, size: R) -> R {
    R::select(inside & R::splat(0.0).lt(size), size, R::splat(1.0))
}

/// Where a ray hits, relative to the centre.
#[inline(always)]
fn place<R: Real>(chord: &Chord<R>, far: R::Mask, ray: &Ray<R>) -> V3<R> {
    let step = R::select(far, chord.far, chord.near);
    chord.place + (ray.direction * step).map(|c| c.flush(FAINT))
}

#[inline(always)]
fn accept_chord<Q: Query, R: Real>(
    context: &TraceContext<'_>,
    sphere: &Primitive,
    index: u32,
    chord: &Chord<R>,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let number = sphere.number();
    let end = end(chord, number, ray);
    let mut inside = end.hit & end.t.le(hit.t);
    if context.base.spec.effects.has(Effects::CULLING) && !Q::ANY && sphere.is_culled() {
        inside = inside & !end.far;
    }
    inside = hidden::met::<Q, R>(context.base.spec, sphere, ray, inside);
    if !inside.any() {
        return;
    }
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let (u, v, size) =
        if Q::ANY || cfg!(target_arch = "spirv") { (zero, zero, one) } else { octahedral(place(chord, end.far, ray)) };
    let scale = size_or_one(inside, size).reciprocal();
    let met = Meeting { inside, t: end.t, u, v, scale };
    accept::<Q, R>(met, Identity::alone(index, sphere), hit);
}

/// Tests up to four spheres, as many at once as there are lanes.
#[cfg(not(target_arch = "spirv"))]
#[inline(always)]
pub fn intersect_four<Q: Query, R: Scalar, F: Lanes<R>>(
    context: &TraceContext<'_>,
    spheres: &Sphere4,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let all = |v: V3<R>| V3::new(F::all(v.x), F::all(v.y), F::all(v.z));
    let (origin, direction) = (all(ray.origin), all(ray.direction));
    let mut first = 0;
    while first < MOST {
        Q::on_primitive();
        let of = |axis: usize| F::taken(&spheres.centres[axis][first..]);
        let radius = F::taken(&spheres.radii[first..]);
        let chord = intersect_sphere(V3::new(of(0), of(1), of(2)), radius, origin, direction);
        // What the ray starts inside of is met whatever rounding does, and its far end may lie beyond any limit.
        let own = own_lanes::<R, F>(spheres, first, ray);
        let mut open = F::bits(chord.meets & (chord.base + chord.near).le(F::all(hit.t))) | own;
        while open != 0 {
            let lane = open.trailing_zeros() as usize;
            open &= open - 1;
            let index = spheres.primitive_indices[(first + lane) & 3];
            let sphere = context.primitive(index);
            if counts::<Q>(context.base.spec.effects, &sphere) {
                accept_chord::<Q, R>(context, &sphere, index, &chord.lane(lane), ray, hit);
            }
        }
        first += F::COUNT as usize;
    }
}

/// A bit for the sphere through whose inside the ray goes from its surface.
#[cfg(not(target_arch = "spirv"))]
#[inline(always)]
fn own_lanes<R: Scalar, F: Lanes<R>>(spheres: &Sphere4, first: usize, ray: &Ray<R>) -> u32 {
    if ray.source_primitive & Ray::<R>::INSIDE == 0 || ray.source_primitive == Hit::<R>::NOTHING {
        return 0;
    }
    let number = ray.source_primitive & !Ray::<R>::INSIDE;
    let is_own = |lane: usize| u32::from(spheres.numbers[(first + lane) & 3] == number) << lane;
    (0..F::COUNT as usize).map(is_own).sum()
}
