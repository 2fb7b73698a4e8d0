//! Several rays through nodes of eight children in turn, each a step at a time: what one reads comes from memory while the others take their
//! steps. Where rays have no order, a core waits for memory most of the time otherwise.

use super::Query;
use super::bvh8::Walk;
use super::leaf::Leaf;
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, SimdIsa};
use crate::scene::TraceContext;

/// Rays on their way at once.
const WAYS: usize = 8;

/// Whose rays they are.
pub trait Rays<R: Scalar> {
    /// Ray `i` and its limit.
    fn ray(&self, i: usize) -> (Ray<R>, R);
    /// Takes what ray `i` has found.
    fn done(&mut self, i: usize, ray: &Ray<R>, hit: &Hit<R>);
}

/// A ray, its number, and how far it has come.
struct Traveller<R: Scalar, V: SimdIsa<R>> {
    number: usize,
    ray: Ray<R>,
    hit: Hit<R>,
    walk: Walk<R, V>,
}

/// Where there are fewer rays than ways.
const NOBODY: usize = usize::MAX;

impl<R: Scalar, V: SimdIsa<R>> Traveller<R, V> {
    #[inline(always)]
    fn new(rays: &impl Rays<R>, number: usize) -> Self {
        let (ray, limit) = rays.ray(number);
        Traveller { number, ray, hit: Hit::none(limit), walk: Walk::new(&ray) }
    }

    /// Another ray in its place, whose stack is not copied.
    #[inline(always)]
    fn turn(&mut self, rays: &impl Rays<R>, number: usize) {
        let (ray, limit) = rays.ray(number);
        (self.number, self.ray, self.hit) = (number, ray, Hit::none(limit));
        self.walk.turn(&ray);
    }
}

/// Follows `count` rays; each finds what it does by itself.
#[inline(always)]
pub fn interleaved<Q: Query, L: Leaf, R: Scalar, V: SimdIsa<R>>(
    context: &TraceContext<'_>,
    count: usize,
    rays: &mut impl Rays<R>,
) {
    if count == 0 {
        return;
    }
    let mut ways: [Traveller<R, V>; WAYS] = core::array::from_fn(|way| Traveller::new(rays, way.min(count - 1)));
    ways.iter_mut().skip(count).for_each(|way| way.number = NOBODY);
    let (mut next, mut left) = (count.min(WAYS), count.min(WAYS));
    while left > 0 {
        for way in &mut ways {
            if way.number == NOBODY {
                continue;
            }
            if way.walk.step::<Q, L>(context, &way.ray, &mut way.hit) {
                way.walk.prefetch(context);
                continue;
            }
            rays.done(way.number, &way.ray, &way.hit);
            if next < count {
                way.turn(rays, next);
                next += 1;
            } else {
                way.number = NOBODY;
                left -= 1;
            }
        }
    }
}
