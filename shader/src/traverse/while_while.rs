//! While-while traversal (Aila and Laine 2009): every ray by itself, pairs until it is at a leaf, then
//! all of the leaf's triangles.
//!
//! A ray that shares its instructions with others waits at its leaf for those on their way to theirs. With
//! a vote it waits no longer than half of them take.

use core::marker::PhantomData;

use super::cursor::{Cursor, Stack};
use super::resumable::{Resumable, follow};
use super::step::{leaf, pair};
use super::{Method, Query};
use crate::data::NodeRef;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::TraceContext;
use crate::warp::Warp;

/// See the module. `W` is who waits for each other; [`Alone`](crate::warp::Alone) never breaks off.
pub struct WhileWhile<W>(PhantomData<W>);

impl<R: Scalar, W: Warp> Resumable<R> for WhileWhile<W> {
    type Cursor = Cursor;
    type Stack = Stack;

    #[inline(always)]
    fn stack() -> Stack {
        Stack::new()
    }

    /// The two inner whiles.
    #[inline(always)]
    fn step<Q: Query>(geometry: &TraceContext<'_>, ray: &Ray<R>, hit: &mut Hit<R>, cursor: &mut Cursor, stack: &mut Stack) {
        let all = W::count(true);
        while !cursor.node.is_leaf() {
            pair::<Q, R>(geometry, ray, hit, cursor, stack);
            // Turns of a loop cost a GPU, and votes more.
            inner::<Q, R>(geometry, ray, hit, cursor, stack);
            inner::<Q, R>(geometry, ray, hit, cursor, stack);
            if W::SHARED && 100 * W::count(!cursor.node.is_leaf()) < geometry.base.spec.tuning.cut() * all {
                break;
            }
        }
        if cursor.node.is_leaf() && cursor.node != NodeRef::NONE {
            if leaf::<Q, R>(geometry, cursor.node, ray, hit) {
                cursor.finish();
            } else {
                cursor.pop(stack);
            }
        }
    }
}

/// A pair, unless the traversal stands at a leaf.
#[inline(always)]
fn inner<Q: Query, R: Scalar>(
    geometry: &TraceContext<'_>,
    ray: &Ray<R>,
    hit: &Hit<R>,
    cursor: &mut Cursor,
    stack: &mut Stack,
) {
    if !cursor.node.is_leaf() {
        pair::<Q, R>(geometry, ray, hit, cursor, stack);
    }
}

impl<R: Scalar, W: Warp> Method<R> for WhileWhile<W> {
    #[inline(always)]
    fn traverse<Q: Query>(geometry: &TraceContext<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        follow::<Q, R, Self>(geometry, ray, hit);
    }
}
