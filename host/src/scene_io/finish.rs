//! What lies on a material by microfacets, and what else its base does with light, as files describe it, in part.

use glam::Vec3;

use super::hair;
use super::table::Table;
use crate::choice::Named;
use crate::error::Result;
use crate::scene::{Coat, DiffuseTransmission, FinishMaps, Physical, Range, Sheen, ThinFilm};
use crate::spectrum::Glass;

/// What a file says of it; the rest is left to whoever else describes the material. A table takes the place of another one as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fields {
    pub coat: Option<CoatFields>,
    pub sheen: Option<SheenFields>,
    pub diffuse_transmission: Option<DiffuseFields>,
    pub film: Option<FilmFields>,
    pub abbe: Option<f32>,
    pub glass: Option<Glass>,
    pub hair: Option<hair::Fields>,
}

/// What is said of a [`Coat`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoatFields {
    pub weight: Option<f32>,
    pub roughness: Option<f32>,
}

/// What is said of a [`Sheen`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SheenFields {
    pub colour: Option<Vec3>,
    pub roughness: Option<f32>,
}

/// What is said of a [`DiffuseTransmission`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DiffuseFields {
    pub weight: Option<f32>,
    /// That of the base where nobody says it.
    pub colour: Option<Vec3>,
}

/// What is said of a [`ThinFilm`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FilmFields {
    pub weight: Option<f32>,
    pub ior: Option<f32>,
    /// The least and the greatest, in nanometres.
    pub thickness: Option<[f32; 2]>,
}

/// The roughness of fibres that nobody says.
const SHEEN_ROUGHNESS: f32 = 0.3;
/// The index of refraction of a film that nobody says (KHR_materials_iridescence).
pub const FILM_IOR: f32 = 1.3;
/// The least and the greatest thickness that nobody says, in nanometres (KHR_materials_iridescence).
pub const FILM_THICKNESS: [f32; 2] = [100.0, 400.0];

impl Fields {
    /// Takes the keys of a `[[material]]` table.
    ///
    /// # Errors
    /// A number out of range, or an unknown key of a table within.
    pub fn read(table: &mut Table) -> Result<Fields> {
        Ok(Fields {
            coat: table.table("coat")?.map(coat).transpose()?,
            sheen: table.table("sheen")?.map(sheen).transpose()?,
            diffuse_transmission: table.table("diffuse_transmission")?.map(diffuse_transmission).transpose()?,
            film: table.table("film")?.map(film).transpose()?,
            abbe: table.number("abbe", Range::ABBE)?,
            glass: table.choice("glass")?,
            hair: hair::Fields::read(table)?,
        })
    }

    /// These fields, and `under` where they say nothing.
    pub fn over(self, under: Fields) -> Fields {
        // Hair is in the place of all of it.
        let under = if self.hair.is_some() { Fields { hair: under.hair, ..Fields::default() } } else { under };
        Fields {
            coat: self.coat.or(under.coat),
            sheen: self.sheen.or(under.sheen),
            diffuse_transmission: self.diffuse_transmission.or(under.diffuse_transmission),
            film: self.film.or(under.film),
            abbe: self.abbe.or(under.abbe),
            glass: self.glass.or(under.glass),
            hair: self.hair.or(under.hair),
        }
    }

    /// A picture whose factor nobody says is taken as it is, and one of what nobody describes makes it.
    pub fn take_pictures(&mut self, maps: &FinishMaps) {
        if maps.coat.is_some() || maps.coat_normal.is_some() {
            self.coat.get_or_insert_default();
        }
        if maps.coat_roughness.is_some() {
            self.coat.get_or_insert_default().roughness.get_or_insert(1.0);
        }
        if maps.sheen_colour.is_some() {
            self.sheen.get_or_insert_default();
        }
        if maps.sheen_roughness.is_some() {
            self.sheen.get_or_insert_default().roughness.get_or_insert(1.0);
        }
        if maps.diffuse_transmission.is_some() {
            self.diffuse_transmission.get_or_insert_default();
        }
        if maps.diffuse_transmission_colour.is_some() {
            self.diffuse_transmission.get_or_insert_default().colour.get_or_insert(Vec3::ONE);
        }
        if maps.film.is_some() {
            self.film.get_or_insert_default();
        }
        if maps.film_thickness.is_some() {
            self.film.get_or_insert_default().thickness.get_or_insert(FILM_THICKNESS);
        }
    }

