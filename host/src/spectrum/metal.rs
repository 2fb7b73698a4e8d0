//! Metals by their measured complex indices of refraction.

use glam::{DVec3, Vec3};

use super::{observer, primaries, rgb};
use crate::choice::choices;
use crate::scene::Conductor;

choices! {
    /// A metal.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Metal {
        /// Al
        Aluminium = "aluminium",
        /// Cr
        Chromium = "chromium",
        /// Cu
        Copper = "copper",
        /// Au
        Gold = "gold",
        /// Ag
        Silver = "silver",
    }
}

/// From one wavelength of the tables to the next, in nanometres; the first is [`observer::FIRST`].
const STEP: f64 = 20.0;
/// How many there are.
const COUNT: usize = 21;

/// The refractive and the absorbing part at each wavelength.
type Table = [(f64, f64); COUNT];

#[rustfmt::skip]
const SILVER: Table = [
    (0.199, 1.718), (0.173, 1.951), (0.167, 2.183), (0.158, 2.375), (0.143, 2.567), (0.131, 2.746), (0.13, 2.918),
    (0.13, 3.098), (0.129, 3.258), (0.121, 3.421), (0.12, 3.58), (0.124, 3.731), (0.131, 3.881), (0.137, 4.045),
    (0.14, 4.21), (0.14, 4.371), (0.142, 4.523), (0.146, 4.671), (0.147, 4.821), (0.145, 4.975), (0.143, 5.131),
];

#[rustfmt::skip]
const ALUMINIUM: Table = [
    (0.442, 4.615), (0.49, 4.861), (0.539, 5.105), (0.591, 5.348), (0.646, 5.59), (0.705, 5.839), (0.769, 6.078),
    (0.839, 6.323), (0.916, 6.562), (1.004, 6.807), (1.097, 7.036), (1.197, 7.257), (1.3, 7.481), (1.415, 7.693),
    (1.536, 7.9), (1.674, 8.115), (1.837, 8.312), (2.037, 8.49), (2.27, 8.594), (2.49, 8.613), (2.665, 8.569),
];

#[rustfmt::skip]
const GOLD: Table = [
    (1.688, 1.918), (1.658, 1.956), (1.628, 1.952), (1.574, 1.911), (1.419, 1.843), (1.19, 1.796), (0.851, 1.887),
    (0.572, 2.184), (0.398, 2.555), (0.317, 2.837), (0.26, 2.948), (0.22, 3.0), (0.194, 3.06), (0.175, 3.09),
    (0.164, 3.275), (0.16, 3.633), (0.16, 3.964), (0.163, 4.237), (0.167, 4.479), (0.172, 4.701), (0.177, 4.914),
];

#[rustfmt::skip]
const COPPER: Table = [
    (1.206, 2.094), (1.175, 2.13), (1.178, 2.248), (1.171, 2.349), (1.16, 2.436), (1.148, 2.515), (1.134, 2.574),
    (1.111, 2.602), (1.033, 2.582), (0.861, 2.593), (0.603, 2.71), (0.39, 2.943), (0.272, 3.241), (0.227, 3.511),
    (0.212, 3.752), (0.211, 3.962), (0.215, 4.158), (0.22, 4.345), (0.23, 4.522), (0.241, 4.692), (0.251, 4.861),
];

#[rustfmt::skip]
const CHROMIUM: Table = [
    (1.436, 3.364), (1.498, 3.591), (1.617, 3.836), (1.82, 4.077), (2.052, 4.258), (2.345, 4.397), (2.606, 4.449),
    (2.839, 4.456), (3.04, 4.438), (3.19, 4.408), (3.326, 4.383), (3.428, 4.367), (3.517, 4.361), (3.597, 4.363),
    (3.678, 4.365), (3.758, 4.368), (3.838, 4.37), (3.906, 4.365), (3.974, 4.36), (4.042, 4.354), (4.109, 4.349),
];

impl Metal {
    // The tables of luxpop.com, which renderers share (of Palik, Handbook of Optical Constants of Solids, and others).
    fn table(self) -> &'static Table {
        match self {
            Metal::Aluminium => &ALUMINIUM,
            Metal::Chromium => &CHROMIUM,
            Metal::Copper => &COPPER,
            Metal::Gold => &GOLD,
            Metal::Silver => &SILVER,
        }
    }

    /// Both parts of its index at a wavelength in nanometres.
    pub fn index(self, wavelength: f64) -> (f64, f64) {
        let (before, share) = observer::place(wavelength, STEP, COUNT);
        let ((a, b), (c, d)) = (self.table()[before], self.table()[before + 1]);
        (a + (c - a) * share, b + (d - b) * share)
    }

    /// What it reflects of light at normal incidence.
    pub fn reflectance(self, wavelength: f64) -> f64 {
        let (eta, k) = self.index(wavelength);
        ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k)
    }

    /// As red, green and blue have it: with the colour that it reflects of D65 at normal incidence, and the mean of its refractive part.
    pub fn conductor(self) -> Conductor {
        let colour = rgb(&|wavelength| self.reflectance(wavelength)).clamp(DVec3::splat(0.01), DVec3::splat(0.999));
        let eta = primaries::mean(&|wavelength| self.index(wavelength).0);
        // No other reflects so much (Gulbrandsen, Artist Friendly Metallic Fresnel, 2014).
        let root = DVec3::new(colour.x.sqrt(), colour.y.sqrt(), colour.z.sqrt());
        let eta = eta.max((1.0 - colour) / (1.0 + colour)).min((1.0 + root) / (1.0 - root));
        let square = (colour * (eta + 1.0) * (eta + 1.0) - (eta - 1.0) * (eta - 1.0)) / (1.0 - colour);
        let k = square.max(DVec3::ZERO).to_array().map(f64::sqrt);
        Conductor { eta: eta.as_vec3(), k: Vec3::from_array(k.map(|k| k as f32)), metal: Some(self) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::Named;

    #[test]
    fn metals_reflect_the_colours_of_their_spectra() {
        for &metal in Metal::VARIANTS {
            let want = rgb(&|wavelength| metal.reflectance(wavelength)).min(DVec3::splat(0.999));
            let found = metal.conductor().reflectance().as_dvec3();
            assert!(found.distance(want) < 1e-5, "{metal:?}: {found} {want}");
        }
        let gold = Metal::Gold.conductor().reflectance();
        assert!(gold.x > 0.95 && gold.y > 0.6 && gold.y < 0.8 && gold.z < 0.5, "{gold}");
    }
}
