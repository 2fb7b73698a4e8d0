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
const METHOD: &str = "joint non-local means, version 2";

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
                let mut denoised = oidn.denoise(picture, guides)?;
                denoised.alpha = opacity(picture, guides);
                Ok((denoised, format!("Open Image Denoise {}", oidn.version())))
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
    let pixels = Pixels::of_light(picture, guides).denoised(&picture.pixels);
    Ok(Picture { alpha: opacity(picture, guides), ..picture.with_pixels(pixels) })
}

/// How opaque pixels are, with less noise where shadow catchers make some.
fn opacity(picture: &Picture, guides: &Guides<'_>) -> Option<Vec<f32>> {
    let alpha = picture.alpha.as_ref()?;
    let Some(errors) = guides.opacity_error else { return Some(alpha.clone()) };
    let as_it_is: Vec<[f32; 3]> = alpha.iter().map(|&alpha| [alpha; 3]).collect();
    let denoised = Pixels::of_opacity(picture, alpha, errors, guides).denoised(&as_it_is);
    // A mean may be rounded to more than the greatest.
    Some(denoised.into_iter().map(|[alpha, ..]| alpha.min(1.0)).collect())
}
