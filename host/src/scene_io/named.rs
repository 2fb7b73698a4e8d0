//! Shapes that a `[[mesh]]` names by a word.

use glam::Vec3;

use super::budget::Budget;
use super::curves;
use super::files::Files;
use super::geometry::Geometry;
use super::shape;
use super::table::Table;
use super::transform::Transform;
use crate::error::Result;
use crate::scene::Range;
use crate::scene::normal::unit;
use crate::scene::{Disk, Sphere};

/// How often the triangles of a sphere are split where nobody says it.
const STEPS: u32 = 5;
/// The triangles of a disk where nobody says how many: the outline of a sphere has about as many edges.
const FAN: u32 = 128;
/// The most triangles of a disk.
const MOST_FAN: u32 = 65_536;

/// What a table asks of its geometry, whatever that is.
pub struct Wish {
    /// Normals from the faces around, or none; as they are where it says nothing.
    pub smooth: Option<bool>,
    /// Where it goes.
    pub transform: Option<Transform>,
}

impl Wish {
    /// Is a sphere no longer one where it goes, nor a disk a disk?
    fn stretches(&self) -> bool {
        self.transform.is_some_and(|transform| !transform.keeps_spheres())
    }
}

#[derive(Clone, Copy)]
enum Shape {
    Sphere,
    Disk,
    Quad,
    Box,
    Curves,
}

/// Reads the keys of a table that has a `shape`: its word, and what it is before it is moved. Where it may be covered by a texture, a
/// box is one of sides that have texture coordinates.
///
/// # Errors
/// An unknown word, a number that is missing or out of range, or more triangles than the budget has room for.
pub fn read(table: &mut Table, wish: &Wish, files: &Files) -> Result<(&'static str, Geometry)> {
    let budget = files.budget;
    let words = [
        ("sphere", Shape::Sphere),
        ("disk", Shape::Disk),
        ("quad", Shape::Quad),
        ("box", Shape::Box),
        ("curves", Shape::Curves),
    ];
    let shape = table.word("shape", &words)?;
    match table.need("shape", shape)? {
        Shape::Sphere => {
            table.rename("a sphere");
            let center = table.triple("center", Range::ANY)?.unwrap_or(Vec3::ZERO);
            let radius = table.number("radius", Range::LENGTH)?.unwrap_or(1.0);
            Ok(("sphere", spheres(table, wish, budget, &[Sphere { center, radius, material: 0 }])?))
        }
        Shape::Disk => {
            table.rename("a disk");
            Ok(("disk", disk(table, wish, budget)?))
        }
        Shape::Quad => {
            table.rename("a quad");
            let corners = table.corners("corners")?;
            Ok(("quad", Geometry::Mesh(shape::quad(table.need("corners", corners)?))))
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
            // Sides that share their corners can have smooth edges.
            let of_sides = files.is_covered && wish.smooth != Some(true);
            let make = if of_sides { shape::covered_cuboid } else { shape::cuboid };
            Ok(("box", Geometry::Mesh(make(min, max))))
        }
        Shape::Curves => Ok(("curves", Geometry::Mesh(curves::inline(table, files)?))),
    }
}

/// Spheres as they are, or as a mesh where the table's other keys ask for one.
///
/// # Errors
/// A number out of range, or more primitives than the budget has room for.
pub fn spheres(table: &mut Table, wish: &Wish, budget: Budget, spheres: &[Sphere]) -> Result<Geometry> {
    let steps = table.whole("tessellate", 0, 8)?;
    let older = table.whole("subdivisions", 0, 8)?;
    if steps.is_some() && older.is_some() {
        let fault = "\"subdivisions\" is an older name of \"tessellate\"; remove the one or the other";
        return Err(table.fault_of("subdivisions", fault));
    }
    // The facets that `smooth = false` shows are those of triangles.
    let by_need = (wish.stretches() || wish.smooth == Some(false)).then_some(STEPS);
    let Some(steps) = steps.or(older).or(by_need) else {
        budget.check_round(spheres.len()).map_err(|fault| table.fault(fault))?;
        return Ok(Geometry::Spheres(spheres.to_vec()));
    };
    let (triangles, vertices) = shape::spheres_size(spheres.len(), steps);
    budget.check(triangles, vertices).map_err(|fault| table.fault(fault))?;
    Ok(Geometry::Mesh(shape::spheres(spheres, steps)))
}

fn disk(table: &mut Table, wish: &Wish, budget: Budget) -> Result<Geometry> {
    let center = table.triple("center", Range::ANY)?.unwrap_or(Vec3::ZERO);
    let radius = table.number("radius", Range::LENGTH)?.unwrap_or(1.0);
    let normal = table.triple("normal", Range::ANY)?.unwrap_or(Vec3::Y);
    let normal = unit(normal.as_dvec3());
    if normal == Vec3::ZERO {
        return Err(table.fault_of("normal", "the normal is zero; say which way the disk faces"));
    }
    let disk = Disk { center, normal, radius, material: 0 };
    let triangles = table.whole("tessellate", 3, MOST_FAN)?;
    let Some(triangles) = triangles.or(wish.stretches().then_some(FAN)) else {
        budget.check_round(1).map_err(|fault| table.fault(fault))?;
        return Ok(Geometry::Disks(vec![disk]));
    };
    let count = triangles as usize;
    budget.check(count, count + 1).map_err(|fault| table.fault(fault))?;
    Ok(Geometry::Mesh(shape::disk(&disk, triangles)))
}
