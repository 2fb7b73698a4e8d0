//! While-while traversal (Aila and Laine 2009): every ray by itself, pairs until it is at a leaf, then
//! all of the leaf's triangles.

use super::cursor::{Cursor, Stack};
use super::resumable::{Resumable, follow};
use super::step::{leaf, pair};
use super::{Method, Query};
use crate::data::STACK;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::Geometry;

/// See the module.
pub struct WhileWhile;

impl<R: Scalar> Resumable<R> for WhileWhile {
    type Cursor = Cursor;
    type Stack = Stack;
    const EMPTY: Stack = [0; STACK];

    /// The two inner whiles.
    #[inline(always)]
    fn step<Q: Query>(geometry: &Geometry<'_>, ray: &Ray<R>, hit: &mut Hit<R>, cursor: &mut Cursor, stack: &mut Stack) {
        while !cursor.done && !cursor.node.is_leaf() {
            pair::<Q, R>(geometry, ray, hit, cursor, stack);
        }
        if !cursor.done {
            let found = leaf::<Q, R>(geometry, cursor.node, ray, hit);
            cursor.pop(stack);
            cursor.done = cursor.done || found;
        }
    }
}

impl<R: Scalar> Method<R> for WhileWhile {
    #[inline(always)]
    fn traverse<Q: Query>(geometry: &Geometry<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        follow::<Q, R, Self>(geometry, ray, hit);
    }
}
