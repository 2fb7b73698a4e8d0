//! Sobol's sequence, shuffled and scrambled as Owen does it (Burley, Practical Hash-based Owen Scrambling, 2020).

use glam::UVec4;

/// A point of the first two dimensions of the sequence in steps of 2^-32. Every aligned run of 2^k points has one in each of the 2^k boxes of
/// equal size, of every shape that halving gives.
#[inline(always)]
pub fn sobol(index: u32, seeds: [u32; 3]) -> [u32; 2] {
    let index = scrambled(index.reverse_bits(), seeds[0]).reverse_bits();
    [scrambled(index, seeds[1]).reverse_bits(), scrambled(pascal(index), seeds[2]).reverse_bits()]
}

/// A point of the first four dimensions. The first two are those of [`sobol`] with the same seeds.
#[inline(always)]
pub fn sobol4(index: u32, seeds: [u32; 3], further: [u32; 2]) -> UVec4 {
    let index = scrambled(index.reverse_bits(), seeds[0]).reverse_bits();
    let (third, fourth) = recurrent(index);
    UVec4::new(
        scrambled(index, seeds[1]).reverse_bits(),
        scrambled(pascal(index), seeds[2]).reverse_bits(),
        scrambled(third, further[0]).reverse_bits(),
        scrambled(fourth, further[1]).reverse_bits(),
    )
}

/// The digits of the third and fourth dimension, the first digit lowest: the sum modulo 2 of what each digit of the index flips,
/// which follows from those of the digits before by the primitive polynomials x^2 + x + 1 and x^3 + x + 1 (Bratley and Fox,
/// Algorithm 659, 1988; starting numbers of Joe and Kuo, 2008: 1, 3 and 1, 3, 1).
#[inline(always)]
fn recurrent(index: u32) -> (u32, u32) {
    let (mut third, mut fourth) = (0, 0);
    let (mut a, mut next_a) = (1u32, 3u32);
    let (mut b, mut next_b, mut last_b) = (1u32, 3u32, 4u32);
    let mut rest = index;
    while rest != 0 {
        let flips = 0u32.wrapping_sub(rest & 1);
        third ^= a & flips;
        fourth ^= b & flips;
        (a, next_a) = (next_a, next_a ^ a ^ (a << 2));
        (b, next_b, last_b) = (next_b, last_b, next_b ^ b ^ (b << 3));
        rest >>= 1;
    }
    (third, fourth)
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

    /// As the table of direction numbers of Joe and Kuo (new-joe-kuo-6.21201) gives it, by the definition of the sequence.
    #[test]
    fn further_dimensions_are_those_of_the_tables() {
        for (degree, coefficients, start) in [(2, 1, vec![1u32, 3]), (3, 1, vec![1, 3, 1])] {
            let mut m: Vec<u64> = start.iter().map(|&m| u64::from(m)).collect();
            for i in degree..32 {
                let mut next = m[i - degree] ^ (m[i - degree] << degree);
                for k in 1..degree {
                    next ^= if coefficients >> (degree - 1 - k) & 1 == 1 { m[i - k] << k } else { 0 };
                }
                m.push(next);
            }
            for index in [1u32, 2, 3, 7, 0x8000_0001, 0xdead_beef, u32::MAX] {
                let digits = (0..32).filter(|&i| index >> i & 1 == 1).fold(0, |sum, i| sum ^ (m[i] << (31 - i)) as u32);
                let (third, fourth) = recurrent(index);
                let got = if degree == 2 { third } else { fourth };
                assert_eq!(got.reverse_bits(), digits, "degree {degree}, {index:x}");
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
