//! Where the meshes of a scene lie, and what they are made of: by these figures its author places cameras, lights and further meshes.

use std::fmt;

use glam::Vec3;
use serde_json::{Value, json};

use super::plural;
use crate::error::printable;
use eyerays::scene::{Animation, Camera, Motion, Projection, Scene, default_camera};

/// The most meshes and the most materials that are told one by one as text.
const MOST: usize = 50;

/// The bounds of a scene and of each of its meshes in world units, and the camera it would have if it named none.
pub(super) struct Outline<'a> {
    scene: &'a Scene,
    camera: Option<Camera>,
}

impl<'a> Outline<'a> {
    /// The outline of a scene, whose default camera fits its image.
    pub fn of(scene: &'a Scene) -> Self {
        let (width, height) = scene.settings.size;
        Outline { scene, camera: default_camera(scene, f64::from(width) / f64::from(height)) }
    }

    pub fn json(&self) -> Value {
        let bounds = |[least, greatest]: [Vec3; 2]| json!([least.to_array(), greatest.to_array()]);
        let meshes = self.scene.objects.iter().map(|object| {
            let count = |noun| if object.primitives.noun() == noun { object.primitives.count() } else { 0 };
            let copied = object.primitives.instances(&self.scene.instances);
            json!({
                "name": object.name,
                "triangles": count("triangle") as u64 + self.scene.triangles_of(copied),
                "instances": count("instance"),
                "spheres": count("sphere"),
                "disks": count("disk"),
                "bounds": bounds(object.bounds),
            })
        });
        let camera = self.camera.as_ref().map(
            |camera| json!({ "eye": camera.eye.to_array(), "target": camera.target.to_array(), "fov": camera.projection.fov() }),
        );
        let materials = self.scene.materials.iter().map(|material| &material.name);
        let animations = self.scene.animations.iter().map(|of| json!({ "name": of.name, "seconds": of.seconds }));
        json!({
            "bounds": bounds(self.scene.bounds()),
            "default_camera": camera,
            "animations": animations.collect::<Vec<_>>(),
            "materials": materials.collect::<Vec<_>>(),
            "meshes": meshes.collect::<Vec<_>>(),
        })
    }
}

impl fmt::Display for Outline<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let range = |[least, greatest]: [Vec3; 2]| format!("{:?} to {:?}", least.to_array(), greatest.to_array());
        writeln!(out, "bounds: {}", range(self.scene.bounds()))?;
        if let Some(camera @ Camera { eye, target, .. }) = &self.camera {
            let (eye, target) = (eye.to_array(), target.to_array());
            write!(out, "default camera: eye = {eye:?}, target = {target:?}")?;
            match camera.projection {
                Projection::Perspective { fov } => writeln!(out, ", fov = {fov:?}")?,
                Projection::Orthographic { height } => writeln!(out, ", orthographic = {height:?}")?,
                // No camera that frames a scene goes all around.
                Projection::Equirectangular | Projection::Fisheye { .. } => writeln!(out)?,
            }
        }
        let objects = &self.scene.objects;
        for (number, object) in objects.iter().enumerate().take(MOST) {
            let primitives = plural(object.primitives.count(), object.primitives.noun());
            let name = printable(&object.name);
            writeln!(out, "mesh {}: {name}, {primitives}, {}", number + 1, range(object.bounds))?;
        }
        more(out, objects.len())?;
        let animations = &self.scene.animations;
        for Animation { name, seconds } in animations.iter().take(MOST) {
            writeln!(out, "animation: {}, {seconds:.3} s", printable(name))?;
        }
        more(out, animations.len())?;
        if let Some(motion) = &self.scene.motion {
            let moving = moving(self.scene, motion);
            let steps = plural(motion.poses.len(), "step");
            let cameras = plural(motion.cameras.len(), "camera");
            let lights = plural(motion.lights.len(), "light");
            let (moving, bent) = (plural(moving, "instance"), plural(motion.bent().count(), "shape"));
            writeln!(
                out,
                "while the shutter is open: {steps}; {moving}, {lights} and {cameras} that move, {bent} that bend"
            )?;
        }
        let materials = &self.scene.materials;
        for (number, material) in materials.iter().enumerate().take(MOST) {
            writeln!(out, "material {}: {}", number + 1, printable(&material.name))?;
        }
        more(out, materials.len())
    }
}

/// How many copies of meshes stand elsewhere later, or are of a mesh that changes its shape.
fn moving(scene: &Scene, motion: &Motion) -> usize {
    scene.instances.iter().enumerate().filter(|&(number, copy)| motion.moves(number, copy)).count()
}

/// Says how many of a list are not told.
fn more(out: &mut fmt::Formatter<'_>, count: usize) -> fmt::Result {
    match count.saturating_sub(MOST) {
        0 => Ok(()),
        more => writeln!(out, "and {more} more, which eyerays info --json has"),
    }
}
