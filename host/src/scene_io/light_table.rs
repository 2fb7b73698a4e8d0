//! A `[[light]]` of a TOML scene.

use glam::Vec3;

use super::illuminant;
use super::keys::Keys;
use super::table::Table;
use crate::error::Result;
use crate::scene::{Light, Range};
use crate::spectrum::Illuminant;

/// Reads every `[[light]]`, and says where each is after so many seconds and when the last key of all is.
///
/// # Errors
/// A light without direction, a number out of range, keys that make no sense, or a key that its kind does not take.
pub fn lights(tables: Vec<Table>, seconds: f64) -> Result<(Vec<Light>, Option<f32>)> {
    let (mut lights, mut last) = (Vec::new(), None);
    for table in tables {
        let (light, own) = light(table, seconds)?;
        last = own.into_iter().chain(last).reduce(f32::max);
        lights.push(light);
    }
    Ok((lights, last))
}

#[derive(Clone, Copy)]
enum Kind {
    Point,
    Directional,
    Spot,
}

fn light(mut table: Table, seconds: f64) -> Result<(Light, Option<f32>)> {
    let words = [("point", Kind::Point), ("directional", Kind::Directional), ("spot", Kind::Spot)];
    let kind = table.word("kind", &words)?;
    let kind = table.need("kind", kind)?;
    let illuminant = illuminant::read(&mut table)?;
    let colour = light_colour(&mut table, illuminant)?;
    let group = table.name("group")?.unwrap_or_default();
    let (light, last) = match kind {
        Kind::Point => {
            table.rename("a point light");
            let ([position], last) = moved(&mut table, ["position"], seconds)?;
            (Light::Point { position, colour, group, illuminant }, last)
        }
        Kind::Directional => {
            table.rename("a directional light");
            let ([direction], last) = moved(&mut table, ["direction"], seconds)?;
            if direction == Vec3::ZERO {
                let fault = "the direction is zero; say which way the light travels";
                return Err(table.fault_of("direction", fault));
            }
            (Light::Directional { direction, colour, group, illuminant }, last)
        }
        Kind::Spot => {
            let (light, last) = spot(&mut table, colour, seconds)?;
            (light.in_group(&group).of_spectrum(illuminant), last)
        }
    };
    table.done()?;
    Ok((light, last))
}

fn spot(table: &mut Table, colour: Vec3, seconds: f64) -> Result<(Light, Option<f32>)> {
    table.rename("a spot light");
    let ([position, target], last) = moved(table, ["position", "target"], seconds)?;
    if target == position {
        let fault = "the spot light shines at its own position; move its target";
        return Err(table.fault_of("target", fault));
    }
    let angle = table.number("angle", Range::CONE)?;
    let outer = table.need("angle", angle)? / 2.0;
    let softness = table.number("softness", Range::SHARE)?.unwrap_or(0.2);
    let falloff = table.choice("falloff")?.unwrap_or_default();
    let inner = outer * (1.0 - softness);
    Ok((Light::Spot { position, target, colour, outer, inner, falloff, group: String::new(), illuminant: None }, last))
}

/// Places or ways that a table must say, as its keys have them after so many seconds, and when the last key is.
fn moved<const N: usize>(
    table: &mut Table,
    names: [&'static str; N],
    seconds: f64,
) -> Result<([Vec3; N], Option<f32>)> {
    let mut own = [Vec3::ZERO; N];
    for (value, name) in own.iter_mut().zip(names) {
        let said = table.triple(name, Range::ANY)?;
        *value = table.need(name, said)?;
    }
    let keys = Keys::read(table, names.map(|name| (name, Range::ANY)), own)?;
    Ok(keys.map_or((own, None), |keys| (keys.at(seconds), Some(keys.last()))))
}

/// What it shines: where no colour is said, that of its spectrum.
fn light_colour(table: &mut Table, illuminant: Option<Illuminant>) -> Result<Vec3> {
    let plain = illuminant.map_or(Vec3::ONE, Illuminant::colour);
    let colour = table.triple("color", Range::AMOUNT)?.unwrap_or(plain);
    let intensity = table.number("intensity", Range::AMOUNT)?.unwrap_or(1.0);
    if !(colour * intensity).is_finite() {
        let fault = "color times intensity is not finite; lower the intensity";
        return Err(table.fault_of("intensity", fault));
    }
    Ok(colour * intensity)
}
