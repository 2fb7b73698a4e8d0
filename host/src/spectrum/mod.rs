//! Light by its wavelengths: the table that kernels read where paths carry three of them (`--spectral`), see
//! [`eyerays_shader::spectrum`].

mod cells;
mod fluorescent;
mod glass;
mod illuminant;
mod metal;
mod observer;
mod planck;
mod primaries;

use eyerays_shader::data::{SpectrumRow, pack};
use glam::{DVec3, UVec4, Vec3};

use self::cells::{SETS, cells};
pub use self::fluorescent::Fluorescent;
pub use self::glass::Glass;
pub use self::illuminant::Illuminant;
pub use self::metal::Metal;
use self::observer::at;
pub use self::planck::{black_body, luminance, planck};
use self::primaries::PRIMARIES;
pub use self::primaries::of_colour;

/// What a wavelength in nanometres has.
pub type Curve<'a> = &'a dyn Fn(f64) -> f64;

/// Yellow light of helium, for which indices of refraction are told, in nanometres.
pub const YELLOW: f64 = 587.56;
/// Blue light of hydrogen.
pub const BLUE: f64 = 486.13;
/// Red light of hydrogen.
pub const RED: f64 = 656.27;

/// Words of the table of spectra: what is of any scene, and rows of its own.
pub fn words(own: &[Curve]) -> Vec<UVec4> {
    let mut words = Vec::with_capacity((SpectrumRow::OWN as usize + own.len()) * SETS);
    let mut row = |of: &dyn Fn(usize) -> DVec3| words.extend((0..SETS).map(|set| pack(kept(of(set)), 0)));
    for band in 0..3 {
        row(&|set| DVec3::from(at(&PRIMARIES, cells()[set + band * SETS].wavelength)));
    }
    for channel in 0..3 {
        row(&|set| bands(set, |cell| SETS as f64 * cells()[cell].response[channel]));
    }
    let mut curve = |of: Curve| row(&|set| bands(set, |cell| of(cells()[cell].wavelength)));
    curve(&|wavelength| 1.0 / wavelength);
    curve(&cauchy);
    for of in own {
        curve(*of);
    }
    words
}

/// What an index of refraction is above that of yellow light, over half of its difference between blue and red light, where it falls
/// with the square of the wavelength.
fn cauchy(wavelength: f64) -> f64 {
    let over = |wavelength: f64| 1.0 / (wavelength * wavelength);
    2.0 * (over(wavelength) - over(YELLOW)) / (over(BLUE) - over(RED))
}

/// Three numbers of a set.
fn bands(set: usize, of: impl Fn(usize) -> f64) -> DVec3 {
    DVec3::new(of(set), of(set + SETS), of(set + 2 * SETS))
}

/// As kernels take them: what is too small to count in products is nothing.
fn kept(v: DVec3) -> Vec3 {
    const LEAST: f64 = 1.0 / (1 << 30) as f64;
    let number = |x: f64| if x.abs() < LEAST { 0.0 } else { x as f32 };
    Vec3::new(number(v.x), number(v.y), number(v.z))
}

/// The mean over all sets of what light adds to red, green and blue that has this spectrum, as a share of D65's.
pub fn rgb(of: Curve) -> DVec3 {
    cells().iter().map(|cell| cell.response * of(cell.wavelength)).sum()
}

#[cfg(test)]
mod tests {
    use eyerays_shader::real::V3;
    use eyerays_shader::spectrum::Bands;
    use proptest::prelude::*;

    use super::*;

    /// All sets, drawn.
    fn sets(words: &[UVec4]) -> impl Iterator<Item = Bands> + '_ {
        (0..SpectrumRow::SETS).map(|set| Bands::drawn(words, set << SpectrumRow::DRAWN))
    }

    fn mean(words: &[UVec4], of: impl Fn(&Bands) -> V3<f64>) -> DVec3 {
        let all: V3<f64> = sets(words).map(|bands| of(&bands)).fold(V3::zero(), |a, b| a + b);
        DVec3::new(all.x, all.y, all.z) / f64::from(SpectrumRow::SETS)
    }

    proptest! {
        /// Any colour is what it was in the mean of all wavelengths, and of any reflectance none is above 1.
        #[test]
        fn colours_are_what_they_were(colour in [0f32..1.0, 0f32..1.0, 0f32..1.0]) {
            let words = words(&[]);
            let colour = Vec3::from(colour);
            let found = mean(&words, |bands| bands.rgb(bands.of(V3::splat(colour))));
            prop_assert!(found.distance(colour.as_dvec3()) < 1e-5, "{found}");
            for bands in sets(&words) {
                let V3 { x, y, z } = bands.of::<f64>(V3::splat(colour));
                prop_assert!([x, y, z].iter().all(|&c| (-1e-9..1.0 + 1e-6).contains(&c)));
            }
        }
    }

    #[test]
    fn white_is_white_and_grey_is_grey_at_every_wavelength() {
        let words = words(&[]);
        for bands in sets(&words) {
            for grey in [1.0f64, 0.25] {
                let V3 { x, y, z } = bands.of(V3::new(grey, grey, grey));
                assert!([x, y, z].iter().all(|c| (c - grey).abs() < 1e-6), "{x} {y} {z}");
            }
        }
    }

    /// Cauchy's glass has its Abbe number: (n - 1) over the difference of blue and red.
    #[test]
    fn cauchys_row_is_1_from_red_to_blue() {
        assert!((cauchy(BLUE) - cauchy(RED) - 2.0).abs() < 1e-12);
        assert_eq!(cauchy(YELLOW), 0.0);
    }

    /// The colour of a black body of 6504 K is near D65's, that of illuminant A (2856 K) is CIE's.
    #[test]
    fn spectra_have_the_colours_of_their_tables() {
        let flat = rgb(&|_| 1.0);
        assert!(flat.distance(DVec3::ONE) < 1e-9, "{flat}");
    }
}
