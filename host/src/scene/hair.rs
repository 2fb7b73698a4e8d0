//! Hair and fur as fibres of a colour, after Chiang, Bitterli, Tappan and Burley (A Practical and Controllable Hair and Fur Model for
//! Production Path Tracing, 2016).

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::math;

/// A fibre in the place of a surface. Its colour is the material's base.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hair {
    /// How far highlights spread along the fibre, in [0, 1]; below [`Hair::LEAST`] as that.
    pub roughness: f32,
    /// How far they spread around it, likewise.
    pub radial_roughness: f32,
    /// By how many degrees the scales of its surface lean towards the tip, in [-10, 10].
    pub tilt: f32,
}

/// What absorbs light in hair, in [0, 100] each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pigment {
    /// The part of light that is absorbed by the radius of the fibre, at each of red, green and blue.
    Absorption(Vec3),
    /// Concentrations of eumelanin, which is brown, and pheomelanin, which is red.
    Melanin(f32, f32),
}

impl Hair {
    /// Less rough is none.
    pub const LEAST: f32 = 0.05;
    /// The index of refraction of keratin.
    pub const IOR: f32 = 1.55;

    /// The variance of the first lobe along the fibre (equation 7).
    pub(crate) fn variance(&self) -> f64 {
        let rough = f64::from(self.roughness.max(Self::LEAST));
        let root = 0.726 * rough + 0.812 * rough * rough + 3.7 * math::pow(rough, 20.0);
        root * root
    }

    /// The scale of the logistic distribution around the fibre, in radians (equation 8).
    pub(crate) fn scale(&self) -> f64 {
        /// The root of an eighth of pi.
        const ROOT: f64 = 0.626_657_068_657_750_1;
        let rough = f64::from(self.radial_roughness.max(Self::LEAST));
        ROOT * (0.265 * rough + 1.194 * rough * rough + 5.372 * math::pow(rough, 22.0))
    }

    /// By what the logarithm of a colour is divided to be the root of what is absorbed (equation 9).
    pub(crate) fn fit(&self) -> f64 {
        let rough = f64::from(self.radial_roughness.max(Self::LEAST));
        let powers = [5.969, -0.215, 2.532, -10.73, 5.574, 0.245];
        powers.iter().rev().fold(0.0, |sum, power| sum * rough + power)
    }

    /// The colour of hair with a pigment, linear RGB in [0, 1].
    pub fn colour(&self, pigment: Pigment) -> Vec3 {
        /// What a unit of eumelanin and one of pheomelanin absorb (pbrt, HairBSDF).
        const MELANINS: [Vec3; 2] = [Vec3::new(0.419, 0.697, 1.37), Vec3::new(0.187, 0.4, 1.05)];
        let absorption = match pigment {
            Pigment::Absorption(absorption) => absorption,
            Pigment::Melanin(brown, red) => MELANINS[0] * brown + MELANINS[1] * red,
        };
        let fit = self.fit();
        let of = |absorbed: f32| math::exp2(-f64::from(absorbed).sqrt() * fit * std::f64::consts::LOG2_E) as f32;
        absorption.map(of)
    }
}

impl Default for Hair {
    /// Human hair.
    fn default() -> Self {
        Hair { roughness: 0.3, radial_roughness: 0.3, tilt: 2.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of pbrt's `HairBSDF`, whose tables of roughness 0.3 these are.
    #[test]
    fn roughness_is_what_chiang_and_others_have() {
        let hair = Hair::default();
        let root = 0.726 * 0.3 + 0.812 * 0.09 + 3.7 * 0.3f64.powi(20);
        assert!((hair.variance() - root * root).abs() < 1e-7, "{}", hair.variance());
        let scale = (std::f64::consts::PI / 8.0).sqrt() * (0.265 * 0.3 + 1.194 * 0.09 + 5.372 * 0.3f64.powi(22));
        assert!((hair.scale() - scale).abs() < 1e-7, "{}", hair.scale());
        let least = Hair { roughness: 0.0, radial_roughness: 0.0, ..hair };
        let same = Hair { roughness: Hair::LEAST, radial_roughness: Hair::LEAST, ..hair };
        assert_eq!((least.variance(), least.scale()), (same.variance(), same.scale()));
        assert!(least.variance() > 1e-3 && least.scale() > 1e-2);
    }

    #[test]
    fn a_pigment_has_the_colour_by_which_it_is_found_again() {
        for radial_roughness in [0.1, 0.3, 0.9] {
            let hair = Hair { radial_roughness, ..Hair::default() };
            let absorption = Vec3::new(0.06, 0.1, 0.2);
            let colour = hair.colour(Pigment::Absorption(absorption)).as_dvec3();
            let again = colour.to_array().map(|c| (c.ln() / hair.fit()).powi(2));
            for (again, want) in again.into_iter().zip(absorption.to_array()) {
                assert!((again - f64::from(want)).abs() < 1e-6, "{again}, not {want}");
            }
        }
        assert_eq!(Hair::default().colour(Pigment::Absorption(Vec3::ZERO)), Vec3::ONE);
        let [brown, red] = [(1.3, 0.0), (0.0, 1.3)].map(|(a, b)| Hair::default().colour(Pigment::Melanin(a, b)));
        assert!(brown.x > brown.y && brown.y > brown.z && red.x > brown.x, "{brown}, {red}");
    }
}
