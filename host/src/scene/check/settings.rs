//! Whether settings are within the limits that memory is planned for.

use crate::error::{Result, within};
use crate::picture::Picture;
use crate::scene::Settings;

impl Settings {
    /// Refuses settings beyond the limits that memory is planned for.
    ///
    /// # Errors
    /// The first of them.
    pub fn check(&self) -> Result<()> {
        let Settings { size: (width, height), samples, spp, bounces, min_contribution, caustics, transport, .. } =
            *self;
        Picture::check_size(width, height)?;
        within("samples", &[samples], 1..=Settings::MOST_SAMPLES)?;
        within("bounces", &[bounces], 0..=Settings::MOST_BOUNCES)?;
        within("min_contribution", &[min_contribution], 0.0..=1.0)?;
        within("spp", &[spp], 0..=Settings::MOST_SPP)?;
        within("caustics", &[caustics], 0.0..=Settings::MOST_PHOTONS)?;
        within("clamp", &[transport.clamp], 0.0..=f32::MAX)?;
        within("ao_distance", &[transport.ao_distance], f32::MIN_POSITIVE..=f32::INFINITY)?;
        self.grid().map(|_| ())
    }
}
