//! What one `[[mesh]]` holds, before it is merged with the others.

use super::transform::Transform;
use crate::scene::{Disk, Mesh, Sphere, extent};
use glam::Vec3;

/// Surfaces of one kind. Their materials are numbered by their own file.
pub enum Geometry {
    Mesh(Mesh),
    Spheres(Vec<Sphere>),
    Disks(Vec<Disk>),
}

impl Geometry {
    /// The least and the greatest corner.
    pub fn bounds(&self) -> [Vec3; 2] {
        match self {
            Geometry::Mesh(mesh) => mesh.bounds(),
            Geometry::Spheres(spheres) => extent::of(spheres.iter().flat_map(Sphere::bounds)),
            Geometry::Disks(disks) => extent::of(disks.iter().flat_map(Disk::bounds)),
        }
    }

    /// Moves it; spheres and disks by a transform that keeps them.
    pub fn apply(&mut self, transform: &Transform) {
        match self {
            Geometry::Mesh(mesh) => transform.apply(mesh),
            Geometry::Spheres(spheres) => {
                for Sphere { center, radius, .. } in spheres {
                    (*center, *radius) = (transform.place(*center), transform.length(*radius));
                }
            }
            Geometry::Disks(disks) => {
                for Disk { center, normal, radius, .. } in disks {
                    (*center, *radius) = (transform.place(*center), transform.length(*radius));
                    *normal = transform.normal(*normal);
                }
            }
        }
    }

    /// What single precision can't hold of it, and the remedy.
    pub fn fault(&self) -> Option<String> {
        let numbered = |noun: &str, count: usize, number: usize, fault: &str| match count {
            1 => format!("the {noun} {fault}"),
            _ => format!("the {noun} number {} {fault}", number + 1),
        };
        match self {
            Geometry::Mesh(mesh) => {
                let is_finite = mesh.positions.iter().all(|position| position.is_finite());
                (!is_finite).then(|| "the mesh leaves the range of single precision; make it smaller".into())
            }
            Geometry::Spheres(spheres) => spheres
                .iter()
                .enumerate()
                .find_map(|(number, sphere)| Some(numbered("sphere", spheres.len(), number, sphere.fault()?))),
            Geometry::Disks(disks) => disks
                .iter()
                .enumerate()
                .find_map(|(number, disk)| Some(numbered("disk", disks.len(), number, disk.fault()?))),
        }
    }

    /// Gives every surface the material that `number` says for its own, in order.
    pub fn renumber(&mut self, mut number: impl FnMut(u32) -> u32) {
        let change = |material: &mut u32| *material = number(*material);
        match self {
            Geometry::Mesh(mesh) => mesh.materials.iter_mut().for_each(change),
            Geometry::Spheres(spheres) => spheres.iter_mut().map(|sphere| &mut sphere.material).for_each(change),
            Geometry::Disks(disks) => disks.iter_mut().map(|disk| &mut disk.material).for_each(change),
        }
    }
}
