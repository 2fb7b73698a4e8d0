//! Pictures that noise is taken off.

use eyerays::denoise::{Denoiser, Guides, Oidn};
use eyerays::film::Film;
use eyerays::layers::{Layer, Values};
use eyerays::picture::Picture;
use eyerays::scene::Integrator;

use crate::error::{Error, Result};

/// The layers that tell neighbours apart.
pub(super) const NEEDED: [Layer; 4] = [Layer::Albedo, Layer::Normal, Layer::Depth, Layer::Error];

/// Refuses a picture that has no noise, and a denoiser that is not there.
pub(super) fn check(denoiser: Denoiser, integrator: Integrator) -> Result<()> {
    if integrator.samples() {
        return match denoiser {
            Denoiser::Own => Ok(()),
            Denoiser::Oidn => Ok(Oidn::find().map(drop)?),
        };
    }
    Err(Error::new(format!("--denoise: pictures of the integrator {integrator} have no noise; leave it out")))
}

/// Takes noise off a picture by its layers, which get the noisy one, too; and by its film off what shadow catchers make of it. The picture
/// says what did it.
pub(super) fn denoised(
    denoiser: Denoiser,
    picture: &Picture,
    film: Option<&Film>,
    layers: &mut Vec<(Layer, Values)>,
) -> Result<(Picture, String)> {
    let opacity_errors = film.and_then(Film::opacity_errors);
    let opacity_error = opacity_errors.as_deref();
    let find = |wanted| layers.iter().find(|(layer, _)| *layer == wanted).map(|(_, values)| values);
    let guides = match NEEDED.map(find) {
        [
            Some(Values::Colours(albedo)),
            Some(Values::Vectors(normal)),
            Some(Values::Lengths(depth)),
            Some(Values::Lengths(error)),
        ] => Guides { albedo, normal, depth, error, opacity_error },
        _ => unreachable!("they were rendered"),
    };
    let denoised = denoiser.denoise(picture, &guides)?;
    layers.push((Layer::Noisy, Values::Light(picture.clone())));
    Ok(denoised)
}
