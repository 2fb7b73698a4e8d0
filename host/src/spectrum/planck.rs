//! Light of what glows.

use glam::DVec3;

use super::observer::{D65, at};
use super::rgb;
use crate::math::exp2;

/// The spectral radiance of a black body at a wavelength in nanometres, up to a factor (Planck; CODATA's second radiation constant).
pub fn planck(kelvins: f64, wavelength: f64) -> f64 {
    /// Nanometres times kelvins.
    const SECOND: f64 = 1.438_776_877e7;
    if kelvins <= 0.0 {
        return 0.0;
    }
    let power = exp2(SECOND / (wavelength * kelvins) * std::f64::consts::LOG2_E) - 1.0;
    let short = 500.0 / wavelength;
    let square = short * short;
    square * square * short / power
}

/// Linear RGB of the light of a black body, up to a factor that is the same for all temperatures in kelvins.
pub fn black_body(kelvins: f64) -> DVec3 {
    rgb(&|wavelength| planck(kelvins, wavelength) / at(&D65, wavelength)[0])
}

/// The luminance of linear RGB (ITU-R BT.709).
pub fn luminance(rgb: DVec3) -> f64 {
    rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::WhiteBalance;

    /// White balance, by Krystek's fit of the chromaticities of black bodies, takes their light for white.
    #[test]
    fn black_bodies_have_their_colours() {
        for kelvins in [2000.0, 2856.0, 4000.0] {
            let light = black_body(kelvins) / luminance(black_body(kelvins));
            let balanced = WhiteBalance::of(kelvins).unwrap().apply(light.as_vec3().to_array());
            let white = balanced.map(|channel| channel / balanced[1]);
            assert!(white.iter().all(|channel| (channel - 1.0).abs() < 0.02), "{kelvins}: {white:?}");
        }
    }

    /// Wien's displacement law: the brightest wavelength of 5000 K is 579.6 nm.
    #[test]
    fn the_brightest_wavelength_is_where_wien_has_it() {
        let bright = |wavelength| planck(5000.0, wavelength);
        assert!(bright(579.55) > bright(574.0) && bright(579.55) > bright(585.0));
        assert_eq!(planck(0.0, 500.0), 0.0);
        assert_eq!(planck(1.0, 500.0), 0.0);
    }
}
