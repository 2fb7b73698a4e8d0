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
            let message = format!(
                "{buckets} buckets take as many samples or more of a pixel, and there are {count}: render more"
            );
            return Err(Error::new(message));
        }
        let end = |bucket: u32| first + (count * u64::from(bucket) / u64::from(self.0)) as u32;
        Ok((0..self.0).map(|bucket| end(bucket)..end(bucket + 1)).collect())
    }
}

/// A bucket of samples.
pub struct Bucket {
    /// What they show in the mean.
    pub picture: Picture,
    /// How many there are of each pixel.
    pub samples: u32,
}

/// The picture of all samples, but for the buckets that are left out of each pixel. Pixels that none is left out of keep their bits.
///
/// # Errors
/// The buckets' pictures have other sizes.
pub fn without(mut picture: Picture, buckets: &[Bucket]) -> Result<Picture> {
    let size = (picture.width, picture.height);
    if buckets.iter().any(|bucket| (bucket.picture.width, bucket.picture.height) != size) {
        return Err(Error::new("the buckets' pictures have other sizes: render them of one view"));
    }
    let kept: Vec<Option<Kept>> = (0..picture.pixels.len()).into_par_iter().map(|at| kept(buckets, at)).collect();
    for (pixel, kept) in picture.pixels.iter_mut().zip(&kept) {
        *pixel = kept.as_ref().map_or(*pixel, |kept| kept.light);
    }
    // As much of the pixel is opaque as sends the light that is left.
    for (alpha, kept) in picture.alpha.iter_mut().flatten().zip(&kept) {
        *alpha = kept.as_ref().map_or(*alpha, |kept| kept.alpha);
    }
    Ok(picture)
}

/// How many standard deviations of darker buckets a brighter one may be above their mean.
const FAR: f64 = 8.0;
/// How many times as bright as their mean it may be, however equal they are: what is less changes its pixel little.
const BRIGHT: f64 = 1.5;

/// What is left of a pixel.
struct Kept {
    light: [f32; 3],
    alpha: f32,
}

/// A pixel without its brightest buckets, one after the other, that are far brighter than all darker ones: at most a third of them. None if
/// there are no such.
fn kept(buckets: &[Bucket], at: usize) -> Option<Kept> {
    let mut order: Vec<&Bucket> = buckets.iter().collect();
    let bright = |bucket: &Bucket| brightness(&bucket.picture.pixels[at]);
    order.sort_by(|a, b| bright(a).total_cmp(&bright(b)));
    let means: Vec<f64> = order.iter().map(|bucket| bright(bucket)).collect();
    let left = left(&means);
    if left == order.len() {
        return None;
    }
    let (mut light, mut alpha, mut samples) = ([0.0; 3], 0.0, 0.0);
    for Bucket { picture, samples: count } in &order[..left] {
        let weight = f64::from(*count);
        light = [0, 1, 2].map(|i| light[i] + weight * f64::from(picture.pixels[at][i]));
        alpha += weight * picture.alpha.as_ref().map_or(1.0, |alpha| f64::from(alpha[at]));
        samples += weight;
    }
    Some(Kept { light: light.map(|channel| (channel / samples) as f32), alpha: (alpha / samples) as f32 })
}

/// How many of the sorted means are left.
fn left(means: &[f64]) -> usize {
    let least = means.len() - means.len() / 3;
    let mut left = means.len();
    while left > least && is_far(means[left - 1], &means[..left - 1]) {
        left -= 1;
    }
    left
}

/// Is something far brighter than all of these? Where they are equal to the last bit they show something even, and it shows the edge of
/// something else.
fn is_far(bright: f64, others: &[f64]) -> bool {
    let count = others.len() as f64;
    let middle = others.iter().sum::<f64>() / count;
    let squares = others.iter().map(|other| (other - middle) * (other - middle)).sum::<f64>();
    let deviation = (squares / (count - 1.0)).sqrt();
    let is_even = others.first() == others.last();
    !is_even && bright > (middle + FAR * deviation).max(BRIGHT * middle)
}

