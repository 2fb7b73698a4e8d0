//! Triangles in leaves.

use super::primitives::counts;
use super::{Identity, Meeting, accept, hidden};
#[cfg(not(target_arch = "spirv"))]
use crate::bvh8::{MOST, Triangle4};
use crate::data::{Effects, Finishes, Launch, Primitive};
use crate::geometry::{Candidate, Passage, crosses, intersect_moller_trumbore, intersect_watertight};
use crate::ray::{Hit, Ray};
#[cfg(not(target_arch = "spirv"))]
use crate::real::Lanes;
use crate::real::{Mask, Real, Scalar, V3};
use crate::scene::TraceContext;
use crate::traverse::Query;

/// Tests a triangle and takes the hit if it is the best so far.
#[inline(always)]
pub fn intersect<Q: Query, R: Real>(
    context: &TraceContext<'_>,
    triangle: &Primitive,
    identity: Identity,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let candidate = single(context, triangle, ray);
    if candidate.nearer(hit.t).any() && counts::<Q>(context.base.spec.effects, triangle) {
        accept_candidate::<Q, R>(context, triangle, identity, &candidate, ray, hit);
    }
}

/// Intersects one triangle.
#[inline(always)]
fn single<R: Real>(context: &TraceContext<'_>, triangle: &Primitive, ray: &Ray<R>) -> Candidate<R> {
    let [a, b, c] = triangle.vertices();
    let (slopes, along) = (ray.slopes(), ray.along());
    intersect_by_choice(context.base.spec.launch, [ray.seen(a), ray.seen(b), ray.seen(c)], slopes, along)
}

/// Takes the crossing of a triangle if it is the first that is not behind the ray.
#[inline(always)]
pub fn cross<Q: Query, R: Real>(
    context: &TraceContext<'_>,
    triangle: &Primitive,
    identity: Identity,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let Passage { ahead, t, u, v, scale } = passage(context, triangle, ray);
    if !ahead.any() {
        return;
    }
    let t = t.max(R::splat(0.0));
    let (number, source) = (identity.number, ray.source_primitive);
    let further = !R::precedes(number, source) & !R::equals(number, source);
    let mut inside = ahead & (ray.behind.lt(t) | (t.eq(ray.behind) & further));
    if context.base.spec.effects.has(Effects::CUTOUT) && triangle.is_cutout() && inside.any() {
        let place = (triangle, identity.index);
        inside = context.cutout.kept(&context.base, place, (u * scale, v * scale), ray, inside);
    }
    accept::<Q, R>(Meeting { inside, t, u, v, scale }, identity, hit);
}

/// Where a ray crosses a triangle.
#[inline(always)]
fn passage<R: Real>(context: &TraceContext<'_>, triangle: &Primitive, ray: &Ray<R>) -> Passage<R> {
    let [a, b, c] = triangle.vertices();
    let (a, b, c) = (ray.seen(a), ray.seen(b), ray.seen(c));
    let (slopes, along) = (ray.slopes(), ray.along());
    let crossed = crosses(a, b, c, slopes);
    if !crossed.is.any() {
        let zero = R::splat(0.0);
        return Passage { ahead: crossed.is, t: zero, u: zero, v: zero, scale: zero };
    }
    let candidate = intersect_by_choice(context.base.spec.launch, [a, b, c], slopes, along);
    candidate.passage(&crossed, [a, b, c], (slopes, along))
}

/// [`weights`] where a ray crosses a triangle.
#[inline(always)]
pub fn crossing_weights<R: Scalar>(context: &TraceContext<'_>, triangle: &Primitive, ray: &Ray<R>) -> (R, R) {
    let Passage { u, v, scale, .. } = passage(context, triangle, ray);
    (u * scale, v * scale)
}

/// The weights of the second and the third vertex where a ray has hit a triangle.
#[inline(always)]
pub fn weights<R: Scalar>(context: &TraceContext<'_>, triangle: &Primitive, ray: &Ray<R>) -> (R, R) {
    let candidate = single(context, triangle, ray);
    let scale = candidate.area.reciprocal();
    (candidate.u * scale, candidate.v * scale)
}

