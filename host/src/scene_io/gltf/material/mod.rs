//! Materials by microfacets, and the extensions of them that are drawn.

mod passing;
mod reflecting;

use glam::Vec3;

use super::super::physical;
use super::notes::Notes;
use super::picture::Pictures;
use super::shading::{Extensions, Gloss, Info, Material, Metal};
use crate::scene::{Alpha, Map, Maps, Range, Unplaced};
use crate::scene_io::material::Fields;

/// The material of what names none: that of an empty one in the file.
pub fn plain() -> Fields {
    let physical =
        physical::Fields { base: Some(Vec3::ONE), metallic: Some(1.0), roughness: Some(1.0), ..Default::default() };
    Fields { physical, ..Fields::default() }
}

/// Reads the material of a number.
///
/// # Errors
/// Those of [`Pictures::map`], and numbers that are out of single precision.
pub fn read(of: &Material, number: usize, pictures: &mut Pictures, notes: &mut Notes) -> Unplaced<Fields> {
    let owner = format!("materials[{number}]");
    let mut reader = Reader { owner, pictures, notes, fields: plain() };
    let none = Extensions::default();
    let extensions = of.extensions.as_deref().unwrap_or(&none);
    let default = Metal::default();
    match &extensions.gloss {
        Some(gloss) => reader.gloss(gloss, of)?,
        None => reader.metal(of.pbr_metallic_roughness.as_deref().unwrap_or(&default), of)?,
    }
    reader.fields.two_sided = Some(of.double_sided);
    (reader.fields.maps.normal, reader.fields.maps.normal_scale) =
        reader.normals(of.normal_texture.as_deref(), "normalTexture")?;
    reader.emission(of, extensions)?;
    // The others are extensions of what this one takes the place of.
    if extensions.gloss.is_none() {
        reader.passing(extensions)?;
        reader.reflecting(extensions)?;
        extensions.ior.as_ref().map_or(Ok(()), |of| reader.ior(of))?;
    }
    if extensions.unlit.is_some() {
        reader.unlit(of.double_sided);
    }
    Ok(reader.fields)
}

/// A material that is being read.
struct Reader<'r, 'f, 'p> {
    /// Its JSON path.
    owner: String,
    pictures: &'r mut Pictures<'f>,
    notes: &'r mut Notes<'p>,
    fields: Fields,
}

