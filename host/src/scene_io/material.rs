//! A material as files describe it, in part, and as the tracer needs it, in full.

use glam::Vec3;

use super::bump::{self, Bump};
use super::map::{self, Images};
use super::table::Table;
use super::{illuminant, medium, physical, visible};
use crate::error::Result;
use crate::scene::Range;
use crate::scene::{Alpha, Checker, Hair, Maps, Material, Physical, Visibility, Volume};
use crate::spectrum::{Glass, Illuminant};

/// What a file says of a material; the rest is left to whoever else describes it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fields {
    pub ambient: Option<Vec3>,
    pub diffuse: Option<Vec3>,
    pub specular: Option<Vec3>,
    pub shininess: Option<f32>,
    pub reflection: Option<Vec3>,
    pub transmission: Option<Vec3>,
    pub ior: Option<f32>,
    pub checker: Option<Checker>,
    pub emission: Option<Vec3>,
    pub illuminant: Option<Illuminant>,
    pub two_sided: Option<bool>,
    pub emission_is_coloured: Option<bool>,
    pub group: Option<String>,
    pub lit_by: Option<Vec<String>>,
    pub physical: physical::Fields,
    pub volume: Option<Volume>,
    pub maps: Maps,
    pub bump: Option<Bump>,
    pub visibility: Option<Visibility>,
    pub alpha: Option<Alpha>,
    pub opacity: Option<f32>,
}

/// The name of the material of a surface that names none.
pub const DEFAULT: &str = "default";
/// A grey that shows form under any light.
const GREY: Vec3 = Vec3::splat(0.7);
/// A highlight some twenty degrees wide.
const SHININESS: f32 = 32.0;
/// Window glass.
const GLASS: f32 = 1.5;

impl Fields {
    /// Reads a `[[material]]` table: its name and what it says.
    ///
    /// # Errors
    /// A missing name, a number out of range, or an unknown key.
    pub fn read(table: &mut Table, images: &mut Images) -> Result<(String, Fields)> {
        let name = table.name("name")?;
        let name = table.need("name", name)?;
        let illuminant = illuminant::read(table)?;
        let emission = emission(table, illuminant)?;
        if table.has("glass") && (table.has("ior") || table.has("abbe")) {
            return Err(table.fault_of("glass", "a glass has an index of its own; remove glass, or ior and abbe"));
        }
        let fields = Fields {
            ambient: table.triple("ambient", Range::SHARE)?,
            diffuse: table.triple("diffuse", Range::SHARE)?,
            specular: table.triple("specular", Range::SHARE)?,
            shininess: table.number("shininess", Range::AMOUNT)?,
            reflection: table.triple("reflection", Range::SHARE)?,
            transmission: table.triple("transmission", Range::SHARE)?,
            ior: table.number("ior", Range::IOR)?,
            checker: table.table("checker")?.map(checker).transpose()?,
            illuminant,
            emission,
            two_sided: table.flag("two_sided")?,
            emission_is_coloured: None,
            group: table.name("group")?,
            lit_by: table.names("lit_by")?,
            physical: physical::Fields::read(table)?,
            volume: table.table("volume")?.map(|table| medium::volume(table, images)).transpose()?,
            maps: map::maps(table, images)?,
            bump: bump::read(table, images)?,
            visibility: visible::read(table)?,
            alpha: alpha(table)?,
            opacity: table.number("opacity", Range::SHARE)?,
        };
        Ok((name, fields))
    }

