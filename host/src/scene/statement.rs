//! The statements of a mesh file, checked one by one and written anew for tobj.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::io::Write;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::budget::Budget;
use super::face::Faces;
use super::lines::{self, NOT_UTF8};
use super::material::{DEFAULT, Fields};
use super::tally::Tally;
use super::{Unplaced, file, mtl};
use crate::error::{Error, Result};

/// What the lines hold besides the mesh.
pub struct Found {
    /// By the numbers that the objects in the text are named by.
    pub materials: Vec<(String, Fields)>,
    pub warnings: Vec<String>,
    /// The material files that were read, by name.
    pub libraries: Vec<PathBuf>,
}

/// What has been seen so far, and the text that comes of it.
pub struct State<'p> {
    /// The file, which errors name.
    pub path: &'p Path,
    /// What is written; the reader takes it away.
    pub text: Vec<u8>,
    faces: Faces,
    budget: Budget,
    material: u32,
    materials: Vec<(String, Fields)>,
    by_name: HashMap<String, u32>,
    libraries: HashSet<PathBuf>,
    missing: Tally,
    lost: Tally,
    unknown: Tally,
    nameless: Tally,
    latin: Tally,
    warnings: Vec<String>,
}

impl<'p> State<'p> {
    /// Nothing yet of a mesh within the budget.
    pub fn new(path: &'p Path, budget: Budget) -> Self {
        State {
            path,
            // Normal 1 stands for "flat here", and object 0 has the default material.
            text: b"vn 0 0 0\no 0\n".to_vec(),
            faces: Faces::default(),
            budget,
            material: 0,
            materials: vec![(DEFAULT.to_owned(), Fields::default())],
            by_name: HashMap::new(),
            libraries: HashSet::new(),
            missing: Tally::default(),
            lost: Tally::default(),
            unknown: Tally::default(),
            nameless: Tally::default(),
            latin: Tally::default(),
            warnings: Vec::new(),
        }
    }

    /// Checks a line and writes what tobj shall see of it.
    ///
    /// # Errors
    /// The line, or the material file that it names, makes no sense.
    pub fn line(&mut self, number: usize, line: &[u8]) -> Result<()> {
        let text = lines::text(line);
        if let Cow::Owned(_) = text {
            self.latin.add(number, "line");
        }
        let Some((key, rest)) = lines::split(&text) else {
            return Ok(());
        };
        let fault = match key {
            "v" => self.position(rest),
            "vn" => self.normal(rest),
            "f" | "fo" => self.face(number, rest),
            "usemtl" => {
                self.use_material(number, rest);
                Ok(())
            }
            "mtllib" => return self.library(number, rest),
            "vt" => {
                self.faces.textures += 1;
                Ok(())
            }
            "o" | "g" | "s" | "l" | "p" => Ok(()),
            _ => {
                self.unknown.add(number, format_args!("statement {key:?}"));
                Ok(())
            }
        };
        fault.map_err(|fault| Error::line(self.path, number, fault))
    }

    fn position(&mut self, rest: &str) -> Unplaced<()> {
        // What follows is a weight or a colour, and tobj would divide by the one and want the other
        // on all vertices or none.
        let xyz = three("v", rest)?;
        let [x, y, z] = xyz.map(|word| lines::number("v", word));
        self.faces.positions.push(Vec3::new(x?, y?, z?));
        self.vector("v", xyz);
        self.budget.check(self.faces.triangles, self.faces.positions.len())
    }

    fn normal(&mut self, rest: &str) -> Unplaced<()> {
        self.faces.normals += 1;
        let mut xyz = three("vn", rest)?;
        for word in xyz {
            match word.parse::<f32>() {
                Ok(number) if number.is_finite() => {}
                // Exporters write NaN for the normal of a face without area: it is flat.
                Ok(_) => xyz = ["0"; 3],
                Err(_) => return lines::number("vn", word).map(drop),
            }
        }
        self.vector("vn", xyz);
        Ok(())
    }

    fn vector(&mut self, key: &str, xyz: [&str; 3]) {
        self.text.extend_from_slice(key.as_bytes());
        for word in xyz {
            self.text.push(b' ');
            self.text.extend_from_slice(word.as_bytes());
        }
        self.text.push(b'\n');
    }

    fn face(&mut self, line: usize, rest: &str) -> Unplaced<()> {
        self.faces.read(line, rest, &mut self.text)?;
        self.budget.check(self.faces.triangles, self.faces.positions.len())
    }

    fn use_material(&mut self, line: usize, name: &str) {
        let number = self.by_name.get(name).copied();
        match number {
            None => self.lost.add(line, format_args!("material {name:?}")),
            Some(_) if name.is_empty() => self.nameless.add(line, "usemtl"),
            Some(_) => {}
        }
        let number = number.unwrap_or(0);
        if number != self.material {
            self.material = number;
            let _ = writeln!(self.text, "o {number}");
        }
    }

    fn library(&mut self, line: usize, names: &str) -> Result<()> {
        if names.is_empty() {
            let fault = "mtllib names no file; add a name";
            return Err(Error::line(self.path, line, fault));
        }
        // The format lists files between blanks, but exporters write names that hold blanks.
        if self.material_file(line, names)? {
            return Ok(());
        }
        for name in names.split_whitespace() {
            if !self.material_file(line, name)? {
                self.missing.add(line, format_args!("material file {name:?}"));
            }
        }
        Ok(())
    }

    /// Reads a material file once; false if there is none.
    fn material_file(&mut self, line: usize, name: &str) -> Result<bool> {
        let path = file::inside(file::folder(self.path), name).map_err(|fault| Error::line(self.path, line, fault))?;
        if self.libraries.contains(&path) {
            return Ok(true);
        }
        if !path.exists() {
            return Ok(false);
        }
        let library = mtl::load(&path)?;
        // Paths that differ in dots and slashes are equal.
        self.libraries.insert(path);
        self.warnings.extend(library.warnings);
        for (name, fields) in library.materials {
            let number = self.materials.len() as u32;
            self.by_name.insert(name.clone(), number);
            self.materials.push((name, fields));
        }
        Ok(true)
    }

    /// What was found, once all lines are read.
    ///
    /// # Errors
    /// There was no face.
    pub fn finish(mut self) -> Result<Found> {
        if self.faces.triangles == 0 {
            let none = || Error::file(self.path, "there is no face in it; is it a Wavefront OBJ mesh?");
            return Err(self.faces.left_out(self.path).unwrap_or_else(none));
        }
        let missing = self.missing.warn(self.path, "not found: its surfaces are grey");
        // A missing file explains the missing materials.
        let lost = self.lost.warn(self.path, "in none of its material files: drawn grey");
        let warnings = [
            self.latin.warn(self.path, NOT_UTF8),
            missing.or(lost),
            self.nameless.warn(self.path, "without a name: it means the material without one"),
            self.unknown.warn(self.path, "ignored: only polygons are read"),
        ];
        self.warnings.extend(warnings.into_iter().flatten());
        self.warnings.extend(self.faces.warnings(self.path));
        let mut libraries: Vec<PathBuf> = self.libraries.into_iter().collect();
        libraries.sort();
        Ok(Found { materials: self.materials, warnings: self.warnings, libraries })
    }
}

fn three<'r>(key: &str, rest: &'r str) -> Unplaced<[&'r str; 3]> {
    let mut words = lines::words(rest);
    match (words.next(), words.next(), words.next()) {
        (Some(x), Some(y), Some(z)) => Ok([x, y, z]),
        _ => Err(format!("{key} takes three numbers, not {rest:?}; add what is missing")),
    }
}
