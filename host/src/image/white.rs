//! White balance: which light looks white.

use std::borrow::Cow;

use rayon::prelude::*;

use super::tone::{Matrix, times};
use crate::error::{Result, within};
use crate::picture::Picture;

/// The light that looks white, by its temperature. Light of Rec. 709's white, which is what pictures have without it, is 6504 kelvins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WhiteBalance {
    kelvins: f64,
    /// Rows that a colour is multiplied with.
    matrix: Matrix,
}

/// A colour without its brightness: CIE 1931's x and y.
type Chromaticity = (f64, f64);

/// Rec. 709's white.
const WHITE: Chromaticity = (0.3127, 0.3290);

/// From linear Rec. 709 to CIE 1931 XYZ, of its primaries and white (ITU-R BT.709; SMPTE RP 177).
const TO_XYZ: Matrix = [
    [0.412_390_799_265_959_5, 0.357_584_339_383_878, 0.180_480_788_401_834_3],
    [0.212_639_005_871_510_27, 0.715_168_678_767_756, 0.072_192_315_360_733_71],
    [0.019_330_818_715_591_85, 0.119_194_779_794_625_99, 0.950_532_152_249_660_6],
];

/// The inverse of [`TO_XYZ`].
const FROM_XYZ: Matrix = [
    [3.240_969_941_904_522_6, -1.537_383_177_570_094, -0.498_610_760_293_003_4],
    [-0.969_243_636_280_879_6, 1.875_967_501_507_720_2, 0.041_555_057_407_175_59],
    [0.055_630_079_696_993_66, -0.203_976_958_888_976_52, 1.056_971_514_242_878_6],
];

/// From XYZ to what cones answer with (Bradford; Lam 1985, as in ICC.1:2010, annex E).
const TO_CONES: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

impl WhiteBalance {
    /// The lowest temperature, in kelvins: a candle has 1900.
    pub const LEAST: f64 = 1700.0;
    /// The highest, of a blue sky.
    pub const MOST: f64 = 25_000.0;

    /// Light of so many kelvins looks white: that of a black body up to 4000, daylight from 5000 on, and what is between them between
    /// (as the reference of ANSI/IES TM-30).
    ///
    /// # Errors
    /// A temperature out of range.
    pub fn of(kelvins: f64) -> Result<WhiteBalance> {
        within("white balance", &[kelvins], Self::LEAST..=Self::MOST)?;
        let cones = |of: Chromaticity| times(&TO_CONES, xyz(of));
        let (wanted, light) = (cones(WHITE), cones(reference(kelvins)));
        let gain = [0, 1, 2].map(|i| wanted[i] / light[i]);
        // A column at a time: what becomes of each primary.
        let column = |i: usize| {
            let primary = [0, 1, 2].map(|k| if k == i { 1.0 } else { 0.0 });
            let cones = times(&TO_CONES, times(&TO_XYZ, primary));
            times(&FROM_XYZ, times(&inverse(&TO_CONES), [0, 1, 2].map(|k| cones[k] * gain[k])))
        };
        let columns = [0, 1, 2].map(column);
        Ok(WhiteBalance { kelvins, matrix: [0, 1, 2].map(|row| columns.map(|column| column[row])) })
    }

    /// The temperature of the light that looks white.
    pub fn kelvins(self) -> f64 {
        self.kelvins
    }

    /// A colour of linear Rec. 709 as it looks then. Colours that no screen shows have channels below 0; one that is not finite stays as
    /// it is.
    pub fn apply(&self, colour: [f32; 3]) -> [f32; 3] {
        if !colour.iter().all(|v| v.is_finite()) {
            return colour;
        }
        times(&self.matrix, colour.map(f64::from)).map(|v| v as f32)
    }

    /// A picture of light as it looks then.
    pub fn balanced(&self, picture: &Picture) -> Picture {
        picture.with_pixels(picture.pixels.par_iter().map(|&pixel| self.apply(pixel)).collect())
    }
}

/// A picture as a balance has it, if there is one.
pub(super) fn balanced(picture: &Picture, white: Option<WhiteBalance>) -> Cow<'_, Picture> {
    white.map_or(Cow::Borrowed(picture), |white| Cow::Owned(white.balanced(picture)))
}

/// Linear Rec. 709 of CIE 1931 XYZ.
pub(crate) fn from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    times(&FROM_XYZ, xyz)
}

/// With a brightness of 1.
fn xyz((x, y): Chromaticity) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

fn reference(kelvins: f64) -> Chromaticity {
    let share = ((kelvins - 4000.0) / 1000.0).clamp(0.0, 1.0);
    let (body, day) = (black_body(kelvins.min(5000.0)), daylight(kelvins.max(4000.0)));
    (body.0 + (day.0 - body.0) * share, body.1 + (day.1 - body.1) * share)
}

