//! What light of single wavelengths does: a table.

/// A row of the table of spectra, which lies in memory by row and set: three numbers for the three wavelengths of each set, and an unused
/// integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpectrumRow(pub u32);

impl SpectrumRow {
    /// Bits of a drawn number below those that mean a set.
    pub const DRAWN: u32 = 23;
    /// Sets of wavelengths, of which each is as likely.
    pub const SETS: u32 = 1 << (32 - Self::DRAWN);
    /// The first of three: red, green and blue of three smooth spectra that come to one.
    pub const OF_RGB: u32 = 0;
    /// The first of three: what light of each wavelength adds to red, to green and to blue.
    pub const TO_RGB: u32 = 3;
    /// One over the wavelength in nanometres.
    pub const PER_NANOMETRE: u32 = 6;
    /// How far an index of refraction is above that of yellow light (587.6 nm), over half of the difference of those of blue (486.1 nm)
    /// and red light (656.3 nm), where it falls with the square of the wavelength (Cauchy).
    pub const CAUCHY: u32 = 7;
    /// The first of the scene's own.
    pub const OWN: u32 = 8;
    /// The most rows that a number in a record means.
    pub const MOST: u32 = 1 << 6;

    /// Where the row has a set.
    #[inline(always)]
    pub fn at(self, set: u32) -> u32 {
        self.0 * Self::SETS + set
    }
}
