//! The steps that all methods share: testing two boxes, or one triangle.

use super::Query;
use super::cursor::{Cursor, Stack};
#[cfg(not(target_arch = "spirv"))]
use crate::bvh8::Triangle4;
use crate::data::{CentredPair, Effects, Launch, NodeRef, Triangle, numbers};
use crate::geometry::{Candidate, Span, intersect_moller_trumbore, intersect_watertight, slab, straddles_origin};
use crate::ray::{Hit, Ray};
#[cfg(not(target_arch = "spirv"))]
use crate::real::Lanes;
use crate::real::{Mask, Real, Scalar, V3};
use crate::scene::TraceContext;
use glam::UVec4;

/// The limit of an any-hit ray that has found its triangle: no box lies before it.
const FOUND: f32 = -1.0;

/// Has an any-hit ray found something opaque?
#[inline(always)]
pub fn occluded<R: Real>(hit: &Hit<R>) -> R::Mask {
    hit.t.lt(R::splat(0.0))
}

/// Which children of a pair a ray hits before its limit.
#[derive(Clone, Copy)]
pub struct Wanted<R: Real> {
    /// Is the left box hit?
    pub left: R::Mask,
    /// Is the right box hit?
    pub right: R::Mask,
    /// Is the right box the nearer?
    pub right_first: R::Mask,
}

/// Tests both boxes of a pair.
///
/// With coordinates in [-1, 1] the rounding of a plane's distance amounts to shifting the plane by less than 7 * 2^-24,
/// that of a triangle's own box to 4 * 2^-24, and its widened exit to 17 * 2^-24: together less than
/// [`CentredPair::MARGIN`], so a box is hit, and entered no later, wherever a triangle's own box inside it is.
#[inline(always)]
pub fn children<R: Real>(pair: &CentredPair, ray: &Ray<R>, hit: &Hit<R>) -> Wanted<R> {
    let left = inside(pair.left_centre, pair.left_half, ray, hit.t);
    let right = inside(pair.right_centre, pair.right_half, ray, hit.t);
    Wanted { left: left.near.le(left.far), right: right.near.le(right.far), right_first: right.near.lt(left.near) }
}

/// Where a ray is inside a box given by centre and half its extent, before its limit; see [`children`]. The far end is
/// valid where it is not negative.
// A function, since closures are not always inlined, and what is not inlined is not compiled for the
// processor's vectors.
#[inline(always)]
pub fn inside<R: Real>(centre: UVec4, half: UVec4, ray: &Ray<R>, limit: R) -> Span<R> {
    let middle = V3::splat(numbers(centre)).fused(ray.inverse, -ray.offset);
    let (half, reach) = (V3::splat(numbers(half)), ray.inverse.abs());
    Span { near: R::max_entry(half.fused(-reach, middle)), far: R::min_exit(half.fused(reach, middle), limit) }
}

/// A single ray's visit of its current pair.
#[inline(always)]
pub fn pair<Q: Query, R: Scalar>(
    geometry: &TraceContext<'_>,
    ray: &Ray<R>,
    hit: &Hit<R>,
    cursor: &mut Cursor,
    stack: &mut Stack,
) {
    let pair = geometry.pair(cursor.node.index());
    Q::on_boxes(2);
    let wanted = children(&pair, ray, hit);
    cursor.descend(&pair, wanted.left, wanted.right, wanted.right_first, stack);
}

/// Tests every triangle of a leaf. Returns whether this is an any-hit query all of whose rays have found something.
#[inline(always)]
pub fn leaf<Q: Query, R: Real>(geometry: &TraceContext<'_>, mut leaf: NodeRef, ray: &Ray<R>, hit: &mut Hit<R>) -> bool {
    while leaf.is_leaf() {
        triangle::<Q, R>(geometry, leaf, ray, hit);
        leaf = leaf.rest();
    }
    Q::ANY && !(!occluded(hit)).any()
}

/// Tests the first triangle of a leaf and takes the hit if it is the best so far.
#[inline(always)]
pub fn triangle<Q: Query, R: Real>(geometry: &TraceContext<'_>, leaf: NodeRef, ray: &Ray<R>, hit: &mut Hit<R>) {
    Q::on_triangle();
    let triangle = geometry.triangle(leaf.index());
    let candidate = single(geometry, &triangle, ray);
    if candidate.nearer(hit.t).any() && counts::<Q>(geometry.base.spec.effects, &triangle) {
        accept_hit::<Q, R>(geometry, &triangle, leaf.index(), &candidate, ray, hit);
    }
}

/// Intersects one triangle.
#[inline(always)]
fn single<R: Real>(geometry: &TraceContext<'_>, triangle: &Triangle, ray: &Ray<R>) -> Candidate<R> {
    let [a, b, c] = triangle.vertices();
    let (slopes, along) = (ray.slopes(), ray.along());
    intersect::<R, R>(geometry.base.spec.launch, [ray.seen(a), ray.seen(b), ray.seen(c)], slopes, along)
}

