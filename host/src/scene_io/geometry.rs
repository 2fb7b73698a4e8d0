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

    /// Moves it to its places, if there are any: spheres and disks to each of them, by transforms that keep them; a mesh that has one.
    pub fn put(&mut self, places: &[Transform]) {
        match (self, places) {
            (_, []) => {}
            (Geometry::Mesh(mesh), [only]) => only.apply(mesh),
            // Its copies stand there.
            (Geometry::Mesh(_), _) => {}
            (Geometry::Spheres(spheres), places) => *spheres = at_each(spheres, places, sphere),
            (Geometry::Disks(disks), places) => *disks = at_each(disks, places, disk),
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

fn at_each<T>(all: &[T], places: &[Transform], moved: impl Fn(&T, &Transform) -> T) -> Vec<T> {
    places.iter().flat_map(|place| all.iter().map(|one| moved(one, place)).collect::<Vec<_>>()).collect()
}

fn sphere(of: &Sphere, place: &Transform) -> Sphere {
    Sphere { center: place.place(of.center), radius: place.length(of.radius), ..*of }
}

fn disk(of: &Disk, place: &Transform) -> Disk {
    Disk { center: place.place(of.center), normal: place.normal(of.normal), radius: place.length(of.radius), ..*of }
}
