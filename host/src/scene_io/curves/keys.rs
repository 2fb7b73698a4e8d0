//! What a table says of its curves.

use crate::error::Result;
use crate::scene::Range;
use crate::scene::curves::{CurveKind, Curves};
use crate::scene_io::files::Files;
use crate::scene_io::table::Table;

/// Takes the keys that say how strands are drawn, and the radius of points without one.
///
/// # Errors
/// A number out of range, an unknown word, or a key of the other kind.
pub fn read(table: &mut Table, files: &Files) -> Result<(Curves, Option<f32>)> {
    let kind = table.choice("kind")?.unwrap_or_default();
    let misplaced: &[&str] = match kind {
        CurveKind::Round => &["up", "normals"],
        CurveKind::Ribbon => &["sides"],
    };
    if let Some(key) = misplaced.iter().find(|key| table.has(key)) {
        let fault = match kind {
            CurveKind::Round => format!("a tube faces all sides; remove {key:?} or set kind = \"ribbon\""),
            CurveKind::Ribbon => format!("a ribbon has no {key}; remove it or set kind = \"round\""),
        };
        return Err(table.fault_of(key, fault));
    }
    let up = table.triple("up", Range::ANY)?;
    if up.is_some_and(|up| up.as_dvec3().length_squared() == 0.0) {
        return Err(table.fault_of("up", "up is zero; say where the ribbon's front faces"));
    }
    let curves = Curves {
        basis: table.choice("basis")?.unwrap_or_default(),
        kind,
        tolerance: table.number("tolerance", Range::LENGTH)?,
        sides: table.whole("sides", *Curves::SIDES.start(), *Curves::SIDES.end())?,
        up,
        has_coordinates: files.is_covered,
        has_tangents: files.has_axes,
    };
    Ok((curves, table.number("radius", Range::LENGTH)?))
}