/// The weights of the second and the third vertex where a ray has hit a triangle, or zeros if it has hit none.
///
/// A CPU keeps them with the hit. A GPU recomputes them, from the same numbers to the same bits: the fewer registers a
/// ray takes, the more rays it can switch to while one waits for memory.
#[inline(always)]
pub fn weights<R: Scalar>(geometry: &TraceContext<'_>, ray: &Ray<R>, hit: &Hit<R>) -> (R, R) {
    if cfg!(not(target_arch = "spirv")) {
        return hit.weights();
    }
    if hit.triangle_index == Hit::<R>::NOTHING {
        return (R::splat(0.0), R::splat(0.0));
    }
    let candidate = single(geometry, &geometry.triangle(hit.triangle_index), ray);
    let scale = candidate.area.reciprocal();
    (candidate.u * scale, candidate.v * scale)
}

/// Tests up to four triangles, as many at once as there are lanes.
#[cfg(not(target_arch = "spirv"))]
#[inline(always)]
pub fn triangle4<Q: Query, R: Scalar, F: Lanes<R>>(
    geometry: &TraceContext<'_>,
    triangles: &Triangle4,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let origin = ray.shear.cycle(ray.origin);
    let shear = (F::all(ray.shear.x), F::all(ray.shear.y));
    let along = F::all(ray.along());
    let mut first = 0;
    while first < Triangle4::TRIANGLES {
        Q::on_triangle();
        let a = vertex::<R, F>(triangles, 0, first, ray, origin);
        let b = vertex::<R, F>(triangles, 1, first, ray, origin);
        let c = vertex::<R, F>(triangles, 2, first, ray, origin);
        let candidate = intersect::<R, F>(geometry.base.spec.launch, [a, b, c], shear, along);
        let mut inside = F::bits(candidate.nearer(F::all(hit.t)));
        while inside != 0 {
            let lane = inside.trailing_zeros() as usize;
            inside &= inside - 1;
            let triangle_index = triangles.triangle_indices[(first + lane) & 3];
            let triangle = geometry.triangle(triangle_index);
            if counts::<Q>(geometry.base.spec.effects, &triangle) {
                accept_hit::<Q, R>(geometry, &triangle, triangle_index, &candidate.lane(lane), ray, hit);
            }
        }
        first += F::COUNT as usize;
    }
}

/// Intersects a triangle by the test that the launch asks for, if rays over `R` leave it a choice; see
/// [`intersect_watertight`].
#[inline(always)]
fn intersect<R: Real, F: Real>(launch: Launch, [a, b, c]: [V3<F>; 3], shear: (F, F), along: F) -> Candidate<F> {
    if R::CHOOSES && launch.has(Launch::MOLLER) {
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

/// Does the query consider this triangle? Only opaque objects cast shadows (thesis 3.2).
#[inline(always)]
fn counts<Q: Query>(effects: Effects, triangle: &Triangle) -> bool {
    !(Q::ANY && effects.has(Effects::TRANSPARENT) && triangle.is_transparent())
}

/// Rejects misses of triangles seen edge-on, divides, moves the hit behind the entry to the triangle's own box, and
/// takes the lesser (t, primitive).
///
/// That box lies in every box that leads here, so no hit that is accepted can have been culled. A part of a split
/// triangle may find a hit in another part, which has the same t there.
#[inline(always)]
fn accept_hit<Q: Query, R: Real>(
    geometry: &TraceContext<'_>,
    triangle: &Triangle,
    triangle_index: u32,
    candidate: &Candidate<R>,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let (primitive, effects, zero) = (triangle.primitive(), geometry.base.spec.effects, R::splat(0.0));
    let mut inside = candidate.inside & !R::equals(primitive, ray.source_primitive);
    // The inside of glass is seen from its back side.
    if effects.has(Effects::CULLING) && !Q::ANY && !triangle.is_transparent() {
        inside = inside & candidate.front;
    }
    // This is rare, so transforming the vertices again costs less than keeping them since the intersection.
    if (inside & candidate.in_line()).any() {
        let [a, b, c] = triangle.vertices();
        inside = inside & straddles_origin(ray.seen(a), ray.seen(b), ray.seen(c), ray.slopes());
    }
    let (least, greatest) = geometry.bounds(triangle_index, triangle);
    let own = slab(V3::splat(least), V3::splat(greatest), ray);
    // Lanes outside divide by one, so that none divides by zero.
    let scale = R::select(inside, candidate.area, R::splat(1.0)).reciprocal();
    let inside = inside & own.near.le(own.far);
    // A bound of zero may have either sign; of zeros `max` takes the second.
    let t = (candidate.depth * scale).max(own.near.max(zero));
    if Q::ANY {
        hit.t = R::select(inside & t.lt(hit.t), R::splat(FOUND), hit.t);
        return;
    }
    let tie = t.eq(hit.t) & R::precedes(primitive, hit.primitive);
    let better = inside & (t.lt(hit.t) | tie);
    if better.any() {
        hit.t = R::select(better, t, hit.t);
        if cfg!(not(target_arch = "spirv")) {
            hit.u = R::select(better, candidate.u, hit.u);
            hit.v = R::select(better, candidate.v, hit.v);
            hit.scale = R::select(better, scale, hit.scale);
        }
        hit.triangle_index = R::select_index(better, R::index(triangle_index), hit.triangle_index);
        hit.primitive = R::select_index(better, R::index(primitive), hit.primitive);
    }
}
