//! Surfaces that are moved by a picture of heights.

use std::collections::HashMap;

use glam::{DVec3, Vec2};

use super::Mesh;
use super::normal::{self, place};

/// A picture of heights.
#[derive(Debug, Clone, PartialEq)]
pub struct Heights {
    /// In texels, at least 1.
    pub width: u32,
    /// Likewise.
    pub height: u32,
    /// Row by row, finite.
    pub values: Vec<f32>,
}

impl Heights {
    /// The height at texture coordinates, of which the second leads down: between the middles of texels linearly, and repeated beyond the
    /// edges.
    pub fn at(&self, coordinates: Vec2) -> f32 {
        let size = Vec2::new(self.width as f32, self.height as f32);
        // However far away they are.
        let place = (coordinates - coordinates.floor()) * size - 0.5;
        let (corner, share) = (place.floor(), place - place.floor());
        let texel = |right: f32, down: f32| {
            let column = (corner.x + right).rem_euclid(size.x) as usize % self.width as usize;
            let row = (corner.y + down).rem_euclid(size.y) as usize % self.height as usize;
            self.values[row * self.width as usize + column]
        };
        let row = |down: f32| texel(0.0, down) * (1.0 - share.x) + texel(1.0, down) * share.x;
        row(0.0) * (1.0 - share.y) + row(1.0) * share.y
    }
}

/// Moves each vertex along its normal, that of the faces around where it has none, as far as `height` says for its texture coordinates;
/// vertices at the same place go together, by the mean of what they are told. Normals are those of the faces around, then.
///
/// # Panics
/// If the mesh has no texture coordinates.
pub fn displaced(mesh: &mut Mesh, height: impl Fn(Vec2) -> f32) {
    assert_eq!(mesh.coordinates[0].len(), mesh.positions.len(), "heights are told by texture coordinates");
    normal::smooth(mesh);
    let mut ways: HashMap<[u32; 3], (DVec3, f64)> = HashMap::new();
    for ((&position, normal), &coordinates) in mesh.positions.iter().zip(&mesh.normals).zip(&mesh.coordinates[0]) {
        let way = ways.entry(place(position)).or_default();
        way.0 += normal.as_dvec3() * f64::from(height(coordinates));
        way.1 += 1.0;
    }
    for position in &mut mesh.positions {
        let (way, count) = ways[&place(*position)];
        *position = (position.as_dvec3() + way / count).as_vec3();
    }
    mesh.normals.clear();
    mesh.tangents.clear();
    normal::smooth(mesh);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_those_of_texels_in_their_middles_and_linear_between_them() {
        let heights = Heights { width: 4, height: 2, values: vec![0.0, 1.0, 2.0, 3.0, 10.0, 11.0, 12.0, 13.0] };
        for (row, column) in (0..2).flat_map(|row| (0..4).map(move |column| (row, column))) {
            let middle = Vec2::new((column as f32 + 0.5) / 4.0, (row as f32 + 0.5) / 2.0);
            for turns in [Vec2::ZERO, Vec2::new(1.0, -3.0)] {
                assert_eq!(heights.at(middle + turns), (10 * row + column) as f32);
            }
        }
        assert_eq!(heights.at(Vec2::new(0.5, 0.25)), 1.5);
        assert_eq!(heights.at(Vec2::new(0.375, 0.5)), 6.0);
        // Over the edge, between the last and the first.
        assert_eq!(heights.at(Vec2::new(0.0, 0.25)), 1.5);
        assert!(heights.at(Vec2::new(-1e-9, 1e9)).is_finite() && heights.at(Vec2::splat(f32::MAX)).is_finite());
    }
}
