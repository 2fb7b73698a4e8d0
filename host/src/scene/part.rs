//! A `[[mesh]]` of a TOML scene: a file or a shape, and where it goes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::budget::Budget;
use super::material::{DEFAULT, Fields};
use super::obj::{self, Obj};
use super::range::Range;
use super::table::Table;
use super::transform::Transform;
use super::{Mesh, Part, file, normal, shape};
use crate::error::Result;

/// Meshes of files already read, since a scene may place one many times, and what is left for others.
pub struct Files<'p> {
    folder: &'p Path,
    budget: Budget,
    read: HashMap<PathBuf, Obj>,
    /// What was ignored in them.
    pub warnings: Vec<String>,
    /// Every file that was read, material files too.
    pub paths: Vec<PathBuf>,
}

/// A mesh in place, and the materials that its triangles index.
pub struct Placed {
    /// The file as the scene names it, or the shape's word.
    pub name: String,
    pub mesh: Mesh,
    pub materials: Vec<(String, Fields)>,
    /// This one instead of them all.
    pub material: Option<String>,
}

impl Placed {
    /// What users are told of the part whose triangles these are.
    pub fn part(&self, triangles: std::ops::Range<usize>) -> Part {
        let name = match &self.material {
            Some(material) => format!("{} ({material})", self.name),
            None => self.name.clone(),
        };
        Part { name, triangles, bounds: self.mesh.bounds() }
    }
}

impl<'p> Files<'p> {
    /// The files that a scene in `folder` names, all within the budget.
    pub fn new(folder: &'p Path, budget: Budget) -> Self {
        Files { folder, budget, read: HashMap::new(), warnings: Vec::new(), paths: Vec::new() }
    }

    fn load(&mut self, name: &str) -> Result<&Obj> {
        let path = self.folder.join(name);
        if !self.read.contains_key(&path) {
            let mut obj = obj::load(&path, self.budget)?;
            self.warnings.append(&mut obj.warnings);
            self.paths.push(path.clone());
            self.paths.append(&mut obj.libraries);
            self.read.insert(path.clone(), obj);
        }
        Ok(&self.read[&path])
    }
}

/// Reads a `[[mesh]]` table, but for refusing unknown keys.
///
/// # Errors
/// A file that cannot be read, no file and no shape or both, a number out of range, or a transform that
/// leads out of single precision.
pub fn read(table: &mut Table, files: &mut Files) -> Result<Placed> {
    let material = table.name("material")?;
    let smooth = table.flag("smooth")?;
    let transform = Transform::read(table)?;
    let (name, mut mesh, materials) = source(table, files)?;
    match smooth {
        Some(true) => normal::smooth(&mut mesh),
        Some(false) => mesh.normals.clear(),
        None => {}
    }
    if let Some(transform) = transform {
        transform.apply(&mut mesh);
    }
    if !mesh.positions.iter().all(|position| position.is_finite()) {
        return Err(table.fault("the mesh leaves the range of single precision; make it smaller"));
    }
    files.budget.take(&mesh);
    Ok(Placed { name, mesh, materials, material })
}

type Source = (String, Mesh, Vec<(String, Fields)>);

fn source(table: &mut Table, files: &mut Files) -> Result<Source> {
    match (table.has("file"), table.has("shape")) {
        (true, false) => from_file(table, files),
        (false, true) => {
            let (word, mesh) = from_shape(table, files.budget)?;
            Ok((word.into(), mesh, vec![(DEFAULT.into(), Fields::default())]))
        }
        (true, true) => Err(table.fault_of("shape", "a mesh is a file or a shape; remove the one")),
        (false, false) => Err(table.fault("[[mesh]] needs \"file\" or \"shape\"; add one")),
    }
}

fn from_file(table: &mut Table, files: &mut Files) -> Result<Source> {
    table.rename("a mesh of a file");
    let name = table.name("file")?;
    let name = table.need("file", name)?;
    let path = files.folder.join(&name);
    // What is wrong with the name is the scene's fault, what is in the file is the mesh's.
    file::open(&path, file::MOST_MESH)
        .map_err(|fault| table.fault_of("file", format!("{}: {fault}", path.display())))?;
    if !is(&path, "obj") {
        let fault = format!("{name:?} is no .obj; meshes are Wavefront OBJ files");
        return Err(table.fault_of("file", fault));
    }
    let budget = files.budget;
    let obj = files.load(&name)?;
    let (triangles, vertices) = (obj.mesh.triangles.len(), obj.mesh.positions.len());
    budget.check(triangles, vertices).map_err(|fault| table.fault(fault))?;
    Ok((name, obj.mesh.clone(), obj.materials.clone()))
}

/// Does the path end like this, in capitals or not?
pub fn is(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case(extension))
}

#[derive(Clone, Copy)]
enum Shape {
    Sphere,
    Quad,
    Box,
}

fn from_shape(table: &mut Table, budget: Budget) -> Result<(&'static str, Mesh)> {
    let words = [("sphere", Shape::Sphere), ("quad", Shape::Quad), ("box", Shape::Box)];
    let shape = table.word("shape", &words)?;
    match table.need("shape", shape)? {
        Shape::Sphere => {
            table.rename("a sphere");
            let center = table.triple("center", Range::ANY)?.unwrap_or(Vec3::ZERO);
            let radius = table.number("radius", Range::LENGTH)?.unwrap_or(1.0);
            let subdivisions = table.whole("subdivisions", 0, 8)?.unwrap_or(5);
            let triangles = 20 << (2 * subdivisions);
            budget.check(triangles, triangles / 2 + 2).map_err(|fault| table.fault(fault))?;
            Ok(("sphere", shape::sphere(center, radius, subdivisions)))
        }
        Shape::Quad => {
            table.rename("a quad");
            let corners = table.corners("corners")?;
            Ok(("quad", shape::quad(table.need("corners", corners)?)))
        }
        Shape::Box => {
            table.rename("a box");
            let min = table.triple("min", Range::ANY)?;
            let min = table.need("min", min)?;
            let max = table.triple("max", Range::ANY)?;
            let max = table.need("max", max)?;
            if !min.cmplt(max).all() {
                let fault = "the box's max is not above its min on every axis; swap them";
                return Err(table.fault_of("max", fault));
            }
            Ok(("box", shape::cuboid(min, max)))
        }
    }
}
