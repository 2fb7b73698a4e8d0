//! Pictures that grow part by part while somebody looks on, as a window has them.

use std::time::Duration;

use super::Session;
use crate::error::Result;
use crate::film::{Film, Leasts, Part};
use crate::image::{self, Encoding};
use crate::picture::Picture;
use crate::view::{Region, View};

/// What a screen shows of a film.
pub enum Display {
    /// A texture on the device that has rendered it, `Rgba8Unorm` with the bytes of a PNG. The same one is written again as long as pictures
    /// have its size.
    Texture(wgpu::Texture),
    /// Red, green, blue and how opaque a pixel is, row by row.
    Pixels {
        /// Columns and rows.
        size: (u32, u32),
        /// The bytes of a PNG.
        bytes: Vec<[u8; 4]>,
    },
}

impl Session {
    /// Starts a film of a view without any sample. Parts that are added lie within one of these regions each, which fill its window.
    ///
    /// # Errors
    /// What the device reports.
    pub fn begin(&mut self, view: &View, regions: &[Region]) -> Result<()> {
        self.device.start(view, regions)
    }

    /// Adds a part of the view of which the film has nothing. A GPU may still be at work on it afterwards.
    ///
    /// # Errors
    /// The view has no such part, or what the device reports; the film must then be started again.
    ///
    /// # Panics
    /// If no film was started since the last job.
    pub fn add(&mut self, part: Part) -> Result<()> {
        self.device.add(part, &|_| ())
    }

    /// Waits until all that was added is done.
    ///
    /// # Errors
    /// What the device reports.
    pub fn wait(&mut self) -> Result<()> {
        self.device.wait()
    }

    /// The film so far.
    ///
    /// # Errors
    /// What the device reports, or if there is no memory for it.
    ///
    /// # Panics
    /// If no film was started since the last job.
    pub fn film(&mut self) -> Result<Film> {
        self.device.film()
    }

    /// A film's picture, developed by as many threads as the session has.
    ///
    /// # Errors
    /// If there is no memory for it.
    pub fn develop(&self, film: &Film) -> Result<Picture> {
        Ok(self.device.develop(film)?.0)
    }

    /// What a screen shows of the film so far, of which every pixel has `samples` samples: a PNG's bytes. A GPU shows it in a texture of its
    /// own, where each channel is shown by itself: without a tone map, another white, and a share that is clear.
    ///
    /// # Errors
    /// As [`Session::film`], and an exposure out of range.
    ///
    /// # Panics
    /// If no film was started since the last job.
    pub fn display(&mut self, encoding: &Encoding, samples: u32) -> Result<Display> {
        if !self.job.is_transparent()
            && let Some(leasts) = Leasts::new(encoding, samples)?
            && let Some(texture) = self.device.show(leasts)
        {
            return Ok(Display::Texture(texture?));
        }
        let film = self.film()?;
        Display::of(&self.develop(&film)?, encoding)
    }

    /// Time on the device of all that was rendered and read, if it has a clock.
    pub fn device_time(&self) -> Option<Duration> {
        self.device.device_time()
    }

    /// What renders: the device's name.
    pub fn device_name(&self) -> &str {
        &self.name
    }
}

impl Display {
    /// Of a picture.
    ///
    /// # Errors
    /// An exposure out of range.
    pub fn of(picture: &Picture, encoding: &Encoding) -> Result<Display> {
        let bytes = image::screen(picture, encoding)?;
        Ok(Display::Pixels { size: (picture.width, picture.height), bytes })
    }
}
