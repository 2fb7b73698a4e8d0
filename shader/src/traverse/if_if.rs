//! If-if traversal (thesis algorithm 6.2, after Aila and Laine 2009): every ray by itself, and in
//! every iteration at most one pair of boxes and at most one triangle.

use super::cursor::{Cursor, Stack};
use super::step::{children, occluded, triangle};
use super::{Method, Query};
use crate::buffer::read;
use crate::data::STACK;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::Geometry;

/// See the module.
pub struct IfIf;

/// One iteration: the two ifs.
#[inline(always)]
fn step<Q: Query, R: Scalar>(
    geometry: &Geometry<'_>, ray: &Ray<R>, stack: &mut Stack, cursor: &mut Cursor, hit: &mut Hit<R>,
) {
    if !cursor.node.is_leaf() {
        let pair = read(geometry.nodes, cursor.node.index());
        let wanted = children(&pair, ray, hit);
        cursor.descend(&pair, wanted.left, wanted.right, wanted.right_first, stack);
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
        let mut cursor = Cursor::new();
        while !cursor.done {
            step::<Q, R>(geometry, ray, &mut stack, &mut cursor, hit);
        }
    }
}
