//! What a scene file asks of a rendering.

use serde::{Deserialize, Serialize};

use super::{Filter, PixelFilter, Sampler, Transport};
use crate::choice::Named;
use crate::error::{Error, Result};
use crate::picture::Picture;

/// A scene file's `[render]` table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Image width and height in pixels.
    pub size: (u32, u32),
    /// Samples along a pixel's edge.
    pub samples: u32,
    /// Samples of a pixel; 0 for the square of `samples`.
    pub spp: u32,
    /// Where in a pixel its samples lie.
    pub sampler: Sampler,
    /// The most times a ray is followed on.
    pub bounces: u32,
    /// A ray whose every weight is less is not followed.
    pub min_contribution: f32,
    /// Skip triangles seen from behind.
    pub culling: bool,
    /// Give back what is lost between the facets of physical materials.
    #[serde(default = "always")]
    pub compensation: bool,
    /// How textures are filtered.
    #[serde(default)]
    pub filter: Filter,
    /// How a pixel weighs what is around its middle; without one as the integrator does, see [`Settings::pixel_filter`].
    #[serde(default)]
    pub pixel_filter: Option<PixelFilter>,
    /// Is what the camera sees of the surroundings left out, so that the picture tells how much of it is opaque?
    #[serde(default)]
    pub transparent: bool,
    /// Do paths carry light of single wavelengths?
    #[serde(default)]
    pub spectral: bool,
    /// Photons for each pixel of a sample, which tell of light that comes by mirrors and glass, in [0, 16]; 0 leaves caustics to chance.
    #[serde(default)]
    pub caustics: f32,
    /// How light is carried.
    pub transport: Transport,
}

fn always() -> bool {
    true
}

impl Settings {
    /// Samples of a pixel.
    pub fn samples_a_pixel(&self) -> u32 {
        if self.spp > 0 { self.spp } else { self.samples * self.samples }
    }

    /// How a pixel weighs what is around its middle: unless it is said, by [`PixelFilter::BlackmanHarris`] where light is sampled, and else
    /// all of the pixel alike.
    pub fn pixel_filter(&self) -> PixelFilter {
        let samples = self.transport.integrator.samples();
        self.pixel_filter.unwrap_or(if samples { PixelFilter::BlackmanHarris } else { PixelFilter::Box })
    }

    /// The edge of the grid that a pixel's samples lie in, 1 without a grid.
    ///
    /// # Errors
    /// That many do not fill one.
    pub fn grid(&self) -> Result<u32> {
        if !self.sampler.has_cells() {
            return Ok(1);
        }
        let samples = self.samples_a_pixel();
        let edge = samples.isqrt();
        if edge * edge == samples && edge <= Self::MOST_SAMPLES {
            return Ok(edge);
        }
        let sampler = self.sampler.name();
        let remedy = "make it a square up to 4096, or the sampler sobol or random";
        Err(Error::new(format!("the sampler {sampler} has no grid of {samples} samples a pixel: {remedy}")))
    }

    /// The largest width and height in pixels.
    pub const MOST_SIDE: u32 = Picture::MAX_SIDE;
    /// The most samples along a pixel's edge.
    pub const MOST_SAMPLES: u32 = 64;
    /// The most samples of a pixel, which single precision still counts.
    pub const MOST_SPP: u32 = 1 << 24;
    /// The most photons for each pixel.
    pub const MOST_PHOTONS: f32 = 16.0;
    /// The largest limit of bounces.
    pub const MOST_BOUNCES: u32 = 65_535;
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            size: (512, 512),
            samples: 1,
            spp: 0,
            sampler: Sampler::default(),
            bounces: 5,
            min_contribution: 1.0 / 1024.0,
            culling: false,
            compensation: true,
            filter: Filter::default(),
            pixel_filter: None,
            transparent: false,
            spectral: false,
            caustics: 0.0,
            transport: Transport::default(),
        }
    }
}
