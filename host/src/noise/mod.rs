//! Pictures that end when their noise is low enough: each cell of the image gets as many samples as the error of what is seen of it asks
//! for. A cell decides by its own sums alone, so that a picture has the same bits on every device and in every partition.

mod grow;
mod steps;
#[cfg(test)]
mod tests;

use std::ops::Range;

use eyerays_shader::camera;

pub(crate) use self::grow::go_on;
pub(crate) use self::steps::{decides_at, next, whole_blocks};
use crate::choice::Named;
use crate::error::{Error, Result};
use crate::image::{Encoding, ToneMap};
use crate::view::Region;

/// How much noise a picture may have where it is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    noise: f64,
    exposure_ev: f32,
    tone: ToneMap,
    /// Of the exposure.
    scale: f64,
}

/// Cells that get samples: whole blocks of them.
pub(crate) struct Lot {
    pub cells: Vec<Region>,
    pub samples: Range<u32>,
}

/// Sums of cells, and what else a device tells of them.
pub(crate) struct CellSums {
    /// Of each cell, as a film of it.
    pub sums: Vec<Vec<u32>>,
    /// Reflected and refracted rays of all.
    pub secondary: u64,
}

impl Target {
    /// Columns and rows of a cell.
    pub const CELL: u32 = camera::CELL;
    /// Samples of a pixel before a cell decides the first time.
    pub const LEAST_SAMPLES: u32 = steps::LEAST;
    /// The least noise that may be asked for: films keep squares of single precision.
    pub const LEAST_NOISE: f64 = 0.0005;
    /// What is darker than this share of white may have as much noise as what is as bright.
    pub const FLOOR: f64 = 0.05;

    /// A standard error of `noise`, as a share of what is seen, with an exposure in stops and a tone map.
    ///
    /// # Errors
    /// Too little noise, more than there is, or an exposure out of range.
    pub fn new(noise: f64, exposure_ev: f32, tone: ToneMap) -> Result<Target> {
        crate::error::within("noise", &[noise], Self::LEAST_NOISE..=1.0)?;
        let scale = Encoding { exposure_ev, ..Encoding::default() }.scale()?;
        Ok(Target { noise, exposure_ev, tone, scale })
    }

    /// The standard error that is allowed, as a share of what is seen.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// What a film of it is beside others, by names.
    pub(crate) fn entries(&self) -> [(&'static str, String); 3] {
        [
            ("noise", self.noise.to_string()),
            ("noise exposure", self.exposure_ev.to_string()),
            ("noise tone", self.tone.name().to_owned()),
        ]
    }

    /// The target that has these [`Target::entries`].
    pub(crate) fn of_entries([noise, exposure, tone]: [&str; 3]) -> Result<Target> {
        let damaged = || Error::BrokenFilm("damaged");
        let noise = noise.parse().map_err(|_| damaged())?;
        let exposure_ev = exposure.parse().map_err(|_| damaged())?;
        Target::new(noise, exposure_ev, ToneMap::from_name(tone)?)
    }

    /// What is seen of light: the mean of the channels of what a screen shows, in linear light from 0 to 1.
    fn seen(&self, light: [f64; 3]) -> f64 {
        let shown = self.tone.apply(light.map(|channel| channel * self.scale));
        shown.into_iter().map(|channel| channel.clamp(0.0, 1.0)).sum::<f64>() / 3.0
    }

    /// The error of what is seen of a pixel, as a share of it, or of [`Target::FLOOR`] where it is darker: half of the way between a
    /// standard error too little light and one too much. `error` is that of the light, as a share of it.
    pub fn seen_error(&self, light: [f64; 3], error: f64) -> f64 {
        let [low, high] = [(1.0 - error).max(0.0), 1.0 + error].map(|share| self.seen(light.map(|c| c * share)));
        (high - low).abs() / 2.0 / ((high + low) / 2.0).max(Self::FLOOR)
    }

    /// The least region of cells around a region of an image; at its right and lower edge cells end where it does.
    pub fn around(region: Region, (width, height): (u32, u32)) -> Region {
        let (x, y) = (region.x / Self::CELL * Self::CELL, region.y / Self::CELL * Self::CELL);
        let right = (region.x + region.width).next_multiple_of(Self::CELL).min(width);
        let bottom = (region.y + region.height).next_multiple_of(Self::CELL).min(height);
        Region { x, y, width: right - x, height: bottom - y }
    }

    /// The cells of a region that is cut at cells.
    pub(crate) fn cells(region: Region) -> impl Iterator<Item = Region> {
        region.pieces(Self::CELL, Self::CELL)
    }
}
