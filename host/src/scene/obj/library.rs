//! The materials of the files that a mesh names.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::super::map::Images;
use super::super::material::{DEFAULT, Fields};
use super::super::tally::Tally;
use super::super::{file, mtl};
use super::block::About;
use crate::error::{Error, Result};

/// Materials by number, and the files that they are from.
pub(super) struct Materials {
    pub materials: Vec<(String, Fields)>,
    pub paths: Vec<PathBuf>,
}

/// What is said of them.
pub(super) struct Warnings {
    /// Those of the files.
    pub warnings: Vec<String>,
    /// What the mesh names and no file has, and names that are none.
    pub faults: [Option<String>; 2],
}

/// The material files that were read so far.
pub(super) struct Libraries<'p> {
    /// The mesh file.
    path: &'p Path,
    images: &'p mut Images,
    materials: Vec<(String, Fields)>,
    by_name: HashMap<String, u32>,
    paths: HashSet<PathBuf>,
    missing: Tally,
    lost: Tally,
    nameless: Tally,
    warnings: Vec<String>,
}

impl Materials {
    /// Does any of them have textures?
    pub fn has_maps(&self) -> bool {
        self.materials.iter().any(|(_, fields)| fields.maps.all().next().is_some())
    }
}

impl<'p> Libraries<'p> {
    /// None yet.
    pub fn new(path: &'p Path, images: &'p mut Images) -> Self {
        Libraries {
            path,
            images,
            materials: vec![(DEFAULT.to_owned(), Fields::default())],
            by_name: HashMap::new(),
            paths: HashSet::new(),
            missing: Tally::default(),
            lost: Tally::default(),
            nameless: Tally::default(),
            warnings: Vec::new(),
        }
    }

    /// Follows a statement. Returns the number of the material from there on, which was `material`.
    ///
    /// # Errors
    /// A material file that makes no sense, or a name that is none.
    pub fn event(&mut self, line: usize, what: About, material: u32) -> Result<u32> {
        match what {
            About::Material(name) => Ok(self.material(line, &name)),
            About::Libraries(names) => self.library(line, &names).map(|()| material),
        }
    }

    fn material(&mut self, line: usize, name: &str) -> u32 {
        let number = self.by_name.get(name).copied();
        match number {
            None => self.lost.add(line, format_args!("material {name:?}")),
            Some(_) if name.is_empty() => self.nameless.add(line, "usemtl"),
            Some(_) => {}
        }
        number.unwrap_or(0)
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
        if self.paths.contains(&path) {
            return Ok(true);
        }
        if !path.exists() {
            return Ok(false);
        }
        let library = mtl::load(&path, self.images)?;
        // Paths that differ in dots and slashes are equal.
        self.paths.insert(path);
        self.warnings.extend(library.warnings);
        for (name, fields) in library.materials {
            let number = self.materials.len() as u32;
            self.by_name.insert(name.clone(), number);
            self.materials.push((name, fields));
        }
        Ok(true)
    }

    /// All materials, and what is to be said of them.
    pub fn finish(self) -> (Materials, Warnings) {
        let missing = self.missing.warn(self.path, "not found: its surfaces are grey");
        // A missing file explains the missing materials.
        let lost = self.lost.warn(self.path, "in none of its material files: drawn grey");
        let nameless = self.nameless.warn(self.path, "without a name: it means the material without one");
        let mut paths: Vec<PathBuf> = self.paths.into_iter().collect();
        paths.sort();
        let warnings = Warnings { warnings: self.warnings, faults: [missing.or(lost), nameless] };
        (Materials { materials: self.materials, paths }, warnings)
    }
}
