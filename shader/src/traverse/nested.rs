//! Copies of meshes in the leaves of nodes of eight children: what is below is walked by pairs.

use super::cursor::{Cursor, Stack};
use super::leaf::Leaf;
use super::resumable::{Progress, Resumable};
use super::{IfIf, Query};
use crate::data::{Effects, NodeRef};
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::TraceContext;

/// Tests what is at an index in leaf order: a primitive, or all of a copy of a mesh.
#[inline(always)]
pub fn intersect<Q: Query, L: Leaf, R: Scalar>(context: &TraceContext<'_>, index: u32, ray: &Ray<R>, hit: &mut Hit<R>) {
    let nothing = Hit::<R>::NOTHING;
    if context.base.spec.effects.has(Effects::INSTANCED) {
        let primitive = context.primitive(index);
        if primitive.is_instance() {
            let node = NodeRef::inner(context.base.frame.pairs + primitive.number());
            let (mut cursor, mut stack) = (Cursor::at(node, nothing), Stack::new());
            while !cursor.is_done() {
                // SAFETY: it is not done, and it started with this stack.
                unsafe { <IfIf as Resumable<R>>::step::<Q, L>(context, ray, hit, &mut cursor, &mut stack) };
            }
            return;
        }
    }
    L::intersect::<Q, R>(context, (index, nothing), ray, hit);
}
