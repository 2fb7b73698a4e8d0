//! Tone maps: linear light of any brightness to what a screen shows, in linear light of Rec. 709 from 0 to 1.

use super::agx::agx;
use crate::choice::choices;
use crate::math;

choices! {
    /// How light brighter than a screen's white finds a place on it.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum ToneMap {
        /// Light as it is; what is brighter than white is cut off
        #[default]
        None = "none",
        /// Khronos PBR Neutral: colours of surfaces stay as they are, less 0.04, and only highlights are compressed
        Neutral = "neutral",
        /// AgX, as in Blender 4: a picture's contrast over 16.5 stops, and bright colours fade to white
        Agx = "agx",
        /// AgX as three.js and Filament have it, a little brighter
        AgxThree = "agx-three",
    }
}

impl ToneMap {
    /// The colour that a screen shows for a colour of the picture, both linear. With [`ToneMap::None`] it is the same;
    /// with the others it is in [0, 1], where NaN and what is below 0 count as 0 and infinity as [`f64::MAX`].
    pub fn apply(self, colour: [f64; 3]) -> [f64; 3] {
        let curve = match self {
            ToneMap::None => return colour,
            ToneMap::Neutral => neutral,
            ToneMap::Agx => agx,
            ToneMap::AgxThree => agx_three,
        };
        // NaN is not above 0.
        let light = colour.map(|v| if v > 0.0 { v.min(f64::MAX) } else { 0.0 });
        curve(light).map(|v| v.clamp(0.0, 1.0))
    }
}

/// The [specification](https://github.com/KhronosGroup/ToneMapping/tree/main/PBR_Neutral) of Khronos PBR Neutral, in its
/// names.
fn neutral(colour: [f64; 3]) -> [f64; 3] {
    const F90: f64 = 0.04;
    const KS: f64 = 0.8 - F90;
    const KD: f64 = 0.15;
    let x = colour.into_iter().fold(f64::INFINITY, f64::min);
    let f = if x <= 2.0 * F90 { x - x * x / (4.0 * F90) } else { F90 };
    let colour = colour.map(|v| v - f);
    let p = colour.into_iter().fold(0.0, f64::max);
    if p <= KS {
        return colour;
    }
    let pn = 1.0 - (1.0 - KS) * (1.0 - KS) / (p + 1.0 - 2.0 * KS);
    let g = 1.0 / (KD * (p - pn) + 1.0);
    // Divided first: the product of two great numbers has no place.
    colour.map(|v| v / p * pn * g + pn * (1.0 - g))
}

/// A matrix by rows.
pub(super) type Matrix = [[f64; 3]; 3];

/// From Rec. 709 to Rec. 2020, of their primaries and white (ITU-R BT.2087). With the four digits that are usual a grey
/// would not stay one.
pub(super) const TO_REC_2020: Matrix = [
    [0.627_403_895_934_699, 0.329_283_038_377_883_7, 0.043_313_065_687_417_225],
    [0.069_097_289_358_232_08, 0.919_540_395_075_458_7, 0.011_362_315_566_309_178],
    [0.016_391_438_875_150_28, 0.088_013_307_877_225_75, 0.895_595_253_247_624],
];

/// The inverse of [`TO_REC_2020`].
pub(super) const TO_REC_709: Matrix = [
    [1.660_491_002_108_434_5, -0.587_641_138_788_549_5, -0.072_849_863_319_884_88],
    [-0.124_550_474_521_590_74, 1.132_899_897_125_960_3, -0.008_349_422_604_369_477],
    [-0.018_150_763_354_905_303, -0.100_578_898_008_007_39, 1.118_729_661_362_912_7],
];

/// Moves Rec. 2020's primaries inwards, so that bright colours fade to white.
pub(super) const INSET: Matrix = [
    [0.856_627_153_315_983, 0.095_121_240_538_158_8, 0.048_251_606_145_858_3],
    [0.137_318_972_929_847, 0.761_241_990_602_591, 0.101_439_036_467_562],
    [0.111_898_212_999_95, 0.076_799_418_603_190_3, 0.811_302_368_396_859],
];

/// Moves them outwards again, not quite as far.
pub(super) const OUTSET: Matrix = [
    [1.127_100_581_814_436_8, -0.110_606_643_096_603_23, -0.016_493_938_717_834_573],
    [-0.141_329_763_498_438_3, 1.157_823_702_216_272, -0.016_493_938_717_834_257],
    [-0.141_329_763_498_438_26, -0.110_606_643_096_602_94, 1.251_936_406_595_040_5],
];

/// The contrast by powers of the brightness in stops, from the highest: the fit of degree 6 in Benjamin Wrensch's "Minimal
/// AgX Implementation" (iolite-engine.com, 2023). It grows everywhere, which that of degree 7 does not near black.
const CONTRAST: [f64; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.002_32];

/// Troy Sobotka's AgX as three.js and Filament have it: the matrices of Eary Chow's AgX_LUT_Gen (`AgXBaseRec2020.py`), and the stops
/// are theirs, and the curve that of three.js.
fn agx_three(colour: [f64; 3]) -> [f64; 3] {
    // 10 stops below a grey of 0.18 to 6.5 above it, as powers of two.
    const LEAST: f64 = -12.473_93;
    const MOST: f64 = 4.026_069;
    let inset = times(&INSET, times(&TO_REC_2020, colour));
    let contrast = inset.map(|v| {
        let place = (math::log2(v) - LEAST) / (MOST - LEAST);
        CONTRAST.into_iter().fold(0.0, |sum, factor| sum * place.clamp(0.0, 1.0) + factor)
    });
    let linear = times(&OUTSET, contrast).map(|v| math::pow(v.max(0.0), 2.2));
    times(&TO_REC_709, linear)
}

