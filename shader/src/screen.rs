//! What a screen shows of a film that lies on a device: each channel's 8 bits, found by comparing its sum with the least sum of each
//! value. Whole numbers are compared and nothing is rounded, so the pixels are those of a picture's file, whatever the device.

use crate::buffer::read;
use crate::data::Quanta;
use crate::stage::{FilmWords, Row};
use bytemuck::{Pod, Zeroable};

/// What the kernel is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Screen {
    /// Columns of the film.
    pub columns: u32,
    /// Its rows.
    pub rows: u32,
    /// Words of the light of a pixel.
    pub light: u32,
    /// Arbitrary output variables of a pixel.
    pub aovs: u32,
    /// Where the film's first pixel is in what is shown.
    pub first: u32,
    /// Pixels of a row of what is shown, with those that only fill it.
    pub stride: u32,
    /// Nothing: records are words of 16 bytes.
    pub unused: u32,
    /// Likewise.
    pub unused_too: u32,
}

/// Values of a channel that have a least sum: all but 0.
pub const VALUES: u32 = 255;

/// Words of a sum.
const WORDS: u32 = 3;

/// A pixel of the film: red in the lowest byte, then green and blue, and 255 for opaque. `least` has the least sum of each value from 1
/// on, [`VALUES`] of them in ascending order, each as a film has its sums.
#[inline(always)]
pub fn shown(screen: &Screen, (x, y): (u32, u32), film: &[u32], least: &[u32]) -> u32 {
    let row = Row::new(y, screen.columns, FilmWords { light: screen.light, aovs: screen.aovs });
    let first = row.first + x;
    let red = value(sum(film, first, row.columns), least);
    let green = value(sum(film, first + WORDS * row.columns, row.columns), least);
    let blue = value(sum(film, first + 2 * WORDS * row.columns, row.columns), least);
    red | green << 8 | blue << 16 | 255 << 24
}

/// A sum whose words lie so far apart.
#[inline(always)]
fn sum(words: &[u32], first: u32, apart: u32) -> Quanta {
    Quanta(read(words, first), read(words, first + apart), read(words, first + 2 * apart), 0)
}

/// How many values a sum reaches.
#[inline(always)]
fn value(sum: Quanta, least: &[u32]) -> u32 {
    let (mut reached, mut step) = (0, 128);
    while step > 0 {
        if !is_less(sum, self::sum(least, WORDS * (reached + step - 1), 1)) {
            reached += step;
        }
        step /= 2;
    }
    reached
}

/// Is a sum of 96 bits less than another?
#[inline(always)]
fn is_less(a: Quanta, b: Quanta) -> bool {
    let (high, other) = (a.2 as i32, b.2 as i32);
    high < other || high == other && (a.1 < b.1 || a.1 == b.1 && a.0 < b.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quanta(number: i128) -> Quanta {
        Quanta(number as u32, (number >> 32) as u32, (number >> 64) as u32, 0)
    }

    #[test]
    fn a_sum_has_the_value_whose_least_it_reaches_last() {
        // Some in each of the three words, and below zero.
        let leasts: Vec<i128> = (-20..235i128).map(|step| step * step * step * (1 << 50) + step).collect();
        let words: Vec<u32> =
            leasts.iter().flat_map(|&least| [0, 32, 64].map(|shift| (least >> shift) as u32)).collect();
        let around = leasts.iter().flat_map(|&least| [least - 1, least, least + 1]);
        for sum in around.chain([-(1 << 94), -1, 0, 1, 1 << 32, 1 << 64, 1 << 94]) {
            let reached = leasts.iter().filter(|&&least| least <= sum).count() as u32;
            assert_eq!(value(quanta(sum), &words), reached, "{sum}");
        }
    }
}
