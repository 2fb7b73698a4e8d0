//! Sobol's sequence, shuffled and scrambled as Owen does it (Burley, Practical Hash-based Owen Scrambling, 2020).

use glam::UVec4;

/// A point of the first two dimensions of the sequence in steps of 2^-32. Every aligned run of 2^k points has one in each of the 2^k boxes of
/// equal size, of every shape that halving gives.
#[inline(always)]
pub fn sobol(index: u32, seeds: [u32; 3]) -> [u32; 2] {
    let index = scrambled(index.reverse_bits(), seeds[0]).reverse_bits();
    [scrambled(index, seeds[1]).reverse_bits(), scrambled(pascal(index), seeds[2]).reverse_bits()]
}

/// A point of the first dimension, likewise.
#[inline(always)]
pub fn van_der_corput(index: u32, seeds: [u32; 3]) -> u32 {
    let index = scrambled(index.reverse_bits(), seeds[0]).reverse_bits();
    scrambled(index, seeds[1]).reverse_bits()
}

/// A point of the first four dimensions. The first two are those of [`sobol`] with the same seeds.
#[inline(always)]
pub fn sobol4(index: u32, seeds: [u32; 3], further: [u32; 2]) -> UVec4 {
    let index = scrambled(index.reverse_bits(), seeds[0]).reverse_bits();
    UVec4::new(
        scrambled(index, seeds[1]).reverse_bits(),
        scrambled(pascal(index), seeds[2]).reverse_bits(),
        scrambled(third(index), further[0]).reverse_bits(),
        scrambled(fourth(index), further[1]).reverse_bits(),
    )
}

/// The digits of the second dimension, the first digit lowest: the index times Pascal's triangle modulo 2. That is the
/// polynomial whose coefficients are the digits, for x + 1 in the place of x.
#[inline(always)]
fn pascal(index: u32) -> u32 {
    let x = index ^ ((index & 0xaaaa_aaaa) >> 1);
    let x = x ^ ((x & 0xcccc_cccc) >> 2);
    let x = x ^ ((x & 0xf0f0_f0f0) >> 4);
    let x = x ^ ((x & 0xff00_ff00) >> 8);
    x ^ (x >> 16)
}

/// The digits of the third dimension, the first digit lowest: those of the index in base x^2 + x + 1 as a polynomial modulo 2.
/// (Tezuka, Polynomial Arithmetic Analogue of Halton Sequences, 1993. Sobol's own directions differ from these by what Owen's
/// scrambling draws anyway.) The square of a polynomial has the squares of its terms, so blocks are halved by division by
/// x^16 + x^8 + 1, x^8 + x^4 + 1 and so on: without loops, which took a compiler of lavapipe longer than anyone waits.
#[inline(always)]
fn third(index: u32) -> u32 {
    let x = halved(index, 8, 0x0000_ffff, 0x0000_00ff);
    let x = halved(x, 4, 0x00ff_00ff, 0x000f_000f);
    let x = halved(x, 2, 0x0f0f_0f0f, 0x0303_0303);
    halved(x, 1, 0x3333_3333, 0x1111_1111)
}

/// Divides each block by x^2m + x^m + 1: `half` has the lower halves' bits, `quarter` their lower halves'.
#[inline(always)]
fn halved(x: u32, m: u32, half: u32, quarter: u32) -> u32 {
    let upper = (x >> (2 * m)) & half;
    let over = (upper >> m) & quarter;
    let rest = (x & half) ^ upper ^ ((upper << m) & half) ^ over ^ (over << m);
    rest | ((upper ^ over) << (2 * m))
}

/// The digits of the fourth dimension, likewise in base x^3 + x + 1, by x^24 + x^8 + 1, x^12 + x^4 + 1 and so on. Its blocks do not
/// fill a word: the highest ones are shorter.
#[inline(always)]
fn fourth(index: u32) -> u32 {
    let upper = index >> 24;
    let x = index ^ upper ^ (upper << 8);
    let x = divided(x & 0x00ff_ffff, 4, 0x0000_0fff, 0x0000_000f) | (x & 0xff00_0000);
    let x = divided(x, 2, 0x3f03_f03f, 0x0300_3003);
    divided(x & 0x3fff_ffff, 1, 0x071c_71c7, 0x0104_1041) | (x & 0xc000_0000)
}

/// Divides each block by x^3m + x^m + 1: `half` has the lower halves' bits, `third` their lowest thirds'.
#[inline(always)]
fn divided(x: u32, m: u32, half: u32, third: u32) -> u32 {
    let upper = (x >> (3 * m)) & half;
    let over = (upper >> (2 * m)) & third;
    let rest = (x & half) ^ upper ^ ((upper << m) & half) ^ over ^ (over << m);
    rest | ((upper ^ over) << (3 * m))
}

