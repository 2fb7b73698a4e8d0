//! The materials of the files that a mesh names.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::super::map::Images;
use super::super::material::{DEFAULT, Fields};
use super::super::mtl;
use super::super::neighbours::Neighbours;
use super::super::tally::Tally;
use super::super::{Warning, WarningKind};
use super::block::About;
use crate::error::Result;

/// Materials by number, and the files that they are from.
pub(super) struct Materials {
    pub materials: Vec<(String, Fields)>,
    pub paths: Vec<PathBuf>,
}

/// What is said of them.
pub(super) struct Warnings {
    /// Those of the files.
    pub warnings: Vec<Warning>,
    /// What the mesh names and no file has, and names that are none.
    pub faults: [Option<Warning>; 2],
}

/// The material files that were read so far.
pub(super) struct Libraries<'p> {
    /// The mesh file.
    path: &'p Path,
    images: &'p mut Images,
    neighbours: Neighbours,
    materials: Vec<(String, Fields)>,
    by_name: HashMap<String, u32>,
    /// Numbers of materials that no file had when they were named; one may still come.
    waiting: HashMap<String, u32>,
    /// Where they were named, and their numbers.
    named: Vec<(usize, u32)>,
    paths: HashSet<PathBuf>,
    missing: Tally,
    nameless: Tally,
    warnings: Vec<Warning>,
}

impl Materials {
    /// Does any of them have textures?
    pub fn has_maps(&self) -> bool {
        self.materials.iter().any(|(_, fields)| fields.has_maps())
    }
}

impl<'p> Libraries<'p> {
    /// None yet.
    pub fn new(path: &'p Path, images: &'p mut Images) -> Self {
        Libraries {
            path,
            neighbours: Neighbours::new(path, images.loading.allow_outside),
            images,
            materials: vec![(DEFAULT.to_owned(), Fields::default())],
            by_name: HashMap::new(),
            waiting: HashMap::new(),
            named: Vec::new(),
            paths: HashSet::new(),
            missing: Tally::default(),
            nameless: Tally::default(),
            warnings: Vec::new(),
        }
    }

    /// Follows a statement. Returns the number of the material from there on, which was `material`.
    ///
    /// # Errors
    /// A material file that cannot be read.
    pub fn event(&mut self, line: usize, what: &About, material: u32) -> Result<u32> {
        match what {
            About::Material(name) => Ok(self.material(line, name)),
            About::Libraries(names) => self.library(line, names).map(|()| material),
            About::Smoothing(_) => Ok(material),
        }
    }

    fn material(&mut self, line: usize, name: &str) -> u32 {
        if let Some(&number) = self.by_name.get(name) {
            if name.is_empty() {
                self.nameless.add(line, "usemtl");
            }
            return number;
        }
        let number = match self.waiting.get(name) {
            Some(&number) => number,
            None => {
                let number = self.materials.len() as u32;
                self.materials.push((DEFAULT.to_owned(), Fields::default()));
                self.waiting.insert(name.to_owned(), number);
                number
            }
        };
        self.named.push((line, number));
        number
    }

    fn library(&mut self, line: usize, names: &str) -> Result<()> {
        // The format lists files between blanks, but exporters write names that hold blanks.
        if names.is_empty() {
            self.missing.add(line, "material file \"\"");
        } else if !self.material_file(names)? {
            for name in listed(names) {
                if !self.material_file(&name)? {
                    self.missing.add(line, format_args!("material file {name:?}"));
                }
            }
        }
        Ok(())
    }

    /// Reads a material file once; false if there is none.
    fn material_file(&mut self, name: &str) -> Result<bool> {
        let Some(path) = self.neighbours.find(name) else { return Ok(false) };
        if self.paths.contains(&path) {
            return Ok(true);
        }
        let library = mtl::load(&path, self.images)?;
        // Paths that differ in dots and slashes are equal.
        self.paths.insert(path);
        self.warnings.extend(library.warnings);
        for (name, fields) in library.materials {
            let number = match self.waiting.remove(&name) {
                Some(number) => {
                    self.materials[number as usize] = (name.clone(), fields);
                    number
                }
                None => {
                    self.materials.push((name.clone(), fields));
                    self.materials.len() as u32 - 1
                }
            };
            self.by_name.insert(name, number);
        }
        Ok(true)
    }

    /// All materials, and what is to be said of them.
    pub fn finish(self) -> (Materials, Warnings) {
        let missing = self.missing.warn(WarningKind::Missing, self.path, "not found: its surfaces are grey");
        let names: HashMap<u32, &str> = self.waiting.iter().map(|(name, &number)| (number, name.as_str())).collect();
        let mut lost = Tally::default();
        for (line, number) in &self.named {
            if let Some(name) = names.get(number) {
                lost.add(*line, format_args!("material {name:?}"));
            }
        }
        // A missing file explains the missing materials.
        let lost = lost.warn(WarningKind::Missing, self.path, "in none of its material files: drawn grey");
        let nameless =
            self.nameless.warn(WarningKind::Changed, self.path, "without a name: it means the material without one");
        let mut paths: Vec<PathBuf> = self.paths.into_iter().collect();
        paths.sort();
        let warnings = Warnings { warnings: self.warnings, faults: [missing.or(lost), nameless] };
        (Materials { materials: self.materials, paths }, warnings)
    }
}

/// The names of a list between blanks that no backslash stands before.
fn listed(names: &str) -> Vec<String> {
    const BLANK: &str = "\u{0}";
    let words = names.replace("\\ ", BLANK);
    words.split_whitespace().map(|word| word.replace(BLANK, " ")).collect()
}
