//! Tangents of triangles, where a normal map or anisotropy asks for them (Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008).

use std::ops::Range;

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use eyerays_shader::data::{Normals, pack};
use glam::{Vec2, Vec3, Vec4};

use super::normalisation::flushed;
use super::records::by_slot;
use crate::scene::{Material, Mesh, Scene};

/// Tangents in the order of slots; three zeros where there are none. Triangles without tangents of their own get them by the
/// coordinates that their normal map lies by, else their coat's, those of the first set if they have none.
pub(super) fn tangents(scene: &Scene, order: &[u32]) -> Vec<Normals> {
    let mesh = &scene.mesh;
    // Those of a mesh that stands in several places are its own.
    let shared = scene.shared.iter().map(|shared| shared.triangles.clone());
    let parts = std::iter::once(0..scene.own_triangles()).chain(shared);
    let made: Vec<_> = parts.flat_map(|part| made(mesh, &scene.materials, part)).collect();
    by_slot(scene, order, |triangle, corners| {
        let found = made.binary_search_by_key(&triangle, |(number, _)| *number);
        let [a, b, c] = found.map_or_else(|_| corners.map(|vertex| own(mesh, vertex)), |place| made[place].1);
        let record = |tangent: Vec4, word| pack(flushed(tangent.truncate()), word);
        let sign = if a.w < 0.0 { -1.0f32 } else { 1.0 };
        Normals { a: record(a, sign.to_bits()), b: record(b, 0), c: record(c, 0) }
    })
}

/// The tangents that triangles of a mesh lack, each with the triangle's number.
pub fn made_tangents(mesh: &Mesh, materials: &[Material]) -> Vec<(usize, [Vec4; 3])> {
    made(mesh, materials, 0..mesh.triangles.len())
}

fn own(mesh: &Mesh, vertex: u32) -> Vec4 {
    mesh.tangents.get(vertex as usize).copied().unwrap_or(Vec4::ZERO)
}

fn made(mesh: &Mesh, materials: &[Material], triangles: Range<usize>) -> Vec<(usize, [Vec4; 3])> {
    let set_of = |Material { maps, .. }: &Material| {
        let map = maps.normal.as_ref().or(maps.finish.coat_normal.as_ref());
        map.map_or(0, |map| map.placement.set as usize)
    };
    let sets: Vec<usize> = materials.iter().map(set_of).collect();
    let set_of = |triangle: usize| sets[mesh.materials[triangle] as usize];
    let lacks = |triangle: usize| mesh.triangles[triangle].iter().all(|&vertex| own(mesh, vertex) == Vec4::ZERO);
    let mut made = Vec::new();
    for set in [0, 1] {
        if mesh.coordinates[set].is_empty() {
            continue;
        }
        let faces = triangles.clone().filter(|&number| set_of(number) == set && lacks(number));
        let tangents = faces.map(|number| (number, [Vec4::ZERO; 3])).collect();
        let mut corners = Corners { mesh, coordinates: &mesh.coordinates[set], tangents };
        // It fails where no triangle has an area, and then there is nothing to be had.
        let _ = generate_tangents(&mut corners);
        made.append(&mut corners.tangents);
    }
    made.sort_unstable_by_key(|(number, _)| *number);
    made
}

struct Corners<'m> {
    mesh: &'m Mesh,
    coordinates: &'m [Vec2],
    /// Of the triangles of these numbers.
    tangents: Vec<(usize, [Vec4; 3])>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[self.tangents[face].0][corner] as usize
    }
}

/// The same numbers on every platform.
struct Software;

impl Ops for Software {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(x.into()) as f32
    }
}

impl Geometry<Software> for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.tangents.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let normal = self.mesh.normals.get(self.vertex(face, corner)).copied().unwrap_or(Vec3::ZERO);
        if normal != Vec3::ZERO {
            return normal.to_array();
        }
        let [a, b, c] =
            self.mesh.triangles[self.tangents[face].0].map(|vertex| self.mesh.positions[vertex as usize].as_dvec3());
        (b - a).cross(c - a).normalize_or_zero().as_vec3().to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let coordinates = self.coordinates[self.vertex(face, corner)];
        // Normal maps have their second axis up, texture coordinates down.
        [coordinates.x, 1.0 - coordinates.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        self.tangents[face].1[corner] = space.map_or(Vec4::ZERO, |space| Vec4::from(space.tangent_encoded()));
    }
}
