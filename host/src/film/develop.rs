//! From sums to a picture.

use eyerays_shader::data::Quanta;
use eyerays_shader::stage::{
    AovSums, CatcherSums, FilmWords, LIGHT_FRACTION, NON_FINITE, PixelSums, Row, SQUARE_FRACTION,
};
use rayon::prelude::*;

use super::{Film, words_of_row};
use crate::error::{Error, Result};
use crate::picture::Picture;
use crate::rays::Rays;
use crate::view::Region;

/// A picture that is developed row by row, and what its sums tell beside light.
pub(crate) struct Developer {
    picture: Picture,
    noise: Noise,
    rays: Rays,
    samples_a_square: u32,
}

/// What a row tells.
#[derive(Default)]
struct Told {
    noise: Noise,
    shadow: u64,
    non_finite: u64,
}

impl Developer {
    /// Of a picture of this size, from its first row on.
    ///
    /// # Errors
    /// If there is no memory for it.
    pub fn new(width: u32, height: u32) -> Result<Self> {
        let picture = Picture::new(width, height)?;
        Ok(Developer { picture, noise: Noise::default(), rays: Rays::default(), samples_a_square: 1 })
    }

    /// Develops rows from `first` on, whose sums are these; `counts` tells the samples of each pixel of a row, counted from there.
    pub fn rows<C>(&mut self, first: u32, words: FilmWords, sums: &[u32], counts: impl Fn(u32) -> C + Sync)
    where
        C: AsRef<[u32]>,
    {
        let width = self.picture.width;
        let samples_a_square = self.samples_a_square;
        if Row::new(0, width, words).counts_clear() {
            self.opaque(first, words, sums, &counts);
        }
        let pixels = self.picture.pixels.par_chunks_mut(width as usize).skip(first as usize);
        let rows = pixels.zip(sums.par_chunks(words_of_row(words, width)));
        let told = rows.enumerate().map(|(y, (pixels, sums))| {
            let (row, mut told) = (Row::new(0, width, words), Told::default());
            for ((pixel, x), &count) in pixels.iter_mut().zip(0..).zip(counts(y as u32).as_ref()) {
                let sums = PixelSums::load(sums, row, x);
                let light = mean_light(&sums, count);
                *pixel = light.map(|channel| channel as f32);
                if row.is_noisy() {
                    told.noise.add(&Mean::of(&sums, light, count, samples_a_square));
                }
                told.shadow += u64::from(sums.word & !NON_FINITE);
                told.non_finite += u64::from(sums.word & NON_FINITE != 0);
            }
            told
        });
        // Added in order, so that the sum is the same however many threads there are.
        for told in told.collect::<Vec<_>>() {
            self.noise = self.noise.with(&told.noise);
            self.rays.shadow += told.shadow;
            self.rays.non_finite += told.non_finite;
        }
    }

    /// Tells how opaque the pixels of rows are.
    fn opaque<C>(&mut self, first: u32, words: FilmWords, sums: &[u32], counts: &(impl Fn(u32) -> C + Sync))
    where
        C: AsRef<[u32]>,
    {
        let width = self.picture.width;
        let alpha = self.picture.alpha.get_or_insert_with(|| vec![0.0; self.picture.pixels.len()]);
        let rows = alpha.par_chunks_mut(width as usize).skip(first as usize);
        rows.zip(sums.par_chunks(words_of_row(words, width))).enumerate().for_each(|(y, (alpha, sums))| {
            let row = Row::new(0, width, words);
            for ((share, x), &count) in alpha.iter_mut().zip(0..).zip(counts(y as u32).as_ref()) {
                *share = opacity(&PixelSums::load(sums, row, x), count) as f32;
            }
        });
    }

    /// The picture, and what was counted of its rays.
    pub fn done(mut self, words: FilmWords) -> (Picture, Rays) {
        let pixels = self.picture.pixels.len();
        self.picture.noise = if Row::new(0, 0, words).is_noisy() { self.noise.share(pixels) } else { None };
        (self.picture, self.rays)
    }
}

impl Film {
    /// The picture of its window: every pixel the mean of its samples, black without any.
    ///
    /// # Errors
    /// If there is no memory for it.
    pub fn develop(&self) -> Result<Picture> {
        Ok(self.developed()?.0)
    }

