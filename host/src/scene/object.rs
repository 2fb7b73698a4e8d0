//! What a scene is made of, by its names.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::{Primitives, Scene, Visibility};

/// What one `[[mesh]]` of a scene file adds to the scene, a node of a glTF file, or a bare mesh file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// The node's name, the file as the scene names it or the shape's word, and the material where one is named: `sphere (glass)`.
    /// Several objects may have the same name.
    pub name: String,
    /// What it is made of; never nothing.
    pub primitives: Primitives,
    /// Its least and its greatest corner in world units.
    pub bounds: [Vec3; 2],
    /// Who sees it, beside what its materials say.
    #[serde(default)]
    pub visibility: Visibility,
}

/// Finds the object of a primitive by the primitive's number in the scene: triangles, then those of copies, then spheres, then disks.
pub struct ObjectNumbers(Vec<(usize, u32)>);

impl ObjectNumbers {
    /// Those of a scene's objects.
    pub fn of(scene: &Scene) -> Self {
        let firsts = scene.first_numbers();
        let (triangles, spheres) = (firsts[scene.instances.len()] as usize, scene.spheres.len());
        let end = |primitives: &Primitives| match primitives {
            Primitives::Triangles(range) => range.end,
            Primitives::Instances(range) => firsts[range.end] as usize,
            Primitives::Spheres(range) => triangles + range.end,
            Primitives::Disks(range) => triangles + spheres + range.end,
        };
        let numbers = scene.objects.iter().zip(0..).map(|(object, number)| (end(&object.primitives), number));
        let mut ends: Vec<_> = numbers.collect();
        ends.sort_unstable();
        ObjectNumbers(ends)
    }

    /// The place of a primitive's object in [`Scene::objects`].
    pub fn find(&self, primitive: usize) -> Option<u32> {
        let after = self.0.partition_point(|&(end, _)| end <= primitive);
        self.0.get(after).map(|&(_, number)| number)
    }
}
