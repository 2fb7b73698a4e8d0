//! What a hand has changed of a scene: its files keep what they say.

use std::collections::BTreeMap;

use eyerays::scene::{Environment, Light, Material, Scene};
use glam::Vec3;

/// What is different from a scene's files, by the numbers of lights and materials.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Edits {
    /// What the light of lights is multiplied with.
    pub lights: BTreeMap<usize, f32>,
    /// Materials in the place of the scene's.
    pub materials: BTreeMap<usize, Material>,
    /// What the light of the environment is multiplied with, and how it is turned in degrees.
    pub environment: Option<(f32, f32)>,
}

/// What of a scene may be changed, as its files have it.
#[derive(Debug, Clone, Default)]
pub struct Own {
    /// In file order.
    pub lights: Vec<Light>,
    /// Likewise.
    pub materials: Vec<Material>,
    /// Light from far away.
    pub environment: Option<Environment>,
}

impl Own {
    /// Of a scene that nobody has changed.
    pub fn of(scene: &Scene) -> Own {
        let Scene { lights, materials, environment, .. } = scene;
        Own { lights: lights.clone(), materials: materials.clone(), environment: environment.clone() }
    }
}

impl Edits {
    /// Changes the scene that was this before. Numbers that it has not change nothing.
    pub fn apply(&self, own: &Own, scene: &mut Scene) {
        scene.lights.clone_from(&own.lights);
        for (&number, &factor) in &self.lights {
            if let Some(light) = scene.lights.get_mut(number) {
                *colour(light) *= factor;
            }
        }
        scene.materials.clone_from(&own.materials);
        for (&number, material) in &self.materials {
            if let Some(place) = scene.materials.get_mut(number) {
                place.clone_from(material);
            }
        }
        scene.environment.clone_from(&own.environment);
        if let (Some((factor, rotation)), Some(environment)) = (self.environment, &mut scene.environment) {
            (environment.scale, environment.rotation) = (environment.scale * factor, rotation);
        }
    }

    /// Nothing is different.
    pub fn is_none(&self) -> bool {
        *self == Edits::default()
    }
}

/// A light's colour.
pub(crate) fn colour(light: &mut Light) -> &mut Vec3 {
    match light {
        Light::Point { colour, .. } | Light::Directional { colour, .. } | Light::Spot { colour, .. } => colour,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_changed_and_changed_back_is_as_it_was() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/whitted.toml");
        let (mut scene, _) = eyerays::scene_io::load(path.as_ref()).unwrap();
        let (own, before) = (Own::of(&scene), scene.clone());
        let grey = Material { diffuse: Vec3::splat(0.5), ..scene.materials[0].clone() };
        let edits = Edits {
            lights: BTreeMap::from([(0, 2.0), (99, 3.0)]),
            materials: BTreeMap::from([(0, grey), (99, scene.materials[0].clone())]),
            environment: Some((2.0, 90.0)),
        };
        edits.apply(&own, &mut scene);
        assert_eq!(*colour(&mut scene.lights[0]), *colour(&mut before.lights.clone()[0]) * 2.0);
        assert_eq!(scene.materials[0].diffuse, Vec3::splat(0.5));
        assert_ne!((&scene.lights, &scene.materials), (&before.lights, &before.materials));
        Edits::default().apply(&own, &mut scene);
        assert_eq!((&scene.lights, &scene.materials), (&before.lights, &before.materials));
    }
}
