//! What kind of light lamps have.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::observer::{D65, at};
use super::{Fluorescent, luminance, of_colour, planck, rgb};

/// The spectrum of a lamp's light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Illuminant {
    /// That of a black body of so many kelvins.
    BlackBody(f32),
    /// That of a fluorescent lamp.
    Fluorescent(Fluorescent),
}

impl Illuminant {
    /// Its power at a wavelength in nanometres, up to a factor.
    pub fn power(self, wavelength: f64) -> f64 {
        match self {
            Illuminant::BlackBody(kelvins) => planck(kelvins.into(), wavelength),
            Illuminant::Fluorescent(lamp) => lamp.power(wavelength),
        }
    }

    /// The same as a share of D65's.
    fn share(self, wavelength: f64) -> f64 {
        self.power(wavelength) / at(&D65, wavelength)[0]
    }

    /// Linear RGB of its light where the luminance of that is 1. What no screen shows is below 0.
    pub fn light(self) -> DVec3 {
        let light = rgb(&|wavelength| self.share(wavelength));
        light / luminance(light)
    }

    /// The same of what a screen shows.
    pub fn colour(self) -> Vec3 {
        self.light().max(DVec3::ZERO).as_vec3()
    }

    /// What its light has at a wavelength in nanometres, as a function of that: as a share of what [`Illuminant::colour`] has.
    pub fn over_colour(self) -> impl Fn(f64) -> f64 {
        let whole = luminance(rgb(&|wavelength| self.share(wavelength)));
        let colour = self.colour();
        move |wavelength| {
            let seen = of_colour(colour, wavelength);
            if seen > 0.0 { self.share(wavelength) / whole / seen } else { 0.0 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::Named;

    /// CIE's chromaticities of FL2, FL7 and FL11 (CIE 015:2018, table 10.2).
    #[test]
    fn fluorescent_lamps_have_the_colours_of_their_tables() {
        let known = [(0.3721, 0.3751), (0.3129, 0.3292), (0.3805, 0.3769)];
        for (&lamp, (x, y)) in Fluorescent::VARIANTS.iter().zip(known) {
            let light = Illuminant::Fluorescent(lamp).light();
            let row = |a: f64, b: f64, c: f64| DVec3::new(a, b, c).dot(light);
            let xyz = [
                row(0.412391, 0.357584, 0.180481),
                row(0.212639, 0.715169, 0.072192),
                row(0.019331, 0.119195, 0.950532),
            ];
            let sum: f64 = xyz.iter().sum();
            let (own_x, own_y) = (xyz[0] / sum, xyz[1] / sum);
            assert!((own_x - x).abs() < 2e-3 && (own_y - y).abs() < 2e-3, "{lamp:?}: {own_x} {own_y}");
        }
    }
}
