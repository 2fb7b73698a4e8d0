//! Pictures with less noise: what pixels have in common with their neighbours is averaged over them. A pixel's neighbours are those
//! whose light differs by no more than its noise explains, and whose surfaces are alike (joint non-local means: Rousselle, Manzi and
//! Zwicker, Robust Denoising using Feature and Color Information, 2013).

mod band;
mod guides;
mod oidn;
mod surface;
#[cfg(test)]
mod tests;
mod variance;

use rayon::prelude::*;

use self::band::Band;
pub use self::guides::Guides;
use self::guides::Pixels;
pub use self::oidn::Oidn;
use crate::choice::choices;
use crate::error::Result;
use crate::picture::Picture;

choices! {
    /// What takes noise off a picture.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Denoiser {
        /// This program's own, by the surfaces that pixels show: the same bits on every machine
        #[default]
        Own = "own",
        /// Open Image Denoise, whose library is then to be found; it gives other bits on other processors
        Oidn = "oidn",
    }
}

/// What a picture says that was denoised by [`Denoiser::Own`].
const METHOD: &str = "joint non-local means, version 1";

/// Rows that a thread takes at once.
const ROWS: usize = 16;

impl Denoiser {
    /// The picture with less noise, and what did that.
    ///
    /// # Errors
    /// As [`denoise`], [`Oidn::find`] and [`Oidn::denoise`].
    pub fn denoise(self, picture: &Picture, guides: &Guides<'_>) -> Result<(Picture, String)> {
        match self {
            Denoiser::Own => Ok((denoise(picture, guides)?, METHOD.to_owned())),
            Denoiser::Oidn => {
                let oidn = Oidn::find()?;
                Ok((oidn.denoise(picture, guides)?, format!("Open Image Denoise {}", oidn.version())))
            }
        }
    }
}

/// The picture with less noise. Pixels that have none keep their bits, unless others beside them on the same surface have some; the same
/// pixels are the same bits on every machine.
///
/// # Errors
/// Guides of another size, a picture of single samples, whose noise nobody knows, or too little memory.
pub fn denoise(picture: &Picture, guides: &Guides<'_>) -> Result<Picture> {
    guides.check(picture)?;
    let pixels = Pixels::new(picture, guides);
    let mut denoised = picture.clone();
    let width = picture.width as usize;
    denoised.pixels.par_chunks_mut(ROWS * width).enumerate().for_each(|(number, rows)| {
        let first = number * ROWS;
        Band::new(&pixels, first..first + rows.len() / width).denoise(picture, rows);
    });
    Ok(denoised)
}
