//! Eight numbers in a register: [`Wide<8>`](super::Wide) where the compiler must not miss an instruction.

use core::arch::x86_64::*;
use core::array::from_fn;
use core::mem::transmute;
use core::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

use glam::UVec4;

use super::{Lanes, Mask, Octet, Real, V3, Vectors, Wide, WideIndex, WideMask};
use crate::ray::{Hit, Ray};

/// A processor with AVX2 and FMA. Nobody else may follow rays over these vectors.
pub struct Avx2;

impl Vectors<f32> for Avx2 {
    type Eight = Eight;
    type Four = Wide<4>;
    type Packet = Wide<16>;
}

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Eight(__m256);

/// Eight truth values, all bits set or none.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct EightMask(__m256);

/// Eight integers.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct EightIndex(__m256i);

/// An operation by one instruction or two.
macro_rules! instruction {
    ($(fn $name:ident($($arg:tt $(: $type:ty)?),*) -> $result:ty { $body:expr })*) => {$(
        #[inline(always)]
        fn $name($($arg $(: $type)?),*) -> $result {
            // SAFETY: plain arithmetic, on a processor that has the instruction: who names `Avx2` promises that.
            unsafe { $body }
        }
    )*};
}

macro_rules! operator {
    ($type:ident, $trait:ident, $name:ident, $instruction:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: as in `instruction`.
                unsafe { $type($instruction(self.0, other.0)) }
            }
        }
    };
}
operator!(Eight, Add, add, _mm256_add_ps);
operator!(Eight, Sub, sub, _mm256_sub_ps);
operator!(Eight, Mul, mul, _mm256_mul_ps);
operator!(EightMask, BitAnd, bitand, _mm256_and_ps);
operator!(EightMask, BitOr, bitor, _mm256_or_ps);

impl Neg for Eight {
    type Output = Self;
    instruction! {
        fn neg(self) -> Self { Eight(_mm256_xor_ps(self.0, _mm256_set1_ps(-0.0))) }
    }
}

impl Not for EightMask {
    type Output = Self;
    instruction! {
        fn not(self) -> Self {
            EightMask(_mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1))))
        }
    }
}

impl Mask for EightMask {
    #[inline(always)]
    fn any(self) -> bool {
        Eight::bits(self) != 0
    }
    #[inline(always)]
    fn count(self) -> u32 {
        Eight::bits(self).count_ones()
    }
}

impl EightMask {
    #[inline(always)]
    fn wide(self) -> WideMask<8> {
        // SAFETY: eight words either way.
        WideMask(unsafe { transmute::<__m256, [u32; 8]>(self.0) })
    }
}

impl EightIndex {
    #[inline(always)]
    fn wide(self) -> WideIndex<8> {
        // SAFETY: eight words either way.
        WideIndex(unsafe { transmute::<__m256i, [u32; 8]>(self.0) })
    }
}

/// The bytes of two words, the lowest first, as integers.
#[inline(always)]
fn integers(words: [u32; 2]) -> EightIndex {
    let bytes = u64::from(words[1]) << 32 | u64::from(words[0]);
    // SAFETY: as in `instruction`.
    EightIndex(unsafe { _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(bytes as i64)) })
}

impl Eight {
    #[inline(always)]
    fn wide(self) -> Wide<8> {
        // SAFETY: eight numbers either way.
        Wide(unsafe { transmute::<__m256, [f32; 8]>(self.0) })
    }

    instruction! {
        fn by_sign(self) -> Self { Eight(_mm256_and_ps(self.0, _mm256_set1_ps(-0.0))) }
        fn loaded(from: [f32; 8]) -> Self { Eight(_mm256_loadu_ps(from.as_ptr())) }
    }

    /// Subnormals become zeros of their sign.
    #[inline(always)]
    fn normal(self) -> Self {
        Self::select(self.abs().lt(Self::splat(f32::MIN_POSITIVE)), self.by_sign(), self)
    }
}

impl Real for Eight {
    type Mask = EightMask;
    type Index = EightIndex;
    type Lane = f32;
    // SAFETY: any bits are eight numbers.
    const ROUNDOFF: Self = Eight(unsafe { transmute::<[f32; 8], __m256>([<f32 as Real>::ROUNDOFF; 8]) });

