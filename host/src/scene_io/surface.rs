//! What a `[[mesh]]` makes of its mesh: a smooth surface, and one that a picture moves.

use super::budget::Budget;
use super::copies::Copies;
use super::face_sizes::FaceSizes;
use super::files::Files;
use super::geometry::Geometry;
use super::table::Table;
use crate::error::Result;
use crate::scene::displace::{self, Heights};
use crate::scene::subdivide::{self, Cage, Subdivision};
use crate::scene::{Mesh, Range, Unplaced};

/// What is said of a surface.
pub struct Surface {
    subdivision: Option<Subdivision>,
    displacement: Option<Displacement>,
}

/// How far a picture moves it.
struct Displacement {
    heights: Heights,
    /// In the mesh's own units, for a height of one.
    factor: f32,
    /// The height that stays.
    middle: f32,
}

/// What is wrong with a key.
type Fault = (&'static str, String);

impl Surface {
    /// Reads the keys of a table.
    ///
    /// # Errors
    /// A number out of range, or a picture that can't be read.
    pub fn read(table: &mut Table, files: &mut Files) -> Result<Surface> {
        let levels = table.whole("subdivide", 1, 8)?;
        let crease = table.number("crease", Range::TURN)?;
        if levels.is_none() && crease.is_some() {
            let fault = "\"crease\" is of a surface that is divided; add \"subdivide\"";
            return Err(table.fault_of("crease", fault));
        }
        let subdivision = levels.map(|levels| Subdivision { levels, crease });
        Ok(Surface { subdivision, displacement: displacement(table, files)? })
    }

    /// Puts it in the place of meshes, and tells whether that changes their triangles.
    ///
    /// # Errors
    /// What has no such surface, or is too much.
    pub fn put(
        &self,
        (geometry, faces): (&mut Geometry, &FaceSizes),
        copies: &mut Copies,
        budget: &Budget,
    ) -> std::result::Result<bool, Fault> {
        let mut all: Vec<(&mut Mesh, &[u32])> = copies.meshes.iter_mut().map(|mesh| (mesh, &[][..])).collect();
        if let Geometry::Mesh(mesh) = geometry {
            all.push((mesh, faces.sizes()));
        } else if self.subdivision.is_some() {
            return Err(("subdivide", "it is round already; leave \"subdivide\" out".into()));
        } else if self.displacement.is_some() {
            return Err(("displace", "it has no vertices that can be moved; \"tessellate\" it".into()));
        }
        for (mesh, faces) in all.into_iter().filter(|(mesh, _)| !mesh.triangles.is_empty()) {
            if let Some(how) = self.subdivision {
                divide(mesh, faces, how, budget).map_err(|why| ("subdivide", why))?;
            }
            if let Some(displacement) = &self.displacement {
                displacement.displace(mesh).map_err(|why| ("displace", why))?;
            }
        }
        Ok(self.subdivision.is_some())
    }
}

fn divide(mesh: &mut Mesh, faces: &[u32], how: Subdivision, budget: &Budget) -> Unplaced<()> {
    let cage = Cage::of(mesh, faces);
    let (triangles, vertices) = subdivide::size(&cage, how.levels);
    budget.check(triangles, vertices)?;
    *mesh = subdivide::subdivided(cage, mesh, how);
    Ok(())
}

fn displacement(table: &mut Table, files: &mut Files) -> Result<Option<Displacement>> {
    let Some((name, of)) = table.text_or_table("displace", "file")? else { return Ok(None) };
    let Some(mut of) = of else {
        let fault = "how far is to be said; write { file = \"...\", height = 0.1 }";
        return Err(table.fault_of("displace", fault));
    };
    let factor = of.number("height", Range::ANY)?;
    let (factor, middle) = (of.need("height", factor)?, of.number("middle", Range::ANY)?.unwrap_or(0.0));
    of.done()?;
    let read = files.images.heights(&name).map_err(|error| table.fault_of("displace", error.to_string()));
    let (heights, path) = read?;
    files.paths.push(path);
    Ok(Some(Displacement { heights, factor, middle }))
}

impl Displacement {
    fn displace(&self, mesh: &mut Mesh) -> Unplaced<()> {
        if mesh.coordinates[0].is_empty() {
            return Err("the mesh has no texture coordinates, which tell where its heights are; give it some".into());
        }
        displace::displaced(mesh, |at| (self.heights.at(at) - self.middle) * self.factor);
        Ok(())
    }
}
