//! What AVX-512 does beside the registers of AVX2, which it shares but for those of packets.

use core::arch::x86_64::*;
use core::mem::transmute;

use super::{Avx2, F32xN, SimdIsa};

/// A processor with AVX-512; not public, as [`Avx2`].
pub(crate) enum Avx512 {}

impl SimdIsa<f32> for Avx512 {
    type Eight = <Avx2 as SimdIsa<f32>>::Eight;
    type Four = <Avx2 as SimdIsa<f32>>::Four;
    type Packet = F32xN<16>;

    #[inline(always)]
    fn sorted(lanes: u32, high: &[f32; 8], low: &[u32; 8]) -> Option<[u64; 8]> {
        // SAFETY: loads of eight numbers each and plain arithmetic, on a processor that has the instructions: see `Avx2`.
        unsafe {
            let high = _mm512_cvtepu32_epi64(_mm256_loadu_si256(high.as_ptr().cast()));
            let low = _mm512_cvtepu32_epi64(_mm256_loadu_si256(low.as_ptr().cast()));
            let all = _mm512_or_si512(_mm512_slli_epi64::<32>(high), low);
            Some(transmute::<__m512i, [u64; 8]>(descending(_mm512_maskz_mov_epi64(lanes as u8, all))))
        }
    }
}

/// A bitonic network: in each step every lane takes the greater or the less of its own number and that of its partner.
#[inline(always)]
unsafe fn descending(x: __m512i) -> __m512i {
    // SAFETY: as above.
    unsafe {
        let step = |x, partner, greater| _mm512_mask_max_epu64(_mm512_min_epu64(x, partner), greater, x, partner);
        let x = step(x, _mm512_shuffle_epi32::<0x4e>(x), 0b1001_1001);
        let x = step(x, _mm512_permutex_epi64::<0x4e>(x), 0b1100_0011);
        let x = step(x, _mm512_shuffle_epi32::<0x4e>(x), 0b1010_0101);
        let x = step(x, _mm512_shuffle_i64x2::<0x4e>(x, x), 0b0000_1111);
        let x = step(x, _mm512_permutex_epi64::<0x4e>(x), 0b0011_0011);
        step(x, _mm512_shuffle_epi32::<0x4e>(x), 0b0101_0101)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn lanes_are_sorted_as_integers_are(
            lanes in 0u32..256, high in prop::array::uniform8(prop_oneof![Just(0f32), 0f32..2.0]), low in prop::array::uniform8(1u32..),
        ) {
            if !(std::arch::is_x86_feature_detected!("avx512f") && std::arch::is_x86_feature_detected!("avx512vl")) {
                return Ok(());
            }
            let of = |lane: usize| u64::from(high[lane].to_bits()) << 32 | u64::from(low[lane]);
            let mut expected = [0, 1, 2, 3, 4, 5, 6, 7].map(|lane| if lanes >> lane & 1 == 1 { of(lane) } else { 0 });
            expected.sort_by(|a, b| b.cmp(a));
            prop_assert_eq!(Avx512::sorted(lanes, &high, &low), Some(expected));
        }
    }
}