    /// The same, with what was traced for it, which one look at the sums tells as well.
    ///
    /// # Errors
    /// As [`Film::develop`].
    pub fn developed(&self) -> Result<(Picture, Rays)> {
        let Region { width, height, .. } = self.window;
        let developer = Developer::new(width, height)?;
        let mut developer = Developer { samples_a_square: self.samples_a_square(), ..developer };
        developer.rows(0, self.words, &self.sums, |row| self.counts(row));
        let (picture, rays) = developer.done(self.words);
        Ok((picture, Rays { primary: self.volume(), secondary: self.secondary, ..rays }))
    }

    /// The standard error of each pixel's mean, of its brightness, estimated from how much its samples differ; row by row. Of samples
    /// that are placed evenly, as Sobol's are, it is too high, unless noise decides how many there are: then it is estimated from blocks of
    /// samples. Infinite with fewer than two samples, and where no noise is told.
    pub fn errors(&self) -> Vec<f32> {
        let (width, words, samples_a_square) = (self.window.width, self.words, self.samples_a_square());
        let rows = self.sums.par_chunks(words_of_row(words, width)).zip(0..self.window.height);
        let errors = rows.flat_map_iter(|(sums, y)| {
            let counts = self.counts(y);
            let row = Row::new(0, width, words);
            let error = move |(count, x)| {
                if count < 2 * samples_a_square || !row.is_noisy() {
                    return f32::INFINITY;
                }
                let sums = PixelSums::load(sums, row, x);
                Mean::of(&sums, mean_light(&sums, count), count, samples_a_square).variance.sqrt() as f32
            };
            counts.into_iter().zip(0..).map(error)
        });
        errors.collect()
    }

    /// The standard error of how opaque each pixel is, as far as shadow catchers make it noisy; row by row, 0 elsewhere. None without
    /// any. A sample tells that its light arrives or does not, and no sample tells how unequal the lights are that are sampled: twice the
    /// variance of equal ones.
    pub fn opacity_errors(&self) -> Option<Vec<f32>> {
        let (width, words) = (self.window.width, self.words);
        if !Row::new(0, width, words).knows_catchers() {
            return None;
        }
        let rows = self.sums.par_chunks(words_of_row(words, width)).zip(0..self.window.height);
        let errors = rows.flat_map_iter(|(sums, y)| {
            let of = move |(count, x)| {
                let catcher = PixelSums::load(sums, Row::new(0, width, words), x).catcher;
                let (caught, kept_away) = (f64::from(catcher.count.max(1)), kept_away(&catcher));
                let variance = 2.0 * kept_away * (1.0 - kept_away) / caught;
                (f64::from(catcher.count) / f64::from(u32::max(count, 1)) * variance.sqrt()) as f32
            };
            self.counts(y).into_iter().zip(0..).map(of)
        });
        Some(errors.collect())
    }

    /// An arbitrary output variable by its number: every pixel the mean of its samples, zeros without any.
    ///
    /// # Errors
    /// There is no such, or no memory for it.
    pub fn aov(&self, number: u32) -> Result<Picture> {
        let (Region { width, height, .. }, words) = (self.window, self.words);
        if number >= words.aovs {
            return Err(Error::new(format!("the film keeps {} layers of a pixel, counted from 0", words.aovs)));
        }
        let mut picture = Picture::new(width, height)?;
        let rows = self.sums.par_chunks(words_of_row(words, width));
        picture.pixels.par_chunks_mut(width as usize).zip(rows).enumerate().for_each(|(y, (pixels, sums))| {
            let row = Row::new(0, width, words);
            for ((pixel, x), count) in pixels.iter_mut().zip(0..).zip(self.counts(y as u32)) {
                let AovSums { x: red, y: green, z: blue } = AovSums::load(sums, row, number, x);
                *pixel = [red, green, blue].map(|sum| (light(sum) / f64::from(count.max(1))) as f32);
            }
        });
        Ok(picture)
    }

    /// How many samples each pixel of its window has, row by row.
    pub fn samples(&self) -> Vec<u32> {
        (0..self.window.height).flat_map(|row| self.counts(row)).collect()
    }

    /// What was traced for it.
    pub fn rays(&self) -> Rays {
        let (width, words) = (self.window.width, self.words);
        let rows = self.sums.par_chunks(words_of_row(words, width));
        let counted = rows.map(|sums| {
            let of = |x| PixelSums::load(sums, Row::new(0, width, words), x).word;
            let add = |(shadow, lost), word| {
                (shadow + u64::from(word & !NON_FINITE), lost + u64::from(word & NON_FINITE != 0))
            };
            (0..width).map(of).fold((0, 0), add)
        });
        let (shadow, non_finite) = counted.reduce(|| (0, 0), |a: (u64, u64), b| (a.0 + b.0, a.1 + b.1));
        Rays { primary: self.volume(), shadow, secondary: self.secondary, non_finite }
    }
}

