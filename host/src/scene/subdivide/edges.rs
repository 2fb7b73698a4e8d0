//! Which faces share an edge, and what is around a vertex.

use glam::DVec3;

use super::cage::Cage;

/// An edge between two vertices, the lesser first.
#[derive(Debug, PartialEq)]
pub struct Edge {
    pub vertices: [u32; 2],
    /// How many faces have it.
    pub count: u32,
    /// The first and the last of them.
    pub faces: [u32; 2],
    /// Is it to stay sharp?
    pub is_sharp: bool,
}

impl Edge {
    /// Its faces, if it is one that the surface goes smoothly over.
    pub fn smooth(&self) -> Option<[u32; 2]> {
        (self.count == 2 && !self.is_sharp).then_some(self.faces)
    }
}

/// The edges of a cage.
pub struct Edges {
    pub all: Vec<Edge>,
    /// The edge from each corner to the next one of its face.
    pub of_corners: Vec<u32>,
}

/// What is around a vertex.
#[derive(Clone, Copy, Default)]
pub struct Around {
    /// The sum of something of its faces.
    pub faces: DVec3,
    pub face_count: u32,
    /// The sum of the other ends of its edges.
    pub neighbours: DVec3,
    pub edges: u32,
    /// That of creases alone.
    pub creased: DVec3,
    pub creases: u32,
}

/// What becomes of a vertex.
#[derive(Debug, PartialEq, Eq)]
pub enum Kind {
    Smooth,
    /// It lies on a crease.
    Crease,
    /// It is a corner, or of no face.
    Stays,
}

impl Around {
    pub fn kind(&self) -> Kind {
        match (self.creases, self.face_count) {
            (_, 0 | 1) | (3.., _) => Kind::Stays,
            (2, _) => Kind::Crease,
            _ => Kind::Smooth,
        }
    }
}

impl Edges {
    pub fn of(cage: &Cage) -> Edges {
        let mut sides: Vec<([u32; 2], u32, u32)> = Vec::with_capacity(cage.corners.len());
        for (number, face) in (0..).zip(cage.faces()) {
            for (at, corner) in face.iter().enumerate() {
                let mut ends = [corner.vertex, face[(at + 1) % face.len()].vertex];
                ends.sort_unstable();
                sides.push((ends, number, sides.len() as u32));
            }
        }
        // By faces among the sides of an edge: the first and the last are the same on every machine.
        sides.sort_unstable();
        let mut edges = Edges { all: Vec::new(), of_corners: vec![0; sides.len()] };
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            let (first, last) = (&same[0], &same[same.len() - 1]);
            for &(_, _, corner) in same {
                edges.of_corners[corner as usize] = edges.all.len() as u32;
            }
            let is_sharp = cage.sharp.binary_search(&first.0).is_ok();
            let (count, faces) = (same.len() as u32, [first.1, last.1]);
            edges.all.push(Edge { vertices: first.0, count, faces, is_sharp });
        }
        edges
    }

    /// What is around each vertex, with something of each face.
    pub fn around(&self, cage: &Cage, of_face: impl Fn(usize) -> DVec3) -> Vec<Around> {
        let mut around = vec![Around::default(); cage.positions.len()];
        for (number, face) in cage.faces().enumerate() {
            for corner in face {
                let around = &mut around[corner.vertex as usize];
                around.faces += of_face(number);
                around.face_count += 1;
            }
        }
        self.ends(cage, &mut around);
        around
    }

    /// Adds the other ends of each vertex's edges.
    pub fn ends(&self, cage: &Cage, around: &mut [Around]) {
        for edge in &self.all {
            let [a, b] = edge.vertices;
            for (own, other) in [(a, b), (b, a)] {
                let (around, place) = (&mut around[own as usize], cage.positions[other as usize]);
                around.neighbours += place;
                around.edges += 1;
                if edge.smooth().is_none() {
                    around.creased += place;
                    around.creases += 1;
                }
            }
        }
    }
}
