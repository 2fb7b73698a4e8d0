//! Speculative while-while traversal (Aila and Laine 2009): a ray that has found a leaf postpones it
//! and continues, until every ray of its warp has one.

use core::marker::PhantomData;

use super::cursor::{Cursor, Stack};
use super::leaf::Leaf;
use super::resumable::Progress;
use super::step::{leaf, pair};
use super::{Method, Query};
use crate::data::NodeRef;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::TraceContext;
use crate::warp::Warp;

/// See the module.
pub struct Speculative<W>(PhantomData<W>);

impl<R: Scalar, W: Warp> Method<R> for Speculative<W> {
    #[inline(always)]
    fn traverse<Q: Query, L: Leaf>(context: &TraceContext<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        let mut stack = Stack::new();
        let mut cursor = Cursor::new();
        while !cursor.is_done() {
            // An inner node means that there is none.
            let mut aside = (NodeRef::ROOT, cursor.instance);
            while !(cursor.is_done() || cursor.node.is_leaf() && aside.0.is_leaf()) {
                if cursor.node.is_leaf() {
                    aside = (cursor.node, cursor.instance);
                    // SAFETY: it pushes to no other stack.
                    unsafe { cursor.pop(&stack) };
                } else {
                    // SAFETY: likewise.
                    unsafe { pair::<Q, R>(context, ray, hit, &mut cursor, &mut stack) };
                }
                if !W::any(!aside.0.is_leaf()) {
                    break;
                }
            }
            if aside.0.is_leaf() && leaf::<Q, L, R>(context, aside, ray, hit) {
                cursor.finish();
            }
        }
    }
}
