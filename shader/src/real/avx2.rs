//! AVX2 registers: as [`F32xN<8>`](super::F32xN) and [`F32xN<4>`](super::F32xN), with intrinsics where the compiler's
//! vectorisation is not to be relied on.

use core::arch::x86_64::*;
use core::array::from_fn;
use core::mem::transmute;
use core::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

use super::{F32xN, FAINT, Lanes, Mask, Real, SimdIsa, U32xN};

/// A processor with AVX2 and FMA. Not public: its vectors' safe functions are instructions that other processors lack, so
/// [`Scalar::run_avx2`](super::Scalar::run_avx2) and [`run_avx512`](super::Scalar::run_avx512), which are unsafe, must stay
/// the only ways to them.
pub(crate) enum Avx2 {}

impl SimdIsa<f32> for Avx2 {
    type Eight = Eight;
    type Four = Four;
    type Packet = F32xN<16>;
}

/// Operations of one or two instructions.
macro_rules! instruction {
    ($(fn $name:ident($($arg:tt $(: $type:ty)?),*) -> $result:ty { $body:expr })*) => {$(
        #[inline(always)]
        fn $name($($arg $(: $type)?),*) -> $result {
            // SAFETY: plain arithmetic, on a processor that has the instruction: see `Avx2`.
            unsafe { $body }
        }
    )*};
}

