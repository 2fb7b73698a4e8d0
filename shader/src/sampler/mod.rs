//! Where in a pixel its samples lie (thesis 3.4.5), and the numbers that their paths draw.

mod sobol;

use crate::data::Launch;
use glam::UVec4;
use sobol::{sobol, sobol4, van_der_corput};

/// Places are whole steps of 2^-17 of a cell's edge, so that one in a pixel of 128 x 128 cells is exact.
const BITS: u32 = 17;

/// What the numbers of a pixel are drawn from: its column and row, with a seed in the upper halves, which images do not reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key(pub u32, pub u32);

impl Key {
    /// Of a pixel below 2^16 columns and rows.
    #[inline(always)]
    pub fn new((x, y): (u32, u32), seed: u32) -> Self {
        Key(x | (seed << 16), y | (seed & 0xffff_0000))
    }
}

/// A sample of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Of its pixel.
    pub key: Key,
    /// Its number in the pixel.
    pub number: u32,
    /// The column and row of its cell, if each has one.
    pub cell: (u32, u32),
}

impl Sample {
    /// A sample of a pixel with `edge` x `edge` cells.
    #[inline(always)]
    pub fn new(key: Key, edge: u32, number: u32) -> Self {
        Sample { key, number, cell: (number % edge, number / edge) }
    }
}

/// Where in its pixel a sample lies, from the left and the top edge in halves of a cell, of which the pixel has `edge` x
/// `edge`, at most 128 x 128. For samplers that draw: a regular grid needs none of this.
// A function of its own on the GPU, so that a module holds it once. (With a division in it the compiler would inline it.)
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn place(launch: Launch, edge: u32, sample: Sample) -> (f32, f32) {
    let Key(x, y) = sample.key;
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

/// The set of the decisions at vertex number 0 of a path, which the other vertices' sets follow; the sets before are those of
/// directions and places.
pub const DECISIONS: u32 = 1 << 31;

/// The set whose first pair is a place on a light that the first vertex sees, where the second pair of set 0 is the place on a lens. No
/// path has so many vertices.
pub const AFTER_LENS: u32 = 1 << 29;

/// Four numbers for a sample, in steps of 2^-32. Of set `s` below [`DECISIONS`] the first pair chooses the ray that finds
/// vertex `s` of a path (in set 0, the place in the pixel), the second a place on a light that is seen from there: pairs that
/// belong together, so Sobol's points are of four dimensions. (Of a camera with a lens, the second pair of set 0 is a place on that.) Samplers with cells have them in the pixel only, and draw these at
/// random.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn set(launch: Launch, key: Key, number: u32, set: u32) -> UVec4 {
    let Key(x, y) = key;
    if launch.has(Launch::SOBOL) {
        let [third, fourth, _] = hash([x, y, set ^ FURTHER]);
        return sobol4(number, hash([x, y, set]), [third, fourth]);
    }
    let [a, b, c] = hash([x, y, number]);
    let [p, q, r] = hash([a, b, c.wrapping_add(set)]);
    UVec4::new(p, q, r, hash([p, q, r])[0])
}

/// The number in [0, 1) that a sample draws for its time: one in each of 2^k equal parts of any aligned run of 2^k samples.
#[inline(always)]
pub fn time(Key(x, y): Key, number: u32) -> f32 {
    unit(van_der_corput(number, hash([x, y, TIMES])))
}

/// The first of the sets of ways through media, of which there are 2^25: those of numbers of bounces and crossings.
pub const FLIGHTS: u32 = 1 << 28;

/// The set whose first number chooses the wavelengths of a sample. No path has so many vertices.
pub const WAVELENGTHS: u32 = AFTER_LENS + 2;

/// In the place of a set, those of times. No path has so many vertices.
const TIMES: u32 = AFTER_LENS + 1;

/// No set has this bit, but for those of [`DECISIONS`] beyond all bounces.
const FURTHER: u32 = 1 << 30;

