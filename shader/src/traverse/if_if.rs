//! If-if traversal (thesis algorithm 6.2, after Aila and Laine 2009): every ray by itself, and in
//! every iteration at most one pair of boxes and at most one triangle.

use super::cursor::{Cursor, Stack};
use super::step::{occluded, pair, triangle};
use super::{Method, Query};
use crate::data::STACK;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::Geometry;

/// See the module.
pub struct IfIf;

/// One iteration: the two ifs.
#[inline(always)]
fn step<Q: Query, R: Scalar>(
    geometry: &Geometry<'_>,
    ray: &Ray<R>,
    stack: &mut Stack,
    cursor: &mut Cursor,
    hit: &mut Hit<R>,
) {
    if !cursor.node.is_leaf() {
        pair(geometry, ray, hit, cursor, stack);
    }
    if cursor.node.is_leaf() && !cursor.done {
        triangle::<Q, R>(geometry, cursor.node, ray, hit);
        cursor.node = cursor.node.rest();
        if Q::ANY && occluded(hit) {
            cursor.done = true;
        } else if !cursor.node.is_leaf() {
            cursor.pop(stack);
        }
    }
}

impl<R: Scalar> Method<R> for IfIf {
    #[inline(always)]
    fn traverse<Q: Query>(geometry: &Geometry<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        let mut stack = [0; STACK];
        finish::<Q, R>(geometry, ray, &mut stack, Cursor::new(), hit);
    }
}

/// Runs a traversal from where it stands to its end.
#[inline(always)]
pub(super) fn finish<Q: Query, R: Scalar>(
    geometry: &Geometry<'_>,
    ray: &Ray<R>,
    stack: &mut Stack,
    mut cursor: Cursor,
    hit: &mut Hit<R>,
) {
    while !cursor.done {
        step::<Q, R>(geometry, ray, stack, &mut cursor, hit);
    }
}