/// A black body from 1000 to 15,000 kelvins (Krystek 1985, whose u and v of CIE 1960 are off by less than 9e-5).
fn black_body(kelvins: f64) -> Chromaticity {
    let t = kelvins;
    let u = (0.860_117_757 + 1.541_182_54e-4 * t + 1.286_412_12e-7 * t * t)
        / (1.0 + 8.424_202_35e-4 * t + 7.081_451_63e-7 * t * t);
    let v = (0.317_398_726 + 4.228_062_45e-5 * t + 4.204_816_91e-8 * t * t)
        / (1.0 - 2.897_418_16e-5 * t + 1.614_560_53e-7 * t * t);
    let share = 2.0 * u - 8.0 * v + 4.0;
    (3.0 * u / share, 2.0 * v / share)
}

/// Daylight from 4000 to 25,000 kelvins (CIE 015:2018, equations 4.1 to 4.3).
fn daylight(kelvins: f64) -> Chromaticity {
    let t = 1000.0 / kelvins;
    let x = match kelvins {
        ..7000.0 => cubic([-4.6070, 2.9678, 0.099_11, 0.244_063], t),
        _ => cubic([-2.0064, 1.9018, 0.247_48, 0.237_040], t),
    };
    (x, -3.0 * x * x + 2.870 * x - 0.275)
}

/// The highest power first.
fn cubic([a, b, c, d]: [f64; 4], x: f64) -> f64 {
    ((a * x + b) * x + c) * x + d
}

fn inverse(m: &Matrix) -> Matrix {
    let cofactor = |row: usize, column: usize| {
        let [r, s] = [(row + 1) % 3, (row + 2) % 3];
        let [c, d] = [(column + 1) % 3, (column + 2) % 3];
        m[r][c] * m[s][d] - m[r][d] * m[s][c]
    };
    let determinant: f64 = (0..3).map(|i| m[0][i] * cofactor(0, i)).sum();
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| cofactor(column, row) / determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Linear Rec. 709 of a light's chromaticity.
    fn light(of: Chromaticity) -> [f32; 3] {
        times(&FROM_XYZ, xyz(of)).map(|v| v as f32)
    }

    /// Chromaticities as CIE 015 lists them. Krystek's error makes half a percent of blue, which is a small share of warm light.
    #[test]
    fn a_light_of_the_temperature_looks_white() {
        for (kelvins, of, bound) in [
            (2856.0, (0.447_58, 0.407_45), 6e-3),
            (5003.0, (0.345_67, 0.358_51), 2e-3),
            (6504.0, (0.312_72, 0.329_03), 2e-3),
            (7504.0, (0.299_02, 0.314_85), 2e-3),
        ] {
            let [red, green, blue] = WhiteBalance::of(kelvins).unwrap().apply(light(of));
            assert!((red - green).abs() < bound && (blue - green).abs() < bound, "{kelvins} K: {red} {green} {blue}");
        }
    }

    /// Bruce Lindbloom's matrix of Bradford from D50 to D65 (brucelindbloom.com, "Chromatic Adaptation"), between XYZ.
    #[test]
    fn colours_are_adapted_as_others_do() {
        let d50_to_d65: Matrix = [
            [0.955_576_6, -0.023_039_3, 0.063_163_6],
            [-0.028_289_5, 1.009_941_6, 0.021_007_7],
            [0.012_298_2, -0.020_483_0, 1.329_909_8],
        ];
        let white = WhiteBalance::of(5003.0).unwrap();
        for colour in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.5, 0.9]] {
            let want = times(&FROM_XYZ, times(&d50_to_d65, times(&TO_XYZ, colour)));
            let got = white.apply(colour.map(|v| v as f32));
            assert!((0..3).all(|i| (f64::from(got[i]) - want[i]).abs() < 2e-3), "{got:?}, wanted {want:?}");
        }
    }

    #[test]
    fn nothing_jumps_between_black_bodies_and_daylight() {
        let steps = (1700..25_000).step_by(10).map(|kelvins| reference(f64::from(kelvins)));
        let steps: Vec<Chromaticity> = steps.collect();
        let far = steps.windows(2).map(|w| (w[1].0 - w[0].0).abs().max((w[1].1 - w[0].1).abs()));
        assert!(far.fold(0.0, f64::max) < 2e-3);
        assert!(steps.windows(2).all(|w| w[1].0 < w[0].0), "warm light is redder");
    }

    #[test]
    fn what_no_light_has_is_refused_and_what_is_not_finite_stays() {
        for kelvins in [0.0, 1699.0, 25_001.0, f64::NAN, f64::INFINITY] {
            let refused = WhiteBalance::of(kelvins).expect_err("accepted").to_string();
            assert!(refused.contains("white balance") && refused.contains("1700 to 25000"), "{refused}");
        }
        let stays = WhiteBalance::of(3000.0).unwrap().apply([f32::INFINITY, 1.0, 0.0]);
        assert_eq!(stays, [f32::INFINITY, 1.0, 0.0]);
    }
}
