//! Layers that films keep: arbitrary output variables, which are rendered beside the light.

use eyerays_shader::data::Aovs;
use eyerays_shader::stage::AOV_WORDS;

use super::{Layer, Values};
use crate::choice::Named;
use crate::error::{Error, Result};
use crate::film::Film;
use crate::job::Job;
use crate::memory::Room;
use crate::picture::Picture;
use crate::scene::{Integrator, LightGroups};
use crate::view::View;

/// What the light of a group is called: this, and its name.
const GROUP: &str = "group_";

impl Layer {
    /// What a film keeps for it, if it keeps it.
    pub fn aov(self) -> Option<Aovs> {
        let bit = match self {
            Layer::Albedo => Aovs::ALBEDO,
            Layer::Normal => Aovs::NORMAL,
            Layer::Emission => Aovs::EMISSION,
            Layer::Environment => Aovs::ENVIRONMENT,
            // The rest of all light.
            Layer::Direct | Layer::Indirect => Aovs::DIRECT,
            Layer::DiffuseDirect => Aovs::DIFFUSE_DIRECT,
            Layer::DiffuseIndirect => Aovs::DIFFUSE_INDIRECT,
            Layer::GlossyDirect => Aovs::GLOSSY_DIRECT,
            Layer::GlossyIndirect => Aovs::GLOSSY_INDIRECT,
            Layer::TransmissionDirect => Aovs::TRANSMISSION_DIRECT,
            Layer::TransmissionIndirect => Aovs::TRANSMISSION_INDIRECT,
            Layer::LightGroups => Aovs::GROUPS,
            _ => return None,
        };
        Some(Aovs(bit))
    }
}

/// What a film keeps for some layers.
pub fn asked(layers: &[Layer]) -> Aovs {
    layers.iter().filter_map(|layer| layer.aov()).fold(Aovs(0), |all, aov| all.with(aov.0))
}

/// Can films of an integrator keep them, of a scene with these groups of lamps?
///
/// # Errors
/// It traces no paths, or groups are asked of a scene without any.
pub fn check(aovs: Aovs, integrator: Integrator, groups: &LightGroups) -> Result<()> {
    if aovs.any() && integrator != Integrator::Path {
        return Err(Error::new(
            "films keep layers of light where paths are traced: set the integrator to \"path\" (--integrator path)",
        ));
    }
    if aovs.has(Aovs::GROUPS) && groups.names().is_empty() {
        return Err(Error::new(
            "no lamp of the scene is in a group: give lights, materials that emit or [background] a group = \"name\"",
        ));
    }
    Ok(())
}

/// What the variables of a job's films are called, in their order.
pub fn names(job: &Job) -> Vec<String> {
    let is_own = |layer: &&Layer| **layer != Layer::Indirect && **layer != Layer::LightGroups;
    let own = Layer::VARIANTS.iter().filter(is_own).filter_map(|&layer| Some((layer.aov()?, layer)));
    let mut kept: Vec<(Aovs, Layer)> = own.filter(|(aov, _)| job.aovs().has(aov.0)).collect();
    kept.sort_unstable_by_key(|(aov, _)| aov.0);
    let mut names: Vec<String> = kept.into_iter().map(|(_, layer)| layer.name().to_owned()).collect();
    if job.aovs().has(Aovs::GROUPS) {
        let groups = job.light_groups().names().iter().map(String::as_str);
        names.extend([LightGroups::REST].into_iter().chain(groups).map(|name| format!("{GROUP}{name}")));
    }
    names
}

/// May a film call a variable so?
pub(crate) fn can_be_named(name: &str) -> bool {
    match name.strip_prefix(GROUP) {
        Some(group) => group == LightGroups::REST || LightGroups::can_be(group),
        None => Layer::from_name(name).is_ok_and(|layer| layer.aov().is_some() && layer != Layer::Indirect),
    }
}

/// Refuses a view whose film takes more memory than there is, with its layers as they are written.
///
/// # Errors
/// One that says how much that is.
pub fn check_room(job: &Job, view: &View) -> Result<()> {
    let (pixels, layers) = (view.region().pixels(), u64::from(job.aov_count()));
    if layers == 0 {
        return Ok(());
    }
    // Sums, and a picture of each with its channels.
    let bytes = pixels * (layers * (4 * u64::from(AOV_WORDS) + 24) + 4 * u64::from(view.noisy_film_words().light));
    Room::now().check(bytes).map_err(|why| {
        Error::new(format!(
            "{layers} layers of {pixels} pixels may {why}; keep fewer, or render tiles of a smaller size"
        ))
    })
}

/// All layers that a film keeps, by the names that its identity has; the picture is that of all its light.
///
/// # Errors
/// If there is no memory for them.
pub fn all_of_film(film: &Film, picture: &Picture) -> Result<Vec<(Layer, Values)>> {
    let names = film.identity.layers();
    let of = |&layer: &Layer| of_film(film, (&names, picture), layer).map(|values| Some((layer, values?))).transpose();
    Layer::VARIANTS.iter().filter_map(of).collect()
}

/// A layer of a film, if it keeps it; the names are those of its variables. Indirect light is what a picture has beside direct light; what
/// rounding leaves of it below zero is none.
///
/// # Errors
/// If there is no memory for it.
pub fn of_film(film: &Film, (names, picture): (&[String], &Picture), layer: Layer) -> Result<Option<Values>> {
    let kept = if names.len() == film.aovs() as usize { names } else { &[] };
    if layer == Layer::LightGroups {
        let groups = kept.iter().zip(0..).filter(|(name, _)| name.starts_with(GROUP));
        let parts: Vec<_> =
            groups.map(|(name, number)| Ok((name.clone(), film.aov(number)?))).collect::<Result<_>>()?;
        return Ok((!parts.is_empty()).then_some(Values::Parts(parts)));
    }
    let name = if layer == Layer::Indirect { Layer::Direct.name() } else { layer.name() };
    let Some((_, number)) = kept.iter().zip(0..).find(|(own, _)| *own == name) else { return Ok(None) };
    let own = film.aov(number)?;
    Ok(Some(match layer {
        Layer::Albedo => Values::Colours(own),
        Layer::Normal => Values::Vectors(own),
        Layer::Indirect => Values::Light(picture.without(&own)?),
        _ => Values::Light(own),
    }))
}
