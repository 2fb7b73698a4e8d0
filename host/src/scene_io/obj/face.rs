//! The faces of a block: what their corners name is checked, and they are cut into triangles.

use glam::{DVec3, Vec3};

use super::super::lines;
use super::super::polygon::{Cut, Effort};
use super::super::tally::Tally;
use super::block::Before;
use crate::scene::Unplaced;

/// Numbers from 1; those of the normal and of the texture coordinates are 0 where there are none.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub position: u32,
    pub normal: u32,
    pub coordinates: u32,
}

/// A face, and where its corners and its triangles end.
struct Face {
    line: usize,
    corners: usize,
    triangles: usize,
}

/// The faces of a block.
pub(super) struct Faces {
    /// What the next face may name.
    pub before: Before,
    /// What fills them, once they are [`cut`](Faces::cut).
    pub triangles: Vec<[Corner; 3]>,
    /// What corners name of which there is nothing.
    pub absent: Tally,
    /// Faces of vertices that make no sense.
    pub lost: Tally,
    /// Faces that no triangles fill.
    pub crossing: Tally,
    corners: Vec<Corner>,
    faces: Vec<Face>,
}

impl Faces {
    /// None yet, of a block with so much before it.
    pub fn after(before: Before) -> Self {
        Faces {
            before,
            triangles: Vec::new(),
            absent: Tally::default(),
            lost: Tally::default(),
            crossing: Tally::default(),
            corners: Vec::new(),
            faces: Vec::new(),
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.faces.len()
    }

    /// Where the triangles of each end, once they are [`cut`](Faces::cut).
    pub fn ends(&self) -> impl Iterator<Item = usize> {
        self.faces.iter().map(|face| face.triangles)
    }

    /// How many triangles the first faces make.
    pub fn triangles_before(&self, faces: usize) -> usize {
        faces.checked_sub(1).map_or(0, |last| self.faces[last].triangles)
    }

    /// Checks the face on a line.
    ///
    /// # Errors
    /// Fewer than three corners, or a corner that names what there is not. The face counts, and has no corners.
    pub fn read(&mut self, line: usize, rest: &str) -> Unplaced<()> {
        let first = self.corners.len();
        let read = self.corners(line, rest);
        if read.is_err() {
            self.corners.truncate(first);
        }
        self.faces.push(Face { line, corners: self.corners.len(), triangles: 0 });
        read
    }

    fn corners(&mut self, line: usize, rest: &str) -> Unplaced<()> {
        let first = self.corners.len();
        for word in lines::words(rest) {
            let corner = self.corner(line, word)?;
            self.corners.push(corner);
        }
        match self.corners.len() - first {
            count @ 0..3 => Err(format!("a face has at least 3 corners, not {count}; remove it")),
            _ => Ok(()),
        }
    }

    /// Cuts all into triangles, given the positions up to the end of the block.
    pub fn cut(&mut self, positions: &[Vec3], effort: &Effort) {
        self.triangles.reserve(self.corners.len().saturating_sub(2 * self.faces.len()));
        let (mut first, mut places): (usize, Vec<DVec3>) = (0, Vec::new());
        for face in &mut self.faces {
            let corners = &self.corners[first..face.corners];
            first = face.corners;
            let is_lost = |corner: &Corner| !positions[corner.position as usize - 1].is_finite();
            if corners.iter().any(is_lost) {
                self.lost.add(face.line, "face");
            } else if let [a, b, c] = *corners {
                self.triangles.push([a, b, c]);
            } else if !corners.is_empty() {
                places.clear();
                places.extend(corners.iter().map(|corner| positions[corner.position as usize - 1].as_dvec3()));
                match effort.cut(&places) {
                    Cut::Fan => {
                        let edges = corners[1..].windows(2);
                        self.triangles.extend(edges.map(|edge| [corners[0], edge[0], edge[1]]));
                    }
                    Cut::Triangles(triangles) => {
                        let corner = |number: u32| corners[number as usize];
                        self.triangles.extend(triangles.into_iter().map(|triangle| triangle.map(corner)));
                    }
                    Cut::Impossible => self.crossing.add(face.line, "face"),
                }
            }
            face.triangles = self.triangles.len();
        }
    }

    fn corner(&mut self, line: usize, word: &str) -> Unplaced<Corner> {
        let mut parts = word.split('/');
        let position = index("vertex", parts.next(), self.before.positions)?;
        let coordinates = self.extra(line, "texture vertex", parts.next(), self.before.textures)?;
        let normal = self.extra(line, "normal", parts.next(), self.before.normals)?;
        if position == 0 || parts.next().is_some() {
            return Err(format!("the corner {word:?} is none of v, v/vt, v//vn and v/vt/vn; correct it"));
        }
        Ok(Corner { position, normal, coordinates })
    }

    /// As [`index`], of what a face can do without: exporters number normals that they do not write, or all by 0.
    fn extra(&mut self, line: usize, what: &str, word: Option<&str>, count: usize) -> Unplaced<u32> {
        index(what, word, count).or_else(|fault| match word {
            Some(word) if word.parse::<i64>().is_ok() => {
                self.absent.add(line, format_args!("{what} {word}"));
                Ok(0)
            }
            _ => Err(fault),
        })
    }
}

/// An index as a number from 1, of `count` that there are so far; 0 for one that is left out. A file of 4 GiB has no more
/// than 32 bits can number.
fn index(what: &str, word: Option<&str>, count: usize) -> Unplaced<u32> {
    let word = match word {
        None | Some("") => return Ok(0),
        Some(word) => word,
    };
    let Ok(number) = word.parse::<i64>() else {
        return Err(format!("{what} {word:?} is no whole number; correct the face"));
    };
    let absolute = if number < 0 { (count as i64).saturating_add(number).saturating_add(1) } else { number };
    match u32::try_from(absolute) {
        Ok(absolute) if (1..=count).contains(&(absolute as usize)) => Ok(absolute),
        _ if number == 0 => Err(format!("{what} 0 does not exist; indices count from 1")),
        _ => Err(format!("{what} {word} does not exist, {count} precede the face; correct it")),
    }
}
