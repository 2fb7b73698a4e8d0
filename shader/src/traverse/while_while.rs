//! While-while traversal (Aila and Laine 2009): every ray by itself, pairs until it is at a leaf, then
//! all of the leaf's triangles.

use super::cursor::Cursor;
use super::step::{leaf, pair};
use super::{Method, Query};
use crate::data::STACK;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::Geometry;

/// See the module.
pub struct WhileWhile;

impl<R: Scalar> Method<R> for WhileWhile {
    #[inline(always)]
    fn traverse<Q: Query>(geometry: &Geometry<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        let mut stack = [0; STACK];
        let mut cursor = Cursor::new();
        while !cursor.done {
            while !cursor.done && !cursor.node.is_leaf() {
                pair(geometry, ray, hit, &mut cursor, &mut stack);
            }
            if !cursor.done {
                let found = leaf::<Q, R>(geometry, cursor.node, ray, hit);
                cursor.pop(&stack);
                cursor.done = cursor.done || found;
            }
        }
    }
}