    /// These fields, and `under` where they say nothing.
    pub fn over(self, mut under: Fields) -> Fields {
        // Normals come of either.
        if self.maps.normal.is_some() || self.bump.is_some() {
            (under.maps.normal, under.bump) = (None, None);
        }
        // As indices do.
        if self.ior.is_some() || self.physical.finish.abbe.is_some() {
            under.physical.finish.glass = None;
        }
        if self.physical.finish.glass.is_some() {
            (under.ior, under.physical.finish.abbe) = (None, None);
        }
        Fields {
            ambient: self.ambient.or(under.ambient),
            diffuse: self.diffuse.or(under.diffuse),
            specular: self.specular.or(under.specular),
            shininess: self.shininess.or(under.shininess),
            reflection: self.reflection.or(under.reflection),
            transmission: self.transmission.or(under.transmission),
            ior: self.ior.or(under.ior),
            checker: self.checker.or(under.checker),
            emission: self.emission.or(under.emission),
            illuminant: self.illuminant.or(under.illuminant),
            two_sided: self.two_sided.or(under.two_sided),
            emission_is_coloured: self.emission_is_coloured.or(under.emission_is_coloured),
            group: self.group.or(under.group),
            lit_by: self.lit_by.or(under.lit_by),
            physical: self.physical.over(under.physical),
            volume: self.volume.or(under.volume),
            maps: self.maps.over(under.maps),
            bump: self.bump.or(under.bump),
            visibility: self.visibility.or(under.visibility),
            alpha: self.alpha.or(under.alpha),
            opacity: self.opacity.or(under.opacity),
        }
    }

    /// Does it have textures?
    pub fn has_maps(&self) -> bool {
        self.bump.is_some() || self.maps.all().next().is_some()
    }

    /// Do its surfaces need tangents, as [`Material::has_axes`] has it?
    pub fn has_axes(&self) -> bool {
        let has_normals = self.bump.is_some() || self.maps.normal.is_some() || self.maps.finish.coat_normal.is_some();
        let is_brushed = self.physical.anisotropy.is_some_and(|anisotropy| anisotropy > 0.0);
        has_normals || is_brushed || self.physical.finish.hair.is_some()
    }

    /// The whole material: grey and matt where nothing is said (glass black), ambient as diffuse. Of one by microfacets the thesis'
    /// model keeps what it can.
    pub fn finish(mut self, name: &str) -> Material {
        self.take_pictures();
        let ior = self.physical.finish.glass.map(Glass::ior).or(self.ior);
        let ior = ior.unwrap_or(if self.physical.finish.hair.is_some() { Hair::IOR } else { GLASS });
        let physical = self.physical.finish(self.diffuse, self.transmission, ior);
        let plain = physical.map_or_else(|| self.plain(), |physical| approximated(&physical));
        // Who gives an opacity means it.
        let is_blended = self.opacity.is_some() || self.maps.opacity.is_some();
        let alpha = if is_blended { Alpha::Blend } else { Alpha::Opaque };
        Material {
            name: name.to_owned(),
            ambient: self.ambient,
            diffuse: self.diffuse.unwrap_or(plain.diffuse),
            specular: self.specular.unwrap_or(plain.specular),
            shininess: self.shininess.unwrap_or(plain.shininess),
            reflection: self.reflection.unwrap_or(plain.reflection),
            transmission: self.transmission.unwrap_or(plain.transmission),
            ior,
            checker: self.checker.map(|c| Checker { ambient: self.ambient.unwrap_or(c.ambient), ..c }),
            emission: self.emission.unwrap_or(plain.emission),
            illuminant: self.illuminant,
            two_sided: self.two_sided.unwrap_or(plain.two_sided),
            emission_is_coloured: self.emission_is_coloured.unwrap_or(plain.emission_is_coloured),
            group: self.group.unwrap_or_default(),
            lit_by: self.lit_by,
            physical,
            volume: self.volume,
            visibility: self.visibility.unwrap_or_default(),
            alpha: self.alpha.unwrap_or(alpha),
            opacity: self.opacity.unwrap_or(plain.opacity),
            maps: self.maps,
        }
    }

    /// A picture whose factor nobody says is taken as it is.
    fn take_pictures(&mut self) {
        let Fields { transmission, emission, physical, maps, .. } = self;
        physical.finish.take_pictures(&maps.finish);
        if physical.finish.takes_base() {
            maps.finish.diffuse_transmission_colour = maps.base.clone();
        }
        if maps.emission.is_some() {
            emission.get_or_insert(Vec3::ONE);
        }
        if maps.transmission.is_some() {
            transmission.get_or_insert(Vec3::ONE);
            // The thesis' model has no such picture.
            physical.wall.get_or_insert_default();
        }
        if maps.specular_tint.is_some() {
            physical.specular_tint.get_or_insert(Vec3::ONE);
        }
        let numbers = [
            (&maps.metallic_roughness, &mut physical.metallic),
            (&maps.metallic_roughness, &mut physical.roughness),
            (&maps.specular_weight, &mut physical.specular_weight),
            (&maps.anisotropy, &mut physical.anisotropy),
        ];
        for (map, number) in numbers {
            if map.is_some() {
                number.get_or_insert(1.0);
            }
        }
    }

