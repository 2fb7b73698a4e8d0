//! The one numeric trait of the kernels, and its machines.
//!
//! | machine | is | `div`, `sqrt`, `pow` |
//! | --- | --- | --- |
//! | `f32` | exact: a GPU lane or one ray on the CPU, the same bits on both | correctly rounded; stated error |
//! | [`Fast`] | `f32` at the device's own speed | the device's |
//! | [`Wide`] | a CPU packet, `f32` in every lane | as `f32` |
//! | `f64` | the reference picture, on the CPU | the standard library's |

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "spirv")]
mod device;
#[cfg(not(target_arch = "spirv"))]
mod double;
mod fast;
mod power;
mod single;
pub mod soft;
mod vector;
#[cfg(not(target_arch = "spirv"))]
mod wide;

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
pub use fast::Fast;
pub use vector::V3;
#[cfg(not(target_arch = "spirv"))]
pub use wide::{Wide, WideIndex, WideMask};

use crate::data::numbers;
use crate::ray::{Hit, Ray};
use core::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};
use glam::UVec4;

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

/// A number, or one a lane: all that traversal and intersection ask of arithmetic.
///
/// Exact implementations use `+ - *`, comparisons and bit operations alone, since Vulkan promises
/// correct rounding for nothing else; `div` and `sqrt` decide every operand themselves.
pub trait Real: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// What a comparison returns.
    type Mask: Mask;
    /// An unsigned 32-bit integer a lane: ids and counts are no floats.
    type Index: Copy;

    /// A lane by itself.
    type Lane: Scalar;

    /// Unit roundoff: half the distance from 1 to the next number.
    const ROUNDOFF: Self;

    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// The quotient; zero where it would be subnormal.
    fn div(self, divisor: Self) -> Self;
    /// One over a number, both normal.
    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self::splat(1.0).div(self)
    }
    /// The square root; zero for a subnormal.
    fn sqrt(self) -> Self;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Exact equality; zeros are equal.
    fn same(self, other: Self) -> Self::Mask;
    /// `a` where the mask holds, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Without its sign.
    fn abs(self) -> Self;

    /// The same integer in every lane.
    fn index(i: u32) -> Self::Index;
    /// Is the integer `i` less than the lane's?
    fn precedes(i: u32, other: Self::Index) -> Self::Mask;
    /// Is the integer `i` the lane's?
    fn equals(i: u32, other: Self::Index) -> Self::Mask;
    /// `a` where the mask holds, else `b`.
    fn select_index(mask: Self::Mask, a: Self::Index, b: Self::Index) -> Self::Index;

    /// Runs `f` for every lane of the mask by itself.
    fn lanes(
        ray: &Ray<Self>,
        hit: &mut Hit<Self>,
        mask: Self::Mask,
        f: impl FnMut(&Ray<Self::Lane>, &mut Hit<Self::Lane>),
    );

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

    /// `self * a + b`, rounded once or twice, as suits the device: for tests that leave room for either, so that
    /// only what they lead to has the same bits everywhere.
    #[inline(always)]
    fn fused(self, a: Self, b: Self) -> Self {
        self * a + b
    }

    /// As [`Real::min`], but of two zeros the device may take either: for what is only compared.
    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        self.min(other)
    }

    /// As [`Real::max`], with the licence of [`Real::lesser`].
    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        self.max(other)
    }

    /// As [`Real::flush`], where the same bits are promised; else a subnormal may stay, or be flushed, as the
    /// device likes.
    #[inline(always)]
    fn settle(self, least: f32) -> Self {
        self.flush(least)
    }

    /// Zero where the magnitude is less than `least`. Devices may flush subnormals, so what could
    /// become one is made zero at a named point, on every device alike.
    #[inline(always)]
    fn flush(self, least: f32) -> Self {
        Self::select(self.abs().lt(Self::splat(least)), Self::splat(0.0), self)
    }
}

/// Lanes over the numbers of `S`: several on a CPU with vectors, `S` itself on a GPU, where other rays fill
/// the lanes.
pub trait Lanes<S: Scalar>: Real {
    /// How many; [`Wide`] has a power of two.
    const COUNT: u32;

