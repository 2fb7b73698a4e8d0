//! Single-ray methods as steps, so that the caller may give a lane another ray in between.

use super::Query;
use super::leaf::Leaf;
use crate::ray::{Hit, Ray};
use crate::real::Scalar;
use crate::scene::TraceContext;

/// The state of a traversal.
pub trait Progress: Copy {
    /// At the root.
    fn start() -> Self;
    /// Nothing to visit.
    fn finished() -> Self;
    /// Is nothing left to visit?
    fn is_done(&self) -> bool;
}

/// A method that runs step by step. The stack is kept beside the cursor, since rust-gpu allows no pointer
/// in a struct that lives across a loop.
pub trait Resumable<R: Scalar> {
    /// The current position.
    type Cursor: Progress;
    /// The nodes still to visit.
    type Stack;

    /// An empty stack.
    fn stack() -> Self::Stack;

    /// One step of a traversal that is not done.
    ///
    /// # Safety
    /// The traversal is not [done](Progress::is_done), and all of its steps since it started were given this stack.
    unsafe fn step<Q: Query, L: Leaf>(
        context: &TraceContext<'_>,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
        cursor: &mut Self::Cursor,
        stack: &mut Self::Stack,
    );
}

/// From the root to the end.
#[inline(always)]
pub fn follow<Q: Query, L: Leaf, R: Scalar, M: Resumable<R>>(
    context: &TraceContext<'_>,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    let mut stack = M::stack();
    // SAFETY: a traversal that starts has pushed nothing.
    unsafe { finish::<Q, L, R, M>(context, ray, hit, M::Cursor::start(), &mut stack) };
}

/// Makes methods that trace a ray from the root by their steps. Not all at once: other crates may make steps of types that
/// trace otherwise here.
macro_rules! stepwise {
    ($($type:ident $(<$warp:ident>)?),*) => {$(
        impl<R: Scalar $(, $warp: $crate::warp::Warp)?> $crate::traverse::Method<R> for $type $(<$warp>)? {
            #[inline(always)]
            fn traverse<Q: Query, L: Leaf>(context: &TraceContext<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
                $crate::traverse::resumable::follow::<Q, L, R, Self>(context, ray, hit);
            }
        }
    )*};
}
pub(super) use stepwise;

/// From the traversal's current state to its end.
///
/// # Safety
/// All that the cursor has pushed is on this stack.
#[inline(always)]
pub unsafe fn finish<Q: Query, L: Leaf, R: Scalar, M: Resumable<R>>(
    context: &TraceContext<'_>,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
    mut cursor: M::Cursor,
    stack: &mut M::Stack,
) {
    while !cursor.is_done() {
        // SAFETY: it is not done, and the stack is the caller's.
        unsafe { M::step::<Q, L>(context, ray, hit, &mut cursor, stack) };
        // Two steps, since loop iterations are expensive on a GPU.
        if !cursor.is_done() {
            // SAFETY: likewise.
            unsafe { M::step::<Q, L>(context, ray, hit, &mut cursor, stack) };
        }
    }
}