    fn plain(&self) -> Material {
        let is_glass = self.transmission.is_some_and(|t| t != Vec3::ZERO);
        Material { diffuse: if is_glass { Vec3::ZERO } else { GREY }, ..Material::default() }
    }
}

impl Material {
    /// Its answer to the scene's ambient light, linear RGB.
    pub fn ambient(&self) -> Vec3 {
        self.ambient.unwrap_or(self.diffuse)
    }
}

impl Default for Material {
    /// Grey and matt, without a name: what a scene file's material has that says nothing.
    fn default() -> Self {
        Material {
            name: String::new(),
            ambient: None,
            diffuse: GREY,
            specular: Vec3::ZERO,
            shininess: SHININESS,
            reflection: Vec3::ZERO,
            transmission: Vec3::ZERO,
            ior: GLASS,
            checker: None,
            emission: Vec3::ZERO,
            illuminant: None,
            two_sided: false,
            emission_is_coloured: false,
            group: String::new(),
            lit_by: None,
            physical: None,
            volume: None,
            maps: Maps::default(),
            visibility: Visibility::default(),
            alpha: Alpha::Opaque,
            opacity: 1.0,
        }
    }
}

/// The thesis' model of a material by microfacets: metal mirrors the more the smoother it is, and the rest is matt.
fn approximated(physical: &Physical) -> Material {
    let Physical { base, metallic, roughness, transmission, ior, conductor, .. } = *physical;
    let (base, metallic) = match conductor {
        Some(conductor) => (conductor.reflectance(), 1.0),
        None => (base, metallic),
    };
    let mirror = base * (metallic * (1.0 - roughness));
    let opaque = base * (1.0 - metallic) * (Vec3::ONE - transmission);
    Material {
        diffuse: opaque + base * metallic - mirror,
        specular: physical.reflectance() * (1.0 - roughness),
        reflection: mirror,
        transmission: if conductor.is_some() { Vec3::ZERO } else { base * transmission * (1.0 - metallic) },
        ior,
        ..Material::default()
    }
}

/// `alpha`: a word, or the least opacity that counts.
fn alpha(table: &mut Table) -> Result<Option<Alpha>> {
    let words = [("opaque", Alpha::Opaque), ("mask", Alpha::Mask(0.5)), ("blend", Alpha::Blend)];
    let alpha = table.word("alpha", &words)?;
    let least = table.number("alpha_cutoff", Range::SHARE)?;
    match (alpha, least) {
        (Some(Alpha::Opaque | Alpha::Blend), Some(_)) => {
            Err(table.fault_of("alpha_cutoff", "alpha_cutoff is of a mask; set alpha to \"mask\" or remove it"))
        }
        (_, Some(least)) => Ok(Some(Alpha::Mask(least))),
        (alpha, None) => Ok(alpha),
    }
}

/// What a `[[material]]` sends out: a colour, or of light of a spectrum how bright it is, which is 1 where nobody says it.
fn emission(table: &mut Table, illuminant: Option<Illuminant>) -> Result<Option<Vec3>> {
    let Some(illuminant) = illuminant else { return table.triple("emission", Range::AMOUNT) };
    let colour = illuminant.colour();
    if table.is_number("emission") {
        return Ok(table.number("emission", Range::AMOUNT)?.map(|luminance| colour * luminance));
    }
    Ok(Some(table.triple("emission", Range::AMOUNT)?.unwrap_or(colour)))
}

fn checker(mut table: Table) -> Result<Checker> {
    let colour = table.triple("color", Range::SHARE)?;
    let size = table.number("size", Range::LENGTH)?;
    let colour = table.need("color", colour)?;
    let checker = Checker { colour, ambient: colour, size: table.need("size", size)? };
    table.done()?;
    Ok(checker)
}
