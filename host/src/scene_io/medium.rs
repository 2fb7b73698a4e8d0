//! What is between surfaces, as scene files say it.

use glam::Vec3;

use super::map::Images;
use super::table::Table;
use crate::error::Result;
use crate::scene::{Medium, Range, Volume};

/// Reads `[fog]`.
///
/// # Errors
/// A number out of range, or an unknown key.
pub fn fog(mut table: Table) -> Result<Medium> {
    let medium = medium(&mut table)?;
    table.done()?;
    Ok(medium)
}

/// Reads the `volume` of a material.
///
/// # Errors
/// As of [`fog`].
pub fn volume(mut table: Table, images: &mut Images) -> Result<Volume> {
    table.rename("volume");
    let volume = Volume {
        medium: medium(&mut table)?,
        interface: table.flag("interface")?.unwrap_or(true),
        priority: table.whole("priority", 0, u8::MAX.into())?.unwrap_or(0) as u8,
        density: images.grid(&mut table, "density")?,
    };
    table.done()?;
    Ok(volume)
}

fn medium(table: &mut Table) -> Result<Medium> {
    let default = Medium::default();
    let anisotropy = table.number("anisotropy", Range::ANISOTROPY)?.unwrap_or(default.anisotropy);
    let emission = table.triple_or_number("emission", Range::AMOUNT)?.unwrap_or(default.emission);
    let medium = match coloured(table)? {
        Some((colour, distance)) => Medium { emission, ..Medium::of_colour(colour, distance, anisotropy) },
        None => Medium {
            scattering: table.triple_or_number("scattering", Range::AMOUNT)?.unwrap_or(default.scattering),
            absorption: table.triple_or_number("absorption", Range::AMOUNT)?.unwrap_or(default.absorption),
            anisotropy,
            emission,
        },
    };
    medium.check_emission().map_err(|fault| table.fault_of("emission", fault))?;
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