/// Flips each digit as a hash of the lower ones says (Laine and Karras 2011, with the constants of Vegdahl, Owen Scrambling
/// Based Blue-noise Dithered Sampling and its notes, 2021). The first digit of the number is the lowest one here.
#[inline(always)]
fn scrambled(digits: u32, seed: u32) -> u32 {
    let x = digits ^ digits.wrapping_mul(0x3d20_adea);
    let x = x.wrapping_add(seed);
    let x = x.wrapping_mul((seed >> 16) | 1);
    let x = x ^ x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// A digit is flipped by what lies below it and by nothing above, and by either half of the seed.
    #[test]
    fn digits_are_flipped_by_lower_ones_and_the_seed() {
        let drawn = |i: u32| crate::sampler::hash([i, 1, 2]);
        for bit in 0..32 {
            let flipped = |change: &dyn Fn([u32; 2]) -> [u32; 2]| {
                let differs = |i| {
                    let [x, seed, _] = drawn(i);
                    let [other, another] = change([x, seed]);
                    (scrambled(x, seed) ^ x ^ scrambled(other, another) ^ other) >> bit & 1
                };
                (0..4096).map(differs).sum::<u32>()
            };
            let above = flipped(&|[x, seed]| [x ^ (0xffff_fffe << bit), seed]);
            let (low, high) = (flipped(&|[x, seed]| [x, seed ^ 0xffff]), flipped(&|[x, seed]| [x, seed ^ 0xffff_0000]));
            assert_eq!(above, 0, "digit {bit}");
            assert!(bit < 4 || (300..3800).contains(&low), "digit {bit}: {low}");
            assert!(bit < 4 || (300..3800).contains(&high), "digit {bit}: {high}");
        }
    }

    /// As the digits themselves give it.
    #[test]
    fn pascals_triangle_modulo_two() {
        let mut column = [0u32; 32];
        column[0] = 1;
        for i in 1..32 {
            // Row i of the triangle: which digits of the result digit i of the index flips.
            column[i] = column[i - 1] ^ (column[i - 1] << 1);
        }
        for index in [0u32, 1, 2, 3, 0x8000_0000, 0xdead_beef, u32::MAX] {
            let want = (0..32).filter(|&i| index >> i & 1 == 1).fold(0, |sum, i| sum ^ column[i]);
            assert_eq!(pascal(index), want, "{index:x}");
        }
    }

    /// As long division gives them, remainder after remainder.
    #[test]
    fn further_dimensions_are_digits_in_a_base_of_polynomials() {
        let digits = |mut n: u64, base: u64, degree: u32| {
            let (mut digits, mut place) = (0u64, 0);
            while n != 0 {
                let mut quotient = 0;
                while n >> degree != 0 {
                    let shift = 63 - n.leading_zeros() - degree;
                    n ^= base << shift;
                    quotient |= 1 << shift;
                }
                digits |= n << place;
                place += degree;
                n = quotient;
            }
            digits as u32
        };
        for index in (0..5000).chain([0x8000_0001, 0xdead_beef, 0xc000_0000, u32::MAX]) {
            assert_eq!(third(index), digits(u64::from(index), 0b111, 2), "{index:x}");
            assert_eq!(fourth(index), digits(u64::from(index), 0b1011, 3), "{index:x}");
        }
    }

    /// A (3, k, 4)-net, as Sobol's: 8 points in each box of 2^3 times its size.
    #[test]
    fn every_aligned_run_is_as_even_in_four_dimensions() {
        let k = 9u32;
        for seed in 0..8 {
            let [a, b, c] = crate::sampler::hash([seed, 6, 0]);
            let points: Vec<_> = (seed << k..(seed + 1) << k).map(|i| sobol4(i, [a, b, c], [!a, !b])).collect();
            for cut in 0..7u32.pow(4) {
                let parts = [cut % 7, cut / 7 % 7, cut / 49 % 7, cut / 343];
                if parts.iter().sum::<u32>() != k - 3 {
                    continue;
                }
                let mut counts = std::collections::HashMap::new();
                for point in &points {
                    let digits = |axis: usize| point[axis].checked_shr(32 - parts[axis]).unwrap_or(0);
                    *counts.entry([0, 1, 2, 3].map(digits)).or_insert(0) += 1;
                }
                assert!(counts.len() == 1 << (k - 3) && counts.values().all(|&n| n == 8), "{seed}, {parts:?}");
            }
        }
    }

    #[test]
    fn four_dimensions_begin_with_the_two() {
        for index in 0..1000 {
            let (two, four) = (sobol(index, [1, 2, 3]), sobol4(index, [1, 2, 3], [4, 5]));
            assert_eq!(two, [four.x, four.y]);
        }
    }

    /// A (0, k, 2)-net: so many runs, of so many pixels.
    #[test]
    fn every_aligned_run_has_one_sample_in_each_box_of_its_size() {
        for (seed, k) in (0..24).flat_map(|seed| (0..=10).map(move |k| (seed, k))) {
            let seeds = crate::sampler::hash([seed, 5, 0]);
            let first = (seed * 3) << k;
            let points: Vec<_> = (first..first + (1 << k)).map(|index| sobol(index, seeds)).collect();
            for columns in 0..=k {
                let digits = |x: u32, count: u32| if count == 0 { 0 } else { x >> (32 - count) };
                let boxes: HashSet<_> =
                    points.iter().map(|&[x, y]| (digits(x, columns), digits(y, k - columns))).collect();
                assert_eq!(boxes.len(), 1 << k, "seed {seed}, 2^{k} points, 2^{columns} columns");
            }
        }
    }
}
