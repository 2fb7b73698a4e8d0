//! Faces of any number of corners, and one step from them to quads.

use std::collections::{HashMap, HashSet};

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::edges::{Around, Edge, Edges, Kind};
use crate::scene::Mesh;
use crate::scene::normal::place;

/// A corner of a face: where it is, and what it carries, which is interpolated linearly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// The number of its vertex.
    pub vertex: u32,
    /// Two sets of texture coordinates.
    pub coordinates: [Vec2; 2],
    pub colour: Vec4,
}

/// Faces, which share vertices where they are at the same place.
#[derive(Debug, Default)]
pub struct Cage {
    pub(super) positions: Vec<DVec3>,
    /// Those of all faces, one face after the other.
    pub(super) corners: Vec<Corner>,
    /// Where the corners of each face end.
    pub(super) ends: Vec<usize>,
    /// Of each face.
    pub(super) materials: Vec<u32>,
    /// Edges that stay sharp, by their vertices, the lesser first; sorted.
    pub(super) sharp: Vec<[u32; 2]>,
}

impl Cage {
    /// Of a mesh: faces of so many of its triangles each, one after the other; each triangle is one where there are no sizes.
    pub fn of(mesh: &Mesh, faces: &[u32]) -> Cage {
        let mut cage = Cage::default();
        let places = cage.weld(mesh);
        let corner = |vertex: u32| {
            let at = vertex as usize;
            let coordinates = [0, 1].map(|set: usize| mesh.coordinates[set].get(at).copied().unwrap_or_default());
            let colour = mesh.colours.get(at).copied().unwrap_or(Vec4::ONE);
            Corner { vertex: places[at], coordinates, colour }
        };
        let mut triangles = &mesh.triangles[..];
        let ones = std::iter::repeat_n(1, if faces.is_empty() { triangles.len() } else { 0 });
        let mut first = 0;
        for count in faces.iter().copied().chain(ones) {
            let (own, rest) = triangles.split_at((count as usize).min(triangles.len()));
            triangles = rest;
            let outlines = outline(own).map_or_else(|| own.iter().map(|t| t.to_vec()).collect(), |all| vec![all]);
            for outline in outlines {
                cage.corners.extend(outline.into_iter().map(corner));
                cage.ends.push(cage.corners.len());
                cage.materials.push(mesh.materials[first]);
            }
            first += own.len();
        }
        cage
    }

    /// Vertices at the same place are one; the number of each of the mesh's.
    fn weld(&mut self, mesh: &Mesh) -> Vec<u32> {
        let mut known: HashMap<[u32; 3], u32> = HashMap::new();
        let number = |position: &Vec3| {
            *known.entry(place(*position)).or_insert_with(|| {
                self.positions.push(position.as_dvec3());
                self.positions.len() as u32 - 1
            })
        };
        mesh.positions.iter().map(number).collect()
    }

