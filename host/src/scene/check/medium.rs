//! What is between surfaces.

use super::Owner;
use crate::scene::{Grid, Material, Medium, Quantity, Range, Unplaced, Volume};

/// Refuses numbers that are out of range.
pub fn medium(owner: &Owner, of: &Medium) -> Unplaced<()> {
    owner.colour("scattering", of.scattering, Range::AMOUNT)?;
    owner.colour("absorption", of.absorption, Range::AMOUNT)?;
    owner.colour("emission", of.emission, Range::AMOUNT)?;
    owner.number("anisotropy", of.anisotropy, Range::ANISOTROPY)?;
    of.check_emission().map_err(|fault| format!("{}: {fault}", owner.0))
}

/// Likewise, and a surface that is not there but shines.
pub fn volume(owner: &Owner, material: &Material, of: &Volume) -> Unplaced<()> {
    medium(owner, &of.medium)?;
    if let Some(grid) = &of.density {
        grid.check(Quantity::Density).map_err(|fault| of_grid(owner, grid, &fault))?;
    }
    if let Some(temperature) = &of.temperature {
        owner.number("kelvins of temperature", temperature.kelvins, Range::KELVINS)?;
        temperature.check().map_err(|fault| of_grid(owner, &temperature.grid, &fault))?;
    }
    if !of.interface && material.emission != glam::Vec3::ZERO {
        return owner
            .refuse("shines without a surface; set interface to true, or let its medium shine (volume emission)");
    }
    Ok(())
}

/// A fault of a grid that it takes.
fn of_grid(owner: &Owner, grid: &Grid, fault: &str) -> String {
    format!("{}, {:?}: {fault}", owner.0, grid.name)
}
