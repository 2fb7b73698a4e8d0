//! The vertices of a mesh: a file numbers positions and normals apart, a mesh pairs of them.

use std::collections::HashMap;

use glam::Vec3;
use rayon::prelude::*;

use super::super::Mesh;
use super::face::Corner;

/// The corners of triangles, as the file numbers them.
#[derive(Default)]
pub(super) struct Corners {
    /// Positions from 1.
    positions: Vec<[u32; 3]>,
    /// Normals from 1, 0 for none; none at all as long as no corner has one.
    normals: Option<Vec<[u32; 3]>>,
}

/// No vertex yet.
const NONE: u32 = u32::MAX;

impl Corners {
    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Adds triangles.
    pub fn extend(&mut self, triangles: &[[Corner; 3]]) {
        let before = self.positions.len();
        self.positions.par_extend(triangles.par_iter().map(|triangle| triangle.map(|corner| corner.position)));
        if self.normals.is_none()
            && triangles.par_iter().any(|triangle| triangle.iter().any(|corner| corner.normal > 0))
        {
            self.normals = Some(vec![[0; 3]; before]);
        }
        if let Some(normals) = &mut self.normals {
            normals.par_extend(triangles.par_iter().map(|triangle| triangle.map(|corner| corner.normal)));
        }
    }

    /// The mesh of them, whose vertices are those that are used, each once. A normal is zero where there is none.
    pub fn mesh(self, positions: &[Vec3], normals: &[Vec3], materials: Vec<u32>) -> Mesh {
        let Corners { positions: mut triangles, normals: of_corners } = self;
        let mut vertices = Vertices::of(positions.len());
        for (i, triangle) in triangles.iter_mut().enumerate() {
            let of_corners = of_corners.as_ref().map_or([0; 3], |normals| normals[i]);
            for (corner, normal) in triangle.iter_mut().zip(of_corners) {
                *corner = vertices.number(*corner, normal);
            }
        }
        let pairs = vertices.pairs;
        let normal = |&(_, normal): &(u32, u32)| normal.checked_sub(1).map_or(Vec3::ZERO, |i| normals[i as usize]);
        let mut normals: Vec<Vec3> = of_corners.iter().flat_map(|_| pairs.iter().map(normal)).collect();
        if normals.iter().all(|&normal| normal == Vec3::ZERO) {
            normals = Vec::new();
        }
        let positions = pairs.iter().map(|&(position, _)| positions[position as usize - 1]).collect();
        Mesh { positions, normals, triangles, materials, ..Mesh::default() }
    }
}

/// Pairs of a position and a normal, numbered as they come.
struct Vertices {
    pairs: Vec<(u32, u32)>,
    /// The first vertex of each position.
    first: Vec<u32>,
    /// Those of other normals.
    others: HashMap<(u32, u32), u32>,
}

impl Vertices {
    fn of(positions: usize) -> Self {
        Vertices { pairs: Vec::new(), first: vec![NONE; positions + 1], others: HashMap::new() }
    }

    fn number(&mut self, position: u32, normal: u32) -> u32 {
        let next = self.pairs.len() as u32;
        let first = &mut self.first[position as usize];
        if *first == NONE {
            *first = next;
        } else if self.pairs[*first as usize].1 == normal {
            return *first;
        } else {
            let number = *self.others.entry((position, normal)).or_insert(next);
            if number != next {
                return number;
            }
        }
        self.pairs.push((position, normal));
        next
    }
}
