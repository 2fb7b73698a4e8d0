//! The finished picture: linear light, before any encoding for a screen or a file.

use eyerays_shader::real::Scalar;
use eyerays_shader::stage::{NON_FINITE, brightness};
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use crate::error::{Error, Result};
use crate::rays::Rays;
use crate::view::Region;

/// A picture in linear RGB (Rec. 709 primaries, 1.0 is a screen's white), values of any size.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Width in pixels, 1 to [`Picture::MAX_SIDE`].
    pub width: u32,
    /// Height in pixels, 1 to [`Picture::MAX_SIDE`].
    pub height: u32,
    /// `width * height` pixels, row-major from the top left.
    pub pixels: Vec<[f32; 3]>,
    noise: Noise,
}

/// What tells the noise of a picture whose integrator samples.
#[derive(Debug, Clone, Copy, Default)]
struct Noise {
    /// Of each pixel's mean brightness, added.
    variances: f64,
    /// Pixels' mean brightness, added.
    brightness: f64,
}

impl Picture {
    /// The longest side in pixels: Radiance HDR has run lengths for no longer line.
    pub const MAX_SIDE: u32 = 32_767;

    /// The most pixels, so that a picture is at most 1.5 GiB and every file of one can be read again.
    pub const MAX_PIXELS: u64 = 1 << 27;

    /// A black picture.
    ///
    /// # Errors
    /// A size that [`Picture::check_size`] refuses, or too little memory.
    pub fn new(width: u32, height: u32) -> Result<Self> {
        let count = Self::check_size(width, height)?;
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(count).map_err(|_| Error::Memory { width, height })?;
        // On all threads: a system takes 5 ms to hand the memory of 1920x1080 pixels to one.
        pixels.par_extend(rayon::iter::repeat_n([0.0; 3], count));
        Ok(Picture { width, height, pixels, noise: Noise::default() })
    }

    /// A picture of given pixels, row-major from the top left.
    ///
    /// # Errors
    /// As [`Picture::validate`].
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Result<Self> {
        let picture = Picture { width, height, pixels, noise: Noise::default() };
        picture.validate()?;
        Ok(picture)
    }

    /// The number of pixels of a size, if a picture may have it.
    ///
    /// # Errors
    /// A side of 0 or above [`Picture::MAX_SIDE`], or more than [`Picture::MAX_PIXELS`] pixels.
    pub fn check_size(width: u32, height: u32) -> Result<usize> {
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || width.max(height) > Self::MAX_SIDE || pixels > Self::MAX_PIXELS {
            return Err(Error::Size { width, height });
        }
        Ok(pixels as usize)
    }

    /// Checks what the public fields cannot promise.
    ///
    /// # Errors
    /// A size that [`Picture::check_size`] refuses, or another number of pixels than it asks for.
    pub fn validate(&self) -> Result<()> {
        let count = Self::check_size(self.width, self.height)?;
        if self.pixels.len() != count {
            return Err(Error::new(format!(
                "a picture of {}x{} pixels has {} of them",
                self.width,
                self.height,
                self.pixels.len()
            )));
        }
        Ok(())
    }

    /// Sets a region to the mean of `samples` samples of each pixel, whose sums a gather or accumulate stage left in
    /// `records`, row by row; and counts.
    pub(crate) fn develop<R: Scalar>(&mut self, region: Region, records: &[R::Record], samples: u32, rays: &mut Rays) {
        let sums = Sums::<R>::new(region, records, samples);
        let lines = self.pixels.chunks_mut(self.width as usize).skip(region.y as usize);
        let rows = lines.take(region.height as usize).enumerate().map(|(row, pixels)| sums.develop(row, pixels));
        self.noise = rows.fold(self.noise, |noise, row| noise.with(&row, rays));
    }

    /// The same on all threads, by one that holds no lock.
    pub(crate) fn develop_on_all_threads<R>(
        &mut self,
        region: Region,
        records: &[R::Record],
        samples: u32,
        rays: &mut Rays,
    ) where
        R: Scalar<Record: Sync>,
    {
        let sums = Sums::<R>::new(region, records, samples);
        let lines = self.pixels.par_chunks_mut(self.width as usize).skip(region.y as usize);
        let rows = lines.take(region.height as usize).enumerate().map(|(row, pixels)| sums.develop(row, pixels));
        // Added in order, so that the sum is the same however many threads there are.
        self.noise = rows.collect::<Vec<_>>().iter().fold(self.noise, |noise, row| noise.with(row, rays));
    }

    /// The noise of a picture whose integrator samples: the standard error of a pixel (root mean square) over the mean of all,
    /// estimated from how much samples differ within pixels. Of samples that are placed evenly, as Sobol's are, it is too high.
    /// None of one sample, of a black picture, or without samples.
    pub fn noise(&self) -> Option<f64> {
        let pixels = self.pixels.len() as f64;
        let noise = (self.noise.variances / pixels).sqrt() / (self.noise.brightness / pixels);
        (self.noise.variances > 0.0 && noise.is_finite()).then_some(noise)
    }

    /// The pixel in column `x` and row `y` from the top left; `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[f32; 3]> {
        if x >= self.width {
            return None;
        }
        let index = y as usize * self.width as usize + x as usize;
        self.pixels.get(index).copied()
    }

    /// SHA-256 of the size and of every bit, as 64 hexadecimal digits: of width and height as `u32`, then of the
    /// pixels' channels in order as `f32`, all little-endian. Equal pictures have equal hashes on every machine.
    pub fn hash(&self) -> String {
        let mut digest = Sha256::new();
        digest.update(self.width.to_le_bytes());
        digest.update(self.height.to_le_bytes());
        for run in self.pixels.chunks(1 << 12) {
            let bytes: Vec<[u8; 4]> = run.as_flattened().iter().map(|v| v.to_le_bytes()).collect();
            digest.update(bytes.as_flattened());
        }
        digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Whether size and every bit agree: 0 and -0 differ, equal NaNs do not.
    pub fn bits_equal(&self, other: &Picture) -> bool {
        self.width == other.width
            && self.height == other.height
            && self.pixels.len() == other.pixels.len()
            && self.pixels.iter().zip(&other.pixels).all(|(&a, &b)| !bits_differ(a, b))
    }
}