    instruction! {
        fn splat(x: f32) -> Self { Eight(_mm256_set1_ps(x)) }
        fn lt(self, other: Self) -> EightMask { EightMask(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) }
        fn le(self, other: Self) -> EightMask { EightMask(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) }
        fn same(self, other: Self) -> EightMask { EightMask(_mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0)) }
        fn select(mask: EightMask, a: Self, b: Self) -> Self { Eight(_mm256_blendv_ps(b.0, a.0, mask.0)) }
        fn abs(self) -> Self { Eight(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)) }
        // The instructions return the second operand for NaN and for two zeros, as compare and select do.
        fn min(self, other: Self) -> Self { Eight(_mm256_min_ps(self.0, other.0)) }
        fn max(self, other: Self) -> Self { Eight(_mm256_max_ps(self.0, other.0)) }
        fn fused(self, a: Self, b: Self) -> Self { Eight(_mm256_fmadd_ps(self.0, a.0, b.0)) }
        fn index(i: u32) -> EightIndex { EightIndex(_mm256_set1_epi32(i as i32)) }
        fn equals(i: u32, other: EightIndex) -> EightMask {
            EightMask(_mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_set1_epi32(i as i32), other.0)))
        }
        fn select_index(mask: EightMask, a: EightIndex, b: EightIndex) -> EightIndex {
            EightIndex(_mm256_blendv_epi8(b.0, a.0, _mm256_castps_si256(mask.0)))
        }
    }

    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        // SAFETY: as in `instruction`.
        Eight(unsafe { _mm256_div_ps(self.normal().0, divisor.normal().0) }).normal()
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as in `instruction`.
        Eight(unsafe { _mm256_sqrt_ps(self.normal().0) })
    }

    #[inline(always)]
    fn precedes(i: u32, other: EightIndex) -> EightMask {
        // Only signed integers compare: both move by the same step.
        // SAFETY: as in `instruction`.
        unsafe {
            let step = _mm256_set1_epi32(i32::MIN);
            let (i, other) = (_mm256_set1_epi32(i as i32 ^ i32::MIN), _mm256_xor_si256(other.0, step));
            EightMask(_mm256_castsi256_ps(_mm256_cmpgt_epi32(other, i)))
        }
    }

    #[inline(always)]
    fn lanes(ray: &Ray<Self>, hit: &mut Hit<Self>, mask: EightMask, mut f: impl FnMut(&Ray<f32>, &mut Hit<f32>)) {
        let wide = Ray {
            origin: ray.origin.each(Eight::wide),
            inverse: ray.inverse.each(Eight::wide),
            offset: ray.offset.each(Eight::wide),
            shear: ray.shear.each(Eight::wide, EightMask::wide),
            leaves: ray.leaves.wide(),
        };
        let mut lanes = Hit {
            t: hit.t.wide(),
            u: hit.u.wide(),
            v: hit.v.wide(),
            scale: hit.scale.wide(),
            slot: hit.slot.wide(),
            primitive: hit.primitive.wide(),
        };
        Wide::<8>::lanes(&wide, &mut lanes, mask.wide(), &mut f);
        let number = |w: Wide<8>| Eight::loaded(w.0);
        let index = |w: WideIndex<8>| Self::indices(|i| w.0[i]);
        *hit = Hit {
            t: number(lanes.t),
            u: number(lanes.u),
            v: number(lanes.v),
            scale: number(lanes.scale),
            slot: index(lanes.slot),
            primitive: index(lanes.primitive),
        };
    }
}

impl Lanes<f32> for Eight {
    const COUNT: u32 = 8;

    #[inline(always)]
    fn all(x: f32) -> Self {
        Self::splat(x)
    }
    #[inline(always)]
    fn of(number: impl Fn(usize) -> f32) -> Self {
        Self::loaded(from_fn(number))
    }
    #[inline(always)]
    fn indices(index: impl Fn(usize) -> u32) -> EightIndex {
        // SAFETY: any bits are eight integers.
        EightIndex(unsafe { transmute::<[u32; 8], __m256i>(from_fn(index)) })
    }
    #[inline(always)]
    fn lane(&self, i: usize) -> f32 {
        self.wide().0[i]
    }
    #[inline(always)]
    fn index_of(index: EightIndex, i: usize) -> u32 {
        index.wide().0[i]
    }
    #[inline(always)]
    fn taken(numbers: &[f32]) -> Self {
        let numbers = &numbers[..8];
        // SAFETY: there are eight numbers.
        Eight(unsafe { _mm256_loadu_ps(numbers.as_ptr()) })
    }
    #[inline(always)]
    fn put(self, numbers: &mut [f32]) {
        let numbers = &mut numbers[..8];
        // SAFETY: there is room for eight numbers.
        unsafe { _mm256_storeu_ps(numbers.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn vectors(records: &[UVec4]) -> V3<Self> {
        let number = |of: fn(&UVec4) -> u32| Self::of(|i| f32::from_bits(of(&records[i])));
        V3::new(number(|r| r.x), number(|r| r.y), number(|r| r.z))
    }
    instruction! {
        fn bits(mask: EightMask) -> u32 { _mm256_movemask_ps(mask.0) as u32 }
        fn every(holds: bool) -> EightMask {
            EightMask(_mm256_castsi256_ps(_mm256_set1_epi32(if holds { -1 } else { 0 })))
        }
    }
}

impl Octet<f32> for Eight {
    instruction! {
        fn bytes(words: [u32; 2], _first: u32) -> Self { Eight(_mm256_cvtepi32_ps(integers(words).0)) }
    }

    // Numbers are swapped, since a choice between words would be a branch or twelve moves.
    #[inline(always)]
    fn sides(swapped: bool, low: [u32; 2], high: [u32; 2], first: u32) -> (Self, Self) {
        let (low, high, swapped) = (Self::bytes(low, first), Self::bytes(high, first), Self::every(swapped));
        (Self::select(swapped, high, low), Self::select(swapped, low, high))
    }

    type Kept = [f32; 8];

    #[inline(always)]
    fn keep(self) -> [f32; 8] {
        self.wide().0
    }

    #[inline(always)]
    fn kept(kept: &[f32; 8], i: u32) -> f32 {
        kept[i as usize & 7]
    }

    type Children = EightIndex;

    instruction! {
        fn children(words: [u32; 2], inverted: u32) -> EightIndex {{
            let (child, inner) = (integers(words).0, _mm256_set1_epi32(24));
            let is_inner = _mm256_cmpeq_epi32(_mm256_and_si256(child, inner), inner);
            let turned = _mm256_and_si256(is_inner, _mm256_set1_epi32(inverted as i32));
            let place = _mm256_and_si256(child, _mm256_set1_epi32(31));
            EightIndex(_mm256_sllv_epi32(_mm256_srli_epi32::<5>(child), _mm256_xor_si256(place, turned)))
        }}
    }

    #[inline(always)]
    fn waiting(met: EightMask, children: &EightIndex, _first: u32) -> u32 {
        let (met, children) = (met.wide().0, children.wide().0);
        (0..8).fold(0, |all, i| all | met[i] & children[i])
    }
}
