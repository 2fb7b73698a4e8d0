//! While-while traversal (Aila and Laine 2009): every ray by itself, pairs until it is at a leaf, then
//! all of the leaf's primitives.
//!
//! On a GPU a ray at its leaf waits for those rays of its warp that are still searching for theirs. A vote ends the
//! wait once too few of them are ([`Tuning::cut`](crate::data::Tuning::cut)).

use core::marker::PhantomData;

use super::Query;
use super::cursor::{Cursor, Stack};
use super::leaf::Leaf;
use super::resumable::{Resumable, stepwise};
use super::step::{leaf, pair};
use crate::data::NodeRef;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::TraceContext;
use crate::warp::Warp;

/// See the module. The lanes of `W` wait for each other; [`Alone`](crate::warp::Alone) never ends the search early.
pub struct WhileWhile<W>(PhantomData<W>);

stepwise!(WhileWhile<W>);

impl<R: Scalar, W: Warp> Resumable<R> for WhileWhile<W> {
    type Cursor = Cursor;
    type Stack = Stack;

    #[inline(always)]
    fn stack() -> Stack {
        Stack::new()
    }

    /// The two inner whiles.
    #[inline(always)]
    unsafe fn step<Q: Query, L: Leaf>(
        context: &TraceContext<'_>,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
        cursor: &mut Cursor,
        stack: &mut Stack,
    ) {
        let all = W::count(true);
        while !cursor.node.is_leaf() {
            // Three pairs per iteration: iterations are expensive on a GPU, and votes more so.
            // SAFETY: the caller's.
            unsafe {
                pair::<Q, R>(context, ray, hit, cursor, stack);
                inner::<Q, R>(context, ray, hit, cursor, stack);
                inner::<Q, R>(context, ray, hit, cursor, stack);
            }
            if W::SHARED && 100 * W::count(!cursor.node.is_leaf()) < context.base.spec.tuning.cut() * all {
                break;
            }
        }
        if cursor.node.is_leaf() && cursor.node != NodeRef::NONE {
            if leaf::<Q, L, R>(context, (cursor.node, cursor.instance), ray, hit) {
                cursor.finish();
            } else {
                // SAFETY: the caller's.
                unsafe { cursor.pop(stack) };
            }
        }
    }
}

/// Visits a pair, unless the traversal is at a leaf.
///
/// # Safety
/// That of [`Cursor::pop`].
#[inline(always)]
unsafe fn inner<Q: Query, R: Scalar>(
    context: &TraceContext<'_>,
    ray: &Ray<R>,
    hit: &Hit<R>,
    cursor: &mut Cursor,
    stack: &mut Stack,
) {
    if !cursor.node.is_leaf() {
        // SAFETY: the caller's.
        unsafe { pair::<Q, R>(context, ray, hit, cursor, stack) };
    }
}
