//! Wavefront meshes, read by all threads: a window of the file at a time, cut into blocks of whole lines, while the next
//! window is read.
//!
//! The lines of a block are counted first, so that each statement knows its line, and what its numbers may name. Blocks
//! are then read side by side, and what they hold is put together in their order: a file gives the same mesh, or the same
//! error, however many threads there are.

mod block;
mod blocks;
mod face;
mod library;
mod vertices;

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use self::block::{About, Before, Block, Event, Notes};
use self::blocks::{Sizes, Windows};
use self::library::Libraries;
use self::vertices::{Attributes, Corners};
use super::Warning;
use super::budget::Budget;
use super::copies::Copies;
use super::face_sizes::FaceSizes;
use super::file;
use super::lines::MOST_LINE;
#[cfg(test)]
use super::load::Loading;
use super::map::Images;
use super::material::Fields;
use super::polygon::Effort;
use crate::error::{Error, Result};
use crate::scene::{Mesh, Object};

/// A mesh, the materials that its triangles index (the first is the default), and what was ignored.
#[derive(Debug, Default)]
pub struct Obj {
    pub mesh: Mesh,
    /// The faces that the mesh is of.
    pub faces: FaceSizes,
    /// Meshes of it that stand in several places.
    pub copies: Copies,
    pub materials: Vec<(String, Fields)>,
    pub warnings: Vec<Warning>,
    /// The material files that were read.
    pub libraries: Vec<PathBuf>,
    /// What it is made of, if the file says so.
    pub objects: Vec<Object>,
}

/// Reads a mesh file, the material files it names and their pictures. A normal is zero where the file has none. It has texture
/// coordinates where a material of its own files has a texture, or where it `is_covered` by those of others.
///
/// # Errors
/// A file that cannot be read, is no mesh, holds no triangle, or more than the budget has room for. A statement that makes no
/// sense is left out with a warning.
pub fn load(path: &Path, budget: Budget, images: &mut Images, is_covered: bool) -> Result<Obj> {
    let file = file::open(path, file::MOST_MESH).map_err(|fault| Error::file(path, fault))?;
    parse_by(Sizes::USUAL, file, Found::new(path, budget, images, is_covered))
}

/// The mesh of a text, with texture coordinates.
#[cfg(test)]
pub(super) fn parse(path: &Path, text: &[u8], budget: Budget) -> Result<Obj> {
    parse_by(
        Sizes::USUAL,
        text,
        Found::new(path, budget, &mut Images::new(file::folder(path), Loading::default()), true),
    )
}

fn parse_by(sizes: Sizes, source: impl Read + Send, mut found: Found) -> Result<Obj> {
    let path = found.path;
    let unread = |error: io::Error| Error::file(path, file::explain(&error));
    let mut windows = Windows::new(source, sizes.window);
    // Memory that was used before is there sooner than new one.
    let (mut window, mut next) = (Vec::new(), Vec::new());
    windows.read(&mut window).map_err(unread)?;
    while !window.is_empty() {
        let blocks = blocks::of(&window, sizes.block);
        // A block is longer only if it is one line, which is refused for it.
        let texts = blocks.iter().map(|block| &block[..block.len().min(sizes.block + MOST_LINE + 1)]).collect();
        let (found, read) = rayon::join(|| found.read(texts), || windows.read(&mut next));
        found?;
        read.map_err(unread)?;
        std::mem::swap(&mut window, &mut next);
    }
    found.finish()
}

/// What the blocks so far hold.
struct Found<'p> {
    path: &'p Path,
    budget: Budget,
    is_covered: bool,
    before: Before,
    positions: Vec<Vec3>,
    /// Of every position, or none at all.
    colours: Vec<Vec3>,
    normals: Vec<Vec3>,
    coordinates: Vec<Vec2>,
    corners: Corners,
    faces: FaceSizes,
    /// The smoothing group of the next faces.
    group: u32,
    /// Of every triangle.
    materials: Vec<u32>,
    /// That of the next faces.
    material: u32,
    effort: Effort,
    libraries: Libraries<'p>,
    notes: Notes,
}

impl<'p> Found<'p> {
    fn new(path: &'p Path, budget: Budget, images: &'p mut Images, is_covered: bool) -> Self {
        Found {
            path,
            budget,
            is_covered,
            before: Before::default(),
            positions: Vec::new(),
            colours: Vec::new(),
            normals: Vec::new(),
            coordinates: Vec::new(),
            corners: Corners::default(),
            faces: FaceSizes::default(),
            group: 0,
            materials: Vec::new(),
            material: 0,
            effort: Effort::default(),
            libraries: Libraries::new(path, images),
            notes: Notes::default(),
        }
    }

