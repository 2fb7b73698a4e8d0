//! What a scene is made of, by its names.

use std::ops::Range;

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
pub struct ObjectNumbers {
    /// The numbers of each object's primitives.
    objects: Vec<Range<usize>>,
    /// The objects in the order of these.
    sorted: Vec<u32>,
}

impl ObjectNumbers {
    /// Those of a scene's objects.
    pub fn of(scene: &Scene) -> Self {
        let firsts = scene.first_numbers();
        let (triangles, spheres) = (firsts[scene.instances.len()] as usize, scene.spheres.len());
        let behind = |first: usize, of: &Range<usize>| first + of.start..first + of.end;
        let numbers = |primitives: &Primitives| match primitives {
            Primitives::Triangles(range) => range.clone(),
            Primitives::Instances(range) => firsts[range.start] as usize..firsts[range.end] as usize,
            Primitives::Spheres(range) => behind(triangles, range),
            Primitives::Disks(range) => behind(triangles + spheres, range),
        };
        let objects: Vec<Range<usize>> = scene.objects.iter().map(|object| numbers(&object.primitives)).collect();
        let mut sorted: Vec<u32> = (0..objects.len() as u32).collect();
        sorted.sort_unstable_by_key(|&object| (objects[object as usize].end, object));
        ObjectNumbers { objects, sorted }
    }

    /// How many objects there are.
    pub(crate) fn count(&self) -> usize {
        self.objects.len()
    }

    /// The place of a primitive's object in [`Scene::objects`].
    #[inline]
    pub fn find(&self, primitive: usize) -> Option<u32> {
        let after = self.sorted.partition_point(|&object| self.objects[object as usize].end <= primitive);
        self.sorted.get(after).copied()
    }

    /// The same, and which of the object's primitives it is: numbers that another moment has, too, where what moves while the shutter is open
    /// comes after what stands still.
    #[inline]
    pub(crate) fn within(&self, primitive: usize) -> Option<(u32, usize)> {
        let object = self.find(primitive)?;
        let within = primitive.checked_sub(self.objects[object as usize].start)?;
        Some((object, within))
    }

    /// The number of a primitive of an object, if that has so many.
    pub(crate) fn number(&self, (object, within): (u32, usize)) -> Option<usize> {
        let of = &self.objects[object as usize];
        (within < of.len()).then(|| of.start + within)
    }
}
