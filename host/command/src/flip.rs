//! How far two pictures look apart to a person who sees one after the other: LDR-FLIP.
//!
//! P. Andersson and others, "FLIP: A Difference Evaluator for Alternating Images", High Performance Graphics 2020, by the
//! authors' own code. It is C++ with the platform's mathematical functions, so last digits depend on the platform.

use eyerays::compare::check_sizes;
use eyerays::error::Result;
use eyerays::image::{quantise_to_byte, srgb_to_linear};
use eyerays::picture::Picture;
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8};
use rayon::prelude::*;

/// Sides of the squares that are compared at once: the authors' code runs on one thread, and takes 82 bytes a pixel.
const SIDE: u32 = 256;

/// How many pixels beyond its own a square needs: the radius of the wider filter at [`DEFAULT_PIXELS_PER_DEGREE`].
const MARGIN: u32 = 10;

/// The error of every pixel.
pub struct Flip {
    width: u32,
    height: u32,
    errors: Vec<f32>,
}

impl Flip {
    /// Compares two pictures as a PNG of 8 bits shows them, seen from where a degree has 67 pixels: 0.7 m from a screen that
    /// is 0.7 m wide and has 3840 pixels a line. NaN is black, and infinity as bright as white.
    ///
    /// # Errors
    /// An invalid picture and unequal sizes.
    pub fn new(a: &Picture, b: &Picture) -> Result<Flip> {
        check_sizes(a, b)?;
        let (width, height) = (a.width, a.height);
        let squares: Vec<Square> = squares(width, height).collect();
        let errors_of = |square: &Square| square.errors(a, b);
        let parts: Vec<Vec<f32>> = squares.par_iter().map(errors_of).collect();
        let mut errors = vec![0.0; a.pixels.len()];
        for (square, part) in squares.iter().zip(&parts) {
            for (y, line) in (square.y..).zip(part.chunks_exact(square.width as usize)) {
                let start = place(width, square.x, y);
                errors[start..start + line.len()].copy_from_slice(line);
            }
        }
        Ok(Flip { width, height, errors })
    }

    /// The mean over all pixels, from 0, which looks equal, to 1.
    pub fn mean(&self) -> f64 {
        let sum: f64 = self.errors.iter().copied().map(f64::from).sum();
        sum / self.errors.len() as f64
    }

    /// The errors as a picture in the authors' colours, matplotlib's "magma": black for 0 over violet and orange to pale
    /// yellow for 1.
    ///
    /// # Errors
    /// As [`Picture::from_pixels`].
    pub fn map(&self) -> Result<Picture> {
        let bytes = nv_flip::magma_lut().to_vec();
        let linear: Vec<f32> = bytes.iter().map(|&byte| srgb_to_linear(f64::from(byte) / 255.0) as f32).collect();
        let colours = linear.as_chunks::<3>().0;
        let last = colours.len() - 1;
        let colour = |&error: &f32| colours[((error * last as f32).round() as usize).min(last)];
        Picture::from_pixels(self.width, self.height, self.errors.iter().map(colour).collect())
    }
}

/// The index of a pixel in lines of `width`.
fn place(width: u32, x: u32, y: u32) -> usize {
    y as usize * width as usize + x as usize
}

/// A part of a picture.
#[derive(Debug, Clone, Copy)]
struct Square {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

/// All of a picture, in squares of [`SIDE`] and what is left at its right and its bottom.
fn squares(width: u32, height: u32) -> impl Iterator<Item = Square> {
    let starts = |length: u32| (0..length).step_by(SIDE as usize);
    starts(height).flat_map(move |y| {
        starts(width).map(move |x| Square { x, y, width: SIDE.min(width - x), height: SIDE.min(height - y) })
    })
}

impl Square {
    /// The errors of its pixels, line by line.
    fn errors(&self, a: &Picture, b: &Picture) -> Vec<f32> {
        let around = self.with_margin(a.width, a.height);
        let [a, b] =
            [a, b].map(|picture| FlipImageRgb8::with_data(around.width, around.height, &around.bytes(picture)));
        let errors = nv_flip::flip(a, b, DEFAULT_PIXELS_PER_DEGREE).to_vec();
        let lines = errors.chunks_exact(around.width as usize).skip((self.y - around.y) as usize);
        let start = (self.x - around.x) as usize;
        let own = lines.take(self.height as usize).flat_map(|line| &line[start..start + self.width as usize]);
        own.copied().collect()
    }

