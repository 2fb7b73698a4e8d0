//! Curves of a `[[mesh]]`: strands of control points in the scene file itself, or of a file.

mod hair;
mod inline;
mod keys;
mod listed;
mod text;

use std::path::Path;

pub use self::listed::Listed;
use super::budget::Budget;
use super::file;
use super::files::{self, Files};
use super::table::Table;
use crate::error::{Error, Result};
use crate::scene::Mesh;
use crate::scene::curves::{Curves, Strands};

/// Is it a file of strands by its ending?
pub fn is(path: &Path) -> bool {
    files::is(path, "hair") || files::is(path, "txt")
}

/// Reads a file of strands, Cem Yuksel's by its first bytes and else text. The radius is for points without one, and for those of a `.hair`
/// file instead of their own.
///
/// # Errors
/// A file that cannot be read, holds no strand, or more than the budget has room for. Strands that make no sense are left out with a warning.
pub fn load(path: &Path, radius: Option<f32>, budget: Budget) -> Result<Listed> {
    let bytes = file::read(path, file::MOST_MESH).map_err(|fault| Error::file(path, fault))?;
    parse(path, &bytes, radius, budget)
}

/// The strands in these bytes.
pub(super) fn parse(path: &Path, bytes: &[u8], radius: Option<f32>, budget: Budget) -> Result<Listed> {
    if hair::is(bytes) {
        return hair::parse(bytes, radius, budget).map_err(|fault| Error::file(path, fault));
    }
    if files::is(path, "hair") {
        return Err(Error::file(path, "it does not begin with \"HAIR\", as a .hair file does; is it one?"));
    }
    text::parse(path, bytes, radius, budget)
}

/// The mesh of the `strands` of a table.
///
/// # Errors
/// A number out of range, a strand that can't be drawn, or more triangles than the budget has room for.
pub fn inline(table: &mut Table, files: &Files) -> Result<Mesh> {
    table.rename("curves");
    let (curves, radius) = keys::read(table, files)?;
    let strands = inline::read(table, &curves, radius)?;
    mesh(table, &curves, &strands, files.budget)
}

/// The mesh of a file that a table names, and whether its strands have colours.
///
/// # Errors
/// Those of [`load`] and [`inline`], but for strands that can't be drawn, which are left out with a warning if others can.
pub fn of_file(table: &mut Table, path: &Path, files: &mut Files) -> Result<(Mesh, bool)> {
    table.rename("a file of curves");
    let (curves, radius) = keys::read(table, files)?;
    let budget = files.budget;
    let (strands, warning) = files.strands(path, radius)?.sound(path, curves.basis)?;
    let mesh = mesh(table, &curves, &strands, budget)?;
    let has_colours = strands.has_colours();
    files.warnings.extend(warning);
    Ok((mesh, has_colours))
}

/// What there is room for.
fn mesh(table: &Table, curves: &Curves, strands: &Strands, budget: Budget) -> Result<Mesh> {
    let fits = curves.count(strands, |triangles, vertices| budget.check(triangles, vertices));
    fits.map_err(|fault| table.fault(format!("{fault} strands, fewer sides or a greater tolerance")))?;
    Ok(curves.mesh(strands))
}
