//! The one numeric trait of the kernels, and its implementations.
//!
//! | type | is | `div`, `sqrt`, `pow` |
//! | --- | --- | --- |
//! | `f32` | exact: a GPU lane or one ray on the CPU, the same bits on both | correctly rounded; stated error |
//! | [`Fast`] | `f32` at the device's own speed | the device's |
//! | [`F32xN`] | a CPU packet, `f32` in every lane | as `f32` |
//! | `f64` | the reference picture, on the CPU | the standard library's |

mod alone;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "spirv")]
mod device;
#[cfg(not(target_arch = "spirv"))]
mod double;
#[cfg(not(target_arch = "spirv"))]
mod f32xn;
mod fast;
#[cfg(not(target_arch = "spirv"))]
mod lanes;
pub mod power;
#[cfg(test)]
mod rests;
mod single;
pub mod soft;
#[cfg(test)]
mod tests;
pub mod turns;
mod vector;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::{Avx2, Eight, Four};
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
#[cfg(not(target_arch = "spirv"))]
pub use f32xn::{F32xN, MaskxN, U32xN};
pub use fast::Fast;
#[cfg(not(target_arch = "spirv"))]
pub use lanes::{Lanes, Native, SimdIsa, Task};
pub use vector::V3;

use core::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

/// One truth value a lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Does it hold in any lane of this value?
    fn any(self) -> bool;
    /// In how many lanes?
    fn count(self) -> u32;
}

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn count(self) -> u32 {
        self as u32
    }
}

/// A number, or one a lane: the arithmetic that traversal and intersection need.
///
/// Exact implementations use only `+ - *`, comparisons and bit operations, since Vulkan promises
/// correct rounding for nothing else; their `div` and `sqrt` handle every operand themselves.
pub trait Real: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// What a comparison returns.
    type Mask: Mask;
    /// An unsigned 32-bit integer a lane, for ids and counts.
    type Index: Copy;

    /// Unit roundoff: half the distance from 1 to the next number.
    const ROUNDOFF: Self;

    /// Do results follow from the operands alone, whatever the device? Else it may trade them for speed.
    const EXACT: bool = true;

    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// The quotient; zero where it would be subnormal.
    fn div(self, divisor: Self) -> Self;
    /// One over a number, both normal.
    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self::splat(1.0).div(self)
    }
    /// The quotient by a normal number between 2^-100 and 2^100, within 1.5 units in the last place, for less than [`Real::div`]
    /// takes. No quotient may be subnormal.
    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        self * divisor.reciprocal()
    }
    /// The square root; zero for a subnormal.
    fn sqrt(self) -> Self;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Exact equality; zeros are equal.
    fn eq(self, other: Self) -> Self::Mask;
    /// `a` where the mask holds, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;

    /// The same integer in every lane.
    fn index(i: u32) -> Self::Index;
    /// Is the integer `i` less than the lane's?
    fn precedes(i: u32, other: Self::Index) -> Self::Mask;
    /// Is the integer `i` equal to the lane's?
    fn equals(i: u32, other: Self::Index) -> Self::Mask;
    /// `a` where the mask holds, else `b`.
    fn select_index(mask: Self::Mask, a: Self::Index, b: Self::Index) -> Self::Index;

    /// The lanes of a mask in which a test of five numbers, in single precision, holds.
    fn sieve(mask: Self::Mask, numbers: [Self; 5], test: impl FnMut([f32; 5]) -> bool) -> Self::Mask;

    /// The lesser, by compare and select; `other` if either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// The greater, by compare and select; `other` if either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }

    /// `self * a + b`, rounded once or twice, as the device prefers. Only for conservative tests, which allow for
    /// either, so that the results still have the same bits everywhere.
    #[inline(always)]
    fn fused(self, a: Self, b: Self) -> Self {
        self * a + b
    }

    /// As [`Real::min`], but of two zeros the device may return either: for values that are only compared.
    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        self.min(other)
    }

    /// As [`Real::max`], but of two zeros the device may return either.
    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        self.max(other)
    }

    /// The greatest component, or zero if none is positive: where a ray enters a box, given where it enters each of its
    /// three pairs of planes.
    #[inline(always)]
    fn max_entry(enter: V3<Self>) -> Self {
        enter.x.greater(enter.y).greater(enter.z.greater(Self::splat(0.0)))
    }

    /// The least of the components and the limit: where a ray leaves a box. If any is negative (-0 included), the
    /// result is some negative number or zero.
    #[inline(always)]
    fn min_exit(leave: V3<Self>, limit: Self) -> Self {
        leave.x.lesser(leave.y).lesser(leave.z.lesser(limit))
    }

    /// A difference, and what its rounding took off: their sum is exact (Knuth, The Art of Computer Programming 2, 4.2.2).
    /// Where precision is not exact the rest is zero.
    #[inline(always)]
    fn difference_and_rest(self, other: Self) -> (Self, Self) {
        let difference = self - other;
        let minuend = difference + other;
        let subtrahend = minuend - difference;
        (difference, (self - minuend) - (other - subtrahend))
    }

    /// A product, and what its rounding took off: their sum is exact where the rest is at least [`FAINT`], and a rest below
    /// counts as zero. Both operands are zero or between 2^-100 and 2^100. Without a fused operation, which no device needs to
    /// have (Dekker, A Floating-Point Technique for Extending the Available Precision, 1971). Where precision is not exact the
    /// rest is zero.
    #[inline(always)]
    fn product_and_rest(self, other: Self) -> (Self, Self) {
        let product = self * other;
        let ((a, b), (c, d)) = (halves(self), halves(other));
        // A product of 2^-78 or more has parts of 2^-126 or more, which are normal; the rest of any other is faint.
        let rest = ((a * c - product) + a * d + b * c) + b * d;
        (product, rest.flush(FAINT))
    }

    /// As [`Real::flush`] in exact precision; otherwise the device decides whether to keep or flush a subnormal.
    #[inline(always)]
    fn flush_if_exact(self, least: f32) -> Self {
        self.flush(least)
    }

    /// Zero where the magnitude is less than `least`. Devices may flush subnormals, so a value that could
    /// become one is made zero explicitly, on every device alike.
    #[inline(always)]
    fn flush(self, least: f32) -> Self {
        Self::select(self.abs().lt(Self::splat(least)), Self::splat(0.0), self)
    }
}

