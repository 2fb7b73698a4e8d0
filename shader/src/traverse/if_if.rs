//! If-if traversal (thesis algorithm 6.2, after Aila and Laine 2009): every ray by itself, and in
//! every iteration at most one pair of boxes and at most one primitive.

use super::Query;
use super::cursor::{Cursor, Stack};
use super::leaf::{Leaf, occluded};
use super::resumable::{Resumable, stepwise};
use super::step::pair;
use crate::data::NodeRef;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::TraceContext;

/// See the module.
pub struct IfIf;

stepwise!(IfIf);

impl<R: Scalar> Resumable<R> for IfIf {
    type Cursor = Cursor;
    type Stack = Stack;

    #[inline(always)]
    fn stack() -> Stack {
        Stack::new()
    }

    /// The two ifs.
    #[inline(always)]
    unsafe fn step<Q: Query, L: Leaf>(
        context: &TraceContext<'_>,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
        cursor: &mut Cursor,
        stack: &mut Stack,
    ) {
        if !cursor.node.is_leaf() {
            // SAFETY: the caller's.
            unsafe { pair::<Q, R>(context, ray, hit, cursor, stack) };
        }
        if cursor.node.is_leaf() && cursor.node != NodeRef::NONE {
            L::intersect::<Q, R>(context, (cursor.node.index(), cursor.instance), ray, hit);
            cursor.node = cursor.node.rest();
            if Q::ANY && occluded(hit) {
                cursor.finish();
            } else if !cursor.node.is_leaf() {
                // SAFETY: the caller's.
                unsafe { cursor.pop(stack) };
            }
        }
    }
}
