//! Persistent subgroups (thesis 6.1, Aila and Laine 2009): as many as the device runs at once, whose
//! lanes take another ray when they are done with theirs.

use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};
use crate::scene::TraceContext;
use crate::traverse::resumable::{Progress, Resumable};
use crate::traverse::{Leaf, Query};
use crate::warp::Warp;

/// A lane without a ray.
const IDLE: u32 = u32::MAX;

/// Follows rays until none is left. `take` gives each lane that wants a ray the number of one, `count` or
/// more if there is none; `load` reads it, with its limit and whether it is to be traced at all; `store` keeps the outcome among the
/// `answers`.
#[inline(always)]
pub fn persistent<R: Scalar, M: Resumable<R>, L: Leaf, Q: Query, W: Warp, A>(
    context: &TraceContext<'_>,
    (count, answers): (u32, &mut [A]),
    mut take: impl FnMut(bool) -> u32,
    load: impl Fn(&[A], u32) -> (Ray<R>, R, bool),
    store: impl Fn(&mut [A], u32, bool, &Ray<R>, &Hit<R>),
) {
    let enough = (W::count(true) * context.base.spec.tuning.busy()).div_ceil(100).max(1);
    let mut number = IDLE;
    let mut traced = false;
    let mut ray = Ray::new(V3::zero(), V3::splat(glam::Vec3::ONE));
    let mut hit = Hit::none(R::splat(0.0));
    let mut cursor = M::Cursor::finished();
    let mut stack = M::stack();
    let mut more = true;
    loop {
        if number != IDLE && cursor.is_done() {
            store(answers, number, traced, &ray, &hit);
            number = IDLE;
        }
        if more {
            let next = take(number == IDLE);
            if number == IDLE && next < count {
                number = next;
                let (own, limit, wanted) = load(answers, next);
                (ray, traced) = (own, wanted);
                hit = Hit::none(limit);
                cursor = if wanted { M::Cursor::start() } else { M::Cursor::finished() };
            }
            // Once a lane has found none left, all see their rays to the end.
            more = !W::any(number == IDLE);
        }
        if !W::any(number != IDLE) {
            return;
        }
        let least = if more { enough } else { 1 };
        while W::count(!cursor.is_done()) >= least {
            if !cursor.is_done() {
                // SAFETY: it is not done, and every traversal starts and ends with this stack.
                unsafe { M::step::<Q, L>(context, &ray, &mut hit, &mut cursor, &mut stack) };
            }
        }
    }
}
