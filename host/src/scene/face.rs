//! The faces of a mesh file: what their corners name is checked, and they are cut into triangles.

use std::io::Write;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::polygon::{Cut, cut};
use super::tally::Tally;
use super::{Unplaced, lines};
use crate::error::Error;

/// What faces may name so far, and what is known of them.
#[derive(Default)]
pub struct Faces {
    /// Of every vertex.
    pub positions: Vec<Vec3>,
    /// How many texture vertices there are.
    pub textures: usize,
    /// How many normals there are.
    pub normals: usize,
    /// How many triangles the faces make.
    pub triangles: usize,
    corners: Vec<Corner>,
    places: Vec<DVec3>,
    crossing: Tally,
    absent: Tally,
}

/// Numbers from 1; the normal's is 0 where there is none.
#[derive(Clone, Copy)]
struct Corner {
    position: usize,
    normal: usize,
}

impl Faces {
    /// Checks the face on a line, and writes for tobj what fills it.
    ///
    /// # Errors
    /// Fewer than three corners, or a corner that names what there is not.
    pub fn read(&mut self, line: usize, rest: &str, text: &mut Vec<u8>) -> Unplaced<()> {
        self.corners.clear();
        for word in lines::words(rest) {
            let corner = self.corner(line, word)?;
            self.corners.push(corner);
        }
        let count = self.corners.len();
        if count < 3 {
            return Err(format!("a face has at least 3 corners, not {count}; remove it"));
        }
        self.places.clear();
        self.places.extend(self.corners.iter().map(|corner| self.positions[corner.position - 1].as_dvec3()));
        match cut(&self.places) {
            Cut::Fan => {
                self.triangles += count - 2;
                write(text, self.corners.iter());
            }
            Cut::Triangles(triangles) => {
                self.triangles += triangles.len();
                for triangle in triangles {
                    write(text, triangle.iter().map(|&corner| &self.corners[corner as usize]));
                }
            }
            Cut::Impossible => self.crossing.add(line, "face"),
        }
        Ok(())
    }

    /// What was ignored.
    pub fn warnings(&self, path: &Path) -> impl Iterator<Item = String> {
        let absent = self.absent.warn(path, "ignored: none precede the face");
        absent.into_iter().chain(self.left_out(path).map(|fault| fault.to_string()))
    }

    /// The faces that cannot be drawn, if there were any.
    pub fn left_out(&self, path: &Path) -> Option<Error> {
        self.crossing.fault(path, "left out: the outline crosses itself; split it into simple polygons")
    }

    fn corner(&mut self, line: usize, word: &str) -> Unplaced<Corner> {
        let mut parts = word.split('/');
        let position = index("vertex", parts.next(), self.positions.len())?;
        self.extra(line, "texture vertex", parts.next(), self.textures)?;
        let normal = self.extra(line, "normal", parts.next(), self.normals)?;
        if position == 0 || parts.next().is_some() {
            return Err(format!("the corner {word:?} is none of v, v/vt, v//vn and v/vt/vn; correct it"));
        }
        Ok(Corner { position, normal })
    }

    /// As [`index`], of what a face can do without: exporters number normals that they do not write.
    fn extra(&mut self, line: usize, what: &str, word: Option<&str>, count: usize) -> Unplaced<usize> {
        match word {
            Some(word) if count == 0 && word.parse().is_ok_and(|number: i64| number != 0) => {
                self.absent.add(line, format_args!("{what} {word}"));
                Ok(0)
            }
            _ => index(what, word, count),
        }
    }
}

/// Writes a polygon, which tobj cuts into a fan.
fn write<'c>(text: &mut Vec<u8>, corners: impl Iterator<Item = &'c Corner>) {
    text.push(b'f');
    for Corner { position, normal } in corners {
        // Writing to a vector does not fail. Normal 1 stands for "flat here".
        let _ = write!(text, " {position}//{}", normal + 1);
    }
    text.push(b'\n');
}

/// An index as a number from 1, of `count` that there are so far; 0 for one that is left out.
fn index(what: &str, word: Option<&str>, count: usize) -> Unplaced<usize> {
    let word = match word {
        None | Some("") => return Ok(0),
        Some(word) => word,
    };
    let Ok(number) = word.parse::<i64>() else {
        return Err(format!("{what} {word:?} is no whole number; correct the face"));
    };
    let absolute = if number < 0 { (count as i64).saturating_add(number).saturating_add(1) } else { number };
    match usize::try_from(absolute) {
        Ok(absolute) if (1..=count).contains(&absolute) => Ok(absolute),
        _ if number == 0 => Err(format!("{what} 0 does not exist; indices count from 1")),
        _ => Err(format!("{what} {word} does not exist, {count} precede the face; correct it")),
    }
}
