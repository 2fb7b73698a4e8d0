//! The light of temperatures as kernels read it, see [`eyerays_shader::data::GlowTable`].

use eyerays_shader::data::GlowTable;
use glam::DVec3;

use crate::device_scene::normalisation::flushed;
use crate::error::{Error, Result};
use crate::memory::Room;
use crate::scene::Temperature;
use crate::spectrum::{black_body, luminance};

/// The number of the last temperature.
const LAST: u32 = GlowTable::TEMPERATURES - 1;

/// Appends the table of a grid with this greatest number, each of so many kelvins, to the words of grids.
///
/// # Errors
/// It is larger than `room`, or lies beyond what devices hold.
pub fn append(greatest: f32, kelvins: f32, room: Room, words: &mut Vec<u32>) -> Result<()> {
    let fault =
        |why: &str| Error::new(format!("the light of temperatures and the grids before it {why}: make them coarser"));
    room.check(4 * u64::from(GlowTable::WORDS)).map_err(|why| fault(&why))?;
    let all = words.len() + GlowTable::WORDS as usize;
    // Kernels count words in 32 bits.
    u32::try_from(all).map_err(|_| fault("are more than devices hold"))?;
    words.try_reserve_exact(GlowTable::WORDS as usize).map_err(|_| fault("take more memory than there is"))?;
    words.extend(table(greatest, kelvins).map(f32::to_bits));
    Ok(())
}

/// How many of its temperatures a number of the grid is, and the light of each.
fn table(greatest: f32, kelvins: f32) -> impl Iterator<Item = f32> {
    let hottest = f64::from(greatest) * f64::from(kelvins);
    let glows = hottest >= Temperature::LEAST;
    let steps = if glows { (f64::from(LAST) / f64::from(greatest)) as f32 } else { 0.0 };
    let over = luminance(black_body(hottest));
    let light = move |step: u32| {
        if !glows {
            return [0.0; 3];
        }
        let light = black_body(hottest * f64::from(step) / f64::from(LAST)) / over;
        // What is beyond the colours of Rec. 709, as that of embers is in blue, is as near as they come.
        flushed(light.max(DVec3::ZERO).as_vec3()).to_array()
    };
    [steps].into_iter().chain((0..=LAST).flat_map(light))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(greatest: f32, kelvins: f32) -> Vec<f32> {
        let mut words = vec![7; 3];
        append(greatest, kelvins, Room { bytes: u64::MAX, limit: "this test" }, &mut words).unwrap();
        assert_eq!(words.len() as u32, 3 + GlowTable::WORDS);
        assert_eq!(words[..3], [7; 3]);
        words[3..].iter().map(|&word| f32::from_bits(word)).collect()
    }

    /// What kernels find at a number of the grid that falls on a step.
    fn light(words: &[f32], number: f32) -> DVec3 {
        let step = (number * words[0]).round() as usize;
        assert!((number * words[0] - step as f32).abs() < 1e-3);
        DVec3::new(words[1 + 3 * step].into(), words[2 + 3 * step].into(), words[3 + 3 * step].into())
    }

    /// Of 1000, 2000 and 3000 kelvins: linear RGB of equal luminance, and luminances over that of 3000, by CIE's observer of 1931 and Planck's
    /// formula (colour-science 0.4.7). Blue of 1000 kelvins is below nothing there.
    #[test]
    fn temperatures_have_the_light_that_others_found() {
        let words = words(3.0, 1000.0);
        for (number, luminance, colour) in [
            (1.0, 8.889_735e-8, DVec3::new(4.599_721, 0.040_065, 0.0)),
            (2.0, 1.534_620e-2, DVec3::new(2.520_021, 0.647_117, 0.020_488)),
            (3.0, 1.0, DVec3::new(1.770_742, 0.844_438, 0.272_125)),
        ] {
            let light = light(&words, number) / luminance;
            assert!(light.abs_diff_eq(colour, 0.02 * colour.x), "{number}: {light}, and {colour} was found");
        }
        assert_eq!(light(&words, 0.0), DVec3::ZERO);
    }

    #[test]
    fn every_temperature_is_a_black_body_beside_the_hottest() {
        let words = words(0.25, 8000.0);
        assert_eq!(words[0], 1020.0);
        for (step, light) in words[1..].chunks_exact(3).enumerate() {
            let want = black_body(2000.0 * step as f64 / 255.0) / luminance(black_body(2000.0));
            let light = DVec3::new(light[0].into(), light[1].into(), light[2].into());
            assert!(light.abs_diff_eq(want.max(DVec3::ZERO), 1e-6), "{step}: {light} is not {want}");
        }
    }

    /// The same light, whatever the unit of the grid's numbers.
    #[test]
    fn kelvins_are_what_counts_and_what_is_cold_does_not_glow() {
        let (by_kelvin, by_thousand) = (words(2000.0, 1.0), words(2.0, 1000.0));
        assert_eq!(by_kelvin[1..], by_thousand[1..]);
        assert!((by_thousand[0] / by_kelvin[0] - 1000.0).abs() < 1e-3);
        assert!(words(499.0, 1.0).iter().chain(&words(0.0, 1e6)).all(|&word| word == 0.0));
        let (hot, thin) = (words(1e12, 0.001), words(0.0005, 1e6));
        assert!(hot.iter().chain(&thin).all(|word| word.is_finite()));
    }

    #[test]
    fn a_table_without_room_is_refused() {
        let mut words = Vec::new();
        let refused = append(2000.0, 1.0, Room { bytes: 3000, limit: "this test" }, &mut words).unwrap_err().message();
        assert!(refused.contains("this test leaves") && refused.contains("make them coarser"), "{refused}");
        assert_eq!(words.capacity(), 0);
    }
}
