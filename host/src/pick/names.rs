//! What the numbers of primitives stand for, by name.

use serde::Serialize;

use crate::layers::Finder;
use crate::scene::{ObjectNumbers, Scene};

/// Something of a scene that has a number and a name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Named {
    /// From 1, as `eyerays info` counts and as layers have it.
    pub number: u32,
    /// Several may have the same.
    pub name: String,
}

/// A place in a mesh that stands in several places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Shared {
    /// Which of [`Scene::shared`] it is in.
    pub mesh: u32,
    /// Which of [`Scene::instances`] puts it there.
    pub copy: usize,
    /// Which of the mesh's triangles it is, from 0.
    pub triangle: usize,
}

/// A primitive of a scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Surface {
    /// Its number in the scene, from 0: triangles, then those of copies, then spheres, then disks.
    pub primitive: usize,
    /// `triangle`, `sphere` or `disk`.
    pub kind: &'static str,
    /// What it is a part of: a `[[mesh]]` of a scene file, or a node of a glTF file.
    pub object: Option<Named>,
    /// Which of the object's primitives it is, from 0.
    pub within: usize,
    /// Where it is in a mesh that stands in several places, if it is in one.
    pub shared: Option<Shared>,
    /// What it is made of.
    pub material: Named,
}

/// Finds what the numbers of a scene's primitives stand for.
pub struct Names<'s> {
    scene: &'s Scene,
    finder: Finder<'s>,
    objects: ObjectNumbers,
}

impl<'s> Names<'s> {
    /// Those of a scene.
    pub fn of(scene: &'s Scene) -> Self {
        Names { scene, finder: Finder::of(scene), objects: ObjectNumbers::of(scene) }
    }

    /// The primitive of a number in the scene.
    ///
    /// # Panics
    /// If the scene has not so many.
    pub fn surface(&self, primitive: usize) -> Surface {
        let (kind, shared) = self.finder.stands_for(primitive);
        let material = self.finder.material(primitive);
        let within = self.objects.within(primitive);
        let object = within
            .map(|(object, _)| Named { number: object + 1, name: self.scene.objects[object as usize].name.clone() });
        let shared = shared.map(|(copy, triangle)| Shared { mesh: self.scene.instances[copy].mesh, copy, triangle });
        let material = Named { number: material + 1, name: self.scene.materials[material as usize].name.clone() };
        Surface { primitive, kind, object, within: within.map_or(primitive, |(_, within)| within), shared, material }
    }
}
