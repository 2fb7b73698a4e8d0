//! Wavefront meshes: tobj reads what a validating reader lets through.
//!
//! tobj reports no lines, takes NaN for a coordinate, wraps indices, confuses normals where only some
//! corners have them, and draws polylines as faces. So it is given a text of our own: checked
//! positions, normals behind one zero normal for the corners without, faces of absolute indices, and
//! objects named by the number of their material.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::budget::Budget;
use super::checked::Checked;
use super::material::Fields;
use super::normal::unit;
use super::{Mesh, file};
use crate::error::{Error, Result};

/// A mesh, the materials that its triangles index (the first is the default), and what was ignored.
#[derive(Debug)]
pub struct Obj {
    pub mesh: Mesh,
    pub materials: Vec<(String, Fields)>,
    pub warnings: Vec<String>,
    /// The material files that were read.
    pub libraries: Vec<PathBuf>,
}

/// Reads a mesh file and the material files it names. A normal is zero where the file has none.
///
/// # Errors
/// A file that cannot be read, is no mesh, names what does not exist, holds no triangle, or more than the budget
/// has room for.
pub fn load(path: &Path, budget: Budget) -> Result<Obj> {
    let file = file::open(path, file::MOST_MESH).map_err(|fault| Error::file(path, fault))?;
    parse(path, BufReader::new(file.take(file::MOST_MESH)), budget)
}

/// The mesh of a text.
pub(super) fn parse(path: &Path, reader: impl BufRead, budget: Budget) -> Result<Obj> {
    let mut checked = Checked::new(path, reader, budget);
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let models = tobj::load_obj_buf(&mut checked, &options, |_| Ok(Default::default()));
    let found = checked.finish()?;
    let (models, _) = models.map_err(|error| Error::file(path, format!("no mesh: {error}")))?;
    let mut mesh = Mesh::default();
    for model in models {
        append(&mut mesh, &model);
    }
    if mesh.normals.iter().all(|&normal| normal == Vec3::ZERO) {
        mesh.normals.clear();
    }
    Ok(Obj { mesh, materials: found.materials, warnings: found.warnings, libraries: found.libraries })
}

/// Adds one of tobj's models, whose name is the number of its material.
fn append(mesh: &mut Mesh, model: &tobj::Model) {
    let first = mesh.positions.len() as u32;
    let part = &model.mesh;
    let vector = |xyz: &[f32; 3]| Vec3::from_array(*xyz);
    let (positions, _) = part.positions.as_chunks();
    let (normals, _) = part.normals.as_chunks();
    let (triangles, _) = part.indices.as_chunks();
    mesh.positions.extend(positions.iter().map(vector));
    let normals = normals.iter().map(vector);
    mesh.normals.extend(normals.map(|normal| unit(normal.as_dvec3())));
    mesh.triangles.extend(triangles.iter().map(|&[a, b, c]| [first + a, first + b, first + c]));
    let material = model.name.parse().unwrap_or(0);
    mesh.materials.resize(mesh.triangles.len(), material);
}
