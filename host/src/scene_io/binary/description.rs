//! What a scene is beside its geometry, as TOML.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::grids::Grids;
use super::header::AGAIN;
use super::motion::Shutter;
use super::textures::Pictures;
use crate::quality;
use crate::scene::{
    Background, Camera, Disk, Instance, Light, Material, Medium, Mesh, Object, Scene, Settings, SharedMesh, Sphere,
    Unplaced,
};
use crate::scene_io::budget::Budget;
use crate::scene_io::source;

/// The fields of a [`Scene`] but for its geometry, the texels of its textures and the files that it came from.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// The quality of the hierarchy, if there is one.
    pub hierarchy: Option<quality::Bvh>,
    ambient: Vec3,
    background: Background,
    #[serde(default)]
    background_group: String,
    #[serde(default)]
    fog: Option<Medium>,
    #[serde(default, skip_serializing_if = "Grids::is_empty")]
    grids: Grids,
    settings: Settings,
    objects: Vec<Object>,
    #[serde(default)]
    shared: Vec<SharedMesh>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
    motion: Option<Shutter>,
    textures: Pictures,
}

/// What sections hold as it is.
pub struct Geometry {
    pub mesh: Mesh,
    pub spheres: Vec<Sphere>,
    pub disks: Vec<Disk>,
    pub instances: Vec<Instance>,
}

impl Description {
    /// That of a scene with these textures and a hierarchy of this quality.
    pub fn of(scene: &Scene, (grids, textures): (Grids, Pictures), hierarchy: Option<quality::Bvh>) -> Self {
        Description {
            hierarchy,
            ambient: scene.ambient,
            background: scene.background,
            background_group: scene.background_group.clone(),
            fog: scene.fog,
            grids,
            settings: scene.settings,
            objects: scene.objects.clone(),
            shared: scene.shared.clone(),
            materials: scene.materials.clone(),
            lights: scene.lights.clone(),
            cameras: scene.cameras.clone(),
            motion: scene.motion.as_ref().map(Shutter::of),
            textures,
        }
    }

    /// The same without settings, cameras and a hierarchy.
    pub fn bare(scene: &Scene, of: (Grids, Pictures)) -> Self {
        let all = Self::of(scene, of, None);
        Description { settings: Settings::default(), cameras: Vec::new(), ..all }
    }

    /// Reads one.
    ///
    /// # Errors
    /// No TOML, other fields, or more of them than the budget has room for.
    pub fn parse(text: &[u8], budget: &Budget) -> Unplaced<Self> {
        let text = std::str::from_utf8(text).map_err(|_| format!("its description is not UTF-8; {AGAIN}"))?;
        budget.check_bytes(source::memory(text)).map_err(|why| format!("its description may {why}; write less"))?;
        toml::from_str(text).map_err(|error| {
            let line = error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
            format!("line {line} of its description: {}; {AGAIN}", error.message().replace('\n', " "))
        })
    }

    /// As text.
    ///
    /// # Errors
    /// None that a scene could make.
    pub fn text(&self) -> Unplaced<String> {
        toml::to_string(self).map_err(|error| error.to_string())
    }

    /// The scene of this geometry, these poses and texels, without a hierarchy.
    ///
    /// # Errors
    /// A motion of other poses, or textures of other texels.
    pub fn scene(self, geometry: Geometry, poses: &[u8], mut texels: &[u8]) -> Unplaced<Scene> {
        let Geometry { mesh, spheres, disks, instances } = geometry;
        let Description {
            hierarchy: _,
            ambient,
            background,
            background_group,
            fog,
            grids,
            settings,
            objects,
            shared,
            materials,
            lights,
            cameras,
            motion,
            textures,
        } = self;
        let mut scene = Scene {
            mesh,
            spheres,
            disks,
            shared,
            instances,
            objects,
            animations: Vec::new(),
            files: Vec::new(),
            motion: None,
            hierarchy: None,
            fog,
            materials,
            lights,
            cameras,
            background,
            environment: None,
            background_group,
            ambient,
            settings,
        };
        scene.motion = motion.map(|motion| motion.motion(&scene, poses)).transpose()?;
        grids.give(&mut scene, &mut texels)?;
        textures.give(&mut scene, texels)?;
        Ok(scene)
    }
}
