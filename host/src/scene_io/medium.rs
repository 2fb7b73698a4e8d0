//! What is between surfaces, as scene files say it.

use glam::Vec3;

use super::map::Images;
use super::table::Table;
use crate::error::Result;
use crate::scene::{Medium, Quantity, Range, Volume};

/// Reads `[fog]`.
///
/// # Errors
/// A number out of range, or an unknown key.
pub fn fog(mut table: Table) -> Result<Medium> {
    let medium = medium(&mut table, Medium::default().emission)?;
    table.done()?;
    Ok(medium)
}

/// Reads the `volume` of a material.
///
/// # Errors
/// As of [`fog`].
pub fn volume(mut table: Table, images: &mut Images) -> Result<Volume> {
    table.rename("volume");
    // What is said to be hot glows.
    let is_hot = table.has(Quantity::Temperature.name());
    let emission = if is_hot { Vec3::ONE } else { Medium::default().emission };
    let volume = Volume {
        medium: medium(&mut table, emission)?,
        interface: table.flag("interface")?.unwrap_or(true),
        priority: table.whole("priority", 0, u8::MAX.into())?.unwrap_or(0) as u8,
        density: images.density(&mut table)?,
        temperature: images.temperature(&mut table)?,
    };
    table.done()?;
    Ok(volume)
}

/// What a medium is, and sends where it says nothing of that.
fn medium(table: &mut Table, emission: Vec3) -> Result<Medium> {
    let default = Medium::default();
    let anisotropy = table.number("anisotropy", Range::ANISOTROPY)?.unwrap_or(default.anisotropy);
    let emission = table.triple_or_number("emission", Range::AMOUNT)?.unwrap_or(emission);
    let medium = match coloured(table)? {
        Some((colour, distance)) => Medium { emission, ..Medium::of_colour(colour, distance, anisotropy) },
        None => Medium {
            scattering: table.triple_or_number("scattering", Range::AMOUNT)?.unwrap_or(default.scattering),
            absorption: table.triple_or_number("absorption", Range::AMOUNT)?.unwrap_or(default.absorption),
            anisotropy,
            emission,
        },
    };
    let sends = if table.has("emission") { "emission" } else { Quantity::Temperature.name() };
    medium.check_emission().map_err(|fault| table.fault_of(sends, fault))?;
    Ok(medium)
}

/// The colour of a thick body and the mean way of light in it, if they are given instead of coefficients.
fn coloured(table: &mut Table) -> Result<Option<(Vec3, Vec3)>> {
    let has = ["scattering", "absorption"].into_iter().find(|key| table.has(key));
    let colour = table.triple("color", Range::SHARE)?;
    let distance = table.triple_or_number("distance", Range::LENGTH)?;
    if colour.is_none() && distance.is_none() {
        return Ok(None);
    }
    if let Some(key) = has {
        return Err(table.fault_of(key, format!("{key} is told by color and distance; remove it or both of these")));
    }
    Ok(Some((table.need("color", colour)?, table.need("distance", distance)?)))
}