/// Registers of `$count` numbers, truth values and integers, and their instructions.
macro_rules! registers {
    (
        $what:literal, $number:ident($floats:ty), $mask:ident, $index:ident($integers:ty), $count:literal;
        add: $add:ident, sub: $sub:ident, mul: $mul:ident, div: $div:ident, sqrt: $sqrt:ident, fused: $fused:ident, fused_minus: $fused_minus:ident,
        min: $min:ident, max: $max:ident, and: $and:ident, or: $or:ident, xor: $xor:ident, without: $without:ident,
        compare: $compare:ident, blend: $blend:ident, blend_bytes: $blend_bytes:ident, bits: $bits:ident,
        all: $all:ident, all_integers: $all_integers:ident, equal: $equal:ident, greater: $greater:ident,
        xor_integers: $xor_integers:ident, as_floats: $as_floats:ident, as_integers: $as_integers:ident,
        load: $load:ident, store: $store:ident
    ) => {
        #[doc = concat!($what, " numbers.")]
        #[derive(Clone, Copy, Debug)]
        #[repr(transparent)]
        pub struct $number($floats);

        #[doc = concat!($what, " truth values, all bits set or none.")]
        #[derive(Clone, Copy, Debug)]
        #[repr(transparent)]
        pub struct $mask($floats);

        #[doc = concat!($what, " integers.")]
        #[derive(Clone, Copy, Debug)]
        #[repr(transparent)]
        pub struct $index($integers);

        impl Add for $number {
            type Output = Self;
            instruction! { fn add(self, other: Self) -> Self { $number($add(self.0, other.0)) } }
        }

        impl Sub for $number {
            type Output = Self;
            instruction! { fn sub(self, other: Self) -> Self { $number($sub(self.0, other.0)) } }
        }

        impl Mul for $number {
            type Output = Self;
            instruction! { fn mul(self, other: Self) -> Self { $number($mul(self.0, other.0)) } }
        }

        impl Neg for $number {
            type Output = Self;
            instruction! { fn neg(self) -> Self { $number($xor(self.0, $all(-0.0))) } }
        }

        impl BitAnd for $mask {
            type Output = Self;
            instruction! { fn bitand(self, other: Self) -> Self { $mask($and(self.0, other.0)) } }
        }

        impl BitOr for $mask {
            type Output = Self;
            instruction! { fn bitor(self, other: Self) -> Self { $mask($or(self.0, other.0)) } }
        }

        impl Not for $mask {
            type Output = Self;
            instruction! { fn not(self) -> Self { $mask($xor(self.0, $as_floats($all_integers(-1)))) } }
        }

        impl Mask for $mask {
            #[inline(always)]
            fn any(self) -> bool {
                $number::bits(self) != 0
            }
            #[inline(always)]
            fn count(self) -> u32 {
                $number::bits(self).count_ones()
            }
        }

        impl $index {
            #[inline(always)]
            fn arrays(self) -> U32xN<$count> {
                // SAFETY: as many words either way.
                U32xN(unsafe { transmute::<$integers, [u32; $count]>(self.0) })
            }
        }

        impl $number {
            #[inline(always)]
            fn arrays(self) -> F32xN<$count> {
                // SAFETY: as many numbers either way.
                F32xN(unsafe { transmute::<$floats, [f32; $count]>(self.0) })
            }

            instruction! {
                fn by_sign(self) -> Self { $number($and(self.0, $all(-0.0))) }
            }

            /// Flushes subnormals to zeros of their sign.
            #[inline(always)]
            fn normal(self) -> Self {
                Self::select(self.abs().lt(Self::splat(f32::MIN_POSITIVE)), self.by_sign(), self)
            }
        }

        impl Real for $number {
            type Mask = $mask;
            type Index = $index;
            const ROUNDOFF: Self = {
                // SAFETY: any bits are numbers.
                $number(unsafe { transmute::<[f32; $count], $floats>([<f32 as Real>::ROUNDOFF; $count]) })
            };

            #[inline(always)]
            fn sieve(mask: $mask, numbers: [Self; 5], mut test: impl FnMut([f32; 5]) -> bool) -> $mask {
                let asked = <Self as Lanes<f32>>::bits(mask);
                let lanes = numbers.map(|number| {
                    let mut lanes = [0.0; $count];
                    Lanes::<f32>::put(number, &mut lanes);
                    lanes
                });
                let mut kept = [0.0; $count];
                for (i, kept) in kept.iter_mut().enumerate() {
                    if asked >> i & 1 == 1 && test(lanes.map(|lanes| lanes[i])) {
                        *kept = 1.0;
                    }
                }
                mask & Self::splat(0.0).lt(<Self as Lanes<f32>>::taken(&kept))
            }

            instruction! {
                fn splat(x: f32) -> Self { $number($all(x)) }
                fn lt(self, other: Self) -> $mask { $mask($compare::<_CMP_LT_OQ>(self.0, other.0)) }
                fn le(self, other: Self) -> $mask { $mask($compare::<_CMP_LE_OQ>(self.0, other.0)) }
                fn eq(self, other: Self) -> $mask { $mask($compare::<_CMP_EQ_OQ>(self.0, other.0)) }
                fn select(mask: $mask, a: Self, b: Self) -> Self { $number($blend(b.0, a.0, mask.0)) }
                fn abs(self) -> Self { $number($without($all(-0.0), self.0)) }
                // For NaN and for two zeros these instructions return the second operand, as compare and select do.
                fn min(self, other: Self) -> Self { $number($min(self.0, other.0)) }
                fn max(self, other: Self) -> Self { $number($max(self.0, other.0)) }
                fn fused(self, a: Self, b: Self) -> Self { $number($fused(self.0, a.0, b.0)) }
                fn flush(self, least: f32) -> Self {
                    $number($without(self.abs().lt(Self::splat(least)).0, self.0))
                }
                fn index(i: u32) -> $index { $index($all_integers(i as i32)) }
                fn equals(i: u32, other: $index) -> $mask {
                    $mask($as_floats($equal($all_integers(i as i32), other.0)))
                }
                // There is only a signed comparison, so both operands are offset by 2^31.
                fn precedes(i: u32, other: $index) -> $mask {
                    $mask($as_floats($greater(
                        $xor_integers(other.0, $all_integers(i32::MIN)),
                        $all_integers(i as i32 ^ i32::MIN),
                    )))
                }
                fn select_index(mask: $mask, a: $index, b: $index) -> $index {
                    $index($blend_bytes(b.0, a.0, $as_integers(mask.0)))
                }
                fn sqrt(self) -> Self { $number($sqrt(self.normal().0)) }
            }

            #[inline(always)]
            fn div(self, divisor: Self) -> Self {
                // SAFETY: as in `instruction`.
                $number(unsafe { $div(self.normal().0, divisor.normal().0) }).normal()
            }

            instruction! {
                fn product_and_rest(self, other: Self) -> (Self, Self) {{
                    let product = $mul(self.0, other.0);
                    // One rounding of a product less its rounded self is none: the bits of the halves' products.
                    (Self(product), Self($fused_minus(self.0, other.0, product)).flush(FAINT))
                }}
            }
        }

        impl Lanes<f32> for $number {
            const COUNT: u32 = $count;

            #[inline(always)]
            fn all(x: f32) -> Self {
                Self::splat(x)
            }
            #[inline(always)]
            fn of(number: impl Fn(usize) -> f32) -> Self {
                Self::taken(&from_fn::<f32, $count, _>(number))
            }
            #[inline(always)]
            fn indices(index: impl Fn(usize) -> u32) -> $index {
                // SAFETY: any bits are integers.
                $index(unsafe { transmute::<[u32; $count], $integers>(from_fn(index)) })
            }
            #[inline(always)]
            fn lane(&self, i: usize) -> f32 {
                self.arrays().0[i & ($count - 1)]
            }
            #[inline(always)]
            fn set_lane(&mut self, i: usize, x: f32) {
                let mut lanes = self.arrays().0;
                lanes[i & ($count - 1)] = x;
                *self = Self::taken(&lanes);
            }
            #[inline(always)]
            fn set_index(index: &mut $index, i: usize, x: u32) {
                let mut lanes = index.arrays().0;
                lanes[i & ($count - 1)] = x;
                *index = Self::indices(|i| lanes[i]);
            }
            #[inline(always)]
            fn index_of(index: $index, i: usize) -> u32 {
                index.arrays().0[i & ($count - 1)]
            }
            #[inline(always)]
            fn taken(numbers: &[f32]) -> Self {
                let numbers = &numbers[..$count];
                // SAFETY: there are so many numbers.
                $number(unsafe { $load(numbers.as_ptr()) })
            }
            #[inline(always)]
            fn put(self, numbers: &mut [f32]) {
                let numbers = &mut numbers[..$count];
                // SAFETY: there is room for so many numbers.
                unsafe { $store(numbers.as_mut_ptr(), self.0) }
            }
            instruction! {
                fn bits(mask: $mask) -> u32 { $bits(mask.0) as u32 }
            }
        }
    };
}

