//! Extensions of materials by which light passes: transmission of either kind, what is inside, and what bends light.

use glam::Vec3;

use super::super::shading::{DiffuseTransmission, Dispersion, Extensions, Ior, Scatter, Transmission, Volume};
use super::Reader;
use crate::scene::{Absorption, Medium, Range, Unplaced, Volume as Filled, Wall};
use crate::scene_io::finish::DiffuseFields;

/// The index of refraction that means that all light is reflected (KHR_materials_ior).
const MIRROR: f64 = 0.0;
/// The greatest by which light is bent.
const MOST_IOR: f64 = 4.0;
/// The product of an Abbe number and what KHR_materials_dispersion says in its place.
const DISPERSION: f64 = 20.0;
/// The greatest Abbe number; light that is bent less unequally than by this looks as if it were bent equally.
const MOST_ABBE: f64 = 1000.0;

impl Reader<'_, '_, '_> {
    /// All of them, but for the index of refraction, which [`Reader::ior`] reads.
    pub(super) fn passing(&mut self, of: &Extensions) -> Unplaced<()> {
        if of.ior.as_ref().and_then(|of| of.ior) == Some(MIRROR) {
            return Ok(());
        }
        of.transmission.as_ref().map_or(Ok(()), |of| self.transmission(of))?;
        of.diffuse_transmission.as_deref().map_or(Ok(()), |of| self.diffuse_transmission(of))?;
        if self.fields.transmission.is_none() && self.fields.physical.finish.diffuse_transmission.is_none() {
            return Ok(());
        }
        self.inside(of.volume.as_ref())?;
        of.scatter.as_ref().map_or(Ok(()), |of| self.scatter(of))?;
        of.dispersion.as_ref().map_or(Ok(()), |of| self.dispersion(of))
    }

    /// An index of refraction. One that is too great to bend light here still reflects as much as it says: by the tint, which the
    /// reflection at normal incidence is multiplied with.
    pub(super) fn ior(&mut self, of: &Ior) -> Unplaced<()> {
        let Some(ior) = of.ior else { return Ok(()) };
        if ior == MIRROR || ior > MOST_IOR && !self.is_glass() {
            let root = |ior: f64| (ior - 1.0) / (ior + 1.0);
            let reflectance = |ior: f64| root(ior) * root(ior);
            let tint = self.fields.physical.specular_tint.unwrap_or(Vec3::ONE);
            self.fields.physical.specular_tint = Some(tint * (reflectance(ior) / reflectance(MOST_IOR)) as f32);
            self.fields.ior = Some(MOST_IOR as f32);
            return Ok(());
        }
        self.fields.ior = Some(self.clamped(ior, "extensions.KHR_materials_ior.ior", Range::IOR, (1.0, MOST_IOR))?);
        Ok(())
    }

    fn transmission(&mut self, of: &Transmission) -> Unplaced<()> {
        let key = |key: &str| format!("extensions.KHR_materials_transmission.{key}");
        let factor = self.share(of.transmission_factor.unwrap_or(0.0), &key("transmissionFactor"))?;
        if factor > 0.0 {
            self.fields.transmission = Some(Vec3::splat(factor));
            self.fields.maps.transmission = self.map(of.transmission_texture.as_ref(), &key("transmissionTexture"))?;
        }
        Ok(())
    }

    fn diffuse_transmission(&mut self, of: &DiffuseTransmission) -> Unplaced<()> {
        let key = |key: &str| format!("extensions.KHR_materials_diffuse_transmission.{key}");
        let weight = self.share(of.diffuse_transmission_factor.unwrap_or(0.0), &key("diffuseTransmissionFactor"))?;
        if weight == 0.0 {
            return Ok(());
        }
        let colour = of.diffuse_transmission_color_factor.unwrap_or([1.0; 3]);
        let colour = self.colour(colour, &key("diffuseTransmissionColorFactor"))?;
        let fields = DiffuseFields { weight: Some(weight), colour: Some(colour) };
        self.fields.physical.finish.diffuse_transmission = Some(fields);
        let maps = [
            (&of.diffuse_transmission_texture, "diffuseTransmissionTexture"),
            (&of.diffuse_transmission_color_texture, "diffuseTransmissionColorTexture"),
        ];
        let [weight, colour] = maps.map(|(info, name)| self.map(info.as_ref(), &key(name)));
        let to = &mut self.fields.maps.finish;
        (to.diffuse_transmission, to.diffuse_transmission_colour) = (weight?, colour?);
        Ok(())
    }

    /// What light passes into. A volume without a thickness is none.
    fn inside(&mut self, volume: Option<&Volume>) -> Unplaced<()> {
        let volume = volume.filter(|volume| volume.thickness_factor.is_some_and(|thickness| thickness > 0.0));
        self.fields.physical.wall = Some(if volume.is_none() { Wall::Interface } else { Wall::Body });
        let Some(Volume { attenuation_distance: Some(distance), attenuation_color, .. }) = volume else {
            return Ok(());
        };
        let key = |key: &str| format!("extensions.KHR_materials_volume.{key}");
        // A number beyond single precision is as good as the infinity that JSON does not have.
        if (*distance as f32).is_finite() {
            let distance = self.number(*distance, &key("attenuationDistance"), Range::LENGTH)?;
            let colour = self.colour(attenuation_color.unwrap_or([1.0; 3]), &key("attenuationColor"))?;
            self.fields.physical.absorption = Some(Absorption { colour, distance });
        }
        Ok(())
    }

    /// The drafts KHR_materials_volume_scatter and KHR_materials_scatter: of what a body takes of light, a share is scattered instead,
    /// by which a thick body has a colour. Without a volume they do nothing.
    fn scatter(&mut self, of: &Scatter) -> Unplaced<()> {
        let key = |key: &str| format!("extensions.KHR_materials_volume_scatter.{key}");
        let Some(Absorption { colour: left, distance }) = self.fields.physical.absorption else { return Ok(()) };
        let strength = self.share(of.scatter_strength_factor.unwrap_or(1.0), &key("scatterStrengthFactor"))?;
        let colour = self.colour(of.multiscatter_color.unwrap_or([0.0; 3]), &key("multiscatterColor"))? * strength;
        let most = f64::from(Medium::MOST_ANISOTROPY);
        let anisotropy = of.scatter_anisotropy.unwrap_or(0.0);
        let anisotropy = self.clamped(anisotropy, &key("scatterAnisotropy"), Range::ANISOTROPY, (-most, most))?;
        if colour == Vec3::ZERO {
            return Ok(());
        }
        let medium = Medium::of_colour(colour, Absorption { colour: left, distance }.mean_way(), anisotropy);
        self.fields.volume = Some(Filled { interface: true, ..Filled::open(medium) });
        // What is absorbed is the medium's.
        self.fields.physical.absorption = None;
        Ok(())
    }

    /// Of glass with a volume alone, whose surface bends light.
    fn dispersion(&mut self, of: &Dispersion) -> Unplaced<()> {
        let key = "extensions.KHR_materials_dispersion.dispersion";
        // From the Abbe number 1 up.
        let dispersion = self.clamped(of.dispersion.unwrap_or(0.0), key, Range::DISPERSION, (0.0, DISPERSION))?;
        if dispersion > 0.0 && self.is_glass() {
            self.fields.physical.finish.abbe = Some((DISPERSION / f64::from(dispersion)).min(MOST_ABBE) as f32);
        }
        Ok(())
    }

    /// Does its surface bend light that passes?
    pub(super) fn is_glass(&self) -> bool {
        self.fields.transmission.is_some() && self.fields.physical.wall == Some(Wall::Body)
    }
}