    /// The corners of each face.
    pub(super) fn faces(&self) -> impl Iterator<Item = &[Corner]> + Clone {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.corners[start..end])
    }

    /// The next finer cage: a quad for each corner of each face (Catmull and Clark, Recursively generated B-spline surfaces on arbitrary
    /// topological meshes, 1978). Edges of one face, or of more than two, and those that are sharp are creases; a vertex where more than two
    /// of them meet stays, and so does the vertex of a single face.
    pub(super) fn refined(&self) -> Cage {
        let edges = Edges::of(self);
        let (vertices, faces) = (self.positions.len() as u32, self.ends.len() as u32);
        let middles: Vec<DVec3> = self.faces().map(|face| self.mean(face)).collect();
        let mut positions = self.moved(&edges, &middles);
        positions.extend_from_slice(&middles);
        positions.extend(edges.all.iter().map(|edge| self.on_edge(edge, &middles)));
        let of_edge = |edge: u32| vertices + faces + edge;
        let mut fine = Cage { positions, ..Cage::default() };
        let mut first = 0;
        for (number, face) in (0..).zip(self.faces()) {
            let count = face.len();
            let centre = Corner { vertex: vertices + number, ..mean_of(face) };
            let own = &edges.of_corners[first..first + count];
            let between =
                |from: usize| Corner { vertex: of_edge(own[from]), ..mean_of(&[face[from], face[(from + 1) % count]]) };
            for (corner, &own) in face.iter().enumerate() {
                fine.corners.extend([own, between(corner), centre, between((corner + count - 1) % count)]);
                fine.ends.push(fine.corners.len());
                fine.materials.push(self.materials[number as usize]);
            }
            first += count;
        }
        let halves = edges.all.iter().zip(0..).filter(|(edge, _)| edge.is_sharp);
        fine.sharp = halves.flat_map(|(edge, number)| edge.vertices.map(|end| [end, of_edge(number)])).collect();
        fine.sharp.sort_unstable();
        fine
    }

    fn mean(&self, face: &[Corner]) -> DVec3 {
        let sum: DVec3 = face.iter().map(|corner| self.positions[corner.vertex as usize]).sum();
        sum / face.len() as f64
    }

    fn on_edge(&self, edge: &Edge, middles: &[DVec3]) -> DVec3 {
        let [a, b] = edge.vertices.map(|end| self.positions[end as usize]);
        match edge.smooth() {
            Some(faces) => (a + b + faces.map(|face| middles[face as usize]).into_iter().sum::<DVec3>()) / 4.0,
            None => (a + b) / 2.0,
        }
    }

    /// Where the vertices go.
    fn moved(&self, edges: &Edges, middles: &[DVec3]) -> Vec<DVec3> {
        let around = edges.around(self, |face| middles[face]);
        let of = |(&at, around): (&DVec3, &Around)| match around.kind() {
            Kind::Stays => at,
            Kind::Crease => (6.0 * at + around.creased) / 8.0,
            Kind::Smooth => {
                let count = f64::from(around.edges);
                // The means of the faces around and of the middles of the edges.
                let faces = around.faces / f64::from(around.face_count);
                let middles = (at + around.neighbours / count) / 2.0;
                (faces + 2.0 * middles + (count - 3.0) * at) / count
            }
        };
        self.positions.iter().zip(&around).map(of).collect()
    }
}

/// The mean of what corners carry, at the vertex of the first.
fn mean_of(corners: &[Corner]) -> Corner {
    let share = 1.0 / corners.len() as f32;
    let coordinates = [0, 1].map(|set: usize| corners.iter().map(|c| c.coordinates[set]).sum::<Vec2>() * share);
    Corner { coordinates, colour: corners.iter().map(|c| c.colour).sum::<Vec4>() * share, ..corners[0] }
}

/// The outline of a face that was cut into triangles; none where that has holes, or touches itself.
fn outline(triangles: &[[u32; 3]]) -> Option<Vec<u32>> {
    let sides = || triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let all: HashSet<(u32, u32)> = sides().collect();
    let mut next = HashMap::new();
    for (from, to) in sides().filter(|&(from, to)| !all.contains(&(to, from))) {
        if next.insert(from, to).is_some() {
            return None;
        }
    }
    let start = triangles.first()?[0];
    let mut outline = vec![start];
    while let Some(to) = next.remove(outline.last()?) {
        if to == start {
            break;
        }
        outline.push(to);
    }
    (next.is_empty() && outline.len() == triangles.len() + 2).then_some(outline)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outline_of_a_face_is_found_again_however_it_was_cut() {
        for triangles in [vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]], vec![[1, 2, 3], [0, 1, 3], [0, 3, 4]]] {
            let mut found = outline(&triangles).unwrap();
            let first = found.iter().position(|&vertex| vertex == 0).unwrap();
            found.rotate_left(first);
            assert_eq!(found, [0, 1, 2, 3, 4]);
        }
        // Two that only touch, and one that is folded.
        assert_eq!(outline(&[[0, 1, 2], [2, 3, 4]]), None);
        assert_eq!(outline(&[[0, 1, 2], [0, 1, 2]]), None);
    }
}
