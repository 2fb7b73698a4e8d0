//! Fireflies: pixels that a few samples make far too bright. Samples are put into buckets by their numbers, and buckets that are far brighter
//! than all others of their pixel are left out. Means of more samples differ less, so that in the end none is left out and the picture
//! comes to what it should. (Medians of means that trim by Gini's coefficient, GMoN of Buisine, Delepoulle and Renaud 2021, were measured
//! beside it: docs/denoising.md.)

use std::ops::Range;

use rayon::prelude::*;

use crate::error::{Error, Result, within};
use crate::picture::Picture;

/// Into how many buckets samples are put.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Buckets(u32);

impl Buckets {
    /// The fewest that tell what stands out.
    pub const LEAST: u32 = 9;
    /// The most.
    pub const MOST: u32 = 64;

    /// So many.
    ///
    /// # Errors
    /// Fewer than [`Buckets::LEAST`], or more than [`Buckets::MOST`].
    pub fn new(count: u32) -> Result<Buckets> {
        within("buckets", &[count], Self::LEAST..=Self::MOST)?;
        Ok(Buckets(count))
    }

    /// How many there are.
    pub fn count(self) -> u32 {
        self.0
    }

    /// The samples of each, which are all of a range.
    ///
    /// # Errors
    /// There are fewer samples than buckets.
    pub fn of(self, samples: Range<u32>) -> Result<Vec<Range<u32>>> {
        let (first, count) = (samples.start, samples.len() as u64);
        if count < u64::from(self.0) {
            let Buckets(buckets) = self;
            return Err(Error::new(format!("{count} samples do not fill {buckets} buckets: render as many or more")));
        }
        let end = |bucket: u32| first + (count * u64::from(bucket) / u64::from(self.0)) as u32;
        Ok((0..self.0).map(|bucket| end(bucket)..end(bucket + 1)).collect())
    }
}

/// A picture of the pictures of its buckets, in their number.
///
/// # Errors
/// They are of different sizes, or none.
pub fn without(buckets: &[Picture]) -> Result<Picture> {
    let Some(first) = buckets.first() else { return Err(Error::new("there is no picture to take fireflies off")) };
    if buckets.iter().any(|picture| (picture.width, picture.height) != (first.width, first.height)) {
        return Err(Error::new("the buckets' pictures have other sizes: render them of one view"));
    }
    let pixel = |at: usize| robust(buckets.iter().map(|picture| picture.pixels[at]).collect());
    let pixels = (0..first.pixels.len()).into_par_iter().map(pixel).collect();
    Picture::from_pixels(first.width, first.height, pixels)
}

/// How many standard deviations of darker buckets a brighter one may be above their mean.
const FAR: f64 = 8.0;
/// How many times as bright as their mean it may be, however equal they are: what is less changes its pixel little, and edges of what is not
/// much brighter are no fireflies.
const BRIGHT: f64 = 1.5;

/// The mean of means, but for the brightest, one after the other, that are far brighter than all darker ones: at most a third of them.
fn robust(mut means: Vec<[f32; 3]>) -> [f32; 3] {
    means.sort_by(|a, b| brightness(a).total_cmp(&brightness(b)));
    let least = means.len() - means.len() / 3;
    let mut kept = means.len();
    while kept > least && is_far(brightness(&means[kept - 1]), &means[..kept - 1]) {
        kept -= 1;
    }
    let sum = means[..kept].iter().fold([0.0; 3], |sum, colour| [0, 1, 2].map(|i| sum[i] + f64::from(colour[i])));
    sum.map(|channel| (channel / kept as f64) as f32)
}

/// Is something far brighter than all of these?
fn is_far(bright: f64, others: &[[f32; 3]]) -> bool {
    let count = others.len() as f64;
    let middle = others.iter().map(brightness).sum::<f64>() / count;
    let apart = others.iter().map(|other| brightness(other) - middle);
    let squares = apart.map(|apart| apart * apart).sum::<f64>();
    let deviation = (squares / (count - 1.0)).sqrt();
    bright > (middle + FAR * deviation).max(BRIGHT * middle) + f64::from(f32::MIN_POSITIVE)
}