fn brightness(colour: &[f32; 3]) -> f64 {
    colour.iter().map(|&channel| f64::from(channel)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of one pixel in buckets of these means, all of as many samples.
    fn robust(means: &[[f32; 3]]) -> [f32; 3] {
        let picture = |pixel| Picture::from_pixels(1, 1, vec![pixel]).unwrap();
        let buckets: Vec<Bucket> = means.iter().map(|&mean| Bucket { picture: picture(mean), samples: 4 }).collect();
        let sum = means.iter().fold([0.0; 3], |sum, mean| [0, 1, 2].map(|i| sum[i] + mean[i]));
        without(picture(sum.map(|channel| channel / means.len() as f32)), &buckets).unwrap().pixels[0]
    }

    fn grey(values: &[f32]) -> f32 {
        robust(&values.iter().map(|&value| [value; 3]).collect::<Vec<_>>())[0]
    }

    #[test]
    fn equal_buckets_are_their_mean_and_bright_ones_are_left_out() {
        assert_eq!((grey(&[2.0; 15]), grey(&[0.0; 9])), (2.0, 0.0));
        let noisy: Vec<f32> = (0..15).map(|i| 1.0 + 0.1 * (i % 3) as f32).collect();
        for fireflies in [&[(3, 1e4)][..], &[(0, 1e6), (9, 1e4)], &[(1, 40.0)]] {
            let mut means = noisy.clone();
            fireflies.iter().for_each(|&(i, bright)| means[i] = bright);
            let left = grey(&means);
            assert!((0.99..1.25).contains(&left), "{fireflies:?}: {left}");
        }
    }

    /// What more than a third of the buckets have is no firefly, and neither is what stands out a little.
    #[test]
    fn light_that_many_samples_find_stays() {
        let half: Vec<f32> = (0..15).map(|i| if i % 2 == 0 { 0.0 } else { 10.0 }).collect();
        assert_eq!(grey(&half), 70.0 / 15.0);
        let even: Vec<f32> = (0..16).map(|i| 1.0 + i as f32 / 16.0).collect();
        assert_eq!(grey(&even), even.iter().sum::<f32>() / 16.0);
    }

    /// A pixel of which few samples show something else than an even background, black or not.
    #[test]
    fn edges_are_no_fireflies() {
        for (background, other) in [(0.0, 1.0), (1.0, 30.0)] {
            let edge: Vec<f32> = (0..15).map(|i| if i < 1 { other } else { background }).collect();
            assert!((grey(&edge) - (14.0 * background + other) / 15.0).abs() < 1e-6);
        }
    }

    #[test]
    fn colours_stay_together() {
        let mut means = [[1.0, 0.0, 0.0], [0.9, 0.1, 0.0], [1.1, 0.0, 0.1]].repeat(5);
        means[4] = [0.0, 50.0, 50.0];
        let [red, green, blue] = robust(&means);
        assert!(red > 0.9 && green < 0.15 && blue < 0.15, "{red} {green} {blue}");
    }

    /// Larger buckets count for more, and what is left out takes along how opaque it was.
    #[test]
    fn what_is_left_is_the_mean_of_its_samples() {
        let bucket = |light: f32, opaque: f32, samples| {
            let picture = Picture::from_pixels(1, 1, vec![[light; 3]]).unwrap();
            Bucket { picture: Picture { alpha: Some(vec![opaque]), ..picture }, samples }
        };
        let mut buckets: Vec<Bucket> = (0..8).map(|i| bucket(1.0 + i as f32 / 100.0, 0.5, 1)).collect();
        buckets.push(bucket(0.5, 0.25, 8));
        buckets.push(bucket(1000.0, 1.0, 1));
        let all = Picture { alpha: Some(vec![0.4]), ..Picture::from_pixels(1, 1, vec![[59.5; 3]]).unwrap() };
        let left = without(all, &buckets).unwrap();
        let (light, alpha) = (left.pixels[0][0], left.alpha.unwrap()[0]);
        assert!((light - (8.28 + 4.0) / 16.0).abs() < 1e-6 && (alpha - 0.375).abs() < 1e-6, "{light} {alpha}");
    }

    /// Of noise without outliers nothing is left out.
    #[test]
    fn what_is_evenly_noisy_keeps_its_light() {
        let mut state = 1u32;
        let mut drawn = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            0.8 + 0.4 * (state >> 8) as f32 / (1 << 24) as f32
        };
        for _ in 0..4000 {
            let means: Vec<f32> = (0..15).map(|_| drawn()).collect();
            assert_eq!(grey(&means), means.iter().sum::<f32>() / 15.0);
        }
    }

    #[test]
    fn buckets_are_all_samples_once() {
        for (count, samples) in [(15, 0..64), (9, 10..19), (64, 0..1000)] {
            let ranges = Buckets::new(count).unwrap().of(samples.clone()).unwrap();
            assert_eq!(ranges.iter().cloned().flatten().collect::<Vec<_>>(), samples.collect::<Vec<_>>());
            let lengths = ranges.iter().map(|range| range.len());
            assert!(ranges.len() == count as usize && lengths.clone().max().unwrap() - lengths.min().unwrap() <= 1);
        }
        assert!(Buckets::new(15).unwrap().of(0..14).unwrap_err().message().contains("15 buckets take as many samples"));
        for count in [0, 1, 8, 65] {
            assert!(Buckets::new(count).is_err(), "{count}");
        }
    }
}
