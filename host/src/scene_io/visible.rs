//! Who sees an object, as scene files say it.

use super::table::Table;
use crate::error::Result;
use crate::scene::{Matte, Visibility};

/// The keys `visible`, `catcher` and `holdout` of a table, if it has any of them.
///
/// # Errors
/// Other values, or a catcher that is a hole.
pub fn read(table: &mut Table) -> Result<Option<Visibility>> {
    let visible = table.table("visible")?.map(rays).transpose()?;
    let [catcher, holdout] = [table.flag("catcher")?, table.flag("holdout")?];
    let matte = match (catcher.unwrap_or(false), holdout.unwrap_or(false)) {
        (true, true) => {
            return Err(table.fault_of("catcher", "a hole catches no shadow; remove holdout or catcher"));
        }
        (true, false) => Matte::Catcher,
        (false, true) => Matte::Holdout,
        (false, false) => Matte::Shown,
    };
    let is_said = visible.is_some() || catcher.is_some() || holdout.is_some();
    Ok(is_said.then(|| Visibility { matte, ..visible.unwrap_or_default() }))
}

fn rays(mut table: Table) -> Result<Visibility> {
    table.rename("visible");
    let visibility = Visibility {
        camera: table.flag("camera")?.unwrap_or(true),
        shadow: table.flag("shadow")?.unwrap_or(true),
        reflection: table.flag("reflection")?.unwrap_or(true),
        matte: Matte::Shown,
    };
    table.done()?;
    Ok(visibility)
}