    /// With the pixels around it that its errors depend on, as far as the picture has them.
    fn with_margin(&self, width: u32, height: u32) -> Square {
        let (x, y) = (self.x.saturating_sub(MARGIN), self.y.saturating_sub(MARGIN));
        let right = width.min(self.x + self.width + MARGIN);
        let bottom = height.min(self.y + self.height + MARGIN);
        Square { x, y, width: right - x, height: bottom - y }
    }

    /// Its sRGB values, line by line.
    fn bytes(&self, picture: &Picture) -> Vec<u8> {
        let lines = (self.y..self.y + self.height).map(|y| place(picture.width, self.x, y));
        let pixels = lines.flat_map(|start| picture.pixels[start..start + self.width as usize].as_flattened());
        pixels.map(|&v| quantise_to_byte(v.into())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of waves, with so much added to its red.
    fn waves(width: u32, height: u32, more: f32) -> Picture {
        let value = |i: u32| (i.wrapping_mul(2_654_435_769) >> 24) as f32 / 512.0;
        let pixels = (0..width * height).map(|i| [value(i / 5) + more, value(i / 7), value(i / 11)]);
        Picture::from_pixels(width, height, pixels.collect()).unwrap()
    }

    fn mean(a: &Picture, b: &Picture) -> f64 {
        Flip::new(a, b).unwrap().mean()
    }

    #[test]
    fn equal_pictures_look_equal() {
        for (width, height) in [(1, 1), (1, 40), (40, 1), (300, 20)] {
            let picture = waves(width, height, 0.1);
            let flip = Flip::new(&picture, &picture).unwrap();
            assert!(flip.errors.iter().all(|&error| error == 0.0));
            assert_eq!(flip.mean(), 0.0);
        }
    }

    #[test]
    fn a_greater_difference_looks_greater() {
        for (width, height) in [(1, 1), (33, 17)] {
            let picture = waves(width, height, 0.0);
            let means = [0.0, 0.02, 0.1, 0.4].map(|more| mean(&picture, &waves(width, height, more)));
            assert!(means[0] == 0.0 && means.is_sorted_by(|a, b| a < b) && means[3] < 1.0, "{means:?}");
        }
    }

    /// In one piece by the authors' code.
    #[test]
    fn squares_have_the_errors_of_the_whole() {
        for (width, height) in [(SIDE + 3, SIDE - 1), (2 * SIDE, 2 * SIDE + MARGIN / 2), (5, 3 * SIDE + 1)] {
            let pictures = [waves(width, height, 0.0), waves(width, height, 0.05)];
            let whole = Square { x: 0, y: 0, width, height };
            let [a, b] =
                pictures.each_ref().map(|picture| FlipImageRgb8::with_data(width, height, &whole.bytes(picture)));
            let wanted = nv_flip::flip(a, b, DEFAULT_PIXELS_PER_DEGREE).to_vec();
            let found = Flip::new(&pictures[0], &pictures[1]).unwrap().errors;
            assert!(found == wanted, "{width}x{height}");
        }
    }

    /// Black and white are as far apart as the paper's measure goes, but for what the filters' weights round.
    #[test]
    fn what_is_no_light_has_a_place() {
        let picture = |value: f32| Picture::from_pixels(8, 8, vec![[value; 3]; 64]).unwrap();
        let [black, white] = [picture(0.0), picture(1.0)];
        for dark in [f32::NAN, f32::NEG_INFINITY, -1.0] {
            assert_eq!(mean(&black, &picture(dark)), 0.0);
        }
        for bright in [f32::INFINITY, f32::MAX, 2.0] {
            assert_eq!(mean(&white, &picture(bright)), 0.0);
        }
        let most = mean(&picture(f32::NAN), &picture(f32::INFINITY));
        assert!(most > 0.9 && most <= 1.0, "{most}");
    }

    #[test]
    fn the_map_is_dark_where_films_look_equal() {
        let (mut a, b) = (Picture::new(64, 1).unwrap(), Picture::new(64, 1).unwrap());
        a.pixels[0] = [1.0; 3];
        let map = Flip::new(&a, &b).unwrap().map().unwrap();
        let [near, far] = [map.pixels[0], map.pixels[63]].map(|pixel| pixel.iter().sum::<f32>());
        assert!(near > 0.5 && far < 0.01, "{near} {far}");
    }

    #[test]
    fn unequal_sizes_are_refused() {
        let error = Flip::new(&waves(2, 3, 0.0), &waves(3, 2, 0.0)).err().unwrap();
        assert!(error.to_string().contains("2x3"), "{error}");
    }
}
