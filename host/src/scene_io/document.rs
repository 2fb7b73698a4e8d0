//! The tables of a TOML scene, but for its meshes and cameras.

use glam::Vec3;

use super::map::Images;
use super::table::Table;
use crate::error::Result;
use crate::picture::Picture;
use crate::scene::Range;
use crate::scene::studio;
use crate::scene::{Background, Environment, Light, Settings, Transport};

/// Reads `[render]`; what it does not say is the default.
///
/// # Errors
/// A number out of range, or an unknown key.
pub fn settings(mut table: Table) -> Result<Settings> {
    let default = Settings::default();
    let settings = Settings {
        size: table.pair("size", 1, Settings::MOST_SIDE)?.unwrap_or(default.size),
        samples: table.whole("samples", 1, Settings::MOST_SAMPLES)?.unwrap_or(default.samples),
        sampler: table.choice("sampler")?.unwrap_or(default.sampler),
        bounces: table.whole("bounces", 0, Settings::MOST_BOUNCES)?.unwrap_or(default.bounces),
        min_contribution: table.number("min_contribution", Range::SHARE)?.unwrap_or(default.min_contribution),
        culling: table.flag("culling")?.unwrap_or(default.culling),
        compensation: table.flag("compensation")?.unwrap_or(default.compensation),
        spp: table.whole("spp", 1, Settings::MOST_SPP)?.unwrap_or(default.spp),
        filter: table.choice("filter")?.unwrap_or(default.filter),
        pixel_filter: table.choice("pixel_filter")?,
        transparent: table.flag("transparent")?.unwrap_or(default.transparent),
        transport: transport(&mut table)?,
    };
    settings.grid().map_err(|error| table.fault_of("spp", error.message()))?;
    let (width, height) = settings.size;
    Picture::check_size(width, height).map_err(|error| table.fault_of("size", error.message()))?;
    table.done()?;
    Ok(settings)
}

fn transport(table: &mut Table) -> Result<Transport> {
    let default = Transport::default();
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

/// Reads every `[[light]]`.
///
/// # Errors
/// A light without direction, a number out of range, or a key that its kind does not take.
pub fn lights(tables: Vec<Table>) -> Result<Vec<Light>> {
    tables.into_iter().map(light).collect()
}

#[derive(Clone, Copy)]
enum Kind {
    Point,
    Directional,
    Spot,
}

fn light(mut table: Table) -> Result<Light> {
    let words = [("point", Kind::Point), ("directional", Kind::Directional), ("spot", Kind::Spot)];
    let kind = table.word("kind", &words)?;
    let kind = table.need("kind", kind)?;
    let colour = light_colour(&mut table)?;
    let group = table.name("group")?.unwrap_or_default();
    let light = match kind {
        Kind::Point => {
            table.rename("a point light");
            let position = table.triple("position", Range::ANY)?;
            Light::Point { position: table.need("position", position)?, colour, group }
        }
        Kind::Directional => {
            table.rename("a directional light");
            let direction = table.triple("direction", Range::ANY)?;
            let direction = table.need("direction", direction)?;
            if direction == Vec3::ZERO {
                let fault = "the direction is zero; say which way the light travels";
                return Err(table.fault_of("direction", fault));
            }
            Light::Directional { direction, colour, group }
        }
        Kind::Spot => spot(&mut table, colour)?.in_group(&group),
    };
    table.done()?;
    Ok(light)
}

fn spot(table: &mut Table, colour: Vec3) -> Result<Light> {
    table.rename("a spot light");
    let position = table.triple("position", Range::ANY)?;
    let position = table.need("position", position)?;
    let target = table.triple("target", Range::ANY)?;
    let target = table.need("target", target)?;
    if target == position {
        let fault = "the spot light shines at its own position; move its target";
        return Err(table.fault_of("target", fault));
    }
    let angle = table.number("angle", Range::CONE)?;
    let outer = table.need("angle", angle)? / 2.0;
    let softness = table.number("softness", Range::SHARE)?.unwrap_or(0.2);
    let falloff = table.choice("falloff")?.unwrap_or_default();
    Ok(Light::Spot { position, target, colour, outer, inner: outer * (1.0 - softness), falloff, group: String::new() })
}

fn light_colour(table: &mut Table) -> Result<Vec3> {
    let colour = table.triple("color", Range::AMOUNT)?.unwrap_or(Vec3::ONE);
    let intensity = table.number("intensity", Range::AMOUNT)?.unwrap_or(1.0);
    if !(colour * intensity).is_finite() {
        let fault = "color times intensity is not finite; lower the intensity";
        return Err(table.fault_of("intensity", fault));
    }
    Ok(colour * intensity)
}