/// A drawn number as one in [0, 1), in steps of 2^-24.
#[inline(always)]
pub fn unit(drawn: u32) -> f32 {
    const STEP: f32 = 1.0 / (1 << 24) as f32;
    (drawn >> 8) as f32 * STEP
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    const SAMPLERS: [u32; 3] = [Launch::JITTERED, Launch::RANDOM, Launch::SOBOL];

    #[test]
    fn every_place_is_in_its_pixel() {
        for (sampler, edge) in SAMPLERS.into_iter().flat_map(|sampler| [1, 2, 3, 64, 128].map(|edge| (sampler, edge))) {
            for (pixel, sample) in (0..20_000).map(|i| ((i * 7, i * 31), i % (edge * edge))) {
                let (right, down) = place(Launch(sampler), edge, Sample::new(Key::new(pixel, 0), edge, sample));
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
                .map(|sample| {
                    cell(place(Launch(Launch::JITTERED), edge, Sample::new(Key::new(pixel, 0), edge, sample)))
                })
                .collect();
            assert_eq!(cells.len(), (edge * edge) as usize);
        }
    }

    /// The slope of the root mean square of an error over 96 pixels against the number of samples, 16 to 4096.
    fn fitted(error: &dyn Fn(u32, u32) -> f64) -> f64 {
        let points: Vec<(f64, f64)> = (2..=6)
            .map(|half| {
                let count = 1 << (2 * half);
                let square = (0..96).map(|pixel| error(pixel, count).powi(2)).sum::<f64>() / 96.0;
                (f64::from(count).log2(), square.sqrt().log2())
            })
            .collect();
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
        let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
        mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x) * (p.0 - x))
    }

    /// That of an integrand over places in the pixel.
    fn slope(sampler: u32, integrand: impl Fn([f64; 2]) -> f64, exact: f64) -> f64 {
        fitted(&|pixel, count| {
            let edge = count.isqrt();
            let at = |sample| {
                let (right, down) = place(Launch(sampler), edge, Sample::new(Key(pixel, 2 * pixel), edge, sample));
                [right, down].map(|half_cells| f64::from(half_cells) / f64::from(2 * edge))
            };
            (0..count).map(|sample| integrand(at(sample))).sum::<f64>() / f64::from(count) - exact
        })
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

    /// One set of four dimensions, which two sets of two would not do: their rate is that of chance.
    #[test]
    fn errors_in_four_dimensions_fall_as_fast_as_they_should() {
        let product = |[a, b, c, d]: [f64; 4]| [a, b, c, d].map(|x| 1.0 + 1.8 * (x - 0.5)).iter().product::<f64>();
        let drawn = |pixel: u32, sample, number| {
            let set = set(Launch(Launch::SOBOL), Key(pixel, 7), sample, number);
            [set.x, set.y, set.z, set.w].map(|x| f64::from(x) / 4_294_967_296.0)
        };
        let slope = |at: &dyn Fn(u32, u32) -> [f64; 4]| {
            fitted(&|pixel, count| {
                (0..count).map(|sample| product(at(pixel, sample))).sum::<f64>() / f64::from(count) - 1.0
            })
        };
        let together = slope(&|pixel, sample| drawn(pixel, sample, 0));
        let apart = slope(&|pixel, sample| {
            let ([a, b, ..], [c, d, ..]) = (drawn(pixel, sample, 0), drawn(pixel, sample, 1));
            [a, b, c, d]
        });
        println!("one set of four {together:.2}, two sets of two {apart:.2}");
        assert!(together <= -1.1 && apart > -0.7, "{together}, {apart}");
    }

    /// Pictures hang on every bit of them: pcg3d by its authors' definition, step by step in wide numbers.
    #[test]
    fn hashes_are_those_of_the_paper() {
        let low = |x: u64| x & 0xffff_ffff;
        let mixed = |[x, y, z]: [u64; 3]| {
            let x = low(x + y * z);
            let y = low(y + z * x);
            [x, y, low(z + x * y)]
        };
        for v in [[0, 0, 0], [1, 2, 3], [0xdead_beef, 0x8000_0000, 77], [u32::MAX; 3]] {
            let stepped = mixed(v.map(|x| low(u64::from(x) * 1_664_525 + 1_013_904_223)));
            assert_eq!(hash(v).map(u64::from), mixed(stepped.map(|x| x ^ (x / 65_536))), "{v:x?}");
        }
    }

    #[test]
    fn a_drawn_number_is_a_share_of_all() {
        assert_eq!([0, 255, 256, 1 << 31].map(unit), [0.0, 0.0, 1.0 / 16_777_216.0, 0.5]);
        assert_eq!(unit(u32::MAX), 1.0 - 1.0 / 16_777_216.0);
    }

    /// No two sets share a dimension's scrambling, and no set has two dimensions of one.
    #[test]
    fn sets_are_scrambled_each_by_itself() {
        let sets = (0..200).chain((0..200).map(|i| DECISIONS + i));
        let first: Vec<UVec4> = sets.map(|number| set(Launch(Launch::SOBOL), Key(5, 6), 0, number)).collect();
        let all: HashSet<u32> = first.iter().flat_map(|set| set.to_array()).collect();
        assert_eq!(all.len(), 4 * first.len());
    }

    /// Disk lights' penumbras: of a disk that is sampled by area, what a half plane leaves.
    #[test]
    fn the_error_of_a_penumbra_falls_as_fast_as_it_should() {
        let drawn = |pixel: u32, sample| {
            let set = set(Launch(Launch::SOBOL), Key(pixel, 9), sample, 0);
            [set.x, set.z, set.w].map(|x| f64::from(x) / 4_294_967_296.0)
        };
        let is_seen = |edge: f64, radius: f64, angle: f64| {
            f64::from(u8::from(radius.sqrt() * (angle * std::f64::consts::TAU).sin() < edge))
        };
        let of = |seen: &dyn Fn(u32, [f64; 3]) -> f64, exact: &dyn Fn(u32) -> f64| {
            fitted(&|pixel, count| {
                let sum: f64 = (0..count).map(|sample| seen(pixel, drawn(pixel, sample))).sum();
                sum / f64::from(count) - exact(pixel)
            })
        };
        // Each place of the penumbra, which here is a pixel, has its edge across the disk.
        let edge = |pixel: u32| (f64::from(pixel) + 0.5) / 48.0 - 1.0;
        let segment = |edge: f64| 0.5 + (edge.asin() + edge * (1.0 - edge * edge).sqrt()) / std::f64::consts::PI;
        let at_places =
            of(&|pixel, [_, radius, angle]| is_seen(edge(pixel), radius, angle), &|pixel| segment(edge(pixel)));
        // With the edge anywhere in the pixel, too: in three dimensions -2/3 is known. The mean is by symmetry a half.
        let over_pixels = of(&|_, [x, radius, angle]| is_seen(x - 0.5, radius, angle), &|_| 0.5);
        println!("penumbra at places {at_places:.3}, over pixels {over_pixels:.3}");
        assert!(at_places <= -0.7 && over_pixels <= -0.66, "{at_places}, {over_pixels}");
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
