//! What lies on a material by microfacets, and what else its base does with light.

use super::Owner;
use crate::scene::{Physical, Range, Unplaced};

/// Refuses numbers that are out of range.
pub(super) fn finish(owner: &Owner, of: &Physical) -> Unplaced<()> {
    if let Some(coat) = of.coat {
        owner.number("coat weight", coat.weight, Range::SHARE)?;
        owner.number("coat roughness", coat.roughness, Range::SHARE)?;
    }
    if let Some(sheen) = of.sheen {
        owner.colour("sheen color", sheen.colour, Range::SHARE)?;
        owner.number("sheen roughness", sheen.roughness, Range::SHARE)?;
    }
    if let Some(transmission) = of.diffuse_transmission {
        owner.number("diffuse_transmission weight", transmission.weight, Range::SHARE)?;
        owner.colour("diffuse_transmission color", transmission.colour, Range::SHARE)?;
    }
    if let Some(film) = of.film {
        owner.number("film weight", film.weight, Range::SHARE)?;
        owner.number("film ior", film.ior, Range::IOR)?;
        film.thickness.into_iter().try_for_each(|at| owner.number("film thickness", at, Range::THICKNESS))?;
    }
    if let Some(hair) = of.hair {
        owner.number("hair roughness", hair.roughness, Range::SHARE)?;
        owner.number("hair radial_roughness", hair.radial_roughness, Range::SHARE)?;
        owner.number("hair tilt", hair.tilt, Range::LEAN)?;
    }
    of.abbe.map_or(Ok(()), |abbe| owner.number("abbe", abbe, Range::ABBE))
}
