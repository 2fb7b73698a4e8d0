//! Triangles.

use glam::{Vec2, Vec3, Vec4};

use super::extent;

/// An indexed triangle mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Vertex positions in world units.
    pub positions: Vec<Vec3>,
    /// Vertex normals of unit length; a zero stands for "flat here". As many as positions, or none at all.
    pub normals: Vec<Vec3>,
    /// Three vertices each, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// One index into [`Scene::materials`](super::Scene::materials) a triangle.
    pub materials: Vec<u32>,
    /// Two sets of texture coordinates, the second down; each as many as positions, or none at all.
    pub coordinates: [Vec<Vec2>; 2],
    /// Unit tangents along the first texture coordinate, and the sign of the bitangent (the cross product of normal and tangent times
    /// it); zeros for none. As many as positions, or none at all.
    pub tangents: Vec<Vec4>,
    /// Colours that base and diffuse colours are multiplied with, linear RGB and opacity in [0, 1]. As many as positions, or none
    /// at all.
    pub colours: Vec<Vec4>,
}

impl Mesh {
    /// The least and the greatest corner of the vertices, in their units; zeros where there are none.
    pub fn bounds(&self) -> [Vec3; 2] {
        extent::of(self.positions.iter().copied())
    }
}
