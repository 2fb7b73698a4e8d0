//! What tells neighbours apart.

use rayon::prelude::*;

use super::band::Band;
use super::surface::Surface;
use super::variance::Field;
use crate::error::{Error, Result};
use crate::picture::Picture;

/// Layers of a picture, of its size: means over the same samples.
#[derive(Clone, Copy)]
pub struct Guides<'g> {
    /// Colours of surfaces, see [`Layer::Albedo`](crate::layers::Layer::Albedo).
    pub albedo: &'g Picture,
    /// Their shading normals.
    pub normal: &'g Picture,
    /// How far away they are, infinite for nothing.
    pub depth: &'g [f32],
    /// Standard errors of the pixels' brightness, at least 0.
    pub error: &'g [f32],
    /// Those of how opaque pixels are, where shadow catchers make that noisy, see [`Film::opacity_errors`](crate::film::Film::opacity_errors).
    pub opacity_error: Option<&'g [f32]>,
}

impl Guides<'_> {
    /// Do they belong to a picture?
    pub(super) fn check(&self, picture: &Picture) -> Result<()> {
        let count = picture.pixels.len();
        let opacity_errors = self.opacity_error.map_or(count, <[f32]>::len);
        let lengths =
            [self.albedo.pixels.len(), self.normal.pixels.len(), self.depth.len(), self.error.len(), opacity_errors];
        if lengths.into_iter().any(|length| length != count) {
            return Err(Error::new("the layers have other pixels than the picture: render them again"));
        }
        // NaN is below nothing.
        if !self.error.iter().all(|&error| error < f32::INFINITY) {
            return Err(Error::new("one sample a pixel does not tell its noise: render two or more"));
        }
        Ok(())
    }
}

/// Rows that a thread takes at once.
const ROWS: usize = 16;
/// The least that light is divided by. What a darker surface sends on is mostly what it mirrors, which does not go with its colour.
const DARK: f32 = 0.05;

/// What pixels are compared by.
pub(super) struct Pixels {
    pub width: usize,
    pub height: usize,
    /// Light without the colour of the surface that sends it on.
    pub light: Vec<[f32; 3]>,
    /// What it was divided by.
    pub colour: Vec<[f32; 3]>,
    /// The mean of its channels.
    pub brightness: Vec<f32>,
    /// The square of that mean's standard error, see [`Field::variances`].
    pub variance: Vec<f32>,
    pub surface: Vec<Surface>,
}

impl Pixels {
    /// Of the light of a picture.
    pub fn of_light(picture: &Picture, guides: &Guides<'_>) -> Self {
        let colour = |albedo: &[f32; 3]| albedo.map(|channel| channel.max(DARK));
        let colours: Vec<[f32; 3]> = guides.albedo.pixels.iter().map(colour).collect();
        let divided = |(light, by): (&[f32; 3], &[f32; 3])| [light[0] / by[0], light[1] / by[1], light[2] / by[2]];
        let light: Vec<[f32; 3]> = picture.pixels.iter().zip(&colours).map(divided).collect();
        let told = picture.pixels.iter().zip(guides.error).zip(&light).map(|((pixel, &error), divided)| {
            // The same share of what was divided.
            let bright = mean(pixel);
            let share = if bright > 0.0 { error / bright } else { 0.0 };
            let error = share * mean(divided);
            error * error
        });
        let told = told.collect();
        Pixels::new(picture, light, colours, told, guides)
    }

    /// Of how opaque its pixels are, with their standard errors.
    pub fn of_opacity(picture: &Picture, opacity: &[f32], errors: &[f32], guides: &Guides<'_>) -> Self {
        let light = opacity.iter().map(|&alpha| [alpha; 3]).collect();
        let told = errors.iter().map(|error| error * error).collect();
        Pixels::new(picture, light, vec![[1.0; 3]; opacity.len()], told, guides)
    }

    /// `told` are squares of standard errors of the light's means over the channels.
    fn new(
        picture: &Picture,
        light: Vec<[f32; 3]>,
        colour: Vec<[f32; 3]>,
        told: Vec<f32>,
        guides: &Guides<'_>,
    ) -> Self {
        let brightness: Vec<f32> = light.iter().map(mean).collect();
        let surfaces = guides.albedo.pixels.iter().zip(&guides.normal.pixels).zip(guides.depth);
        let surface = surfaces.map(|((&albedo, &normal), &depth)| Surface { albedo, normal, depth });
        let surface: Vec<Surface> = surface.collect();
        let (width, height) = (picture.width as usize, picture.height as usize);
        let field = Field { width, height, brightness: &brightness, surfaces: &surface };
        let variance = field.variances(&told);
        Pixels { width, height, light, colour, brightness, variance, surface }
    }

    /// The light of pixels that have noise and of those around that are like them in the mean, times the colours again; `as_it_is` of the
    /// others.
    pub fn denoised(&self, as_it_is: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let mut denoised = as_it_is.to_vec();
        denoised.par_chunks_mut(ROWS * self.width).enumerate().for_each(|(number, rows)| {
            let first = number * ROWS;
            Band::new(self, first..first + rows.len() / self.width).denoise(rows);
        });
        denoised
    }
}

fn mean(pixel: &[f32; 3]) -> f32 {
    (pixel[0] + pixel[1] + pixel[2]) / 3.0
}
