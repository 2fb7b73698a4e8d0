//! Vertex normals: unit length, or zero for "flat here".

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::Mesh;

/// The vector at unit length; zero where it has no direction.
pub fn unit(vector: DVec3) -> Vec3 {
    let length = vector.length();
    if length > 0.0 && length.is_finite() { (vector / length).as_vec3() } else { Vec3::ZERO }
}

/// Gives every vertex without a normal the mean of the faces around it, weighted by their areas.
///
/// Vertices at the same place count as one, since a mesh repeats them where materials meet.
pub fn smooth(mesh: &mut Mesh) {
    mesh.normals.resize(mesh.positions.len(), Vec3::ZERO);
    let mut sums: HashMap<[u32; 3], DVec3> = HashMap::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
        let area = (b - a).cross(c - a);
        for &vertex in triangle {
            *sums.entry(place(mesh.positions[vertex as usize])).or_default() += area;
        }
    }
    for (normal, &position) in mesh.normals.iter_mut().zip(&mesh.positions) {
        if *normal == Vec3::ZERO {
            *normal = sums.get(&place(position)).copied().map_or(Vec3::ZERO, unit);
        }
    }
}

/// The bits of a position; adding zero makes -0 and 0 equal.
pub(in crate::scene) fn place(position: Vec3) -> [u32; 3] {
    (position + Vec3::ZERO).to_array().map(f32::to_bits)
}
