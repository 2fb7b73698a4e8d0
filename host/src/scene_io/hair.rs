//! Hair, as scene files describe it.

use glam::Vec3;

use super::table::Table;
use crate::error::Result;
use crate::scene::{Hair, Physical, Pigment, Range};

/// What is said of [`Hair`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fields {
    hair: Hair,
    pigment: Option<Pigment>,
}

impl Fields {
    /// Takes the key of a `[[material]]` table, whose color it may not have twice.
    ///
    /// # Errors
    /// A number out of range, an unknown key, or two colors.
    pub fn read(table: &mut Table) -> Result<Option<Fields>> {
        let has_base = table.has("base_color");
        let Some(mut own) = table.table("hair")? else { return Ok(None) };
        let plain = Hair::default();
        let hair = Hair {
            roughness: own.number("roughness", Range::SHARE)?.unwrap_or(plain.roughness),
            radial_roughness: own.number("radial_roughness", Range::SHARE)?.unwrap_or(plain.radial_roughness),
            tilt: own.number("tilt", Range::LEAN)?.unwrap_or(plain.tilt),
        };
        let pigment = pigment(&mut own, has_base)?;
        own.done()?;
        Ok(Some(Fields { hair, pigment }))
    }

    /// The color of its pigment, if it says one.
    pub fn colour(&self) -> Option<Vec3> {
        self.pigment.map(|pigment| self.hair.colour(pigment))
    }

    /// Gives it to a material.
    pub fn give(self, to: &mut Physical) {
        to.hair = Some(self.hair);
    }
}

fn pigment(own: &mut Table, has_base: bool) -> Result<Option<Pigment>> {
    let absorption = own.triple("absorption", Range::INDEX)?;
    let melanins = (own.number("melanin", Range::INDEX)?, own.number("pheomelanin", Range::INDEX)?);
    let (pigment, key) = match (absorption, melanins) {
        (None, (None, None)) => return Ok(None),
        (Some(absorption), (None, None)) => (Pigment::Absorption(absorption), "absorption"),
        (None, (brown, red)) => {
            let key = if brown.is_some() { "melanin" } else { "pheomelanin" };
            (Pigment::Melanin(brown.unwrap_or(0.0), red.unwrap_or(0.0)), key)
        }
        (Some(_), _) => {
            return Err(own.fault_of("absorption", "melanin says what hair absorbs; remove absorption or melanin"));
        }
    };
    if has_base {
        return Err(own.fault_of(key, format!("base_color says the color of hair; remove it or {key}")));
    }
    Ok(Some(pigment))
}

/// The key of a material's table that says it again.
pub fn described(Hair { roughness, radial_roughness, tilt }: Hair) -> (&'static str, String) {
    let keys = format!("{{ roughness = {roughness:?}, radial_roughness = {radial_roughness:?}, tilt = {tilt:?} }}");
    ("hair", keys)
}
