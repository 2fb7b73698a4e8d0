//! The tables of a TOML scene, but for its meshes and cameras.

use glam::Vec3;

use super::map::Images;
use super::table::Table;
use crate::error::Result;
use crate::picture::Picture;
use crate::scene::Range;
use crate::scene::studio;
use crate::scene::{Background, Environment, Settings, Transport};

/// Reads `[render]`; what it does not say is as before. Either number of samples goes before both.
///
/// # Errors
/// A number out of range, or an unknown key.
pub fn settings(mut table: Table, default: Settings) -> Result<Settings> {
    let (samples, spp) =
        (table.whole("samples", 1, Settings::MOST_SAMPLES)?, table.whole("spp", 1, Settings::MOST_SPP)?);
    let settings = Settings {
        size: table.pair("size", 1, Settings::MOST_SIDE)?.unwrap_or(default.size),
        samples: samples.unwrap_or(default.samples),
        spp: spp.unwrap_or(if samples.is_some() { 0 } else { default.spp }),
        sampler: table.choice("sampler")?.unwrap_or(default.sampler),
        bounces: table.whole("bounces", 0, Settings::MOST_BOUNCES)?.unwrap_or(default.bounces),
        min_contribution: table.number("min_contribution", Range::SHARE)?.unwrap_or(default.min_contribution),
        culling: table.flag("culling")?.unwrap_or(default.culling),
        compensation: table.flag("compensation")?.unwrap_or(default.compensation),
        filter: table.choice("filter")?.unwrap_or(default.filter),
        pixel_filter: table.choice("pixel_filter")?.or(default.pixel_filter),
        transparent: table.flag("transparent")?.unwrap_or(default.transparent),
        caustics: table.number("caustics", Range::PHOTONS)?.unwrap_or(default.caustics),
        spectral: table.flag("spectral")?.unwrap_or(default.spectral),
        transport: transport(&mut table, default.transport)?,
    };
    settings.grid().map_err(|error| table.fault_of("spp", error.message()))?;
    let (width, height) = settings.size;
    Picture::check_size(width, height).map_err(|error| table.fault_of("size", error.message()))?;
    table.done()?;
    Ok(settings)
}

fn transport(table: &mut Table, default: Transport) -> Result<Transport> {
    Ok(Transport {
        integrator: table.choice("integrator")?.unwrap_or(default.integrator),
        seed: table.whole("seed", 0, u32::MAX)?.unwrap_or(default.seed),
        roulette: table.whole("roulette", 0, Settings::MOST_BOUNCES)?.unwrap_or(default.roulette),
        clamp: table.number("clamp", Range::AMOUNT)?.unwrap_or(default.clamp),
        direct: table.choice("direct")?.unwrap_or(default.direct),
        ao_distance: table.number("ao_distance", Range::LENGTH)?.unwrap_or(default.ao_distance),
    })
}

/// Reads `[background]`: a `color`, a `horizon` and a `zenith`, or an `environment`.
///
/// # Errors
/// Both or neither, a colour below 0, or an unknown key.
pub fn background(mut table: Table, images: &mut Images) -> Result<Surroundings> {
    if table.has("color") && (table.has("horizon") || table.has("zenith")) {
        let fault = "[background] has a color and a gradient; remove the one or the other";
        return Err(table.fault_of("color", fault));
    }
    if table.has("ambient") {
        let fault = "ambient is no key of [background]; move it above the first table";
        return Err(table.fault_of("ambient", fault));
    }
    let environment = environment(&mut table, images)?;
    let colour = table.triple("color", Range::AMOUNT)?;
    let colour = if environment.is_some() { colour.or(Some(Vec3::ZERO)) } else { colour };
    let horizon = table.triple("horizon", Range::AMOUNT)?;
    let zenith = table.triple("zenith", Range::AMOUNT)?;
    let background = match (colour, horizon, zenith) {
        (Some(colour), ..) => Background::Colour(colour),
        (None, None, None) => Background::Colour(table.need("color", colour)?),
        _ => Background::Gradient { horizon: table.need("horizon", horizon)?, zenith: table.need("zenith", zenith)? },
    };
    let group = table.name("group")?.unwrap_or_default();
    table.done()?;
    Ok(Surroundings { background, environment, group })
}

/// What is around a scene.
pub struct Surroundings {
    pub background: Background,
    pub environment: Option<Environment>,
    /// Of lamps, empty for none.
    pub group: String,
}

impl Default for Surroundings {
    fn default() -> Self {
        Surroundings { background: Background::Colour(Vec3::ZERO), environment: None, group: String::new() }
    }
}

/// The picture that `[background]` names, if it does; with it a colour is what the camera sees of one that is not visible.
fn environment(table: &mut Table, images: &mut Images) -> Result<Option<Environment>> {
    let Some(name) = table.name("environment")? else { return Ok(None) };
    if table.has("horizon") || table.has("zenith") {
        let fault = "[background] has an environment and a gradient; remove the one or the other";
        return Err(table.fault_of("environment", fault));
    }
    let texture = match name.as_str() {
        studio::NAME => studio::texture(),
        file => images.texture(file).map_err(|error| table.fault_of("environment", error.to_string()))?,
    };
    let visible = table.flag("visible")?.unwrap_or(true);
    if visible && table.has("color") {
        let fault = "a color is what the camera sees of an environment that is not visible; set visible to false";
        return Err(table.fault_of("color", fault));
    }
    let rotation = table.number("rotation", Range::ANY)?.unwrap_or(0.0);
    let scale = table.number("intensity", Range::AMOUNT)?.unwrap_or(1.0);
    Ok(Some(Environment { texture, rotation, scale, visible }))
}
