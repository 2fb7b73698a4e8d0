//! Packet traversal (thesis algorithm 6.1, after Günther et al. 2007): the lanes of a warp visit the
//! same nodes, those that any of them hits, with the right child first if any of them that hits both prefers it.

use core::marker::PhantomData;

use super::cursor::{Cursor, Stack};
#[cfg(not(target_arch = "spirv"))]
use super::lanes::RayLanes;
use super::leaf::{Leaf, occluded};
use super::resumable::Progress;
use super::step::{children, leaf};
use super::{Method, Query};
use crate::ray::{Hit, Ray};
use crate::real::Real;
use crate::scene::TraceContext;
use crate::warp::Warp;

/// See the module.
pub struct Packet<W>(PhantomData<W>);

impl<R: Real, W: Warp> Method<R> for Packet<W> {
    #[inline(always)]
    fn traverse<Q: Query, L: Leaf>(context: &TraceContext<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        let mut stack = Stack::new();
        let mut cursor = Cursor::new();
        while !cursor.is_done() {
            if cursor.node.is_leaf() {
                // SAFETY: it pushes to no other stack.
                unsafe { visit_leaf::<Q, L, R, W>(context, ray, hit, &mut cursor, &stack) };
            } else {
                let pair = cursor.open(&context.hierarchy(), ray.time);
                Q::on_boxes(2);
                let wanted = children(&pair, ray, hit);
                let (left, right) = (goes::<Q, R, W>(wanted.left), goes::<Q, R, W>(wanted.right));
                let right_first = W::any(wanted.left & wanted.right & wanted.right_first);
                // SAFETY: likewise.
                unsafe { cursor.descend(&pair, left, right, right_first, &mut stack) };
            }
        }
    }
}

#[cfg(not(target_arch = "spirv"))]
impl<W: Warp> super::Together for Packet<W> {
    #[inline(always)]
    fn together<R: RayLanes, Q: Query, L: Leaf>(context: &TraceContext<'_>, rays: &[Ray<R>], hits: &mut [Hit<R>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            Self::traverse::<Q, L>(context, ray, hit);
        }
    }
}

/// Does the packet visit a child that these rays hit?
#[inline(always)]
pub(super) fn goes<Q: Query, R: Real, W: Warp>(wanting: R::Mask) -> bool {
    let any = W::any(wanting);
    if any {
        Q::on_child(|| W::count(wanting));
    }
    any
}

/// All rays test the current leaf; an any-hit packet is done once all its rays have found something.
///
/// # Safety
/// That of [`Cursor::pop`].
#[inline(always)]
pub(super) unsafe fn visit_leaf<Q: Query, L: Leaf, R: Real, W: Warp>(
    context: &TraceContext<'_>,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
    cursor: &mut Cursor,
    stack: &Stack,
) {
    leaf::<Q, L, R>(context, (cursor.node, cursor.instance), ray, hit);
    if Q::ANY && !W::any(!occluded(hit)) {
        cursor.finish();
    } else {
        // SAFETY: the caller's.
        unsafe { cursor.pop(stack) };
    }
}