    /// A number in every lane.
    fn all(x: S) -> Self;
    /// A number for each lane, from the first on.
    fn of(number: impl Fn(usize) -> S) -> Self;
    /// An integer for each lane, from the first on.
    fn indices(index: impl Fn(usize) -> u32) -> Self::Index;
    /// Lane `i`.
    fn lane(&self, i: usize) -> S;
    /// The integer of lane `i`.
    fn index_of(index: Self::Index, i: usize) -> u32;
    /// The first numbers of a slice, as many as there are lanes.
    #[cfg(not(target_arch = "spirv"))]
    fn taken(numbers: &[f32]) -> Self;
    /// Puts the lanes' numbers, in single precision, first into a slice.
    #[cfg(not(target_arch = "spirv"))]
    fn put(self, numbers: &mut [f32]);
    /// The numbers of a record for each lane, from the first on.
    fn vectors(records: &[UVec4]) -> V3<Self>;
    /// A bit a lane, the first in the lowest.
    fn bits(mask: Self::Mask) -> u32;
    /// The same truth in every lane.
    fn every(holds: bool) -> Self::Mask;
}

/// Numbers that the eight boxes of a wide node are tested with.
pub trait Octet<S: Scalar>: Lanes<S> {
    /// The numbers of [`Lanes::COUNT`] bytes (a divisor of 8) from byte `first` on of two words, the lowest
    /// byte first.
    fn bytes(words: [u32; 2], first: u32) -> Self;
    /// [`Octet::bytes`] of `low` and `high`, or of `high` and `low` if `swapped`.
    #[inline(always)]
    fn sides(swapped: bool, low: [u32; 2], high: [u32; 2], first: u32) -> (Self, Self) {
        let (near, far) = if swapped { (high, low) } else { (low, high) };
        (Self::bytes(near, first), Self::bytes(far, first))
    }
    /// Numbers that are kept to be asked for one of them; nothing where there is no room for them.
    type Kept: Copy;
    /// Keeps the lanes' numbers.
    fn keep(self) -> Self::Kept;
    /// Number `i` of those kept, or one less than any of them.
    fn kept(kept: &Self::Kept, i: u32) -> S;
    /// What waits at each child if it is met.
    type Children: Copy;
    /// From a byte a child: how many bits wait (3 to 0) in its upper three bits, where they lie in the lower
    /// five. Places from 24 on are turned by `inverted`.
    fn children(words: [u32; 2], inverted: u32) -> Self::Children;
    /// All that waits of the [`Lanes::COUNT`] children from `first` on that are met.
    fn waiting(met: Self::Mask, children: &Self::Children, first: u32) -> u32;
}

/// The vectors that a processor has for the numbers of `S`.
pub trait Vectors<S: Scalar> {
    /// What tests the boxes of a wide node.
    type Eight: Octet<S>;
    /// What tests the triangles of a wide node.
    #[cfg(not(target_arch = "spirv"))]
    type Four: Lanes<S>;
    /// What follows rays together.
    #[cfg(not(target_arch = "spirv"))]
    type Packet: Lanes<S>;
}

/// What every processor of the target has.
pub struct Native;

impl<S: Scalar> Vectors<S> for Native {
    type Eight = S::Eight;
    #[cfg(not(target_arch = "spirv"))]
    type Four = S::Four;
    #[cfg(not(target_arch = "spirv"))]
    type Packet = S::Packet;
}

/// A processor with AVX-512.
#[cfg(target_arch = "x86_64")]
pub struct Avx512;

#[cfg(target_arch = "x86_64")]
impl Vectors<f32> for Avx512 {
    type Eight = <Avx2 as Vectors<f32>>::Eight;
    type Four = Wide<4>;
    type Packet = Wide<16>;
}

/// A single lane, as shading takes it.
pub trait Scalar: Real<Mask = bool, Index = u32> {
    /// What tests the boxes of a wide node.
    type Eight: Octet<Self>;
    /// What tests the triangles of a wide node.
    #[cfg(not(target_arch = "spirv"))]
    type Four: Lanes<Self>;
    /// What follows rays together.
    #[cfg(not(target_arch = "spirv"))]
    type Packet: Lanes<Self>;
    /// The vectors of a processor with AVX2, if these numbers have any use for them.
    #[cfg(target_arch = "x86_64")]
    type Avx2: Vectors<Self>;
    /// The vectors of a processor with AVX-512.
    #[cfg(target_arch = "x86_64")]
    type Avx512: Vectors<Self>;
    /// Are there other vectors than [`Native`] ones?
    #[cfg(not(target_arch = "spirv"))]
    const VECTORISES: bool = false;
    /// Three numbers and an integer in device memory.
    type Record: Copy + Default;