/// Tests up to four triangles, as many at once as there are lanes.
#[cfg(not(target_arch = "spirv"))]
#[inline(always)]
pub fn intersect_four<Q: Query, R: Scalar, F: Lanes<R>>(
    context: &TraceContext<'_>,
    triangles: &Triangle4,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let origin = ray.shear.cycle(ray.origin);
    let shear = (F::all(ray.shear.x), F::all(ray.shear.y));
    let along = F::all(ray.along());
    let mut first = 0;
    while first < MOST {
        Q::on_primitive();
        let a = vertex::<R, F>(triangles, 0, first, ray, origin);
        let b = vertex::<R, F>(triangles, 1, first, ray, origin);
        let c = vertex::<R, F>(triangles, 2, first, ray, origin);
        let candidate = intersect_by_choice::<F>(context.base.spec.launch, [a, b, c], shear, along);
        let mut inside = F::bits(candidate.nearer(F::all(hit.t)));
        while inside != 0 {
            let lane = inside.trailing_zeros() as usize;
            inside &= inside - 1;
            let index = triangles.primitive_indices[(first + lane) % MOST];
            // Its record lies anywhere in memory, and loading it took a fifth of the time of rays without an order.
            let triangle = triangles.primitive(first + lane);
            let is_cutout = context.base.spec.effects.has(Effects::CUTOUT) && triangle.is_cutout();
            let triangle = if is_cutout { context.primitive(index) } else { triangle };
            if counts::<Q>(context.base.spec.effects, &triangle) {
                let identity = Identity::alone(index, &triangle);
                accept_candidate::<Q, R>(context, &triangle, identity, &candidate.lane(lane), ray, hit);
            }
        }
        first += F::COUNT as usize;
    }
}

/// Intersects a triangle by the test that the launch asks for, if precision leaves it a choice; see
/// [`intersect_watertight`].
#[inline(always)]
fn intersect_by_choice<F: Real>(launch: Launch, [a, b, c]: [V3<F>; 3], shear: (F, F), along: F) -> Candidate<F> {
    if !F::EXACT && launch.has(Launch::MOLLER) {
        intersect_moller_trumbore(a, b, c, shear, along)
    } else {
        intersect_watertight(a, b, c, shear, along)
    }
}

/// A vertex of the triangles from `first` on, relative to the ray's origin, both with their axes cycled.
#[cfg(not(target_arch = "spirv"))]
#[inline(always)]
fn vertex<R: Scalar, F: Lanes<R>>(
    triangles: &Triangle4,
    vertex: usize,
    first: usize,
    ray: &Ray<R>,
    origin: V3<R>,
) -> V3<F> {
    let numbers = &triangles.vertices[vertex];
    let axis = AXES[ray.shear.major()];
    V3::new(
        F::taken(&numbers[axis[0]][first..]) - F::all(origin.x),
        F::taken(&numbers[axis[1]][first..]) - F::all(origin.y),
        F::taken(&numbers[axis[2]][first..]) - F::all(origin.z),
    )
}

/// The axes in their order, given which is the third.
#[cfg(not(target_arch = "spirv"))]
const AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// Divides, finds where triangles that are seen edge-on are met, and hands on what is.
#[inline(always)]
fn accept_candidate<Q: Query, R: Real>(
    context: &TraceContext<'_>,
    triangle: &Primitive,
    identity: Identity,
    candidate: &Candidate<R>,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let (number, effects) = (identity.number, context.base.spec.effects);
    let mut inside = candidate.inside & !R::equals(number, ray.source_primitive);
    if effects.has(Effects::CULLING) && !Q::ANY && triangle.is_culled() {
        inside = inside & candidate.front;
    }
    if context.base.spec.finishes.has(Finishes::HAIR) && triangle.has(Primitive::HAIR) {
        inside = inside & candidate.front;
    }
    inside = hidden::met::<Q, R>(context.base.spec, triangle, ray, inside);
    let scale = candidate.scale(inside);
    let vertices = || {
        let [a, b, c] = triangle.vertices();
        [ray.seen(a), ray.seen(b), ray.seen(c)]
    };
    let (mut inside, t) = candidate.distance(inside, scale, vertices, (ray.slopes(), ray.along()));
    if effects.has(Effects::CUTOUT) && triangle.is_cutout() && inside.any() {
        let weights = (candidate.u * scale, candidate.v * scale);
        inside = context.cutout.kept(&context.base, (triangle, identity.index), weights, ray, inside);
    }
    let met = Meeting { inside, t, u: candidate.u, v: candidate.v, scale };
    accept::<Q, R>(met, identity, hit);
}
