//! What kind of light lamps have, as scene files say it.

use super::table::Table;
use crate::error::Result;
use crate::scene::Range;
use crate::spectrum::Illuminant;

/// Takes the keys of it, if there are any.
///
/// # Errors
/// A temperature out of range, a lamp that there is not, or both keys.
pub fn read(table: &mut Table) -> Result<Option<Illuminant>> {
    if table.has("temperature") && table.has("illuminant") {
        let fault = "a lamp has a temperature or the spectrum of an illuminant; remove temperature or illuminant";
        return Err(table.fault_of("temperature", fault));
    }
    let kelvins = table.number("temperature", Range::TEMPERATURE)?;
    let lamp = table.choice("illuminant")?;
    Ok(kelvins.map(Illuminant::BlackBody).or(lamp.map(Illuminant::Fluorescent)))
}