pub(super) fn times(matrix: &Matrix, [r, g, b]: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * r + row[1] * g + row[2] * b)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const CURVES: [ToneMap; 3] = [ToneMap::Neutral, ToneMap::Agx, ToneMap::AgxThree];

    /// How far the channels of a grey may lie apart: the table's gamut has another white, by four digits.
    fn apart(tone: ToneMap) -> f64 {
        if tone == ToneMap::Agx { 1e-3 } else { 1e-12 }
    }

    fn assert_near(found: [f64; 3], wanted: [f64; 3], of: &str) {
        let near = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-8);
        assert!(near, "{of}: {found:?} instead of {wanted:?}");
    }

    /// By a program of its own, of the published definitions.
    #[test]
    fn known_colours() {
        for (colour, neutral, agx) in [
            ([0.0; 3], [0.0; 3], [0.0; 3]),
            ([0.18; 3], [0.14; 3], [0.214_519_092; 3]),
            ([1.0; 3], [0.869_090_909; 3], [0.590_159_251; 3]),
            ([0.8, 0.2, 0.1], [0.76, 0.16, 0.06], [0.580_584_957, 0.255_244_966, 0.168_478_96]),
            (
                [4.0, 2.0, 0.5],
                [0.983_255_814, 0.639_951_387, 0.382_473_067],
                [0.890_263_946, 0.741_206_76, 0.543_491_903],
            ),
            ([0.0, 0.0, 10.0], [0.571_141_612, 0.571_141_612, 0.993_924_051], [0.446_587_158, 0.612_953_202, 1.0]),
            ([0.01, 0.02, 0.03], [0.000_625, 0.010_625, 0.020_625], [0.005_863_365, 0.019_274_373, 0.032_726_021]),
            ([100.0; 3], [0.999_420_756; 3], [0.996_878_661; 3]),
        ] {
            assert_near(ToneMap::Neutral.apply(colour), neutral, "neutral");
            assert_near(ToneMap::AgxThree.apply(colour), agx, "agx-three");
        }
    }

    #[test]
    fn without_a_tone_map_every_bit_stays() {
        for v in [0.0, -0.0, -1.0, 0.5, 1e30, f64::NAN, f64::INFINITY] {
            assert_eq!(ToneMap::None.apply([v; 3]).map(f64::to_bits), [v.to_bits(); 3]);
        }
    }

    #[test]
    fn what_is_no_light_has_a_place() {
        for tone in CURVES {
            for dark in [f64::NAN, f64::NEG_INFINITY, -1.0, -0.0, f64::MIN_POSITIVE] {
                assert_near(tone.apply([dark, 0.5, dark]), tone.apply([0.0, 0.5, 0.0]), "dark");
            }
            for bright in [1e30, 1e300, f64::MAX, f64::INFINITY] {
                let [r, g, b] = tone.apply([bright; 3]);
                assert!(
                    r > 0.996 && (r - g).abs() < apart(tone) && (r - b).abs() < apart(tone),
                    "{tone} {bright:e}: {r} {g} {b}"
                );
                assert!(tone.apply([bright, 0.0, f64::NAN]).iter().all(|v| (0.0..=1.0).contains(v)), "{tone}");
            }
        }
    }

    #[test]
    fn a_brighter_grey_is_a_brighter_grey() {
        for tone in CURVES {
            // Between two entries that are nearly white the sum of a table's steps is rounded.
            let rounding = if tone == ToneMap::Agx { 1e-12 } else { 0.0 };
            let mut last = -1.0;
            for light in (-2000..=1200).map(|i| math::exp2(f64::from(i) / 100.0)) {
                let [r, g, b] = tone.apply([light; 3]);
                assert!((r - g).abs() < apart(tone) && (r - b).abs() < apart(tone), "{tone} {light}: {r} {g} {b}");
                assert!(r >= last - rounding, "{tone} {light}: {r} after {last}");
                last = r;
            }
        }
    }

    #[test]
    fn the_matrices_there_and_back_are_inverses() {
        for (i, unit) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().enumerate() {
            let back = times(&TO_REC_709, times(&TO_REC_2020, unit));
            let near = back.iter().zip(unit).all(|(a, b)| (a - b).abs() < 1e-14);
            assert!(near, "column {i}: {back:?}");
        }
    }

    fn luminance([r, g, b]: [f64; 3]) -> f64 {
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        #[test]
        fn neutral_takes_its_offset_from_surfaces_and_nothing_else(colour in prop::array::uniform3(0.08..0.8)) {
            let found = ToneMap::Neutral.apply(colour);
            for (found, v) in found.into_iter().zip(colour) {
                prop_assert!((found - (v - 0.04)).abs() < 1e-15);
            }
        }

        #[test]
        fn any_bits_are_within_the_screen(bits in prop::array::uniform3(any::<u64>())) {
            for tone in CURVES {
                let found = tone.apply(bits.map(f64::from_bits));
                prop_assert!(found.iter().all(|v| (0.0..=1.0).contains(v)), "{} {:?}", tone, found);
            }
        }

        #[test]
        fn more_light_of_a_colour_is_never_darker(
            colour in prop::array::uniform3(0.0..1.0), stops in -12.0..10.0, more in 0.0..4.0,
        ) {
            let at = |stops: f64| colour.map(|v: f64| v * math::exp2(stops));
            // The hue that Blender's goes back to may be a darker one.
            for tone in [ToneMap::Neutral, ToneMap::AgxThree] {
                let [less, more] = [at(stops), at(stops + more)].map(|colour| luminance(tone.apply(colour)));
                prop_assert!(more >= less - 1e-12, "{}: {} after {}", tone, more, less);
            }
        }
    }
}
