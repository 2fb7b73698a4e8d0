//! Layers that films keep: arbitrary output variables, which are rendered beside the light.

use eyerays_shader::data::Aovs;

use super::{Layer, Values};
use crate::choice::Named;
use crate::error::{Error, Result};
use crate::film::Film;
use crate::job::Job;
use crate::scene::{Integrator, LightGroups};

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

/// All layers that a film keeps, by the names that its identity has.
///
/// # Errors
/// If there is no memory for them.
pub fn all_of_film(film: &Film) -> Result<Vec<(Layer, Values)>> {
    let names = film.identity.layers();
    let of = |&layer: &Layer| of_film(film, &names, layer).map(|values| Some((layer, values?))).transpose();
    Layer::VARIANTS.iter().filter(|&&layer| layer != Layer::Indirect).filter_map(of).collect()
}

/// A layer of a film, if it keeps it; the names are those of its variables. What rounding leaves of indirect light below zero is none.
///
/// # Errors
/// If there is no memory for it.
pub fn of_film(film: &Film, names: &[String], layer: Layer) -> Result<Option<Values>> {
    let kept = if names.len() == film.aovs() as usize { names } else { &[] };
    if layer == Layer::LightGroups {
        let groups = kept.iter().zip(0..).filter(|(name, _)| name.starts_with(GROUP));
        let parts: Vec<_> =
            groups.map(|(name, number)| Ok((name.clone(), film.aov(number)?))).collect::<Result<_>>()?;
        return Ok((!parts.is_empty()).then_some(Values::Parts(parts)));
    }
    let name = if layer == Layer::Indirect { Layer::Direct.name() } else { layer.name() };
    let Some((_, number)) = kept.iter().zip(0..).find(|(own, _)| *own == name) else { return Ok(None) };
    let picture = film.aov(number)?;
    Ok(Some(match layer {
        Layer::Albedo => Values::Colours(picture),
        Layer::Normal => Values::Vectors(picture),
        Layer::Indirect => Values::Light(film.develop()?.without(&picture)?),
        _ => Values::Light(picture),
    }))
}