    /// Reads the blocks of a window.
    fn read(&mut self, texts: Vec<&[u8]>) -> Result<()> {
        let is_first = |number| number == 0 && self.before == Before::default();
        let count = |(number, text): (usize, &&[u8])| Before::count(self.path, text, is_first(number));
        let counts: Vec<Before> = texts.par_iter().enumerate().map(count).collect();
        let mut before = Vec::with_capacity(texts.len());
        for count in counts {
            before.push(self.before);
            self.before = self.before.and(count);
        }
        let mut blocks: Vec<Block> =
            texts.par_iter().zip(&before).map(|(text, &before)| Block::read(self.path, text, before)).collect();
        if let Some(last) = blocks.iter().position(|block| block.fault.is_some()) {
            blocks.truncate(last + 1);
        }
        for block in &blocks {
            if !block.colours.is_empty() || !self.colours.is_empty() {
                self.colours.resize(self.positions.len(), Vec3::ONE);
                self.colours.extend_from_slice(&block.colours);
            }
            self.positions.extend_from_slice(&block.positions);
            self.normals.extend_from_slice(&block.normals);
            self.coordinates.extend_from_slice(&block.coordinates);
        }
        blocks.par_iter_mut().for_each(|block| block.faces.cut(&self.positions, &self.effort));
        self.effort.check().map_err(|fault| Error::file(self.path, fault))?;
        for ((block, text), before) in blocks.into_iter().zip(texts).zip(before) {
            self.add(block, text, before)?;
        }
        Ok(())
    }

    /// Adds a block's faces, by the materials that its statements name.
    fn add(&mut self, mut block: Block, text: &[u8], before: Before) -> Result<()> {
        let triangles = block.faces.triangles.len();
        let vertices = before.positions + block.positions.len();
        if self.budget.check(self.corners.len() + triangles, vertices).is_err() {
            let fits =
                |more: usize, positions| self.budget.check(self.corners.len() + more, before.positions + positions);
            block.end_where_full(self.path, text, before, fits);
        }
        self.corners.extend(&block.faces.triangles);
        self.faces.extend(block.faces.ends());
        for Event { line, face, what } in std::mem::take(&mut block.events) {
            // Those of the faces before.
            let triangles = self.corners.len() - triangles + block.faces.triangles_before(face);
            self.materials.resize(triangles, self.material);
            self.material = self.libraries.event(line, &what, self.material)?;
            if let About::Smoothing(group) = what {
                self.corners.group(triangles, std::mem::replace(&mut self.group, group));
            }
        }
        self.corners.group(self.corners.len(), self.group);
        self.materials.resize(self.corners.len(), self.material);
        self.notes.append(block.notes, block.faces);
        block.fault.map_or(Ok(()), Err)
    }

    /// What was found, once all is read.
    ///
    /// # Errors
    /// There was no face.
    fn finish(self) -> Result<Obj> {
        let Found {
            path,
            is_covered,
            positions,
            mut colours,
            mut normals,
            coordinates,
            mut corners,
            faces,
            materials,
            libraries,
            notes,
            ..
        } = self;
        if corners.len() == 0 {
            let none = || Error::file(path, "there is no face in it; is it a Wavefront OBJ mesh?");
            return Err(notes.no_face(path).unwrap_or_else(none));
        }
        let (mut libraries, of_libraries) = libraries.finish();
        if !is_covered && !libraries.has_maps() {
            corners.uncover();
        }
        corners.smooth(&positions, &mut normals);
        if !colours.is_empty() {
            colours.resize(positions.len(), Vec3::ONE);
            // Vertices say what colour it is.
            libraries.materials[0].1.diffuse = Some(Vec3::ONE);
        }
        let attributes =
            Attributes { positions: &positions, colours: &colours, normals: &normals, coordinates: &coordinates };
        let [latin, others @ ..] = notes.warnings(path);
        let [missing, nameless] = of_libraries.faults;
        let warnings = [latin, missing, nameless].into_iter().chain(others).flatten();
        Ok(Obj {
            faces,
            copies: Copies::default(),
            mesh: corners.mesh(attributes, materials),
            materials: libraries.materials,
            warnings: of_libraries.warnings.into_iter().chain(warnings).collect(),
            libraries: libraries.paths,
            objects: Vec::new(),
        })
    }
}

#[cfg(test)]
mod tests;
