//! The steps that all methods share: testing two boxes, or a leaf.

use super::Query;
use super::cursor::{Cursor, Stack};
use super::leaf::{Leaf, occluded};
use crate::data::{CentredPair, NodeRef, numbers};
use crate::geometry::Span;
use crate::ray::{Hit, Ray};
use crate::real::{Mask, Real, Scalar, V3};
use crate::scene::TraceContext;
use glam::UVec4;

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
///
/// # Safety
/// That of [`Cursor::pop`].
#[inline(always)]
pub(super) unsafe fn pair<Q: Query, R: Scalar>(
    context: &TraceContext<'_>,
    ray: &Ray<R>,
    hit: &Hit<R>,
    cursor: &mut Cursor,
    stack: &mut Stack,
) {
    let pair = cursor.open(&context.hierarchy(), ray.time);
    Q::on_boxes(2);
    let wanted = children(&pair, ray, hit);
    // SAFETY: the caller's.
    unsafe { cursor.descend(&pair, wanted.left, wanted.right, wanted.right_first, stack) };
}

/// Tests all that a leaf holds, in a copy of a mesh or in none. Returns whether this is an any-hit query all of whose rays have found something.
#[inline(always)]
pub fn leaf<Q: Query, L: Leaf, R: Real>(
    context: &TraceContext<'_>,
    (mut leaf, instance): (NodeRef, u32),
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) -> bool {
    while leaf.is_leaf() {
        L::intersect::<Q, R>(context, (leaf.index(), instance), ray, hit);
        leaf = leaf.rest();
    }
    Q::ANY && !(!occluded(hit)).any()
}
