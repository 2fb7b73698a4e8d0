//! Where in a pixel its samples lie (thesis 3.4.5).

use crate::data::Launch;

/// Places in a pixel and in a cell are whole numbers of 2^-24 of its edge.
const BITS: u32 = 24;

/// A place in a pixel that is divided into a grid of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The cell's, from the left.
    pub column: u32,
    /// From the top.
    pub row: u32,
    /// From the cell's centre to the right, in halves of its edge, in [-1, 1).
    pub right: f32,
    /// Down, likewise.
    pub down: f32,
}

/// The place of a sample in the pixel at column `x` and row `y` of the image, whose grid has `edge` x `edge` cells, at most
/// 128 x 128. A sample's place does not depend on how many there are, but for the cells of a grid.
#[inline(always)]
pub fn place(launch: Launch, edge: u32, (x, y): (u32, u32), sample: u32) -> Place {
    if launch.has(Launch::RANDOM) {
        let drawn = hash([x, y, sample]);
        return in_pixel(edge, [drawn[0], drawn[1]]);
    }
    if launch.has(Launch::SOBOL) {
        return in_pixel(edge, sobol(sample, hash([x, y, 0])));
    }
    let (column, row) = (sample % edge, sample / edge);
    if launch.has(Launch::JITTERED) {
        let drawn = hash([x, y, sample]);
        return Place {
            column,
            row,
            right: from_centre(drawn[0] >> (32 - BITS)),
            down: from_centre(drawn[1] >> (32 - BITS)),
        };
    }
    Place { column, row, right: 0.0, down: 0.0 }
}

/// A place in the whole pixel, each coordinate a share of its edge in steps of 2^-32.
#[inline(always)]
fn in_pixel(edge: u32, drawn: [u32; 2]) -> Place {
    let (across, down) = ((drawn[0] >> (32 - BITS)) * edge, (drawn[1] >> (32 - BITS)) * edge);
    let in_cell = |at: u32| from_centre(at & ((1 << BITS) - 1));
    Place { column: across >> BITS, row: down >> BITS, right: in_cell(across), down: in_cell(down) }
}

/// A share of a cell's edge, from its centre in halves of the edge. Exact.
#[inline(always)]
fn from_centre(share: u32) -> f32 {
    const HALF: u32 = 1 << (BITS - 1);
    (share as i32 - HALF as i32) as f32 * (1.0 / HALF as f32)
}

/// Three numbers that look drawn at random, of three others (pcg3d: Jarzynski and Olano, Hash Functions for GPU Rendering,
/// 2020).
#[inline(always)]
pub fn hash([x, y, z]: [u32; 3]) -> [u32; 3] {
    let step = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let mix = |x: u32, y: u32, z: u32| {
        let x = x.wrapping_add(y.wrapping_mul(z));
        let y = y.wrapping_add(z.wrapping_mul(x));
        (x, y, z.wrapping_add(x.wrapping_mul(y)))
    };
    let (x, y, z) = mix(step(x), step(y), step(z));
    let (x, y, z) = mix(x ^ (x >> 16), y ^ (y >> 16), z ^ (z >> 16));
    [x, y, z]
}