fn brightness(colour: &[f32; 3]) -> f64 {
    colour.iter().map(|&channel| f64::from(channel)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Vec<[f32; 3]> {
        values.iter().map(|&value| [value; 3]).collect()
    }

    #[test]
    fn equal_buckets_are_their_mean_and_bright_ones_are_left_out() {
        assert_eq!(robust(grey(&[2.0; 15])), [2.0; 3]);
        assert_eq!(robust(grey(&[0.0; 9])), [0.0; 3]);
        let noisy: Vec<f32> = (0..15).map(|i| 1.0 + 0.1 * (i % 3) as f32).collect();
        for fireflies in [&[(3, 1e4)][..], &[(0, 1e6), (9, 1e4)], &[(1, 40.0)]] {
            let mut means = noisy.clone();
            fireflies.iter().for_each(|&(i, bright)| means[i] = bright);
            let [left, ..] = robust(grey(&means));
            assert!((0.99..1.25).contains(&left), "{fireflies:?}: {left}");
        }
    }

    /// What more than a third of the buckets have is no firefly, and what all have least.
    #[test]
    fn light_that_many_samples_find_stays() {
        let half: Vec<f32> = (0..15).map(|i| if i % 2 == 0 { 0.0 } else { 10.0 }).collect();
        assert_eq!(robust(grey(&half)), [70.0 / 15.0; 3]);
        let edge: Vec<f32> = (0..16).map(|i| 1.0 + i as f32 / 16.0).collect();
        let mean = edge.iter().sum::<f32>() / 16.0;
        assert!((robust(grey(&edge))[0] - mean).abs() < 1e-6);
    }

    /// A pixel at the edge of something a little brighter, which few samples show, beside what is the same for all.
    #[test]
    fn edges_are_no_fireflies() {
        let edge: Vec<f32> = (0..15).map(|i| if i < 2 { 1.4 } else { 1.0 }).collect();
        assert!((robust(grey(&edge))[0] - 15.8 / 15.0).abs() < 1e-6);
    }

    #[test]
    fn colours_stay_together() {
        let mut means = [[1.0, 0.0, 0.0], [0.9, 0.1, 0.0], [1.1, 0.0, 0.1]].repeat(5);
        means[4] = [0.0, 50.0, 50.0];
        let [red, green, blue] = robust(means);
        assert!(red > 0.9 && green < 0.15 && blue < 0.15, "{red} {green} {blue}");
    }

    /// Of noise without outliers nothing is left out: the mean of many pixels is that of all samples.
    #[test]
    fn what_is_evenly_noisy_keeps_its_light() {
        let mut state = 1u32;
        let mut drawn = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            0.8 + 0.4 * (state >> 8) as f32 / (1 << 24) as f32
        };
        let pixels = 4000;
        let sum: f32 = (0..pixels).map(|_| robust((0..15).map(|_| [drawn(); 3]).collect())[0]).sum();
        assert!((sum / pixels as f32 - 1.0).abs() < 2e-3, "{}", sum / pixels as f32);
    }

    #[test]
    fn buckets_are_all_samples_once() {
        for (count, samples) in [(15, 0..64), (9, 10..19), (64, 0..1000)] {
            let ranges = Buckets::new(count).unwrap().of(samples.clone()).unwrap();
            assert_eq!(ranges.iter().cloned().flatten().collect::<Vec<_>>(), samples.collect::<Vec<_>>());
            let lengths = ranges.iter().map(|range| range.len());
            assert!(ranges.len() == count as usize && lengths.clone().max().unwrap() - lengths.min().unwrap() <= 1);
        }
        assert!(Buckets::new(15).unwrap().of(0..14).unwrap_err().message().contains("do not fill 15 buckets"));
        for count in [0, 1, 8, 65] {
            assert!(Buckets::new(count).is_err(), "{count}");
        }
    }
}
