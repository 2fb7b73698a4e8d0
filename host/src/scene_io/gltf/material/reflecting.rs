//! Extensions of materials by which they reflect: the strength and the shape of highlights, and what lies on a surface.

use glam::Vec3;

use super::super::shading::{Anisotropy, Clearcoat, Extensions, Iridescence, Sheen, Specular};
use super::Reader;
use crate::scene::{Range, Unplaced};
use crate::scene_io::finish::{CoatFields, FILM_IOR, FILM_THICKNESS, FilmFields, SheenFields};

/// The thickest film in nanometres.
const MOST_THICKNESS: f64 = 100_000.0;

impl Reader<'_, '_, '_> {
    /// All of them.
    pub(super) fn reflecting(&mut self, of: &Extensions) -> Unplaced<()> {
        of.specular.as_ref().map_or(Ok(()), |of| self.specular(of))?;
        of.anisotropy.as_ref().map_or(Ok(()), |of| self.anisotropy(of))?;
        of.clearcoat.as_deref().map_or(Ok(()), |of| self.clearcoat(of))?;
        of.sheen.as_deref().map_or(Ok(()), |of| self.sheen(of))?;
        of.iridescence.as_deref().map_or(Ok(()), |of| self.iridescence(of))
    }

    fn specular(&mut self, of: &Specular) -> Unplaced<()> {
        let key = |key: &str| format!("extensions.KHR_materials_specular.{key}");
        self.fields.physical.specular_weight =
            Some(self.share(of.specular_factor.unwrap_or(1.0), &key("specularFactor"))?);
        let tint = of.specular_color_factor.unwrap_or([1.0; 3]);
        let of_tint = key("specularColorFactor");
        let [red, green, blue] = tint.map(|number| self.number(number, &of_tint, Range::AMOUNT));
        self.fields.physical.specular_tint = Some(Vec3::new(red?, green?, blue?));
        if self.is_glass() && (tint != [1.0; 3] || of.specular_color_texture.is_some()) {
            let text = format!("{}.{of_tint}: bodies of glass reflect without a tint", self.owner);
            self.notes.changed("glass", &text);
        }
        self.fields.maps.specular_weight = self.map(of.specular_texture.as_ref(), &key("specularTexture"))?;
        self.fields.maps.specular_tint = self.map(of.specular_color_texture.as_ref(), &key("specularColorTexture"))?;
        Ok(())
    }

    fn anisotropy(&mut self, of: &Anisotropy) -> Unplaced<()> {
        let key = |key: &str| format!("extensions.KHR_materials_anisotropy.{key}");
        let strength = of.anisotropy_strength.unwrap_or(0.0);
        self.fields.physical.anisotropy = Some(self.share(strength, &key("anisotropyStrength"))?);
        let degrees = of.anisotropy_rotation.unwrap_or(0.0).to_degrees();
        self.fields.physical.anisotropy_rotation =
            Some(self.number(degrees, &key("anisotropyRotation"), Range::ANY)?);
        self.fields.maps.anisotropy = self.map(of.anisotropy_texture.as_ref(), &key("anisotropyTexture"))?;
        Ok(())
    }

    fn clearcoat(&mut self, of: &Clearcoat) -> Unplaced<()> {
        let key = |key: &str| format!("extensions.KHR_materials_clearcoat.{key}");
        let weight = self.share(of.clearcoat_factor.unwrap_or(0.0), &key("clearcoatFactor"))?;
        if weight == 0.0 {
            return Ok(());
        }
        let roughness = self.share(of.clearcoat_roughness_factor.unwrap_or(0.0), &key("clearcoatRoughnessFactor"))?;
        self.fields.physical.finish.coat = Some(CoatFields { weight: Some(weight), roughness: Some(roughness) });
        let coat = self.map(of.clearcoat_texture.as_ref(), &key("clearcoatTexture"))?;
        let rough = self.map(of.clearcoat_roughness_texture.as_ref(), &key("clearcoatRoughnessTexture"))?;
        let (normal, scale) = self.normals(of.clearcoat_normal_texture.as_ref(), &key("clearcoatNormalTexture"))?;
        let to = &mut self.fields.maps.finish;
        (to.coat, to.coat_roughness, to.coat_normal, to.coat_normal_scale) = (coat, rough, normal, scale);
        Ok(())
    }

    fn sheen(&mut self, of: &Sheen) -> Unplaced<()> {
        let key = |key: &str| format!("extensions.KHR_materials_sheen.{key}");
        let colour = self.colour(of.sheen_color_factor.unwrap_or([0.0; 3]), &key("sheenColorFactor"))?;
        if colour == Vec3::ZERO {
            return Ok(());
        }
        let roughness = self.share(of.sheen_roughness_factor.unwrap_or(0.0), &key("sheenRoughnessFactor"))?;
        self.fields.physical.finish.sheen = Some(SheenFields { colour: Some(colour), roughness: Some(roughness) });
        let colour = self.map(of.sheen_color_texture.as_ref(), &key("sheenColorTexture"))?;
        let rough = self.map(of.sheen_roughness_texture.as_ref(), &key("sheenRoughnessTexture"))?;
        let to = &mut self.fields.maps.finish;
        (to.sheen_colour, to.sheen_roughness) = (colour, rough);
        Ok(())
    }

    fn iridescence(&mut self, of: &Iridescence) -> Unplaced<()> {
        let key = |key: &str| format!("extensions.KHR_materials_iridescence.{key}");
        let weight = self.share(of.iridescence_factor.unwrap_or(0.0), &key("iridescenceFactor"))?;
        if weight == 0.0 {
            return Ok(());
        }
        let ior = of.iridescence_ior.unwrap_or(FILM_IOR.into());
        let ior = self.clamped(ior, &key("iridescenceIor"), Range::IOR, (1.0, 4.0))?;
        let [least, greatest] = FILM_THICKNESS.map(f64::from);
        let ends = [
            (of.iridescence_thickness_minimum.unwrap_or(least), "iridescenceThicknessMinimum"),
            (of.iridescence_thickness_maximum.unwrap_or(greatest), "iridescenceThicknessMaximum"),
        ];
        let within = (0.0, MOST_THICKNESS);
        let [least, greatest] = ends.map(|(at, name)| self.clamped(at, &key(name), Range::THICKNESS, within));
        let (least, greatest) = (least?, greatest?);
        let film = self.map(of.iridescence_texture.as_ref(), &key("iridescenceTexture"))?;
        let thickness = self.map(of.iridescence_thickness_texture.as_ref(), &key("iridescenceThicknessTexture"))?;
        // Without a texture all of it has the greatest.
        let ends = if thickness.is_some() { [least, greatest] } else { [greatest; 2] };
        let fields = FilmFields { weight: Some(weight), ior: Some(ior), thickness: Some(ends) };
        self.fields.physical.finish.film = Some(fields);
        let to = &mut self.fields.maps.finish;
        (to.film, to.film_thickness) = (film, thickness);
        Ok(())
    }
}