impl Reader<'_, '_, '_> {
    fn metal(&mut self, metal: &Metal, of: &Material) -> Unplaced<()> {
        let [red, green, blue, opacity] = metal.base_color_factor.unwrap_or([1.0; 4]);
        let here = "pbrMetallicRoughness";
        let key = |key: &str| format!("{here}.{key}");
        self.fields.physical.base = Some(self.colour([red, green, blue], &key("baseColorFactor"))?);
        self.fields.opacity = Some(self.share(opacity, &key("baseColorFactor"))?);
        self.fields.physical.metallic = Some(self.share(metal.metallic_factor.unwrap_or(1.0), &key("metallicFactor"))?);
        self.fields.physical.roughness =
            Some(self.share(metal.roughness_factor.unwrap_or(1.0), &key("roughnessFactor"))?);
        self.fields.alpha = Some(self.alpha(of)?);
        self.fields.maps.base = self.map(metal.base_color_texture.as_ref(), &key("baseColorTexture"))?;
        let rough = metal.metallic_roughness_texture.as_ref();
        self.fields.maps.metallic_roughness = self.map(rough, &key("metallicRoughnessTexture"))?;
        Ok(())
    }

    /// KHR_materials_pbrSpecularGlossiness: no metal, whose reflection at normal incidence is the specular colour, and as rough as it
    /// is not glossy. Metals are black there, with a bright specular colour.
    fn gloss(&mut self, gloss: &Gloss, of: &Material) -> Unplaced<()> {
        /// The reflection at normal incidence that a tint is multiplied with, for the index of refraction 1.5.
        const REFLECTANCE: f32 = 0.04;
        let key = |key: &str| format!("extensions.KHR_materials_pbrSpecularGlossiness.{key}");
        let [red, green, blue, opacity] = gloss.diffuse_factor.unwrap_or([1.0; 4]);
        self.fields.physical.base = Some(self.colour([red, green, blue], &key("diffuseFactor"))?);
        self.fields.opacity = Some(self.share(opacity, &key("diffuseFactor"))?);
        self.fields.alpha = Some(self.alpha(of)?);
        self.fields.maps.base = self.map(gloss.diffuse_texture.as_ref(), &key("diffuseTexture"))?;
        self.fields.physical.metallic = Some(0.0);
        let specular = self.colour(gloss.specular_factor.unwrap_or([1.0; 3]), &key("specularFactor"))?;
        self.fields.physical.specular_tint = Some(specular / REFLECTANCE);
        let glossiness = self.share(gloss.glossiness_factor.unwrap_or(1.0), &key("glossinessFactor"))?;
        let texture = self.map(gloss.specular_glossiness_texture.as_ref(), &key("specularGlossinessTexture"))?;
        self.fields.physical.roughness = Some(if texture.is_some() { 1.0 } else { 1.0 - glossiness });
        if let Some(map) = &texture {
            self.fields.maps.metallic_roughness = Some(self.pictures.rough(map, glossiness)?);
        }
        self.fields.maps.specular_tint = texture;
        Ok(())
    }

    fn alpha(&mut self, of: &Material) -> Unplaced<Alpha> {
        let cutoff = of.alpha_cutoff.unwrap_or(0.5);
        match of.alpha_mode.as_deref() {
            Some("MASK") if cutoff > 1.0 => {
                // Nothing is as opaque.
                self.fields.opacity = Some(0.0);
                Ok(Alpha::Mask(1.0))
            }
            Some("MASK") => Ok(Alpha::Mask(self.share(cutoff, "alphaCutoff")?)),
            Some("BLEND") => Ok(Alpha::Blend),
            None | Some("OPAQUE") => Ok(Alpha::Opaque),
            Some(other) => {
                let text = format!(
                    "{}.alphaMode: {other:?} is none of OPAQUE, MASK and BLEND; OPAQUE takes its place",
                    self.owner
                );
                self.notes.changed("alphaMode", &text);
                Ok(Alpha::Opaque)
            }
        }
    }

    fn emission(&mut self, of: &Material, extensions: &Extensions) -> Unplaced<()> {
        let strength = extensions.strength.as_ref().and_then(|of| of.emissive_strength).unwrap_or(1.0);
        let factor = of.emissive_factor.unwrap_or([0.0; 3]);
        let [red, green, blue] = factor.map(|share| self.number(share * strength, "emissiveFactor", Range::AMOUNT));
        let emission = Vec3::new(red?, green?, blue?);
        // A picture of light that is switched off need not be decoded.
        if emission != Vec3::ZERO {
            self.fields.emission = Some(emission);
            self.fields.maps.emission = self.map(of.emissive_texture.as_deref(), "emissiveTexture")?;
        }
        Ok(())
    }

    /// What has its own colour in any light sends it out, and reflects nothing.
    fn unlit(&mut self, is_two_sided: bool) {
        self.notes
            .changed("unlit", "materials without lighting (KHR_materials_unlit) are drawn as light that they send out");
        let Fields { physical: metal, opacity, alpha, maps, .. } = std::mem::take(&mut self.fields);
        let physical = physical::Fields {
            base: Some(Vec3::ZERO),
            metallic: Some(0.0),
            roughness: Some(1.0),
            specular_weight: Some(0.0),
            ..Default::default()
        };
        // The base's picture stays for its opacity.
        let maps = Maps { emission: maps.base.clone(), base: maps.base, normal_scale: 1.0, ..Maps::default() };
        self.fields = Fields {
            physical,
            emission: metal.base,
            emission_is_coloured: Some(true),
            two_sided: Some(is_two_sided),
            opacity,
            alpha,
            maps,
            ..Fields::default()
        };
    }

    /// A map of normals, and what their slopes are multiplied with.
    fn normals(&mut self, info: Option<&Info>, key: &str) -> Unplaced<(Option<Map>, f32)> {
        let scale = match info.and_then(|info| info.scale) {
            Some(scale) => self.number(scale, &format!("{key}.scale"), Range::ANY)?,
            None => 1.0,
        };
        Ok((self.map(info, key)?, scale))
    }

    fn map(&mut self, info: Option<&Info>, key: &str) -> Unplaced<Option<Map>> {
        self.pictures.map(info, &format!("{}.{key}", self.owner), self.notes)
    }

    fn share(&mut self, share: f64, key: &str) -> Unplaced<f32> {
        self.clamped(share, key, Range::SHARE, (0.0, 1.0))
    }

    fn colour(&mut self, colour: [f64; 3], key: &str) -> Unplaced<Vec3> {
        let [red, green, blue] = colour.map(|share| self.share(share, key));
        Ok(Vec3::new(red?, green?, blue?))
    }

    /// The nearest number of the range, with a warning where it is another.
    fn clamped(&mut self, number: f64, key: &str, range: Range, (least, most): (f64, f64)) -> Unplaced<f32> {
        let nearest = number.clamp(least, most);
        if nearest != number {
            let text = format!("{}.{key}: {number} must be {}; {nearest} takes its place", self.owner, range.says());
            self.notes.changed(key, &text);
        }
        self.number(nearest, key, range)
    }

    fn number(&self, number: f64, key: &str, range: Range) -> Unplaced<f32> {
        let single = number as f32;
        if range.holds(single) {
            return Ok(single);
        }
        Err(format!("{}.{key}: {number} must be {}; repair it", self.owner, range.says()))
    }
}
