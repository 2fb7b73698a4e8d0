//! What tells neighbours apart.

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
}

impl Guides<'_> {
    /// Do they belong to a picture?
    pub(super) fn check(&self, picture: &Picture) -> Result<()> {
        let count = picture.pixels.len();
        let lengths = [self.albedo.pixels.len(), self.normal.pixels.len(), self.depth.len(), self.error.len()];
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

/// Surfaces darker than this do not divide the light that they send on.
const DARK: f32 = 0.02;

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
    pub fn new(picture: &Picture, guides: &Guides<'_>) -> Self {
        let colour = |albedo: [f32; 3]| albedo.map(|channel| if channel > DARK { channel } else { 1.0 });
        let colours: Vec<[f32; 3]> = guides.albedo.pixels.iter().map(|&albedo| colour(albedo)).collect();
        let divided = |(light, by): (&[f32; 3], &[f32; 3])| [light[0] / by[0], light[1] / by[1], light[2] / by[2]];
        let light: Vec<[f32; 3]> = picture.pixels.iter().zip(&colours).map(divided).collect();
        let brightness: Vec<f32> = light.iter().map(mean).collect();
        let own = picture.pixels.iter().zip(guides.error).zip(&brightness).map(|((pixel, &error), &divided)| {
            // The same share of what was divided.
            let bright = mean(pixel);
            let share = if bright > 0.0 { error / bright } else { 0.0 };
            (share * divided) * (share * divided)
        });
        let own: Vec<f32> = own.collect();
        let surfaces = guides.albedo.pixels.iter().zip(&guides.normal.pixels).zip(guides.depth);
        let surface = surfaces.map(|((&albedo, &normal), &depth)| Surface { albedo, normal, depth });
        let surface: Vec<Surface> = surface.collect();
        let (width, height) = (picture.width as usize, picture.height as usize);
        let field = Field { width, height, brightness: &brightness, surfaces: &surface };
        let variance = field.variances(&own);
        Pixels { width, height, light, colour: colours, brightness, variance, surface }
    }
}

fn mean(pixel: &[f32; 3]) -> f32 {
    (pixel[0] + pixel[1] + pixel[2]) / 3.0
}
