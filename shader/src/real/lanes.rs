//! Several numbers side by side, in the vectors of a CPU. Not for GPUs, whose lanes are filled by other rays.

use super::{Fast, Real, Scalar};
use crate::traverse::lanes::RayLanes;

/// Lanes over the numbers of `S`: several on a CPU with vectors, or `S` itself.
pub trait Lanes<S: Scalar>: Real {
    /// How many lanes; a power of two.
    const COUNT: u32;

    /// A number in every lane.
    fn all(x: S) -> Self;
    /// A number for each lane, from the first on.
    fn of(number: impl Fn(usize) -> S) -> Self;
    /// An integer for each lane, from the first on.
    fn indices(index: impl Fn(usize) -> u32) -> Self::Index;
    /// Lane `i`.
    fn lane(&self, i: usize) -> S;
    /// Changes lane `i`.
    fn set_lane(&mut self, i: usize, x: S);
    /// Changes the integer of lane `i`.
    fn set_index(index: &mut Self::Index, i: usize, x: u32);
    /// The integer of lane `i`.
    fn index_of(index: Self::Index, i: usize) -> u32;
    /// Loads the first numbers of a slice, as many as there are lanes.
    fn taken(numbers: &[f32]) -> Self;
    /// Stores the lanes' numbers, in single precision, at the start of a slice.
    fn put(self, numbers: &mut [f32]);
    /// A bit a lane, the first in the lowest.
    fn bits(mask: Self::Mask) -> u32;
}

/// The vectors that a processor has for the numbers of `S`.
pub trait SimdIsa<S: Scalar> {
    /// Vectors that test the boxes of a node of eight children.
    type Eight: Lanes<S>;
    /// Vectors that test the triangles of its leaves.
    type Four: Lanes<S>;
    /// Vectors that trace several rays together.
    type Packet: Lanes<S> + RayLanes;

    /// The bits of eight numbers that are at least +0, each before those of an integer, of the lanes whose bits are set: the greatest first, and
    /// zeros behind them. None where no instructions do that without a branch.
    #[inline(always)]
    fn sorted(_lanes: u32, _high: &[f32; 8], _low: &[u32; 8]) -> Option<[u64; 8]> {
        None
    }
}

/// What is to be compiled for every instruction set.
pub trait Task<S: Scalar> {
    /// Runs with some vectors. Must be `inline(always)`, as all that it calls in loops: only what is
    /// inlined is compiled for the instruction set.
    fn run<V: SimdIsa<S>>(self);
}

/// What every processor of the target has.
pub struct Native;

impl<S: Scalar> SimdIsa<S> for Native {
    type Eight = S::Eight;
    type Four = S::Four;
    type Packet = S::Packet;
}

/// Implements [`Lanes`] for a [`Scalar`]: it is one lane of itself.
#[macro_export]
macro_rules! one_lane {
    ($type:ty) => {
        impl $crate::real::Lanes<$type> for $type {
            const COUNT: u32 = 1;

            #[inline(always)]
            fn all(x: $type) -> Self {
                x
            }
            #[inline(always)]
            fn of(number: impl Fn(usize) -> $type) -> Self {
                number(0)
            }
            #[inline(always)]
            fn indices(index: impl Fn(usize) -> u32) -> u32 {
                index(0)
            }
            #[inline(always)]
            fn lane(&self, _: usize) -> $type {
                *self
            }
            #[inline(always)]
            fn set_lane(&mut self, _: usize, x: $type) {
                *self = x;
            }
            #[inline(always)]
            fn set_index(index: &mut u32, _: usize, x: u32) {
                *index = x;
            }
            #[inline(always)]
            fn index_of(index: u32, _: usize) -> u32 {
                index
            }
            #[inline(always)]
            fn taken(numbers: &[f32]) -> Self {
                $crate::real::Real::splat(numbers[0])
            }
            #[inline(always)]
            fn put(self, numbers: &mut [f32]) {
                numbers[0] = $crate::real::Scalar::to_f32(self);
            }
            #[inline(always)]
            fn bits(mask: bool) -> u32 {
                mask as u32
            }
        }
    };
}
one_lane!(f32);
one_lane!(Fast);
one_lane!(f64);