    /// Packs three numbers and an integer.
    fn store(v: V3<Self>, word: u32) -> Self::Record;
    /// What [`Scalar::store`] packed.
    fn load(record: Self::Record) -> (V3<Self>, u32);
    /// `self` to the power of `exponent`, both at least 0; zero below 2^-100.
    fn pow(self, exponent: Self) -> Self;
    /// The whole number at or below, for magnitudes up to 2^23 (clamped there).
    fn floor_index(self) -> i32;
    /// Rounded to single precision, as a film holds it.
    fn to_f32(self) -> f32;
    /// Neither NaN nor infinite?
    fn is_finite(self) -> bool;
}

/// A single number is a lane.
macro_rules! one_lane {
    ($type:ty) => {
        impl Lanes<$type> for $type {
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
            fn index_of(index: u32, _: usize) -> u32 {
                index
            }
            #[cfg(not(target_arch = "spirv"))]
            #[inline(always)]
            fn taken(numbers: &[f32]) -> Self {
                Self::splat(numbers[0])
            }
            #[cfg(not(target_arch = "spirv"))]
            #[inline(always)]
            fn put(self, numbers: &mut [f32]) {
                numbers[0] = self.to_f32();
            }
            #[inline(always)]
            fn vectors(records: &[UVec4]) -> V3<$type> {
                V3::splat(numbers(records[0]))
            }
            #[inline(always)]
            fn bits(mask: bool) -> u32 {
                mask as u32
            }
            #[inline(always)]
            fn every(holds: bool) -> bool {
                holds
            }
        }
    };
}
one_lane!(f32);
one_lane!(Fast);
#[cfg(not(target_arch = "spirv"))]
one_lane!(f64);

/// Byte `i` of two words.
#[inline(always)]
fn byte(words: [u32; 2], i: u32) -> u32 {
    let word = if i < 4 { words[0] } else { words[1] };
    (word >> (8 * (i & 3))) & 255
}

/// The places of four children, of all at once (Ylitie et al. 2017, appendix).
#[inline(always)]
fn places(children: u32, inverted: u32) -> u32 {
    // Bits 3 and 4 are set from 24 on.
    let is_inner = ((children & (children << 1) & 0x1010_1010) >> 4) * 0xff;
    (children ^ ((inverted * 0x0101_0101) & is_inner)) & 0x1f1f_1f1f
}

/// One box at a time.
macro_rules! octet_of_one {
    ($type:ty) => {
        impl Octet<$type> for $type {
            #[inline(always)]
            fn bytes(words: [u32; 2], first: u32) -> Self {
                Self::splat(byte(words, first) as f32)
            }
            type Kept = ();
            #[inline(always)]
            fn keep(self) {}
            #[inline(always)]
            fn kept(_: &(), _: u32) -> $type {
                Self::splat(f32::MIN)
            }
            type Children = ([u32; 2], [u32; 2]);
            #[inline(always)]
            fn children(words: [u32; 2], inverted: u32) -> Self::Children {
                let bits = [(words[0] >> 5) & 0x0707_0707, (words[1] >> 5) & 0x0707_0707];
                (bits, [places(words[0], inverted), places(words[1], inverted)])
            }
            #[inline(always)]
            fn waiting(met: bool, (bits, places): &Self::Children, first: u32) -> u32 {
                if met { byte(*bits, first) << byte(*places, first) } else { 0 }
            }
        }
    };
}

#[cfg(target_arch = "spirv")]
octet_of_one!(f32);
#[cfg(target_arch = "spirv")]
octet_of_one!(Fast);
#[cfg(not(target_arch = "spirv"))]
octet_of_one!(f64);

/// Products of two numbers of at least this magnitude, and sums of such products, are normal.
pub const SMALL: f32 = 1.0 / (1u64 << 40) as f32;
/// A coordinate or direction below this is zero.
pub const TINY: f32 = 1.0 / (1u64 << 60) as f32;
/// A contribution below this is zero: 2^-100.
pub const FAINT: f32 = TINY * SMALL;
