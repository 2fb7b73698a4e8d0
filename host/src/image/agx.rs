//! AgX as Blender 4 has it: a table that its authors' formulas fill.
//!
//! The table is that of Eary Chow's [AgX_LUT_Gen](https://github.com/EaryChow/AgX_LUT_Gen) (`AgXBasesRGB.py`), after Troy Sobotka's
//! AgX: 37 entries for each channel of light in E-Gamut, by stops from 10 below a grey of 0.18 to 15 above it. Blender interpolates
//! between them in tetrahedra, which differs from the formulas by up to 2e-3; so does this.

use std::sync::OnceLock;

use super::tone::{INSET, Matrix, OUTSET, TO_REC_709, TO_REC_2020, times};
use crate::math;

/// Entries along a channel.
const SIZE: usize = 37;
const GREY: f64 = 0.18;
/// Stops below grey from which a table, or the image, starts.
const BELOW: f64 = 10.0;
/// Stops of the table.
const TABLE: f64 = 25.0;
/// Stops of the image.
const IMAGE: f64 = 16.5;
/// What the curve's values are raised to, to be linear.
const POWER: f64 = 2.4;
/// The share of the hue that each channel's own curve leads to; the rest is that of before.
const MIXED: f64 = 0.4;
/// Luminance of Rec. 2020's primaries to the observers of 2015.
const LUMINANCE: [f64; 3] = [0.258_923_535_568_984_8, 0.610_498_534_606_652_5, 0.130_577_929_824_362_84];

const TO_E_GAMUT: Matrix = [
    [0.888_397_755_316_427_1, 0.002_916_356_433_747_869, 0.108_663_433_359_970_1],
    [0.025_956_387_048_950_78, 0.834_256_518_614_75, 0.139_779_272_793_405_02],
    [0.074_336_898_848_349_54, 0.070_471_577_694_146_3, 0.855_064_894_467_762_1],
];

const FROM_E_GAMUT: Matrix = [
    [1.137_588_873_202_479_5, 0.008_350_502_199_667_572, -0.145_932_245_247_024_4],
    [-0.019_087_164_934_078_936, 1.215_316_048_572_778, -0.196_244_656_675_712_86],
    [-0.097_325_626_288_876_05, -0.100_888_237_059_907_86, 1.198_362_636_273_614],
];

/// The colour on a screen, linear Rec. 709, of a colour of at least 0 in linear Rec. 709.
pub fn agx(colour: [f64; 3]) -> [f64; 3] {
    static ENTRIES: OnceLock<Vec<[f64; 3]>> = OnceLock::new();
    let entries = ENTRIES.get_or_init(|| (0..SIZE.pow(3)).map(entry).collect());
    let light = times(&TO_E_GAMUT, times(&TO_REC_2020, colour));
    let place = light.map(|v| (stops(v) / TABLE).clamp(0.0, 1.0));
    interpolated(entries, place).map(|v| math::pow(v, POWER))
}

/// Stops above the table's first; less than none for what is no light.
fn stops(light: f64) -> f64 {
    if light > 0.0 { math::log2(light / GREY) + BELOW } else { -1.0 }
}

/// Between the entries of a tetrahedron: from the entry of the cell's least corner along one channel after the other, that of which
/// the place is furthest first.
fn interpolated(entries: &[[f64; 3]], place: [f64; 3]) -> [f64; 3] {
    let scaled = place.map(|v| v * (SIZE - 1) as f64);
    let cell = scaled.map(|v| (v as usize).min(SIZE - 2));
    let within = [0, 1, 2].map(|i| scaled[i] - cell[i] as f64);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| within[b].total_cmp(&within[a]));
    let steps = [1, SIZE, SIZE * SIZE];
    let mut at = cell[0] + cell[1] * SIZE + cell[2] * SIZE * SIZE;
    let mut sum = entries[at];
    for channel in order {
        let from = entries[at];
        at += steps[channel];
        let to = entries[at];
        for i in 0..3 {
            sum[i] += (to[i] - from[i]) * within[channel];
        }
    }
    sum
}

/// An entry of the table, whose first channel changes fastest: what a screen shows, encoded.
fn entry(number: usize) -> [f64; 3] {
    let place = [number % SIZE, number / SIZE % SIZE, number / (SIZE * SIZE)].map(|i| i as f64 / (SIZE - 1) as f64);
    let light = place.map(|v| GREY * math::exp2(v * TABLE - BELOW));
    let shown = times(&TO_REC_709, formed(times(&FROM_E_GAMUT, light)));
    within_rec_709(shown).map(|v| if v > 0.0 { math::pow(v, 1.0 / POWER).min(1.0) } else { 0.0 })
}

/// The image in linear Rec. 2020 of light there.
fn formed(light: [f64; 3]) -> [f64; 3] {
    let inset = times(&INSET, within_rec_2020(light));
    let curved = inset.map(|v| {
        let shown = curve(stops(v) / IMAGE);
        if shown > 0.0 { math::pow(shown, POWER) } else { 0.0 }
    });
    times(&OUTSET, with_hue(curved, hue(inset)))
}

/// The contrast over the image's stops: a line of slope 2.4 through grey, bent at both ends by the power 1.5.
fn curve(place: f64) -> f64 {
    const SLOPE: f64 = 2.4;
    const BENT: f64 = 1.5;
    let (x, y) = (BELOW / IMAGE, math::pow(GREY, 1.0 / POWER));
    let (to_x, to_y, sign) = if place < x { (x, y, -1.0) } else { (1.0 - x, 1.0 - y, 1.0) };
    let rise = SLOPE * to_x;
    let scale = math::pow(math::pow(rise, -BENT) * (math::pow(rise / to_y, BENT) - 1.0), -1.0 / BENT);
    let along = SLOPE * (place - x) * sign / scale;
    y + sign * scale * along / math::pow(1.0 + math::pow(along, BENT), 1.0 / BENT)
}

