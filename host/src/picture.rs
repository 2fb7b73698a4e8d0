//! The developed picture: linear light, before any encoding for a screen or a file.

use rayon::prelude::*;
use sha2::{Digest, Sha256};

use crate::about::About;
use crate::error::{Error, Result};

/// A picture in linear RGB (Rec. 709 primaries, 1.0 is a screen's white), values of any size.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Width in pixels, 1 to [`Picture::MAX_SIDE`].
    pub width: u32,
    /// Height in pixels, 1 to [`Picture::MAX_SIDE`].
    pub height: u32,
    /// `width * height` pixels, row-major from the top left.
    pub pixels: Vec<[f32; 3]>,
    /// How much of each pixel is opaque, from 0 to 1, where the surroundings were left out: the pixels are of light that this share of them
    /// sends, as films and compositors have it (associated).
    pub alpha: Option<Vec<f32>>,
    pub(crate) noise: Option<f64>,
    /// What a file says of it.
    pub about: About,
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
        Ok(Picture { width, height, pixels, alpha: None, noise: None, about: About::default() })
    }

    /// A picture of given pixels, row-major from the top left.
    ///
    /// # Errors
    /// As [`Picture::validate`].
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Result<Self> {
        let picture = Picture { width, height, pixels, alpha: None, noise: None, about: About::default() };
        picture.validate()?;
        Ok(picture)
    }

    /// The light that it has and another has not. What rounding leaves of it below zero is none.
    ///
    /// # Errors
    /// As [`Picture::validate`].
    pub(crate) fn without(&self, other: &Picture) -> Result<Picture> {
        let less = |(a, b): (&[f32; 3], &[f32; 3])| [0, 1, 2].map(|channel| (a[channel] - b[channel]).max(0.0));
        let pixels = self.pixels.iter().zip(&other.pixels).map(less).collect();
        Picture::from_pixels(self.width, self.height, pixels)
    }

    /// The same picture of other pixels, as many.
    pub(crate) fn with_pixels(&self, pixels: Vec<[f32; 3]>) -> Picture {
        // Field by field: a copy of the pixels would be thrown away.
        let Picture { width, height, ref alpha, noise, ref about, .. } = *self;
        Picture { width, height, pixels, alpha: alpha.clone(), noise, about: about.clone() }
    }

    /// The number of pixels of a size, if a picture may have it.
    ///
    /// # Errors
    /// A side of 0 or above [`Picture::MAX_SIDE`], or more than [`Picture::MAX_PIXELS`] pixels.
    pub fn check_size(width: u32, height: u32) -> Result<usize> {
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || width.max(height) > Self::MAX_SIDE || pixels > Self::MAX_PIXELS {
            return Err(Error::Size { width, height, most_side: Self::MAX_SIDE, most_pixels: Self::MAX_PIXELS });
        }
        Ok(pixels as usize)
    }

    /// Checks what the public fields cannot promise.
    ///
    /// # Errors
    /// A size that [`Picture::check_size`] refuses, or another number of pixels than it asks for.
    pub fn validate(&self) -> Result<()> {
        let count = Self::check_size(self.width, self.height)?;
        let lengths = [Some(self.pixels.len()), self.alpha.as_ref().map(Vec::len)];
        match lengths.into_iter().flatten().find(|&length| length != count) {
            Some(length) => {
                let (width, height) = (self.width, self.height);
                Err(Error::new(format!("a picture of {width}x{height} pixels has {length} of them")))
            }
            None => Ok(()),
        }
    }

    /// The noise of a picture whose integrator samples: the standard error of a pixel (root mean square) over the mean of all,
    /// estimated from how much samples differ within pixels. Of samples that are placed evenly, as Sobol's are, it is too high.
    /// None of one sample, of a black picture, or without samples.
    pub fn noise(&self) -> Option<f64> {
        self.noise
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
    /// pixels' channels in order as `f32`, all little-endian; then of how opaque they are, if the picture tells it. Equal pictures have equal hashes on every machine.
    pub fn hash(&self) -> String {
        let mut digest = Sha256::new();
        digest.update(self.width.to_le_bytes());
        digest.update(self.height.to_le_bytes());
        for run in self.pixels.chunks(1 << 12) {
            let bytes: Vec<[u8; 4]> = run.as_flattened().iter().map(|v| v.to_le_bytes()).collect();
            digest.update(bytes.as_flattened());
        }
        for share in self.alpha.iter().flatten() {
            digest.update(share.to_le_bytes());
        }
        hexadecimal(&digest.finalize())
    }

    /// Whether size and every bit agree: 0 and -0 differ, equal NaNs do not.
    pub fn bits_equal(&self, other: &Picture) -> bool {
        self.width == other.width
            && self.height == other.height
            && self.pixels.len() == other.pixels.len()
            && self.pixels.iter().zip(&other.pixels).all(|(&a, &b)| !bits_differ(a, b))
            && alpha_bits(self).eq(alpha_bits(other))
    }
}

fn alpha_bits(picture: &Picture) -> impl Iterator<Item = u32> {
    picture.alpha.iter().flatten().map(|share| share.to_bits())
}

/// Bytes of a hash as people write them.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
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
