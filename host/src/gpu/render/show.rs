//! Films shown without leaving the GPU.

use super::Renderer;
use crate::error::{Error, Result};
use crate::film::Leasts;
use crate::gpu::screen::Screen;

impl Renderer {
    /// Shows the film so far in a texture of its device, of which every pixel has as many samples as `leasts` says: with the values that
    /// [`screen`](crate::image::screen) has of its picture, as if it were opaque. Does not wait for the device: what is submitted after this
    /// finds them there. It is the same texture for as long as films have the same size.
    ///
    /// # Errors
    /// A part of the film has no sample; a picture that is too large for a texture, or what the GPU reports.
    ///
    /// # Panics
    /// If no film was started.
    pub fn show(&mut self, leasts: Leasts) -> Result<wgpu::Texture> {
        let growing = self.growing.as_ref().expect("a film was started");
        if growing.bands.iter().any(|band| band.is_empty) {
            return Err(Error::new("a part of the film has no sample yet: add one before it is shown"));
        }
        let region = growing.view.region();
        let screen = match self.screen.take() {
            Some(screen) if screen.region() == region => screen,
            _ => Screen::new(&self.gpu, region)?,
        };
        let films: Vec<_> = growing.bands.iter().map(|band| (band.region, &band.film)).collect();
        self.screen.insert(screen).show(&self.gpu, self.plan.film_words, &films, leasts)
    }
}