/// The share of a pixel that is opaque: what the camera sees of objects, and what they keep away of the light of shadow catchers.
fn opacity(sums: &PixelSums, count: u32) -> f64 {
    let seen = count - sums.clear.min(count);
    let caught = f64::from(sums.catcher.count.min(seen));
    (f64::from(seen) - caught + caught * kept_away(&sums.catcher)) / f64::from(count.max(1))
}

/// The share of the light of shadow catchers that others keep away.
fn kept_away(catcher: &CatcherSums) -> f64 {
    // Without any light there is no shadow.
    let full = light(catcher.full);
    if full > 0.0 { 1.0 - (light(catcher.lit) / full).clamp(0.0, 1.0) } else { 0.0 }
}

/// A pixel's samples in the mean.
pub(super) struct Mean {
    pub brightness: f64,
    /// Of the mean brightness.
    pub variance: f64,
}

impl Mean {
    /// Of a pixel whose channels are these in the mean of so many samples, of which each square is of some.
    pub fn of(sums: &PixelSums, light: [f64; 3], samples: u32, samples_a_square: u32) -> Mean {
        let count = f64::from((samples / samples_a_square).max(1));
        let brightness = (light[0] + light[1] + light[2]) / 3.0;
        let of_samples = squares(sums.squares) / count - brightness * brightness;
        Mean { brightness, variance: of_samples.max(0.0) / (count - 1.0).max(1.0) }
    }
}

/// Linear RGB, rounded to double precision as a sum and as a quotient.
pub(super) fn mean_light(sums: &PixelSums, count: u32) -> [f64; 3] {
    [sums.red, sums.green, sums.blue].map(|sum| mean(sum, count))
}

/// A channel in the mean of so many samples.
pub(super) fn mean(sum: Quanta, count: u32) -> f64 {
    light(sum) / f64::from(count.max(1))
}

/// A sum of 96 bits.
fn light(sum: Quanta) -> f64 {
    let quanta = if sum.2 as i32 == sum.1 as i32 >> 31 {
        // Of light up to 2^23; a conversion of 128 bits takes several times as long.
        ((i64::from(sum.1 as i32) << 32) + i64::from(sum.0)) as f64
    } else {
        let upper = (i64::from(sum.2 as i32) << 32) + i64::from(sum.1);
        ((i128::from(upper) << 32) + i128::from(sum.0)) as f64
    };
    quanta / (1u64 << LIGHT_FRACTION) as f64
}

fn squares(sum: Quanta) -> f64 {
    let [a, b, c, d] = [sum.0, sum.1, sum.2, sum.3].map(u128::from);
    (d << 96 | c << 64 | b << 32 | a) as f64 / (1u64 << SQUARE_FRACTION) as f64
}

/// What tells the noise of some pixels.
#[derive(Debug, Clone, Copy, Default)]
struct Noise {
    /// Of each pixel's mean brightness, added.
    variances: f64,
    /// Pixels' mean brightness, added.
    brightness: f64,
}

impl Noise {
    fn add(&mut self, pixel: &Mean) {
        self.variances += pixel.variance;
        self.brightness += pixel.brightness;
    }

    fn with(self, other: &Noise) -> Noise {
        Noise { variances: self.variances + other.variances, brightness: self.brightness + other.brightness }
    }

    /// The standard error of a pixel (root mean square) over the mean of all.
    fn share(&self, pixels: usize) -> Option<f64> {
        let pixels = pixels as f64;
        let noise = (self.variances / pixels).sqrt() / (self.brightness / pixels);
        (self.variances > 0.0 && noise.is_finite()).then_some(noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Short sums and long ones, of either sign: the conversion is that of 128 bits.
        #[test]
        fn a_sum_is_its_nearest_number(high in prop_oneof![Just(0i64), Just(-1), -4i64..4, any::<i32>().prop_map(i64::from)], low: u64) {
            let sum = Quanta(low as u32, (low >> 32) as u32, high as u32, 0);
            let whole = (i128::from(high) << 64) + i128::from(low);
            prop_assert_eq!(light(sum), whole as f64 / 2f64.powi(40));
        }
    }
}
