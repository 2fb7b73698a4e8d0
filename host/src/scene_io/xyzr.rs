//! Lists of spheres as text: a line holds the center's three coordinates and the radius.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use glam::Vec3;

use super::budget::Budget;
use super::file;
use super::lines::{self, Lines};
use crate::error::{Error, Result};
use crate::scene::Range;
use crate::scene::{Sphere, Unplaced};

/// Reads a file of spheres, all of the material 0.
///
/// # Errors
/// A file that cannot be read, a line that is no sphere, no sphere at all, or more than the budget has room for.
pub fn load(path: &Path, budget: Budget) -> Result<Vec<Sphere>> {
    let file = file::open(path, file::MOST_MESH).map_err(|fault| Error::file(path, fault))?;
    parse(path, BufReader::new(file.take(file::MOST_MESH)), budget)
}

/// The spheres of a text.
pub(super) fn parse(path: &Path, reader: impl BufRead, budget: Budget) -> Result<Vec<Sphere>> {
    let mut lines = Lines::new(path, reader);
    let mut spheres = Vec::new();
    while let Some((number, line)) = lines.advance()? {
        let text = lines::text(line);
        let sphere = sphere(&text).and_then(|sphere| {
            spheres.extend(sphere);
            budget.check_round(spheres.len())
        });
        sphere.map_err(|fault| Error::line(path, number, fault))?;
    }
    match spheres.is_empty() {
        true => Err(Error::file(path, "there is no sphere in it; write one a line, as x y z radius")),
        false => Ok(spheres),
    }
}

/// The sphere of a line, if it is not blank.
fn sphere(line: &str) -> Unplaced<Option<Sphere>> {
    let mut words = lines::words(line);
    let [x, y, z, radius] = [(); 4].map(|()| words.next());
    if x.is_none() {
        return Ok(None);
    }
    let (Some(x), Some(y), Some(z), Some(radius), None) = (x, y, z, radius, words.next()) else {
        let count = lines::words(line).count();
        return Err(format!("a sphere is four numbers, x y z radius, not {count}; correct the line"));
    };
    let number = |word| lines::number("a sphere", word);
    let (center, radius) = (Vec3::new(number(x)?, number(y)?, number(z)?), number(radius)?);
    if !Range::LENGTH.holds(radius) {
        return Err(format!("the sphere's radius must be {}, not {radius}; correct it", Range::LENGTH.says()));
    }
    let sphere = Sphere { center, radius, material: 0 };
    match sphere.fault() {
        Some(fault) => Err(format!("the sphere {fault}")),
        None => Ok(Some(sphere)),
    }
}