/// The sums that a device left of a region.
struct Sums<'r, R: Scalar> {
    region: Region,
    /// Light by pixel.
    sums: &'r [R::Record],
    /// What rounding took off, where light is sampled.
    rests: &'r [R::Record],
    samples: u32,
}

/// What the pixels of a row tell beside their light.
#[derive(Default)]
struct Row {
    noise: Noise,
    shadow: u64,
    non_finite: u64,
}

impl<'r, R: Scalar> Sums<'r, R> {
    fn new(region: Region, records: &'r [R::Record], samples: u32) -> Self {
        let (sums, rests) = records.split_at(region.pixels() as usize);
        Sums { region, sums, rests, samples }
    }

    /// Sets the region's part of a line of the image to means.
    fn develop(&self, row: usize, line: &mut [[f32; 3]]) -> Row {
        let width = self.region.width as usize;
        let (mut told, count, first) = (Row::default(), R::splat(self.samples as f32), row * width);
        for (i, pixel) in line[self.region.x as usize..][..width].iter_mut().enumerate() {
            let (mut sum, word) = R::load(self.sums[first + i]);
            if let Some(&rest) = self.rests.get(first + i) {
                let (rest, squares) = R::load(rest);
                sum = sum + rest;
                told.noise.add(brightness(sum).to_f32(), f32::from_bits(squares), self.samples);
            }
            *pixel = [sum.x, sum.y, sum.z].map(|channel| channel.div(count).to_f32());
            told.shadow += u64::from(word & !NON_FINITE);
            told.non_finite += u64::from(word & NON_FINITE != 0);
        }
        told
    }
}

impl Noise {
    /// With a row's, whose rays are counted too.
    fn with(self, row: &Row, rays: &mut Rays) -> Noise {
        rays.shadow += row.shadow;
        rays.non_finite += row.non_finite;
        let Noise { variances, brightness } = row.noise;
        Noise { variances: self.variances + variances, brightness: self.brightness + brightness }
    }

    /// Adds a pixel by the sums of its samples' brightness and of its squares.
    fn add(&mut self, sum: f32, squares: f32, samples: u32) {
        let (count, sum) = (f64::from(samples), f64::from(sum));
        self.brightness += sum / count;
        if samples > 1 {
            self.variances += (f64::from(squares) - sum * sum / count).max(0.0) / (count * (count - 1.0));
        }
    }
}

/// Whether two pixels differ in any bit.
pub fn bits_differ(a: [f32; 3], b: [f32; 3]) -> bool {
    a.map(f32::to_bits) != b.map(f32::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_empty_and_huge_sizes() {
        for (width, height) in [(0, 1), (1, 0), (Picture::MAX_SIDE + 1, 1), (32_767, 32_767)] {
            assert!(Picture::new(width, height).is_err(), "{width}x{height}");
        }
        assert!(Picture::new(u32::MAX, u32::MAX).is_err());
        assert_eq!(Picture::new(3, 2).unwrap().pixels.len(), 6);
    }

    #[test]
    fn refuses_a_wrong_number_of_pixels() {
        assert!(Picture::from_pixels(2, 2, vec![[0.0; 3]; 3]).is_err());
        assert!(Picture::from_pixels(2, 2, vec![[0.0; 3]; 4]).is_ok());
    }

    #[test]
    fn pixels_are_row_major() {
        let pixels = (0..6).map(|i| [i as f32; 3]).collect();
        let picture = Picture::from_pixels(3, 2, pixels).unwrap();
        assert_eq!(picture.pixel(2, 1), Some([5.0; 3]));
        assert_eq!(picture.pixel(3, 0), None);
        assert_eq!(picture.pixel(0, 2), None);
    }

    #[test]
    fn a_hash_is_of_the_size_and_of_every_bit() {
        let picture = |width, values: [f32; 6]| {
            let pixels = values.chunks(3).map(|v| [v[0], v[1], v[2]]).collect();
            Picture::from_pixels(width, 2 / width, pixels).unwrap().hash()
        };
        let values = [0.0, 1.0, -2.5, 0.1, f32::INFINITY, 3.0];
        let hash = picture(2, values);
        // By another program: Python's hashlib over struct.pack("<II6f", 2, 1, 0, 1, -2.5, 0.1, inf, 3).
        assert_eq!(hash, "c50ec7616b65874188f491001af24f58fe0abed41149058c618d2e05e247f923");
        assert_ne!(hash, picture(1, values));
        for i in 0..values.len() {
            let mut other = values;
            other[i] = f32::from_bits(other[i].to_bits() ^ if i == 0 { 1 << 31 } else { 1 });
            assert_ne!(hash, picture(2, other), "{i}");
        }
    }

    #[test]
    fn equality_is_of_bits() {
        let picture = |value| Picture::from_pixels(1, 1, vec![[value; 3]]).unwrap();
        assert!(picture(f32::NAN).bits_equal(&picture(f32::NAN)));
        assert!(!picture(0.0).bits_equal(&picture(-0.0)));
        assert!(!picture(0.0).bits_equal(&Picture::new(1, 2).unwrap()));
    }
}
