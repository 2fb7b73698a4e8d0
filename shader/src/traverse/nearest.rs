//! The triangle that is nearest to a point.
//!
//! It is the first by (square of the distance, number) of all triangles, whatever the hierarchy: a box is passed only where it is farther than
//! what has been found by more than rounding can make of the distances of what is in it.

use super::cursor::{Cursor, Stack};
use crate::data::{Effects, NodeRef, numbers};
use crate::geometry;
use crate::ray::Hit;
use crate::real::{Scalar, TINY, V3};
use crate::scene::Hierarchy;
use crate::stage::Found;
use glam::UVec4;

/// Rounding moves a distance by less than this, times what a point and the scene's cube are across: 16 roundoffs.
const LOST: f32 = 1.0 / (1 << 20) as f32;

/// Finds what is nearer to a point than `found`, whose `t` is the square of a distance. Spheres and disks are left out.
#[inline(always)]
pub fn nearest<R: Scalar>(hierarchy: &Hierarchy<'_>, point: V3<R>, found: &mut Found<R>) {
    let lost = (point.abs().greatest() + R::splat(2.0)) * R::splat(LOST);
    let mut cursor = Cursor::new();
    let mut stack = Stack::new();
    let mut number = Hit::<R>::NOTHING;
    while cursor.node != NodeRef::NONE {
        if cursor.node.is_leaf() {
            let mut leaf = cursor.node;
            while leaf.is_leaf() {
                nearer(hierarchy, (leaf.index(), cursor.instance), point, found, &mut number);
                leaf = leaf.rest();
            }
            // SAFETY: the stack is this cursor's own.
            unsafe { cursor.pop(&stack) };
        } else {
            let pair = cursor.open(hierarchy, 0.0);
            let left = square(pair.left_centre, pair.left_half, point, lost);
            let right = square(pair.right_centre, pair.right_half, point, lost);
            // SAFETY: likewise.
            unsafe { cursor.descend(&pair, left.le(found.t), right.le(found.t), right.lt(left), &mut stack) };
        }
    }
}

/// Takes a triangle if it is nearer than what has been found; of several that are as near, that of the lowest number.
#[inline(always)]
fn nearer<R: Scalar>(
    hierarchy: &Hierarchy<'_>,
    (index, instance): (u32, u32),
    point: V3<R>,
    found: &mut Found<R>,
    least: &mut u32,
) {
    let primitive = hierarchy.base.placed(index, instance, 0.0);
    if hierarchy.base.spec.effects.has(Effects::SPHERE | Effects::DISK) && !primitive.is_triangle() {
        return;
    }
    let [a, b, c] = primitive.vertices();
    let near = geometry::nearest(V3::splat(a), V3::splat(b), V3::splat(c), point);
    let number = primitive.number();
    if near.square.lt(found.t) || (near.square.eq(found.t) && number < *least) {
        (found.t, found.index, found.instance) = (near.square, index, instance);
        *least = number;
    }
}

/// The square of a point's distance from a box, less what rounding may take.
#[inline(always)]
fn square<R: Scalar>(centre: UVec4, half: UVec4, point: V3<R>, lost: R) -> R {
    let (centre, half) = (V3::<R>::splat(numbers(centre)), V3::<R>::splat(numbers(half)));
    let apart = (point - centre).abs() - half;
    let apart = apart.map(|x| (x - lost).max(R::splat(0.0)).flush(TINY));
    apart.dot(apart)
}