/// Hue from 0 to 1, 0 of a grey.
fn hue(colour: [f64; 3]) -> f64 {
    let [r, g, b] = colour;
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    let range = most - least;
    if range <= 0.0 {
        return 0.0;
    }
    let sixths = if r == most {
        (g - b) / range
    } else if g == most {
        2.0 + (b - r) / range
    } else {
        4.0 + (r - g) / range
    };
    (sixths / 6.0).rem_euclid(1.0)
}

/// A colour whose hue goes most of the way back to that of before; its greatest and least channels keep their values.
fn with_hue(colour: [f64; 3], before: f64) -> [f64; 3] {
    let [r, g, b] = colour;
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    let mixed = before + MIXED * (hue(colour) - before);
    // The distance of each channel's own hue, in sixths of the circle, is how far it falls.
    [0.0, 2.0, 4.0].map(|own| {
        let away = (mixed * 6.0 - own + 3.0).rem_euclid(6.0) - 3.0;
        most - (most - least) * (away.abs() - 1.0).clamp(0.0, 1.0)
    })
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    r * LUMINANCE[0] + g * LUMINANCE[1] + b * LUMINANCE[2]
}

/// A colour that is lifted until no channel is below zero, and how bright it is by its own light and what it lacks of a grey.
fn lifted(colour: [f64; 3], luminance: impl Fn([f64; 3]) -> f64) -> ([f64; 3], f64, f64) {
    let least = colour.into_iter().fold(0.0, f64::min);
    let lifted = colour.map(|v| v - least);
    (lifted, compensated(colour, &luminance), compensated(lifted, &luminance))
}

/// The luminance of a colour, and what the greatest channel of its opponent has beyond the opponent's own.
fn compensated(colour: [f64; 3], luminance: impl Fn([f64; 3]) -> f64) -> f64 {
    let most = colour.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let opponent = colour.map(|v| most - v);
    opponent.into_iter().fold(f64::NEG_INFINITY, f64::max) - luminance(opponent) + luminance(colour)
}

/// The lower guard rail of Rec. 2020 (`compensate_low_side`).
fn within_rec_2020(colour: [f64; 3]) -> [f64; 3] {
    let (lifted, wanted, has) = lifted(colour, luminance);
    let share = if has > wanted { wanted / has } else { 1.0 };
    lifted.map(|v| v * share)
}

/// That of Rec. 709, where brighter colours are compensated less.
fn within_rec_709(colour: [f64; 3]) -> [f64; 3] {
    let own = |colour| luminance(times(&TO_REC_2020, colour));
    let (lifted, wanted, has) = lifted(colour, own);
    let less = |compensated: f64, plain: f64| {
        let share = if plain > 0.0 { math::pow(plain, 0.08).min(1.0) } else { 0.0 };
        compensated + (plain - compensated) * share
    };
    let (wanted, has) = (less(wanted, own(colour)), less(has, own(lifted)));
    let share = if has > wanted { wanted / has.max(1e-100) } else { 1.0 };
    lifted.map(|v| v * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_screen(linear: f64) -> f64 {
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
    }

    /// Of Blender 5.0, to the three digits that were read off.
    #[test]
    fn a_dark_grey_is_as_blender_shows_it() {
        let [r, g, b] = agx([0.051; 3]).map(on_screen);
        assert!([r, g, b].iter().all(|v| (v - 0.231).abs() < 6e-4), "{r} {g} {b}");
    }

    #[test]
    fn grey_is_the_curves_fixed_point() {
        assert!((math::pow(curve(BELOW / IMAGE), POWER) - GREY).abs() < 1e-12);
        assert!(curve(0.0).abs() < 1e-12 && (curve(1.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn hues_come_back_from_colours() {
        for colour in [[0.9, 0.2, 0.1], [0.2, 0.9, 0.4], [0.1, 0.3, 0.8], [0.7, 0.1, 0.6], [0.5, 0.5, 0.1]] {
            let back = with_hue(colour, hue(colour));
            assert!(colour.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-12), "{colour:?}: {back:?}");
        }
    }

    #[test]
    fn entries_of_the_table_are_met() {
        let entries: Vec<_> = (0..SIZE.pow(3)).map(|i| [i as f64, 0.0, 0.0]).collect();
        for cell in [[0, 0, 0], [36, 36, 36], [3, 17, 30]] {
            let number = cell[0] + SIZE * (cell[1] + SIZE * cell[2]);
            let found = interpolated(&entries, cell.map(|i| i as f64 / 36.0))[0];
            assert!((found - number as f64).abs() < 1e-6, "{cell:?}: {found}");
        }
    }

    #[test]
    fn saturated_lights_stay_within_the_screen_and_fade_to_white() {
        for colour in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let bright = agx(colour.map(|v| v * 1000.0));
            assert!(bright.iter().all(|v| (0.3..=1.0).contains(v)), "{bright:?}");
            let dim = agx(colour.map(|v| v * 0.1));
            let strongest = (0..3).max_by(|&a, &b| dim[a].total_cmp(&dim[b])).unwrap();
            assert!(colour[strongest] == 1.0 && dim.iter().all(|v| (0.0..=1.0).contains(v)), "{dim:?}");
        }
    }
}
