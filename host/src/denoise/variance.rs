//! How noisy pixels are.

use rayon::prelude::*;

use super::surface::{Surface, weight};

/// Around each pixel so many others along each axis tell how noise really is.
const REACH: isize = 5;
/// Squares of differences that are more than so many times what noise explains are edges, of which no more counts.
const EDGE: f32 = 4.0;

/// Pixels that variances are of.
pub(super) struct Field<'f> {
    pub width: usize,
    pub height: usize,
    pub brightness: &'f [f32],
    pub surfaces: &'f [Surface],
}

impl Field<'_> {
    /// Variances of pixels by those that their samples tell. Squares of samples that are placed evenly, as Sobol's are, overstate noise,
    /// and neighbours on one surface differ by what it really is: a variance is lowered to that. Then it becomes the mean of those
    /// around, since that of few samples is itself noisy.
    pub fn variances(&self, told: &[f32]) -> Vec<f32> {
        let differences = self.each(|x, y| self.differences(told, x, y));
        let rows = self.each(|x, y| self.sum(&differences, (-REACH..=REACH).map(|d| (x + d, y))));
        let lowered = self.each(|x, y| {
            let [found, expected] = self.sum(&rows, (-REACH..=REACH).map(|d| (x, y + d)));
            let share = if expected > 0.0 { (found / expected).min(1.0) } else { 1.0 };
            told[self.at(x, y)] * share
        });
        self.each(|x, y| self.smooth(&lowered, x, y))
    }

    fn each<T: Send>(&self, of: impl Fn(isize, isize) -> T + Sync) -> Vec<T> {
        let (of, width) = (&of, self.width as isize);
        (0..self.height as isize).into_par_iter().flat_map_iter(|y| (0..width).map(move |x| of(x, y))).collect()
    }

    /// The place of a pixel, at the edges that of the outermost.
    fn at(&self, x: isize, y: isize) -> usize {
        let within = |at: isize, size: usize| at.clamp(0, size as isize - 1) as usize;
        within(y, self.height) * self.width + within(x, self.width)
    }

    fn sum(&self, of: &[[f32; 2]], places: impl Iterator<Item = (isize, isize)>) -> [f32; 2] {
        places.fold([0.0; 2], |sum, (x, y)| {
            let [a, b] = of[self.at(x, y)];
            [sum[0] + a, sum[1] + b]
        })
    }

    /// Squares of differences from the four beside it, as far as they are alike, and what noise that is told makes of them.
    fn differences(&self, told: &[f32], x: isize, y: isize) -> [f32; 2] {
        let p = self.at(x, y);
        [(1, 0), (0, 1), (-1, 0), (0, -1)].into_iter().fold([0.0; 2], |sum, (dx, dy)| {
            let q = self.at(x + dx, y + dy);
            let like = weight(self.surfaces[p].unlike(&self.surfaces[q], dx, dy));
            let (difference, expected) = (self.brightness[p] - self.brightness[q], told[p] + told[q]);
            [sum[0] + like * (difference * difference).min(EDGE * expected), sum[1] + like * expected]
        })
    }

    /// The mean of a pixel and those of the eight around it that are like it.
    fn smooth(&self, variances: &[f32], x: isize, y: isize) -> f32 {
        let p = self.at(x, y);
        let offsets = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
        let [sum, weights] = offsets.fold([0.0; 2], |sum, (dx, dy)| {
            let q = self.at(x + dx, y + dy);
            let like = if p == q { 1.0 } else { weight(self.surfaces[p].unlike(&self.surfaces[q], dx, dy)) };
            [sum[0] + like * variances[q], sum[1] + like]
        });
        sum / weights
    }
}
