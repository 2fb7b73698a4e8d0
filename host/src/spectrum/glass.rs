//! Glass by its measured index of refraction.

use super::{BLUE, RED, YELLOW};
use crate::choice::choices;

choices! {
    /// What bends light of each wavelength as was measured.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Glass {
        /// The crown glass N-BK7: 1.5168, Abbe number 64.2
        Bk7 = "bk7",
        /// The flint glass N-SF11: 1.7847, 25.7
        Sf11 = "sf11",
        /// Fused silica: 1.4585, 67.8
        Silica = "silica",
        /// Water at 20 degrees: 1.3334, 55.8
        Water = "water",
        /// Sapphire's ordinary ray: 1.7682, 72.3
        Sapphire = "sapphire",
        /// Diamond: 2.4175, 55.3
        Diamond = "diamond",
    }
}

/// The terms `b l^2 / (l^2 - c)` that the square of the index is above 1 by, of the wavelength `l` in micrometres (Sellmeier).
type Terms = &'static [(f64, f64)];

/// Schott's catalogue, for it and the next.
const BK7: Terms = &[(1.039_612_12, 0.006_000_698_67), (0.231_792_344, 0.020_017_914_4), (1.010_469_45, 103.560_653)];
const SF11: Terms = &[(1.737_596_95, 0.013_188_707), (0.313_747_346, 0.062_306_814_2), (1.898_781_01, 155.236_29)];
/// Malitson, Interspecimen Comparison of the Refractive Index of Fused Silica, 1965.
const SILICA: Terms = &[(0.696_166_3, 0.004_679_148), (0.407_942_6, 0.013_512_063), (0.897_479_4, 97.934_003)];
/// Daimon and Masumura, Measurement of the Refractive Index of Distilled Water, 2007.
const WATER: Terms = &[
    (0.568_402_756_5, 0.005_101_829_712),
    (0.172_617_739_1, 0.018_211_539_36),
    (0.020_861_895_78, 0.026_207_222_93),
    (0.113_074_868_8, 10.697_927_21),
];
/// Malitson and Dodge, Refractive Index and Birefringence of Synthetic Sapphire, 1972.
const SAPPHIRE: Terms = &[(1.431_349_3, 0.005_279_926_1), (0.650_547_13, 0.014_238_264_7), (5.341_402_1, 325.017_834)];
/// Peter, 1923.
const DIAMOND: Terms = &[(0.3306, 0.030_625), (4.3356, 0.011_236)];

impl Glass {
    fn terms(self) -> Terms {
        match self {
            Glass::Bk7 => BK7,
            Glass::Sf11 => SF11,
            Glass::Silica => SILICA,
            Glass::Water => WATER,
            Glass::Sapphire => SAPPHIRE,
            Glass::Diamond => DIAMOND,
        }
    }

    /// Its index of refraction at a wavelength in nanometres.
    pub fn index(self, wavelength: f64) -> f64 {
        let square = wavelength * wavelength * 1e-6;
        (1.0 + self.terms().iter().map(|(b, c)| b * square / (square - c)).sum::<f64>()).sqrt()
    }

    /// That for yellow light, for which indices are told.
    pub fn ior(self) -> f32 {
        self.index(YELLOW) as f32
    }

    /// Half of the difference between its indices for blue and for red light.
    pub fn spread(self) -> f64 {
        0.5 * (self.index(BLUE) - self.index(RED))
    }

    /// What its index is above that for yellow light, over [`Glass::spread`].
    pub fn bends(self, wavelength: f64) -> f64 {
        (self.index(wavelength) - self.index(YELLOW)) / self.spread()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Catalogues' indices and Abbe numbers.
    #[test]
    fn glasses_bend_light_as_catalogues_say() {
        let known = [
            (Glass::Bk7, 1.5168, 64.17),
            (Glass::Sf11, 1.78472, 25.68),
            (Glass::Silica, 1.45846, 67.82),
            (Glass::Water, 1.33336, 55.8),
            (Glass::Sapphire, 1.76817, 72.31),
            (Glass::Diamond, 2.4175, 55.3),
        ];
        for (glass, index, abbe) in known {
            let found = (glass.index(YELLOW) - 1.0) / (2.0 * glass.spread());
            assert!((glass.index(YELLOW) - index).abs() < 1e-4, "{glass:?} {}", glass.index(YELLOW));
            assert!((found / abbe - 1.0).abs() < 5e-3, "{glass:?} {found}");
            assert!((glass.bends(BLUE) - glass.bends(RED) - 2.0).abs() < 1e-12);
        }
    }
}
