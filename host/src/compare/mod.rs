//! How far two pictures are apart, in bits and in light.

mod heat;
mod ulp;

use std::fmt;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::math;
use crate::picture::{Picture, bits_differ};

pub use heat::{heat_map, ramp};
pub use ulp::ulp_distance;

/// What [`compare`] found. As JSON, infinite numbers are `null`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Width of both pictures in pixels.
    pub width: u32,
    /// Height of both pictures in pixels.
    pub height: u32,
    /// Whether no bit differs. 0 and -0 differ; NaNs of the same bits do not.
    pub bit_equal: bool,
    /// Pixels in which any bit differs.
    pub differing_pixels: u64,
    /// The largest [`ulp_distance`] of two channel values.
    pub largest_ulps: u32,
    /// The largest difference of two channel values, in linear light. Infinite where the bits
    /// differ and either value is infinite or NaN.
    pub largest_difference: f64,
    /// Root of the mean square difference over all channel values, in linear light; infinite if
    /// a difference is.
    pub rmse: f64,
    /// Peak signal-to-noise ratio in dB with a peak of 1.0: infinite if the RMSE is 0, and minus
    /// infinity if that is infinite.
    pub psnr: f64,
    /// Channel values of either picture that are infinite or NaN.
    pub non_finite: [u64; 2],
}

/// Measures the differences of two pictures.
///
/// # Errors
/// An invalid picture and unequal sizes.
pub fn compare(a: &Picture, b: &Picture) -> Result<Comparison> {
    check_sizes(a, b)?;
    let pairs = || a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    let pixels = a.pixels.iter().zip(&b.pixels);
    let differing_pixels = pixels.filter(|&(&a, &b)| bits_differ(a, b)).count() as u64;
    let squares: f64 = pairs().map(|(&a, &b)| difference(a, b)).map(|d| d * d).sum();
    let rmse = (squares / (a.pixels.len() * 3) as f64).sqrt();
    Ok(Comparison {
        width: a.width,
        height: a.height,
        bit_equal: differing_pixels == 0,
        differing_pixels,
        largest_ulps: pairs().map(|(&a, &b)| ulp_distance(a, b)).max().unwrap_or(0),
        largest_difference: pairs().map(|(&a, &b)| difference(a, b)).fold(0.0, f64::max),
        rmse,
        // Not -20 log 0, which is as infinite, lest it be "-0" at an RMSE of 1.
        psnr: 20.0 * math::log10(rmse.recip()),
        non_finite: [a, b].map(non_finite),
    })
}

impl Comparison {
    /// Whether the pictures are further apart than is tolerated: by the largest difference in
    /// linear light, and at a tolerance of 0 or less by any bit, be it the sign of a zero.
    pub fn exceeds(&self, tolerance: f32) -> bool {
        if tolerance > 0.0 { self.largest_difference > tolerance.into() } else { !self.bit_equal }
    }
}

impl fmt::Display for Comparison {
    /// Aligned lines for a terminal, without a last line feed.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pixels = u64::from(self.width) * u64::from(self.height);
        let equal = if self.bit_equal { "yes" } else { "no" };
        let ulps = match self.largest_ulps {
            u32::MAX => "not a number".to_owned(),
            ulps => ulps.to_string(),
        };
        writeln!(out, "size                {} x {}", self.width, self.height)?;
        writeln!(out, "equal in every bit  {equal}")?;
        writeln!(out, "differing pixels    {} of {pixels}", self.differing_pixels)?;
        writeln!(out, "largest ulps        {ulps}")?;
        writeln!(out, "largest difference  {}", short(self.largest_difference))?;
        writeln!(out, "RMSE                {}", short(self.rmse))?;
        writeln!(out, "PSNR                {:.2} dB", self.psnr)?;
        let [a, b] = self.non_finite;
        write!(out, "non-finite values   {a} and {b}")
    }
}

/// Seven digits, and plain where a number is plain.
fn short(x: f64) -> String {
    if x == 0.0 { "0".to_owned() } else { format!("{x:.6e}") }
}

/// Refuses pictures that cannot be compared pixel by pixel.
///
/// # Errors
/// An invalid picture and unequal sizes.
pub fn check_sizes(a: &Picture, b: &Picture) -> Result<()> {
    a.validate()?;
    b.validate()?;
    if (a.width, a.height) == (b.width, b.height) {
        return Ok(());
    }
    Err(Error::new(format!(
        "the images differ in size, {}x{} and {}x{} pixels; compare images of one size",
        a.width, a.height, b.width, b.height
    )))
}

/// The absolute difference, as [`Comparison::largest_difference`] counts it.
fn difference(a: f32, b: f32) -> f64 {
    if a.to_bits() == b.to_bits() {
        0.0
    } else if a.is_finite() && b.is_finite() {
        (f64::from(a) - f64::from(b)).abs()
    } else {
        f64::INFINITY
    }
}

fn non_finite(picture: &Picture) -> u64 {
    let values = picture.pixels.as_flattened().iter();
    values.filter(|value| !value.is_finite()).count() as u64
}

#[cfg(test)]
mod tests;
