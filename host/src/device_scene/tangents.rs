//! Tangents of triangles, where a normal map or a grain asks for them (Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008).

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use eyerays_shader::data::{Normals, pack};
use glam::{Vec3, Vec4};

use super::normalisation::flushed;
use super::records::by_slot;
use crate::scene::{Mesh, Scene};

/// Tangents in the order of slots; three zeros where there are none.
pub(super) fn tangents(scene: &Scene, order: &[u32]) -> Vec<Normals> {
    let mesh = &scene.mesh;
    let made = if mesh.tangents.is_empty() && !mesh.coordinates[0].is_empty() { made(mesh) } else { Vec::new() };
    let own = |vertex: u32| mesh.tangents.get(vertex as usize).copied().unwrap_or(Vec4::ZERO);
    by_slot(scene, order, |triangle, corners| {
        let [a, b, c] = made.get(triangle).copied().unwrap_or_else(|| corners.map(own));
        let record = |tangent: Vec4, word| pack(flushed(tangent.truncate()), word);
        let sign = if a.w < 0.0 { -1.0f32 } else { 1.0 };
        Normals { a: record(a, sign.to_bits()), b: record(b, 0), c: record(c, 0) }
    })
}

/// Those of a mesh without, by its texture coordinates.
fn made(mesh: &Mesh) -> Vec<[Vec4; 3]> {
    let mut corners = Corners { mesh, tangents: vec![[Vec4::ZERO; 3]; mesh.triangles.len()] };
    // It fails where no triangle has an area, and then there is nothing to be had.
    let _ = generate_tangents(&mut corners);
    corners.tangents
}

struct Corners<'m> {
    mesh: &'m Mesh,
    tangents: Vec<[Vec4; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
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
        let [a, b, c] = self.mesh.triangles[face].map(|vertex| self.mesh.positions[vertex as usize].as_dvec3());
        (b - a).cross(c - a).normalize_or_zero().as_vec3().to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let coordinates = self.mesh.coordinates[0][self.vertex(face, corner)];
        // Normal maps have their second axis up, texture coordinates down.
        [coordinates.x, 1.0 - coordinates.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        self.tangents[face][corner] = space.map_or(Vec4::ZERO, |space| Vec4::from(space.tangent_encoded()));
    }
}
