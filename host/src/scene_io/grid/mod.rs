//! Files of numbers in space: how dense a medium is, or how hot.

mod blosc;
pub(super) mod bytes;
mod nvdb;
#[cfg(test)]
mod tests;
mod vol;

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::budget::Budget;
use super::file;
use super::table::Table;
use crate::error::Result;
use crate::scene::{Grid, Quantity, Range, Unplaced};

/// A grid that a table names.
pub struct Named {
    pub grid: Grid,
    pub path: PathBuf,
    /// How many kelvins a number of it is, if it is of temperatures.
    pub kelvins: f32,
}

/// Reads what a table's key for such numbers names: a file, or a table of that, the name of a grid in it, the box that it is to fill and,
/// of temperatures, how many kelvins a number is.
///
/// # Errors
/// A file that cannot be read, or has no such grid; a box without a volume, a number out of range or an unknown key.
pub fn named(table: &mut Table, quantity: Quantity, folder: &Path, budget: &Budget) -> Result<Option<Named>> {
    let key = quantity.name();
    let Some((name, of)) = table.text_or_table(key, "file")? else { return Ok(None) };
    let (mut grid_name, mut bounds, mut kelvins) = (None, None, None);
    if let Some(mut of) = of {
        grid_name = of.name("grid")?;
        bounds = of.two_places("bounds")?;
        let is_flat = bounds.is_some_and(|[min, max]| !min.cmplt(max).all());
        if is_flat {
            return Err(of.fault_of("bounds", "the second corner must be greater than the first on each axis"));
        }
        if quantity == Quantity::Temperature {
            kelvins = of.number("kelvins", Range::KELVINS)?;
        }
        of.done()?;
    }
    let path = folder.join(&name);
    let grid = read(&path, (quantity, grid_name.as_deref()), budget);
    let grid = grid.map_err(|fault| table.fault_of(key, format!("{name}: {fault}")))?;
    let grid = match bounds {
        Some(bounds) => grid.fitted(bounds.map(|corner| DVec3::from(corner.to_array().map(f64::from)))),
        None => grid,
    };
    Ok(Some(Named { grid, path, kelvins: kelvins.unwrap_or(1.0) }))
}

/// Reads a grid of such numbers of a file, by its name or else by the one that they have by convention.
fn read(path: &Path, (quantity, name): (Quantity, Option<&str>), budget: &Budget) -> Unplaced<Grid> {
    let bytes = file::read(path, file::MOST_MESH)?;
    let title = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let grid = if nvdb::is(&bytes) {
        nvdb::grid(&bytes, (name, quantity.name()), &title, budget)?
    } else if vol::is(&bytes) {
        vol::grid(&bytes, &title, budget)?
    } else if bytes.starts_with(b" BDV") {
        return Err(
            "this is OpenVDB's own format, which is not read; convert it to NanoVDB (nanovdb_convert)".to_owned()
        );
    } else {
        return Err("this is neither NanoVDB (.nvdb) nor a grid volume of Mitsuba (.vol)".to_owned());
    };
    grid.check(quantity)?;
    Ok(grid)
}
