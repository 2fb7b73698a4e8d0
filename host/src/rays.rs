//! What a rendering counts.

use serde::Serialize;

/// Rays traced, by kind, and pixels that lost a contribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Rays {
    /// One a sample.
    pub primary: u64,
    /// Towards lights, from surfaces that face them.
    pub shadow: u64,
    /// Reflected and refracted.
    pub secondary: u64,
    /// Pixels with a contribution that was no finite number and was left out.
    #[serde(rename = "non_finite_pixels")]
    pub non_finite: u64,
}

impl Rays {
    /// All rays.
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.secondary
    }
}

impl std::ops::AddAssign for Rays {
    fn add_assign(&mut self, other: Rays) {
        self.primary += other.primary;
        self.shadow += other.shadow;
        self.secondary += other.secondary;
        self.non_finite += other.non_finite;
    }
}
