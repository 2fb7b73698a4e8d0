//! Differences as colours.

use super::{check_sizes, difference};
use crate::error::Result;
use crate::image::srgb_to_linear;
use crate::math;
use crate::picture::{Picture, bits_differ};

/// One colour a decade, sRGB: the "inferno" map of matplotlib 2.0 (CC0) at 0.2, 0.3, ..., 1.0.
/// Its lightness grows evenly, and it begins where it can be told from black.
const COLOURS: [u32; 9] =
    [0x42_0a_68, 0x6a_17_6e, 0x93_26_67, 0xbc_37_54, 0xdd_51_3a, 0xf3_78_19, 0xfc_a5_0a, 0xf6_d7_46, 0xfc_ff_a4];

/// The decade of the first colour.
const FIRST_DECADE: f64 = -8.0;

/// A picture that shows where two pictures differ and how much, by the largest absolute difference of
/// a pixel's channels in linear light. Black is equal in every bit. Above it is a logarithmic
/// scale from dark violet for 1e-8 and less over red for 1e-5 and orange for 1e-3 to pale yellow
/// for 1 and more, a colour a decade; a difference to infinity or NaN is pale yellow as well.
///
/// # Errors
/// As [`super::compare()`].
pub fn heat_map(a: &Picture, b: &Picture) -> Result<Picture> {
    check_sizes(a, b)?;
    let pixels = a.pixels.iter().zip(&b.pixels);
    let heat = pixels.map(|(&a, &b)| {
        if bits_differ(a, b) {
            let differences = [0, 1, 2].map(|i| difference(a[i], b[i]));
            colour(differences.into_iter().fold(0.0, f64::max))
        } else {
            [0.0; 3]
        }
    });
    Picture::from_pixels(a.width, a.height, heat.collect())
}

/// The linear colour of a difference of at least 0.
fn colour(difference: f64) -> [f32; 3] {
    let last = (COLOURS.len() - 1) as f64;
    mixed((math::log10(difference) - FIRST_DECADE).clamp(0.0, last))
}

/// The linear colour of a share of the greatest number, from 0 to 1: black, dark violet, red, orange, pale yellow.
pub fn ramp(share: f64) -> [f32; 3] {
    // Below the first colour it fades to black.
    let place = share.clamp(0.0, 1.0) * COLOURS.len() as f64 - 1.0;
    if place < 0.0 { mixed(0.0).map(|channel| channel * (place + 1.0) as f32) } else { mixed(place) }
}

/// Between two colours.
fn mixed(place: f64) -> [f32; 3] {
    let below = (place as usize).min(COLOURS.len() - 2);
    let share = place - below as f64;
    // Mixed as sRGB, where even steps look even.
    [16, 8, 0].map(|shift| {
        let channel = |i: usize| f64::from((COLOURS[i] >> shift) & 0xff) / 255.0;
        srgb_to_linear(channel(below) * (1.0 - share) + channel(below + 1) * share) as f32
    })
}
