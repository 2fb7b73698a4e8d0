//! Where in a pixel its samples lie (thesis 3.4.5).

use crate::data::Launch;

/// Places are whole steps of 2^-17 of a cell's edge, so that one in a pixel of 128 x 128 cells is exact.
const BITS: u32 = 17;

/// A sample of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The pixel's column and row in the image.
    pub pixel: (u32, u32),
    /// Its number in the pixel.
    pub number: u32,
    /// The column and row of its cell, if each has one.
    pub cell: (u32, u32),
}

impl Sample {
    /// A sample of a pixel with `edge` x `edge` cells.
    #[inline(always)]
    pub fn new(pixel: (u32, u32), edge: u32, number: u32) -> Self {
        Sample { pixel, number, cell: (number % edge, number / edge) }
    }
}

/// Where in its pixel a sample lies, from the left and the top edge in halves of a cell, of which the pixel has `edge` x
/// `edge`, at most 128 x 128. For samplers that draw: a regular grid needs none of this.
// A function of its own on the GPU, so that a module holds it once. (With a division in it the compiler would inline it.)
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn place(launch: Launch, edge: u32, sample: Sample) -> (f32, f32) {
    let (x, y) = sample.pixel;
    let [right, down] = if launch.has(Launch::SOBOL) {
        sobol(sample.number, hash([x, y, 0]))
    } else {
        let [right, down, _] = hash([x, y, sample.number]);
        [right, down]
    };
    if launch.has(Launch::JITTERED) {
        let in_cell = |cell: u32, drawn: u32| half_cells((cell << BITS) + (drawn >> (32 - BITS)));
        return (in_cell(sample.cell.0, right), in_cell(sample.cell.1, down));
    }
    let in_pixel = |drawn: u32| half_cells(((drawn >> 8) * edge) >> (24 - BITS));
    (in_pixel(right), in_pixel(down))
}

#[inline(always)]
fn half_cells(steps: u32) -> f32 {
    const STEP: f32 = 2.0 / (1 << BITS) as f32;
    steps as f32 * STEP
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

    const SAMPLERS: [u32; 3] = [Launch::JITTERED, Launch::RANDOM, Launch::SOBOL];

    #[test]
    fn every_place_is_in_its_pixel() {
        for (sampler, edge) in SAMPLERS.into_iter().flat_map(|sampler| [1, 2, 3, 64, 128].map(|edge| (sampler, edge))) {
            for (pixel, sample) in (0..20_000).map(|i| ((i * 7, i * 31), i % (edge * edge))) {
                let (right, down) = place(Launch(sampler), edge, Sample::new(pixel, edge, sample));
                let size = 2.0 * edge as f32;
                assert!(
                    (0.0..size).contains(&right) && (0.0..size).contains(&down),
                    "{sampler}, {edge}: {right} {down}"
                );
            }
        }
    }

    #[test]
    fn jittered_samples_have_a_cell_each() {
        let cell = |(right, down): (f32, f32)| ((right / 2.0) as u32, (down / 2.0) as u32);
        for (edge, pixel) in [(7, (3, 5)), (128, (0, 1))] {
            let cells: HashSet<_> = (0..edge * edge)
                .map(|sample| cell(place(Launch(Launch::JITTERED), edge, Sample::new(pixel, edge, sample))))
                .collect();
            assert_eq!(cells.len(), (edge * edge) as usize);
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
                    let at = |sample| {
                        let (right, down) = place(Launch(sampler), edge, Sample::new((pixel, 2 * pixel), edge, sample));
                        [right, down].map(|half_cells| f64::from(half_cells) / f64::from(2 * edge))
                    };
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
