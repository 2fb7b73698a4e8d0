//! What of a scene a pixel shows.

use glam::{DQuat, DVec3, Vec3};

use crate::scene::Scene;

/// The primitive that a pixel of [`Feature::Place`](crate::device_scene::Feature::Place) shows.
pub fn primitive([_, low, high]: [f32; 3]) -> Option<usize> {
    (low as usize + ((high as usize) << 16)).checked_sub(1)
}

/// What is seen at the middle of a pixel, if anything is.
#[derive(Clone, Copy)]
pub struct Place {
    /// In the scene's units; infinite for nothing.
    pub depth: f32,
    /// The primitive's number.
    pub primitive: Option<usize>,
}

impl Place {
    /// What a pixel of [`Feature::Place`](crate::device_scene::Feature::Place) shows, of a scene that was normalised by a scale.
    pub fn of(pixel: [f32; 3], scale: f64) -> Place {
        let primitive = primitive(pixel);
        let depth = if primitive.is_some() { (f64::from(pixel[0]) / scale) as f32 } else { f32::INFINITY };
        Place { depth, primitive }
    }
}

/// Finds what the numbers of primitives stand for.
pub struct Finder<'s> {
    scene: &'s Scene,
    /// The first numbers of copies, and the number after the last.
    firsts: Vec<u64>,
}

/// What a number stands for.
enum Primitive {
    /// A triangle of the mesh, and the copy that it is in.
    Triangle(usize, Option<usize>),
    /// A sphere or a disk behind them.
    Round(usize),
}

impl<'s> Finder<'s> {
    /// Of a scene.
    pub fn of(scene: &'s Scene) -> Self {
        Finder { scene, firsts: scene.first_numbers() }
    }

    fn find(&self, primitive: usize) -> Primitive {
        if primitive < self.scene.own_triangles() {
            return Primitive::Triangle(primitive, None);
        }
        let after = self.firsts.partition_point(|&first| first <= primitive as u64);
        match self.scene.instances.get(after - 1) {
            Some(copy) => {
                let first = self.scene.shared[copy.mesh as usize].triangles.start;
                Primitive::Triangle(first + primitive - self.firsts[after - 1] as usize, Some(after - 1))
            }
            None => Primitive::Round(primitive - self.firsts[after - 1] as usize),
        }
    }

    /// The word for a primitive; and of a triangle in a copy, the copy and which triangle of its mesh it is.
    pub fn stands_for(&self, primitive: usize) -> (&'static str, Option<(usize, usize)>) {
        match self.find(primitive) {
            Primitive::Triangle(triangle, copy) => {
                let first = |copy: usize| self.scene.shared[self.scene.instances[copy].mesh as usize].triangles.start;
                ("triangle", copy.map(|copy| (copy, triangle - first(copy))))
            }
            Primitive::Round(round) if round < self.scene.spheres.len() => ("sphere", None),
            Primitive::Round(_) => ("disk", None),
        }
    }

    /// The corners of a triangle in the world, or of one in a copy.
    fn corners(&self, triangle: usize, copy: Option<usize>) -> [DVec3; 3] {
        let transform = copy.map(|copy| self.scene.instances[copy].transform());
        self.scene.mesh.triangles[triangle].map(|corner| {
            let own = self.scene.mesh.positions[corner as usize];
            transform.as_ref().map_or(own, |transform| transform.place(own)).as_dvec3()
        })
    }

    /// How a place of a primitive moves, in world units, until the scene is that of another finder, where the primitive has a number. Spheres
    /// and disks turn as little as they can.
    pub fn moved(&self, (primitive, at): (usize, DVec3), (other, there): (&Finder<'_>, usize)) -> DVec3 {
        match (self.find(primitive), other.find(there)) {
            (Primitive::Triangle(triangle, copy), Primitive::Triangle(triangle_there, copy_there)) => {
                let (now, then) = (self.corners(triangle, copy), other.corners(triangle_there, copy_there));
                let weights = barycentric(now, at);
                (0..3).map(|corner| (then[corner] - now[corner]) * weights[corner]).sum()
            }
            (Primitive::Round(round), Primitive::Round(round_there)) => {
                let ((centre, axis, radius), (centre_there, axis_there, radius_there)) =
                    (self.round(round), other.round(round_there));
                let (from, grown) = (at - centre, radius_there / radius);
                let turned = if axis == axis_there { from } else { DQuat::from_rotation_arc(axis, axis_there) * from };
                centre_there - centre + (turned * grown - from)
            }
            _ => DVec3::ZERO,
        }
    }

    /// The centre, the axis and the radius of a sphere or a disk.
    fn round(&self, round: usize) -> (DVec3, DVec3, f64) {
        let disk = || {
            let disk = &self.scene.disks[round - self.scene.spheres.len()];
            (disk.center.as_dvec3(), disk.normal.as_dvec3().normalize_or_zero(), disk.radius.into())
        };
        let sphere = self.scene.spheres.get(round);
        sphere.map_or_else(disk, |sphere| (sphere.center.as_dvec3(), DVec3::Z, sphere.radius.into()))
    }

    /// The number of a primitive's material, from 0.
    pub fn material(&self, primitive: usize) -> u32 {
        let scene = self.scene;
        match self.find(primitive) {
            Primitive::Triangle(triangle, _) => scene.mesh.materials[triangle],
            Primitive::Round(round) => {
                let disk = || scene.disks[round - scene.spheres.len()].material;
                scene.spheres.get(round).map_or_else(disk, |sphere| sphere.material)
            }
        }
    }

    /// The first texture coordinates of a triangle at a place in world units; zeros where it has none, and of other primitives.
    pub fn texture_coordinates(&self, primitive: usize, at: [f32; 3]) -> [f32; 2] {
        let mesh = &self.scene.mesh;
        let (false, Primitive::Triangle(triangle, copy)) = (mesh.coordinates[0].is_empty(), self.find(primitive))
        else {
            return [0.0; 2];
        };
        let weights = barycentric(self.corners(triangle, copy), Vec3::from(at).as_dvec3());
        let of = mesh.triangles[triangle].map(|corner| mesh.coordinates[0][corner as usize].as_dvec2());
        (of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2]).as_vec2().to_array()
    }
}

/// Weights of a triangle's corners at the place of its plane that is nearest to a point; of one without area those of its first corner.
fn barycentric([a, b, c]: [DVec3; 3], at: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let square = normal.length_squared();
    if square == 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let second = (at - a).cross(c - a).dot(normal) / square;
    let third = (b - a).cross(at - a).dot(normal) / square;
    [1.0 - second - third, second, third]
}