/// The upper twelve bits of a number, rounded, and the rest of it (Veltkamp).
#[inline(always)]
fn halves<R: Real>(x: R) -> (R, R) {
    let scaled = x * R::splat(4097.0);
    let upper = scaled - (scaled - x);
    (upper, x - upper)
}

/// A number of a single lane, as shading uses it.
pub trait Scalar: Real<Mask = bool, Index = u32> + Send + Sync {
    /// Vectors that test the boxes of a node of eight children.
    #[cfg(not(target_arch = "spirv"))]
    type Eight: Lanes<Self>;
    /// Vectors that test the triangles of its leaves.
    #[cfg(not(target_arch = "spirv"))]
    type Four: Lanes<Self>;
    /// Vectors that trace several rays together.
    #[cfg(not(target_arch = "spirv"))]
    type Packet: Lanes<Self> + crate::traverse::lanes::RayLanes;
    /// Are there vectors other than the [`Native`] ones?
    #[cfg(not(target_arch = "spirv"))]
    const VECTORISES: bool = false;
    /// Three numbers and an integer in device memory.
    type Record: Copy + Default;

    /// Runs a task with the vectors of a processor with AVX2, if these numbers have any use for them.
    ///
    /// # Safety
    /// The processor has AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn run_avx2(task: impl Task<Self>) {
        task.run::<Native>();
    }

    /// Likewise with the vectors of a processor with AVX-512.
    ///
    /// # Safety
    /// The processor has AVX-512, AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn run_avx512(task: impl Task<Self>) {
        task.run::<Native>();
    }

    /// Packs three numbers and an integer.
    fn store(v: V3<Self>, word: u32) -> Self::Record;
    /// Unpacks what [`Scalar::store`] packed.
    fn load(record: Self::Record) -> (V3<Self>, u32);
    /// The logarithm of a positive normal number to the base 2.
    fn log2(self) -> Self;
    /// `self` to the power of `exponent`, both at least 0; zero below 2^-100.
    fn pow(self, exponent: Self) -> Self;
    /// The whole number at or below, for magnitudes up to 2^23 (clamped there).
    fn floor_index(self) -> i32;
    /// The power of two at or below a magnitude, at most 2^126, and its inverse; of zero, zero and some power of two.
    fn binade(self) -> (Self, Self);
    /// Rounded to single precision, as a film holds it.
    fn to_f32(self) -> f32;
    /// Is it neither NaN nor infinite?
    fn is_finite(self) -> bool;
}

/// Products of two numbers of at least this magnitude, and sums of such products, are normal.
pub const SMALL: f32 = 1.0 / (1u64 << 40) as f32;
/// A coordinate or direction below this is zero.
pub const TINY: f32 = 1.0 / (1u64 << 60) as f32;
/// A contribution below this is zero: 2^-100.
pub const FAINT: f32 = TINY * SMALL;
