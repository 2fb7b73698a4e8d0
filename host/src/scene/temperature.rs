//! What glows by its temperature.

use std::sync::Arc;

use super::{Grid, Quantity, Unplaced};

/// How hot a medium is, where: what it emits is multiplied with the light of a black body there, over the luminance of that of the hottest
/// place, and with nothing outside of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Temperature {
    /// Its numbers.
    pub grid: Arc<Grid>,
    /// How many kelvins a number of the grid is, in [0.001, 1e6].
    pub kelvins: f32,
}

impl Temperature {
    /// The least temperature in kelvins of the hottest place: the eye sees nothing glow below about 800.
    pub const LEAST: f64 = 500.0;
    /// The greatest: beyond it, Planck's formula has few digits left.
    const MOST: f64 = 1e9;

    /// Refuses what [`Grid`]s may not be, and places that are too hot.
    pub(crate) fn check(&self) -> Unplaced<()> {
        self.grid.check(Quantity::Temperature)?;
        self.check_hottest()
    }

    /// Refuses places that are too hot.
    pub(crate) fn check_hottest(&self) -> Unplaced<()> {
        let (hottest, most) = (self.hottest(), Self::MOST);
        if hottest > most {
            return Err(format!(
                "its hottest place has {hottest:.1e} kelvins; lower kelvins, to at most {most:e} there"
            ));
        }
        Ok(())
    }

    /// Is it so cold everywhere that nothing is seen of what glows?
    pub(crate) fn is_dark(&self) -> bool {
        self.hottest() < Self::LEAST
    }

    /// The temperature of its hottest place in kelvins.
    fn hottest(&self) -> f64 {
        f64::from(self.grid.greatest()) * f64::from(self.kelvins)
    }
}
