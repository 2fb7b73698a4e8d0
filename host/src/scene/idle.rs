//! What of a material by microfacets does nothing beside the rest.

use glam::Vec3;

use super::{Maps, Physical, Wall};

impl Physical {
    /// What of it does nothing beside the rest, covered with these maps, and what to do.
    pub fn idle(&self, maps: &Maps) -> Option<&'static str> {
        if self.hair.is_some() {
            return self.on_hair();
        }
        let of_base = if self.conductor.is_some() { self.on_conductor() } else { self.of_base(maps) };
        of_base.or_else(|| self.inside()).or_else(|| self.of_film(maps))
    }

    fn on_conductor(&self) -> Option<&'static str> {
        if self.transmission != Vec3::ZERO {
            return Some("no light passes a conductor; remove conductor or transmission");
        }
        if self.diffuse_transmission.is_some() {
            return Some("no light passes a conductor; remove conductor or diffuse_transmission");
        }
        self.film
            .map(|_| "a conductor has no film; remove film, or give it base_color and metallic in place of conductor")
    }

    fn on_hair(&self) -> Option<&'static str> {
        let idle = [
            (self.conductor.is_some(), "hair has a color instead of a complex index; remove conductor or hair"),
            (self.metallic > 0.0, "hair is no metal; remove metallic or hair"),
            (self.transmission != Vec3::ZERO, "hair lets light pass by itself; remove transmission or hair"),
            (
                self.diffuse_transmission.is_some(),
                "hair lets light pass by itself; remove diffuse_transmission or hair",
            ),
            (self.absorption.is_some(), "hair absorbs light by its base_color; remove absorption or hair"),
            (self.coat.is_some(), "hair is a fibre as a whole; remove coat or hair"),
            (self.sheen.is_some(), "hair is a fibre as a whole; remove sheen or hair"),
            (self.film.is_some(), "hair is a fibre as a whole; remove film or hair"),
            (self.anisotropy > 0.0, "hair has a direction of its own; remove anisotropy or hair"),
            (self.abbe.is_some() || self.glass.is_some(), "hair bends all light alike; remove abbe, glass or hair"),
        ];
        idle.into_iter().find_map(|(is_idle, why)| is_idle.then_some(why))
    }

    fn of_base(&self, maps: &Maps) -> Option<&'static str> {
        self.diffuse_transmission?;
        if self.metallic == 1.0 && maps.metallic_roughness.is_none() {
            return Some("no light passes metal; lower metallic, or remove diffuse_transmission");
        }
        let is_clear = self.transmission == Vec3::ONE && maps.transmission.is_none();
        is_clear.then_some("transmission leaves no light to diffuse_transmission; lower the first or remove the second")
    }

    fn inside(&self) -> Option<&'static str> {
        if self.absorption.is_some() && !self.lets_light_in() {
            return Some(
                "absorption is of light that passes inside; give it transmission or diffuse_transmission and leave thin out",
            );
        }
        let bends = self.is_transparent() && self.wall == Wall::Body;
        if self.glass.is_some() && !bends {
            return Some("glass is a body that bends light; leave transmission and thin out, or remove glass");
        }
        let is_idle = self.abbe.is_some() && !bends;
        is_idle.then_some("abbe is of light that a body bends; give it transmission and leave thin out, or remove abbe")
    }

    fn of_film(&self, maps: &Maps) -> Option<&'static str> {
        let [least, greatest] = self.film?.thickness;
        match (least == greatest, maps.finish.film_thickness.is_some()) {
            (true, true) => Some(
                "film_thickness_texture tells where between two thicknesses a film is; give the film both, \
                 thickness = [100, 400]",
            ),
            (false, false) => Some(
                "without film_thickness_texture a film has the second of its thicknesses; add that texture, or give one \
                 thickness",
            ),
            _ => None,
        }
    }
}
