//! Ways through a grid of densities, by chance: delta tracking where light collides (Woodcock et al. 1965; in several channels by Kutz et
//! al., Spectral and Decomposition Tracking for Rendering Heterogeneous Volumes, 2017, with probabilities by what is left in each), ratio
//! tracking where it gets through (Novak et al. 2014). Both by the greatest density of each block.

use super::flight::Flight;
use super::grid::GridRay;
use crate::data::{Medium, numbers};
use crate::real::{FAINT, Scalar, V3};
use crate::sampler::{hash, unit};
use glam::Vec3;

/// Blocks and collisions of a way at most: what comes after is not there. Some drivers end loops at twice as many.
const MOST_STEPS: u32 = 32_000;

/// Of all that is dimmed to less than this nothing is left.
const DARK: f32 = 1.0 / (1 << 24) as f32;

/// One over the logarithm of two to the base e.
const NATS: f32 = core::f32::consts::LOG2_E;

/// Numbers drawn one after the other.
#[derive(Clone, Copy)]
pub struct Chain {
    a: u32,
    b: u32,
}

impl Chain {
    /// From two drawn numbers.
    #[inline(always)]
    pub fn new(a: u32, b: u32) -> Self {
        Chain { a, b }
    }

    /// Those of a further way of the same ray.
    #[inline(always)]
    pub fn further(self, way: u32) -> Self {
        Chain { b: self.b ^ (way << 24), ..self }
    }

    /// Both as numbers that are kept exactly: their upper 24 bits.
    #[inline(always)]
    pub fn numbers(self) -> (f32, f32) {
        ((self.a >> 8) as f32, (self.b >> 8) as f32)
    }

    /// From such numbers.
    #[inline(always)]
    pub fn of(a: f32, b: f32) -> Self {
        Chain::new(a as u32, b as u32)
    }

    /// Two of them.
    #[inline(always)]
    fn drawn(self, number: u32) -> (u32, u32) {
        let [p, q, _] = hash([self.a, self.b, number]);
        (p, q)
    }
}

/// An optical depth as likely as light gets so far: -ln(1 - u).
#[inline(always)]
fn depth<R: Scalar>(drawn: u32) -> R {
    -(R::splat(1.0) - R::splat(unit(drawn))).log2() * R::splat(const { 1.0 / NATS })
}

/// A share in each channel of what a number of one is: zero below what counts.
#[inline(always)]
fn scaled<R: Scalar>(v: V3<R>, by: R) -> V3<R> {
    (v * by).map(|c| c.flush(FAINT))
}

/// The way of a ray in the normalised scene that goes on at most so far in a medium with a grid, and whose light counts as `weight`.
#[inline(always)]
pub fn delta<R: Scalar>(
    medium: &Medium,
    grids: &[u32],
    ray: (V3<R>, V3<R>),
    (most, weight): (R, V3<R>),
    chain: Chain,
) -> Flight<R> {
    track::<R, true>(medium, grids, ray, (most, weight), chain)
}

/// What of light gets through a medium with a grid, linear RGB: by chance, right in the mean.
#[inline(always)]
pub fn ratio<R: Scalar>(medium: &Medium, grids: &[u32], ray: (V3<R>, V3<R>), most: R, chain: Chain) -> V3<R> {
    track::<R, false>(medium, grids, ray, (most, V3::splat(Vec3::ONE)), chain).factor
}

/// Either, from collision to collision with what is as dense everywhere as the densest place of a block. Where it is not there, or where
/// nothing may collide, the light goes on, as much of it as would not have collided.
#[inline(always)]
fn track<R: Scalar, const COLLIDES: bool>(
    medium: &Medium,
    grids: &[u32],
    (origin, direction): (V3<R>, V3<R>),
    (most, weight): (R, V3<R>),
    chain: Chain,
) -> Flight<R> {
    let at = medium.grid();
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let extinction = V3::<R>::splat(numbers(medium.extinction));
    let top = extinction.greatest();
    let mut flight = Flight { distance: most, collides: false, factor: V3::splat(Vec3::ONE) };
    let ray = GridRay::new(grids, at, origin, direction);
    let (enter, leave) = ray.within(grids, at);
    let end = leave.min(most);
    let mut t = enter.max(zero);
    if !t.lt(end) || !zero.lt(top) {
        return flight;
    }
    let relative = scaled(extinction, top.reciprocal());
    let mut block = ray.block(grids, at, t);
    let mut left = depth::<R>(chain.drawn(0).0);
    let mut steps = 0;
    while steps < MOST_STEPS && t.lt(end) && block.is_in(grids, at) {
        steps += 1;
        let (exit, after) = ray.leaves(block);
        let (exit, greatest) = (exit.min(end).max(t), R::splat(block.greatest(grids, at)));
        let sigma = (greatest * top).flush(FAINT);
        let way = ((exit - t) * sigma).flush(FAINT);
        if !left.lt(way) {
            left = left - way;
            t = exit;
            block = after;
            continue;
        }
        t = (t + left.div(sigma)).min(exit);
        let real = scaled(relative, block.number(grids, at, ray.at(t)).div(greatest));
        let passes = V3::new(one - real.x, one - real.y, one - real.z);
        let (chosen, drawn) = chain.drawn(steps);
        left = depth(drawn);
        if !COLLIDES {
            flight.factor = flight.factor.times(passes).map(|c| c.flush(FAINT));
            if flight.factor.greatest().lt(R::splat(DARK)) {
                flight.factor = V3::zero();
                break;
            }
            continue;
        }
        let likely = mean(weight.times(flight.factor), real);
        if R::splat(unit(chosen)).lt(likely) {
            flight = Flight { distance: t, collides: true, factor: over(flight.factor.times(real), likely) };
            break;
        }
        flight.factor = over(flight.factor.times(passes), one - likely);
    }
    flight
}

/// The mean of shares of channels, by what counts in each.
#[inline(always)]
fn mean<R: Scalar>(weight: V3<R>, shares: V3<R>) -> R {
    let weight = weight.map(|c| c.flush(FAINT));
    let sum = weight.x + weight.y + weight.z;
    let is_something = R::splat(0.0).lt(sum);
    let all = R::select(is_something, sum, R::splat(1.0));
    weight.times(shares).map(|c| c.flush(FAINT)).dot(V3::splat(Vec3::ONE)).div(all).min(R::splat(1.0))
}

/// Over the probability of what happened.
#[inline(always)]
fn over<R: Scalar>(factor: V3<R>, likely: R) -> V3<R> {
    let is_likely = R::splat(0.0).lt(likely);
    scaled(factor, R::select(is_likely, likely, R::splat(1.0)).reciprocal())
}

#[cfg(test)]
mod tests;