    /// Is light to be scattered to the far side in the colour of the base?
    pub fn takes_base(&self) -> bool {
        self.diffuse_transmission.is_some_and(|of| of.colour.is_none())
    }

    /// Gives a material all of it.
    pub fn give(self, to: &mut Physical) {
        to.coat = self.coat.map(|of| Coat { weight: of.weight.unwrap_or(1.0), roughness: of.roughness.unwrap_or(0.0) });
        to.sheen = self.sheen.map(|of| Sheen {
            colour: of.colour.unwrap_or(Vec3::ONE),
            roughness: of.roughness.unwrap_or(SHEEN_ROUGHNESS),
        });
        to.diffuse_transmission = self
            .diffuse_transmission
            .map(|of| DiffuseTransmission { weight: of.weight.unwrap_or(1.0), colour: of.colour.unwrap_or(to.base) });
        to.film = self.film.map(|of| ThinFilm {
            weight: of.weight.unwrap_or(1.0),
            ior: of.ior.unwrap_or(FILM_IOR),
            thickness: of.thickness.unwrap_or([FILM_THICKNESS[1]; 2]),
        });
        (to.abbe, to.glass) = (self.abbe, self.glass);
        if let Some(hair) = self.hair {
            hair.give(to);
        }
    }
}

fn coat(mut table: Table) -> Result<CoatFields> {
    let weight = table.number("weight", Range::SHARE)?;
    let fields = CoatFields { weight, roughness: table.number("roughness", Range::SHARE)? };
    table.done()?;
    Ok(fields)
}

fn sheen(mut table: Table) -> Result<SheenFields> {
    let colour = table.triple("color", Range::SHARE)?;
    let fields = SheenFields { colour, roughness: table.number("roughness", Range::SHARE)? };
    table.done()?;
    Ok(fields)
}

fn diffuse_transmission(mut table: Table) -> Result<DiffuseFields> {
    let weight = table.number("weight", Range::SHARE)?;
    let fields = DiffuseFields { weight, colour: table.triple("color", Range::SHARE)? };
    table.done()?;
    Ok(fields)
}

fn film(mut table: Table) -> Result<FilmFields> {
    let fields = FilmFields {
        weight: table.number("weight", Range::SHARE)?,
        ior: table.number("ior", Range::IOR)?,
        thickness: table.two("thickness", Range::THICKNESS)?.map(|ends| ends.to_array()),
    };
    table.done()?;
    Ok(fields)
}

/// The keys of a material's table that say all of it again.
pub fn described(of: &Physical) -> Vec<(&'static str, String)> {
    let colour = |colour: Vec3| format!("{:?}", colour.to_array());
    let mut keys = Vec::new();
    if let Some(Coat { weight, roughness }) = of.coat {
        keys.push(("coat", format!("{{ weight = {weight:?}, roughness = {roughness:?} }}")));
    }
    if let Some(Sheen { colour: of, roughness }) = of.sheen {
        keys.push(("sheen", format!("{{ color = {}, roughness = {roughness:?} }}", colour(of))));
    }
    if let Some(DiffuseTransmission { weight, colour: of }) = of.diffuse_transmission {
        keys.push(("diffuse_transmission", format!("{{ weight = {weight:?}, color = {} }}", colour(of))));
    }
    if let Some(ThinFilm { weight, ior, thickness }) = of.film {
        let [least, greatest] = thickness;
        let thickness = if least == greatest { format!("{least:?}") } else { format!("{thickness:?}") };
        keys.push(("film", format!("{{ weight = {weight:?}, ior = {ior:?}, thickness = {thickness} }}")));
    }
    keys.extend(of.abbe.map(|abbe| ("abbe", format!("{abbe:?}"))));
    keys.extend(of.glass.map(|glass| ("glass", format!("{:?}", glass.name()))));
    keys.extend(of.hair.map(hair::described));
    keys
}