/// A point of the first two dimensions of Sobol's sequence, shuffled and scrambled as Owen does it (Burley, Practical
/// Hash-based Owen Scrambling, 2020), in steps of 2^-32. Every aligned run of 2^k points has one in each of the 2^k boxes of
/// equal size, of every shape that halving gives.
#[inline(always)]
pub fn sobol(index: u32, seeds: [u32; 3]) -> [u32; 2] {
    let index = scrambled(index.reverse_bits(), seeds[0]).reverse_bits();
    [scrambled(index, seeds[1]).reverse_bits(), scrambled(pascal(index), seeds[2]).reverse_bits()]
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

    const SAMPLERS: [u32; 4] = [0, Launch::JITTERED, Launch::RANDOM, Launch::SOBOL];

    /// In [0, 1) from the pixel's left or top edge.
    fn shares(place: Place, edge: u32) -> [f64; 2] {
        [(place.column, place.right), (place.row, place.down)]
            .map(|(cell, half)| (f64::from(cell) + 0.5 + 0.5 * f64::from(half)) / f64::from(edge))
    }

    #[test]
    fn every_place_is_in_its_cell_and_every_cell_in_the_pixel() {
        for sampler in SAMPLERS {
            for edge in [1, 2, 3, 64] {
                for (pixel, sample) in (0..2000).map(|i| ((i * 7, i * 31), i % (edge * edge))) {
                    let place = place(Launch(sampler), edge, pixel, sample);
                    assert!(place.column < edge && place.row < edge, "{sampler}: {place:?}");
                    assert!([place.right, place.down].iter().all(|x| (-1.0..1.0).contains(x)), "{sampler}: {place:?}");
                }
            }
        }
    }

    #[test]
    fn regular_and_jittered_samples_have_a_cell_each() {
        for sampler in [0, Launch::JITTERED] {
            let cells: HashSet<_> =
                (0..49).map(|sample| place(Launch(sampler), 7, (3, 5), sample)).map(|p| (p.column, p.row)).collect();
            assert_eq!(cells.len(), 49);
        }
        assert!((0..49).all(|sample| place(Launch(0), 7, (3, 5), sample).right == 0.0));
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

    /// A (0, k, 2)-net: so many runs, of so many pixels.
    #[test]
    fn every_aligned_run_has_one_sample_in_each_box_of_its_size() {
        for (seed, k) in (0..24).flat_map(|seed| (0..=10).map(move |k| (seed, k))) {
            let seeds = hash([seed, 5, 0]);
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

    /// The slope of the root mean square error over 96 pixels against the number of samples, 16 to 4096.
    fn slope(sampler: u32, integrand: impl Fn([f64; 2]) -> f64, exact: f64) -> f64 {
        let points: Vec<(f64, f64)> = (2..=6)
            .map(|half| {
                let (edge, count) = (1 << half, 1 << (2 * half));
                let error = |pixel: u32| {
                    let at = |sample| shares(place(Launch(sampler), edge, (pixel, 2 * pixel), sample), edge);
                    (0..count).map(|sample| integrand(at(sample))).sum::<f64>() / f64::from(count) - exact
                };
                let square = (0..96).map(error).map(|e| e * e).sum::<f64>() / 96.0;
                (f64::from(count).log2(), square.sqrt().log2())
            })
            .collect();
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
        let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
        mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x) * (p.0 - x))
    }

    /// Known rates: of what is smooth -3/2 by Owen's scrambling, -1 by jittered cells; along an edge -3/4 by both; -1/2 by
    /// chance.
    #[test]
    fn errors_fall_as_fast_as_they_should() {
        let smooth = |[x, y]: [f64; 2]| (1.0 + x * (1.0 - x)) * (1.0 + y * y);
        let disk = |[x, y]: [f64; 2]| f64::from(u8::from(x * x + y * y < 0.64));
        let (of_smooth, of_disk) = (14.0 / 9.0, std::f64::consts::PI * 0.16);
        let slopes = |sampler| [slope(sampler, smooth, of_smooth), slope(sampler, disk, of_disk)];
        let (sobol, jittered, random) = (slopes(Launch::SOBOL), slopes(Launch::JITTERED), slopes(Launch::RANDOM));
        println!("smooth, disk: sobol {sobol:.2?}, jittered {jittered:.2?}, random {random:.2?}");
        assert!(sobol[0] <= -1.3 && sobol[1] <= -0.7, "{sobol:?}");
        assert!(jittered[0] <= -0.9 && jittered[1] <= -0.65, "{jittered:?}");
        assert!(random.iter().all(|slope| (slope + 0.5).abs() < 0.1), "{random:?}");
    }

    /// No two dimensions or neighbours go together: means of products, each within five of its standard errors.
    #[test]
    fn drawn_numbers_do_not_depend_on_one_another() {
        let centred = |x: u32| f64::from(x) / f64::from(u32::MAX) - 0.5;
        let count = 1 << 16;
        let bound = 5.0 / 12.0 / f64::from(count).sqrt();
        for (what, key) in [("column", [1, 0, 0]), ("row", [0, 1, 0]), ("sample", [0, 0, 1])] {
            let drawn = |i: u32| hash(key.map(|axis: u32| axis * i)).map(centred);
            let mean = |f: &dyn Fn(u32) -> f64| (0..count).map(f).sum::<f64>() / f64::from(count);
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let together = mean(&|i| drawn(i)[a] * drawn(i)[b]);
                assert!(together.abs() < bound, "{what}, {a} and {b}: {together}");
            }
            for a in 0..3 {
                let next = mean(&|i| drawn(i)[a] * drawn(i + 1)[a]);
                assert!(next.abs() < bound, "{what}, number {a} and its neighbour's: {next}");
            }
        }
    }
}