registers! {
    "Eight", Eight(__m256), EightMask, EightIndex(__m256i), 8;
    add: _mm256_add_ps, sub: _mm256_sub_ps, mul: _mm256_mul_ps, div: _mm256_div_ps, sqrt: _mm256_sqrt_ps,
    fused: _mm256_fmadd_ps, fused_minus: _mm256_fmsub_ps, min: _mm256_min_ps, max: _mm256_max_ps, and: _mm256_and_ps, or: _mm256_or_ps,
    xor: _mm256_xor_ps, without: _mm256_andnot_ps, compare: _mm256_cmp_ps, blend: _mm256_blendv_ps,
    blend_bytes: _mm256_blendv_epi8, bits: _mm256_movemask_ps, all: _mm256_set1_ps, all_integers: _mm256_set1_epi32,
    equal: _mm256_cmpeq_epi32, greater: _mm256_cmpgt_epi32, xor_integers: _mm256_xor_si256,
    as_floats: _mm256_castsi256_ps, as_integers: _mm256_castps_si256,
    load: _mm256_loadu_ps, store: _mm256_storeu_ps
}

registers! {
    "Four", Four(__m128), FourMask, FourIndex(__m128i), 4;
    add: _mm_add_ps, sub: _mm_sub_ps, mul: _mm_mul_ps, div: _mm_div_ps, sqrt: _mm_sqrt_ps,
    fused: _mm_fmadd_ps, fused_minus: _mm_fmsub_ps, min: _mm_min_ps, max: _mm_max_ps, and: _mm_and_ps, or: _mm_or_ps,
    xor: _mm_xor_ps, without: _mm_andnot_ps, compare: _mm_cmp_ps, blend: _mm_blendv_ps,
    blend_bytes: _mm_blendv_epi8, bits: _mm_movemask_ps, all: _mm_set1_ps, all_integers: _mm_set1_epi32,
    equal: _mm_cmpeq_epi32, greater: _mm_cmpgt_epi32, xor_integers: _mm_xor_si128,
    as_floats: _mm_castsi128_ps, as_integers: _mm_castps_si128,
    load: _mm_loadu_ps, store: _mm_storeu_ps
}
