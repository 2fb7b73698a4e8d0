//! What a `[[mesh]]` makes of its mesh: a smooth surface, and one that a picture moves.

use super::budget::Budget;
use super::copies::Copies;
use super::face_sizes::FaceSizes;
use super::files::Files;
use super::geometry::Geometry;
use super::table::Table;
use super::transform::Transform;
use crate::error::Result;
use crate::scene::displace::{self, Heights};
use crate::scene::subdivide::{self, Cage, Fineness, Subdivision};
use crate::scene::{Mesh, Range, Unplaced};
use glam::DMat4;

/// What is said of a surface.
pub struct Surface {
    subdivision: Option<(Fineness, Option<f32>)>,
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
        let fineness = fineness(table)?;
        let crease = table.number("crease", Range::TURN)?;
        if fineness.is_none() && crease.is_some() {
            let fault = "\"crease\" is of a surface that is divided; add \"subdivide\"";
            return Err(table.fault_of("crease", fault));
        }
        if matches!(fineness, Some(Fineness::Pixels { .. })) && files.eyes.is_empty() {
            let fault = "how many pixels edges have is told by the scene's cameras; add a [[camera]], or say how often: subdivide = 3";
            return Err(table.fault_of("subdivide", fault));
        }
        let subdivision = fineness.map(|fineness| (fineness, crease));
        Ok(Surface { subdivision, displacement: displacement(table, files)? })
    }

    /// Does it look otherwise where it stands elsewhere?
    pub fn differs_by_place(&self) -> bool {
        matches!(self.subdivision, Some((Fineness::Pixels { .. }, _)))
    }

    /// Puts it in the place of meshes that will stand in these places, and tells whether that changes their triangles.
    ///
    /// # Errors
    /// What has no such surface, or is too much.
    pub fn put(
        &self,
        (geometry, faces): (&mut Geometry, &FaceSizes),
        copies: &mut Copies,
        places: &[Transform],
        files: &Files,
    ) -> std::result::Result<bool, Fault> {
        // Most surfaces are the same wherever they stand.
        let (outer, inner) = if self.differs_by_place() { worlds(copies, places) } else { Default::default() };
        let inner = inner.into_iter().chain(std::iter::repeat_with(Vec::new));
        let mut all: Vec<(&mut Mesh, &[u32], Vec<DMat4>)> =
            copies.meshes.iter_mut().zip(inner).map(|(mesh, worlds)| (mesh, &[][..], worlds)).collect();
        if let Geometry::Mesh(mesh) = geometry {
            all.push((mesh, faces.sizes(), outer));
        } else if self.subdivision.is_some() {
            return Err(("subdivide", "it is round already; leave \"subdivide\" out".into()));
        } else if self.displacement.is_some() {
            return Err(("displace", "it has no vertices that can be moved; \"tessellate\" it".into()));
        }
        for (mesh, faces, worlds) in all.into_iter().filter(|(mesh, ..)| !mesh.triangles.is_empty()) {
            if let Some((fineness, crease)) = self.subdivision {
                let cage = Cage::of(mesh, faces);
                let levels = fineness.levels(&cage, &worlds, &files.eyes);
                divide(mesh, cage, Subdivision { levels, crease }, &files.budget).map_err(|why| ("subdivide", why))?;
            }
            if let Some(displacement) = &self.displacement {
                displacement.displace(mesh).map_err(|why| ("displace", why))?;
            }
        }
        Ok(self.subdivision.is_some())
    }
}

/// Where a mesh comes to stand in these places, and each of the copies' meshes.
fn worlds(copies: &Copies, places: &[Transform]) -> (Vec<DMat4>, Vec<Vec<DMat4>>) {
    let outer: Vec<DMat4> = match places {
        [] => vec![DMat4::IDENTITY],
        places => places.iter().map(|place| place.matrix()).collect(),
    };
    let mut inner = vec![Vec::new(); copies.meshes.len()];
    for (mesh, own) in &copies.places {
        inner[*mesh].extend(outer.iter().map(|outer| *outer * *own));
    }
    (outer, inner)
}

fn divide(mesh: &mut Mesh, cage: Cage, how: Subdivision, budget: &Budget) -> Unplaced<()> {
    let (triangles, vertices) = subdivide::size(&cage, how.levels);
    budget.check(triangles, vertices)?;
    *mesh = subdivide::subdivided(cage, mesh, how);
    Ok(())
}

/// A number of levels, or how long edges may be in pixels.
fn fineness(table: &mut Table) -> Result<Option<Fineness>> {
    let (least, greatest) = (*Fineness::LEVELS.start(), *Fineness::LEVELS.end());
    if !table.is_table("subdivide") {
        return Ok(table.whole("subdivide", least, greatest)?.map(Fineness::Levels));
    }
    let Some(mut of) = table.table("subdivide")? else { return Ok(None) };
    let length = of.number("pixels", Range::LENGTH)?;
    let length = of.need("pixels", length)?;
    let most = of.whole("most", least, greatest)?.unwrap_or(6);
    of.done()?;
    Ok(Some(Fineness::Pixels { length, most }))
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
