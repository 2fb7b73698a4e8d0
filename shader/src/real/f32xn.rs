//! A CPU packet: arrays that the compiler vectorises. Every lane has the bits that `f32` alone has.

use core::array::from_fn;
use core::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

use super::{Fast, Lanes, Mask, Real, V3};

/// `N` numbers, one a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct F32xN<const N: usize>(pub [f32; N]);

/// `N` truth values, all bits set or none, as vector registers compare.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct MaskxN<const N: usize>(pub [u32; N]);

/// `N` integers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct U32xN<const N: usize>(pub [u32; N]);

macro_rules! lanewise {
    ($type:ident, $trait:ident, $name:ident, $op:tt) => {
        impl<const N: usize> $trait for $type<N> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                $type(from_fn(|i| self.0[i] $op other.0[i]))
            }
        }
    };
}
lanewise!(F32xN, Add, add, +);
lanewise!(F32xN, Sub, sub, -);
lanewise!(F32xN, Mul, mul, *);
lanewise!(MaskxN, BitAnd, bitand, &);
lanewise!(MaskxN, BitOr, bitor, |);

impl<const N: usize> Neg for F32xN<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        F32xN(self.0.map(|x| -x))
    }
}

impl<const N: usize> Not for MaskxN<N> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        MaskxN(self.0.map(|m| !m))
    }
}

impl<const N: usize> Mask for MaskxN<N> {
    #[inline(always)]
    fn any(self) -> bool {
        self.0.iter().fold(0, |a, m| a | m) != 0
    }
    #[inline(always)]
    fn count(self) -> u32 {
        self.0.iter().map(|m| m & 1).sum()
    }
}

/// The mask of a lane.
#[inline(always)]
fn bits(holds: bool) -> u32 {
    if holds { u32::MAX } else { 0 }
}

impl<const N: usize> Real for F32xN<N> {
    type Mask = MaskxN<N>;
    type Index = U32xN<N>;
    const ROUNDOFF: Self = F32xN([<f32 as Real>::ROUNDOFF; N]);

    #[inline(always)]
    fn sieve(mask: MaskxN<N>, numbers: [Self; 5], mut test: impl FnMut([f32; 5]) -> bool) -> MaskxN<N> {
        MaskxN(from_fn(|i| bits(mask.0[i] != 0 && test(numbers.map(|lanes| lanes.0[i])))))
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        F32xN([x; N])
    }
    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        F32xN(from_fn(|i| Real::div(self.0[i], divisor.0[i])))
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        F32xN(self.0.map(Real::reciprocal))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        F32xN(self.0.map(Real::sqrt))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> MaskxN<N> {
        MaskxN(from_fn(|i| bits(self.0[i] < other.0[i])))
    }
    #[inline(always)]
    fn le(self, other: Self) -> MaskxN<N> {
        MaskxN(from_fn(|i| bits(self.0[i] <= other.0[i])))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> MaskxN<N> {
        MaskxN(from_fn(|i| bits(self.0[i] == other.0[i])))
    }
    #[inline(always)]
    fn select(mask: MaskxN<N>, a: Self, b: Self) -> Self {
        F32xN(from_fn(|i| if mask.0[i] != 0 { a.0[i] } else { b.0[i] }))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        F32xN(self.0.map(f32::abs))
    }
    #[inline(always)]
    fn index(i: u32) -> U32xN<N> {
        U32xN([i; N])
    }
    #[inline(always)]
    fn precedes(i: u32, other: U32xN<N>) -> MaskxN<N> {
        MaskxN(other.0.map(|o| bits(i < o)))
    }
    #[inline(always)]
    fn equals(i: u32, other: U32xN<N>) -> MaskxN<N> {
        MaskxN(other.0.map(|o| bits(i == o)))
    }
    #[inline(always)]
    fn select_index(mask: MaskxN<N>, a: U32xN<N>, b: U32xN<N>) -> U32xN<N> {
        U32xN(from_fn(|i| if mask.0[i] != 0 { a.0[i] } else { b.0[i] }))
    }
}

macro_rules! lanes {
    ($scalar:ty, $wrap:expr, $inner:expr) => {
        impl<const N: usize> Lanes<$scalar> for F32xN<N> {
            const COUNT: u32 = N as u32;

            #[inline(always)]
            fn all(x: $scalar) -> Self {
                F32xN([$inner(x); N])
            }
            #[inline(always)]
            fn of(number: impl Fn(usize) -> $scalar) -> Self {
                F32xN(from_fn(|i| $inner(number(i))))
            }
            #[inline(always)]
            fn indices(index: impl Fn(usize) -> u32) -> U32xN<N> {
                U32xN(from_fn(index))
            }
            #[inline(always)]
            fn lane(&self, i: usize) -> $scalar {
                $wrap(self.0[i])
            }
            #[inline(always)]
            fn set_lane(&mut self, i: usize, x: $scalar) {
                self.0[i] = $inner(x);
            }
            #[inline(always)]
            fn set_index(index: &mut U32xN<N>, i: usize, x: u32) {
                index.0[i] = x;
            }
            #[inline(always)]
            fn index_of(index: U32xN<N>, i: usize) -> u32 {
                index.0[i]
            }
            #[inline(always)]
            fn taken(numbers: &[f32]) -> Self {
                let numbers = &numbers[..N];
                F32xN(from_fn(|i| numbers[i]))
            }
            #[inline(always)]
            fn put(self, numbers: &mut [f32]) {
                numbers[..N].copy_from_slice(&self.0);
            }
            #[inline(always)]
            fn bits(mask: MaskxN<N>) -> u32 {
                (0..N).map(|i| (mask.0[i] & 1) << i).sum()
            }
        }
    };
}
lanes!(f32, core::convert::identity, core::convert::identity);
lanes!(Fast, Fast, |x: Fast| x.0);

impl<const N: usize> V3<F32xN<N>> {
    /// Vectors of `N` lanes.
    #[inline(always)]
    pub fn of_lanes(lane: impl Fn(usize) -> V3<f32>) -> Self {
        V3::new(F32xN(from_fn(|i| lane(i).x)), F32xN(from_fn(|i| lane(i).y)), F32xN(from_fn(|i| lane(i).z)))
    }
}
