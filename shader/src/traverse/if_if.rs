//! If-if traversal (thesis algorithm 6.2, after Aila and Laine 2009): every ray by itself, and in
//! every iteration at most one pair of boxes and at most one triangle.

use super::step::{children, occluded, triangle};
use super::{Method, Query};
use crate::buffer::read;
use crate::data::{NodeRef, STACK};
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::Geometry;

/// See the module.
pub struct IfIf;

/// Where a traversal stands; its stack is kept beside it, since a pointer may not live in a struct
/// that crosses a loop.
#[derive(Clone, Copy)]
struct Cursor {
    node: NodeRef,
    depth: u32,
    done: bool,
}

impl Cursor {
    #[inline(always)]
    fn push(&mut self, stack: &mut [u32; STACK], node: NodeRef) {
        stack[self.depth as usize & (STACK - 1)] = node.0;
        self.depth += 1;
    }

    #[inline(always)]
    fn pop(&mut self, stack: &[u32; STACK]) {
        if self.depth == 0 {
            self.done = true;
        } else {
            self.depth -= 1;
            self.node = NodeRef(stack[self.depth as usize & (STACK - 1)]);
        }
    }
}

/// One iteration: the two ifs.
#[inline(always)]
fn step<Q: Query, R: Scalar>(
    geometry: &Geometry<'_>, ray: &Ray<R>, stack: &mut [u32; STACK], cursor: &mut Cursor, hit: &mut Hit<R>,
) {
    if !cursor.node.is_leaf() {
        let pair = read(geometry.nodes, cursor.node.index());
        let wanted = children(&pair, ray, hit);
        if wanted.left && wanted.right {
            let (near, far) =
                if wanted.right_first { (pair.right(), pair.left()) } else { (pair.left(), pair.right()) };
            cursor.push(stack, far);
            cursor.node = near;
        } else if wanted.left {
            cursor.node = pair.left();
        } else if wanted.right {
            cursor.node = pair.right();
        } else {
            cursor.pop(stack);
        }
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

impl Method for IfIf {
    #[inline(always)]
    fn traverse<Q: Query, R: Scalar>(geometry: &Geometry<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        let mut stack = [0; STACK];
        let mut cursor = Cursor { node: NodeRef::ROOT, depth: 0, done: false };
        while !cursor.done {
            step::<Q, R>(geometry, ray, &mut stack, &mut cursor, hit);
        }
    }
}
