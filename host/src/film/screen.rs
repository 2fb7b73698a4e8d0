//! What a screen shows of a film.

use eyerays_shader::data::Quanta;
use eyerays_shader::screen::VALUES;
use eyerays_shader::stage::LIGHT_FRACTION;

use super::develop::mean;
use crate::error::Result;
use crate::image::{Encoding, ToneMap, least_of_byte};

/// The least sums of a pixel's samples for which a screen shows each value of a channel but 0: with them a device that holds a film finds
/// the pixels that [`screen`](crate::image::screen) has of its picture, to the bit, and without any rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct Leasts {
    /// The least light of each value, as a picture has it.
    light: Vec<f32>,
    /// Of which the sums are the mean.
    samples: u32,
}

impl Leasts {
    /// For films of so many samples a pixel. None where a channel's value is not its own light's alone, by a tone map or another white.
    ///
    /// # Errors
    /// An exposure out of range.
    pub fn new(encoding: &Encoding, samples: u32) -> Result<Option<Leasts>> {
        let scale = encoding.scale()?;
        if encoding.tone != ToneMap::None || encoding.white.is_some() {
            return Ok(None);
        }
        Ok(Some(Leasts { light: (1..=VALUES as u8).map(|value| least_light(value, scale)).collect(), samples }))
    }

    /// The same for films of another number of samples.
    #[must_use]
    pub fn of(self, samples: u32) -> Leasts {
        Leasts { samples, ..self }
    }

    /// The sums, as a film has them.
    pub(crate) fn words(&self) -> Vec<u32> {
        let words = self.light.iter().map(|&light| {
            let sum = least_sum(light, self.samples);
            [0, 32, 64].map(|shift| (sum >> shift) as u32)
        });
        words.flatten().collect()
    }
}

/// The least light that is shown as a value; infinite where none is.
fn least_light(value: u8, scale: f64) -> f32 {
    let least = least_of_byte(value);
    // The bits of positive numbers have their order.
    let (mut below, mut above) = (0, f32::INFINITY.to_bits());
    while above - below > 1 {
        let middle = u32::midpoint(below, above);
        let reaches = f64::from(f32::from_bits(middle)) * scale >= least;
        *(if reaches { &mut above } else { &mut below }) = middle;
    }
    f32::from_bits(above)
}

/// More than any sum of a film.
const MOST: i128 = 1 << 94;

/// The least sum whose mean of so many samples is this light or more.
fn least_sum(light: f32, samples: u32) -> i128 {
    let reaches =
        |sum: i128| mean(Quanta(sum as u32, (sum >> 32) as u32, (sum >> 64) as u32, 0), samples) as f32 >= light;
    let quanta = (1u64 << LIGHT_FRACTION) as f64;
    let guess = ((f64::from(light) * f64::from(samples) * quanta) as i128).min(MOST);
    // It lies near the guess: ever farther away on both sides until it lies between.
    let (mut below, mut above, mut reach) = (guess, guess, 1);
    while below > -MOST && reaches(below) {
        below = (guess - reach).max(-MOST);
        reach *= 2;
    }
    reach = 1;
    while above < MOST && !reaches(above) {
        above = (guess + reach).min(MOST);
        reach *= 2;
    }
    while above - below > 1 {
        let middle = below.midpoint(above);
        *(if reaches(middle) { &mut above } else { &mut below }) = middle;
    }
    above
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::image::quantise_to_byte;

    fn shown(sum: i128, samples: u32, scale: f64) -> u8 {
        let quanta = Quanta(sum as u32, (sum >> 32) as u32, (sum >> 64) as u32, 0);
        quantise_to_byte(f64::from(mean(quanta, samples) as f32) * scale)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        /// Of any exposure and number of samples: one quantum less is shown as less.
        #[test]
        fn each_value_begins_at_its_least_sum(stops in -25.0f32..40.0, samples in 1u32..=1 << 24, value in 1u8..=255) {
            let encoding = Encoding { exposure_ev: stops, ..Encoding::default() };
            let scale = encoding.scale().unwrap();
            let leasts = Leasts::new(&encoding, samples).unwrap().unwrap();
            let words = leasts.words();
            let at = 3 * (usize::from(value) - 1);
            let sum = words[at..at + 3].iter().rev().fold(0i128, |sum, &word| sum << 32 | i128::from(word));
            prop_assert!(shown(sum, samples, scale) >= value);
            prop_assert!(shown(sum - 1, samples, scale) < value);
        }
    }

    #[test]
    fn tone_maps_and_whites_mix_channels() {
        let neutral = Encoding { tone: ToneMap::Neutral, ..Encoding::default() };
        assert_eq!(Leasts::new(&neutral, 1).unwrap(), None);
        let warm = Encoding { white: Some(crate::image::WhiteBalance::of(3000.0).unwrap()), ..Encoding::default() };
        assert_eq!(Leasts::new(&warm, 1).unwrap(), None);
    }

    #[test]
    fn what_no_light_reaches_no_sum_reaches() {
        let dark = Encoding { exposure_ev: -256.0, ..Encoding::default() };
        let words = Leasts::new(&dark, 1).unwrap().unwrap().words();
        assert!(words.chunks(3).all(|least| least == [0, 0, 1 << 30]), "{words:?}");
    }
}
