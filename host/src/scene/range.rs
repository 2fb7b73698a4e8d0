//! What numbers mean something where.

use super::Medium;

/// The numbers that a key takes.
#[derive(Clone, Copy)]
pub struct Range {
    holds: fn(f32) -> bool,
    says: &'static str,
}

impl Range {
    /// A coordinate or an angle.
    pub const ANY: Range = Range { holds: |x| x.is_finite(), says: "a finite number" };
    /// A share of light.
    pub const SHARE: Range = Range { holds: |x| (0.0..=1.0).contains(&x), says: "between 0 and 1" };
    /// An amount of light, an exponent.
    pub const AMOUNT: Range = Range { holds: |x| x.is_finite() && x >= 0.0, says: "a finite number of at least 0" };
    /// A length.
    pub const LENGTH: Range = Range { holds: |x| x.is_finite() && x > 0.0, says: "a finite number greater than 0" };
    /// A factor, which may mirror.
    pub const FACTOR: Range = Range { holds: |x| x.is_finite() && x != 0.0, says: "a finite number other than 0" };
    /// A full angle of view or of a cone, in degrees.
    pub const CONE: Range =
        Range { holds: |x| x > 0.0 && x < 180.0, says: "between 0 and 180 degrees, both exclusive" };
    /// How far something turns.
    pub const TURN: Range = Range { holds: |x| (0.0..=180.0).contains(&x), says: "an angle between 0 and 180 degrees" };
    /// How far an image is moved, as a share of its side.
    pub const SHIFT: Range = Range { holds: |x| (-100.0..=100.0).contains(&x), says: "between -100 and 100" };
    /// A full angle that may go all around, in degrees.
    pub const CIRCLE: Range =
        Range { holds: |x| x > 0.0 && x <= 360.0, says: "greater than 0 and at most 360 degrees" };
    /// Photons for each pixel.
    pub const PHOTONS: Range = Range { holds: |x| (0.0..=16.0).contains(&x), says: "between 0 and 16" };
    /// By how much the scales of hair lean, in degrees.
    pub const LEAN: Range = Range { holds: |x| (-10.0..=10.0).contains(&x), says: "between -10 and 10 degrees" };
    /// An index of refraction.
    pub const IOR: Range = Range { holds: |x| (1.0..=4.0).contains(&x), says: "between 1 and 4" };
    /// An Abbe number.
    pub const ABBE: Range = Range { holds: |x| (1.0..=1000.0).contains(&x), says: "between 1 and 1000" };
    /// 20 over an Abbe number; 0 for none.
    pub const DISPERSION: Range = Range { holds: |x| (0.0..=20.0).contains(&x), says: "between 0 and 20" };
    /// The thickness of a film, in nanometres.
    pub const THICKNESS: Range =
        Range { holds: |x| (0.0..=100_000.0).contains(&x), says: "between 0 and 100000 nanometres" };
    /// How many kelvins a number of a grid is.
    pub const KELVINS: Range =
        Range { holds: |x| (0.001..=1e6).contains(&x), says: "between 0.001 and 1000000 kelvins" };
    /// The mean cosine of an angle by which light is scattered.
    pub const ANISOTROPY: Range =
        Range { holds: |x| x.abs() <= Medium::MOST_ANISOTROPY, says: "between -0.999 and 0.999" };
    /// The temperature of what glows.
    pub const TEMPERATURE: Range =
        Range { holds: |x| (500.0..=100_000.0).contains(&x), says: "between 500 and 100000" };
    /// A part of a conductor's complex index of refraction.
    pub const INDEX: Range = Range { holds: |x| (0.0..=100.0).contains(&x), says: "between 0 and 100" };

    /// Is the number in the range? NaN never is.
    pub fn holds(&self, number: f32) -> bool {
        (self.holds)(number)
    }

    /// The range in words that follow "must be".
    pub fn says(&self) -> &'static str {
        self.says
    }
}
