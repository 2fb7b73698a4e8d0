//! The vertices of a mesh: a file numbers positions, normals and texture coordinates apart, a mesh all together.

use std::collections::HashMap;
use std::hash::Hash;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::face::Corner;
use crate::scene::Mesh;
use crate::scene::normal::unit;

/// The corners of triangles, as the file numbers them.
#[derive(Default)]
pub(super) struct Corners {
    /// Positions from 1.
    positions: Vec<[u32; 3]>,
    /// Normals from 1, 0 for none; none at all as long as no corner has one.
    normals: Option<Vec<[u32; 3]>>,
    /// Texture coordinates, likewise.
    coordinates: Option<Vec<[u32; 3]>>,
    /// Smoothing groups, 0 for none; none at all as long as no triangle has one.
    groups: Option<Vec<u32>>,
    /// Of how many triangles the group was said.
    said: usize,
}

/// What corners number, as the file holds it.
#[derive(Clone, Copy)]
pub(super) struct Attributes<'f> {
    pub positions: &'f [Vec3],
    /// Linear RGB of every position, or none at all.
    pub colours: &'f [Vec3],
    pub normals: &'f [Vec3],
    pub coordinates: &'f [Vec2],
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
        extend(&mut self.normals, before, triangles, |corner| corner.normal);
        extend(&mut self.coordinates, before, triangles, |corner| corner.coordinates);
    }

    /// Says the smoothing group of all triangles before this one of which none was said.
    pub fn group(&mut self, triangles: usize, group: u32) {
        if group != 0 || self.groups.is_some() {
            let said = self.said;
            self.groups.get_or_insert_with(|| vec![0; said]).resize(triangles, group);
        }
        self.said = triangles;
    }

    /// Gives corners without a normal the mean of the faces of their smoothing group around their position, weighted by areas.
    pub fn smooth(&mut self, positions: &[Vec3], normals: &mut Vec<Vec3>) {
        let Some(groups) = self.groups.take() else { return };
        let mut sums: HashMap<(u32, u32), (DVec3, u32)> = HashMap::new();
        let grouped = || self.positions.iter().zip(&groups).enumerate().filter(|(_, (_, group))| **group != 0);
        for (_, (corners, &group)) in grouped() {
            let [a, b, c] = corners.map(|corner| positions[corner as usize - 1].as_dvec3());
            let area = (b - a).cross(c - a);
            for &corner in corners {
                sums.entry((corner, group)).or_default().0 += area;
            }
        }
        let numbers = self.normals.get_or_insert_with(|| vec![[0; 3]; self.positions.len()]);
        for (triangle, (corners, &group)) in grouped() {
            for (number, &corner) in numbers[triangle].iter_mut().zip(corners).filter(|(number, _)| **number == 0) {
                let (sum, made) = sums.get_mut(&(corner, group)).expect("its own face is summed");
                if *made == 0 {
                    normals.push(unit(*sum));
                    *made = normals.len() as u32;
                }
                *number = *made;
            }
        }
    }

    /// Forgets texture coordinates.
    pub fn uncover(&mut self) {
        self.coordinates = None;
    }

    /// The mesh of them, whose vertices are those that are used, each once. Where there is none, a normal is zero, and texture
    /// coordinates are.
    pub fn mesh(self, of: Attributes, materials: Vec<u32>) -> Mesh {
        let Corners { positions: mut triangles, normals: of_normals, coordinates: of_coordinates, .. } = self;
        let Attributes { positions, colours, normals, coordinates } = of;
        let normal = |triangle: usize, corner: usize| of_normals.as_ref().map_or(0, |all| all[triangle][corner]);
        let place = |number: u32| positions[number as usize - 1];
        let upright = |number: u32| number.checked_sub(1).map_or(Vec3::ZERO, |i| normals[i as usize]);
        let coloured = |number: u32| colours.get(number as usize - 1).map(|colour| colour.extend(1.0));
        let covered = |number: u32| number.checked_sub(1).map_or(Vec2::ZERO, |i| coordinates[i as usize]);
        let mut mesh = Mesh { materials, ..Mesh::default() };
        // Pairs take less than triples of which one number is always 0.
        if let Some(of_coordinates) = &of_coordinates {
            let rest = |triangle: usize, corner: usize| (normal(triangle, corner), of_coordinates[triangle][corner]);
            let vertices = numbered(&mut triangles, positions.len(), rest);
            mesh.positions = vertices.iter().map(|&(position, _)| place(position)).collect();
            mesh.colours = vertices.iter().filter_map(|&(position, _)| coloured(position)).collect();
            mesh.normals = of_normals.iter().flat_map(|_| vertices.iter().map(|&(_, (n, _))| upright(n))).collect();
            mesh.coordinates[0] = vertices.iter().map(|&(_, (_, c))| covered(c)).collect();
        } else {
            let vertices = numbered(&mut triangles, positions.len(), normal);
            mesh.positions = vertices.iter().map(|&(position, _)| place(position)).collect();
            mesh.colours = vertices.iter().filter_map(|&(position, _)| coloured(position)).collect();
            mesh.normals = of_normals.iter().flat_map(|_| vertices.iter().map(|&(_, n)| upright(n))).collect();
        }
        if mesh.normals.iter().all(|&normal| normal == Vec3::ZERO) {
            mesh.normals = Vec::new();
        }
        Mesh { triangles, ..mesh }
    }
}

/// Adds what the corners of more triangles have to what those before do.
fn extend(
    all: &mut Option<Vec<[u32; 3]>>,
    before: usize,
    more: &[[Corner; 3]],
    number: impl Fn(&Corner) -> u32 + Copy + Sync,
) {
    if all.is_none() && more.par_iter().any(|triangle| triangle.iter().any(|corner| number(corner) > 0)) {
        *all = Some(vec![[0; 3]; before]);
    }
    if let Some(all) = all {
        all.par_extend(more.par_iter().map(|triangle| triangle.each_ref().map(number)));
    }
}

/// Numbers the vertices of triangles, whose corners are positions so far, and returns them: positions, and the rest of what a
/// corner of a triangle has.
fn numbered<E: Copy + Eq + Hash>(
    triangles: &mut [[u32; 3]],
    positions: usize,
    rest: impl Fn(usize, usize) -> E,
) -> Vec<(u32, E)> {
    let mut vertices = Vertices::of(positions);
    for (i, triangle) in triangles.iter_mut().enumerate() {
        for (j, corner) in triangle.iter_mut().enumerate() {
            *corner = vertices.number(*corner, rest(i, j));
        }
    }
    vertices.all
}

/// Vertices of a position and the rest that there is to one, numbered as they come.
struct Vertices<E> {
    all: Vec<(u32, E)>,
    /// The first vertex of each position.
    first: Vec<u32>,
    /// Those of another rest.
    others: HashMap<(u32, E), u32>,
}

impl<E: Copy + Eq + Hash> Vertices<E> {
    fn of(positions: usize) -> Self {
        Vertices { all: Vec::new(), first: vec![NONE; positions + 1], others: HashMap::new() }
    }

    fn number(&mut self, position: u32, rest: E) -> u32 {
        let next = self.all.len() as u32;
        let first = &mut self.first[position as usize];
        if *first == NONE {
            *first = next;
        } else if self.all[*first as usize].1 == rest {
            return *first;
        } else {
            let number = *self.others.entry((position, rest)).or_insert(next);
            if number != next {
                return number;
            }
        }
        self.all.push((position, rest));
        next
    }
}
