//! A material by microfacets as files describe it, in part.

use glam::Vec3;

use super::finish;
use super::table::Table;
use crate::error::Result;
use crate::scene::{Absorption, Conductor, Physical, Range, Wall};
use crate::spectrum::Metal;

/// What a file says of a material by microfacets; the rest is left to whoever else describes it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fields {
    pub base: Option<Vec3>,
    pub metallic: Option<f32>,
    pub roughness: Option<f32>,
    pub anisotropy: Option<f32>,
    pub anisotropy_rotation: Option<f32>,
    pub specular_weight: Option<f32>,
    pub specular_tint: Option<Vec3>,
    pub wall: Option<Wall>,
    pub absorption: Option<Absorption>,
    pub conductor: Option<Conductor>,
    pub finish: finish::Fields,
}

impl Fields {
    /// Takes the keys of a `[[material]]` table.
    ///
    /// # Errors
    /// A number out of range, or an unknown key of a table within.
    pub fn read(table: &mut Table) -> Result<Fields> {
        Ok(Fields {
            base: table.triple("base_color", Range::SHARE)?,
            metallic: table.number("metallic", Range::SHARE)?,
            roughness: table.number("roughness", Range::SHARE)?,
            anisotropy: table.number("anisotropy", Range::SHARE)?,
            anisotropy_rotation: table.number("anisotropy_rotation", Range::ANY)?,
            specular_weight: table.number("specular_weight", Range::SHARE)?,
            specular_tint: table.triple("specular_tint", Range::AMOUNT)?,
            wall: table.flag_or_choice("thin", [Wall::Body, Wall::Pane])?,
            absorption: table.table("absorption")?.map(absorption).transpose()?,
            conductor: metal(table)?,
            finish: finish::Fields::read(table)?,
        })
    }

    /// These fields, and `under` where they say nothing.
    pub fn over(self, under: Fields) -> Fields {
        let is_hair = self.finish.hair.is_some();
        let under =
            if is_hair { Fields { base: under.base, finish: under.finish, ..Fields::default() } } else { under };
        Fields {
            base: self.base.or(under.base),
            metallic: self.metallic.or(under.metallic),
            roughness: self.roughness.or(under.roughness),
            anisotropy: self.anisotropy.or(under.anisotropy),
            anisotropy_rotation: self.anisotropy_rotation.or(under.anisotropy_rotation),
            specular_weight: self.specular_weight.or(under.specular_weight),
            specular_tint: self.specular_tint.or(under.specular_tint),
            wall: self.wall.or(under.wall),
            absorption: self.absorption.or(under.absorption),
            conductor: self.conductor.or(under.conductor),
            finish: self.finish.over(under.finish),
        }
    }

    /// The material, if any of the fields is said; `diffuse`, `transmission` and `ior` are those of the thesis' model.
    pub fn finish(self, diffuse: Option<Vec3>, transmission: Option<Vec3>, ior: f32) -> Option<Physical> {
        if self == Fields::default() {
            return None;
        }
        let plain = Physical::default();
        let mut physical = Physical {
            base: self.base.or(self.finish.hair.and_then(|hair| hair.colour())).or(diffuse).unwrap_or(plain.base),
            metallic: self.metallic.unwrap_or(plain.metallic),
            roughness: self.roughness.unwrap_or(if self.finish.glass.is_some() { 0.0 } else { plain.roughness }),
            anisotropy: self.anisotropy.unwrap_or(plain.anisotropy),
            anisotropy_rotation: self.anisotropy_rotation.unwrap_or(plain.anisotropy_rotation),
            specular_weight: self.specular_weight.unwrap_or(plain.specular_weight),
            specular_tint: self.specular_tint.unwrap_or(plain.specular_tint),
            // Who names a glass means it.
            transmission: transmission.unwrap_or(if self.finish.glass.is_some() {
                Vec3::ONE
            } else {
                plain.transmission
            }),
            ior,
            wall: self.wall.unwrap_or(plain.wall),
            absorption: self.absorption,
            conductor: self.conductor,
            ..plain
        };
        self.finish.give(&mut physical);
        Some(physical)
    }
}

fn absorption(mut table: Table) -> Result<Absorption> {
    let colour = table.triple("color", Range::SHARE)?;
    let distance = table.number("distance", Range::LENGTH)?;
    let absorption = Absorption { colour: table.need("color", colour)?, distance: table.need("distance", distance)? };
    table.done()?;
    Ok(absorption)
}

/// A `metal` by its name, or a `conductor` by its index.
fn metal(table: &mut Table) -> Result<Option<Conductor>> {
    let Some(metal) = table.choice::<Metal>("metal")? else {
        return table.table("conductor")?.map(conductor).transpose();
    };
    if table.has("conductor") {
        return Err(table.fault_of("conductor", "a metal has an index of its own; remove metal or conductor"));
    }
    Ok(Some(metal.conductor()))
}

fn conductor(mut table: Table) -> Result<Conductor> {
    let eta = table.triple("eta", Range::INDEX)?;
    let k = table.triple("k", Range::INDEX)?;
    let conductor = Conductor { eta: table.need("eta", eta)?, k: table.need("k", k)?, metal: None };
    table.done()?;
    Ok(conductor)
}
