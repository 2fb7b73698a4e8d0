//! Rows of a picture, averaged with what is like them around.

use std::ops::Range;

use super::guides::Pixels;
use super::surface::weight;

/// How far neighbours are looked for, along each axis.
const RADIUS: isize = 7;
/// Around each pixel so many others along each axis are compared together, which says more than one.
const PATCH: isize = 1;
/// How many standard errors of a difference count as one.
const TOLERANCE: f32 = 0.6;

/// Rows that are denoised together.
pub(super) struct Band<'p> {
    pixels: &'p Pixels,
    rows: Range<usize>,
    /// How unlike pixels and their neighbours at an offset are, of the rows and those that patches reach around them.
    single: Vec<f32>,
    /// The same in the mean of a row's patch.
    across: Vec<f32>,
    /// Light of neighbours, weighted and added; and the weights.
    sums: Vec<[f32; 4]>,
}

impl<'p> Band<'p> {
    pub fn new(pixels: &'p Pixels, rows: Range<usize>) -> Self {
        let (count, around) = (rows.len() * pixels.width, (rows.len() + 2 * PATCH as usize) * pixels.width);
        Band { pixels, rows, single: vec![0.0; around], across: vec![0.0; around], sums: vec![[0.0; 4]; count] }
    }

    /// Averages the rows, whose pixels without noise stay as they are.
    pub fn denoise(mut self, rows: &mut [[f32; 3]]) {
        for (dx, dy) in (-RADIUS..=RADIUS).flat_map(|dy| (-RADIUS..=RADIUS).map(move |dx| (dx, dy))) {
            self.compare(dx, dy);
            self.add(dx, dy);
        }
        let first = self.rows.start * self.pixels.width;
        for (i, (pixel, sums)) in rows.iter_mut().zip(&self.sums).enumerate() {
            let (at, colour) = (first + i, self.pixels.colour[first + i]);
            if self.pixels.variance[at] > 0.0 {
                *pixel = [0, 1, 2].map(|channel| sums[channel] / sums[3] * colour[channel]);
            }
        }
    }

    /// Rows that patches reach, as those of the image: at its edges the outermost again.
    fn reached(&self) -> impl Iterator<Item = usize> + use<> {
        let (first, end, last) = (self.rows.start as isize, self.rows.end as isize, self.pixels.height as isize - 1);
        (first - PATCH..end + PATCH).map(move |y| y.clamp(0, last) as usize)
    }

    /// Compares all pixels with those at an offset.
    fn compare(&mut self, dx: isize, dy: isize) {
        let Pixels { width, height, brightness, variance, .. } = self.pixels;
        let (width, last) = (*width, *width as isize - 1);
        for (row, y) in self.reached().enumerate() {
            let other = (y as isize + dy).clamp(0, *height as isize - 1) as usize * width;
            let single = &mut self.single[row * width..(row + 1) * width];
            for (x, unlike) in single.iter_mut().enumerate() {
                let (p, q) = (y * width + x, other + (x as isize + dx).clamp(0, last) as usize);
                let (difference, own, others) = (brightness[p] - brightness[q], variance[p], variance[q]);
                // What noise alone makes of the square of a difference is taken off.
                let beyond = difference * difference - (own + own.min(others));
                *unlike = beyond / (TOLERANCE * TOLERANCE * (own + others) + f32::MIN_POSITIVE);
            }
            let across = &mut self.across[row * width..(row + 1) * width];
            for (x, mean) in across.iter_mut().enumerate() {
                let at = |x: isize| single[x.clamp(0, last) as usize];
                *mean = (-PATCH..=PATCH).map(|d| at(x as isize + d)).sum();
            }
        }
    }

    /// Adds the light of those that are alike enough.
    fn add(&mut self, dx: isize, dy: isize) {
        let Pixels { width, height, .. } = *self.pixels;
        const SHARE: f32 = 1.0 / ((2 * PATCH + 1) * (2 * PATCH + 1)) as f32;
        for (row, y) in self.rows.clone().enumerate() {
            let other = y as isize + dy;
            if !(0..height as isize).contains(&other) {
                continue;
            }
            let inside = (-dx).max(0) as usize..(width as isize - dx.max(0)).max(0) as usize;
            for x in inside {
                let (p, q) = (y * width + x, other as usize * width + (x as isize + dx) as usize);
                let patch: f32 = (0..=2 * PATCH as usize).map(|d| self.across[(row + d) * width + x]).sum();
                let surfaces = &self.pixels.surface;
                let unlike = (patch * SHARE).max(surfaces[p].unlike(&surfaces[q], dx, dy)).max(0.0);
                // A pixel is like itself, whatever its noise.
                let weight = if p == q { 1.0 } else { weight(unlike) };
                let (sums, light) = (&mut self.sums[row * width + x], self.pixels.light[q]);
                (0..3).for_each(|channel| sums[channel] += weight * light[channel]);
                sums[3] += weight;
            }
        }
    }
}
