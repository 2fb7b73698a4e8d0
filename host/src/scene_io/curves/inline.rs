//! Strands in the scene file itself.

use glam::Vec3;

use crate::error::Result;
use crate::scene::Range;
use crate::scene::curves::{ControlPoint, Curves, Strand, Strands};
use crate::scene_io::table::{Table, Value};

const STRANDS: &str = "a list of strands, each of points: [[[x, y, z, radius], ...], ...]";
const NORMALS: &str = "a list of strands, each of normals: [[[x, y, z], ...], ...]";

/// Takes `strands` and, of ribbons, `normals` of a table.
///
/// # Errors
/// No strand, numbers that are missing or out of range, a strand that can't be drawn, or other normals than points.
pub fn read(table: &mut Table, curves: &Curves, radius: Option<f32>) -> Result<Strands> {
    let normals = table.map("normals", |table, value| normals(table, &value))?.unwrap_or_default();
    let strands = table.map("strands", |table, value| {
        let items = table.list("strands", STRANDS, &value)?;
        if items.is_empty() {
            return Err(table.fault_at(&value, "there is no strand; add one, as a list of points [x, y, z, radius]"));
        }
        if !normals.is_empty() && normals.len() != items.len() {
            let fault =
                format!("there are {} strands and normals of {}; give each its own", items.len(), normals.len());
            return Err(table.fault_of("normals", fault));
        }
        let mut strands = Strands::default();
        let mut normals = normals.iter();
        for item in items {
            let points = points(table, item, radius)?;
            let ups = normals.next().map(Vec::as_slice).unwrap_or_default();
            if !ups.is_empty() && ups.len() != points.len() {
                let fault = format!("the strand has {} points and {} normals; give each one", points.len(), ups.len());
                return Err(table.fault_at(item, fault));
            }
            let strand = Strand { points: &points, ups, colours: &[] };
            if let Some(fault) = strand.fault(curves.basis) {
                return Err(table.fault_at(item, format!("the strand {fault}")));
            }
            strands.push(strand);
        }
        Ok(strands)
    })?;
    table.need("strands", strands)
}

fn points(table: &Table, strand: &Value, radius: Option<f32>) -> Result<Vec<ControlPoint>> {
    const KEY: &str = "strands";
    let point = |value: &Value| {
        let numbers = table.list(KEY, STRANDS, value)?;
        let ([x, y, z] | [x, y, z, _]) = numbers else {
            let fault = format!("a control point is [x, y, z, radius], not {} numbers; correct it", numbers.len());
            return Err(table.fault_at(value, fault));
        };
        let own = numbers.get(3).map(|own| table.check(KEY, own, &Range::AMOUNT)).transpose()?;
        let Some(radius) = own.or(radius) else {
            let fault = "the control point has no radius; add a fourth number, or \"radius\" for all";
            return Err(table.fault_at(value, fault));
        };
        let number = |value| table.check(KEY, value, &Range::ANY);
        Ok(ControlPoint { position: Vec3::new(number(x)?, number(y)?, number(z)?), radius })
    };
    table.list(KEY, STRANDS, strand)?.iter().map(point).collect()
}

fn normals(table: &Table, value: &Value) -> Result<Vec<Vec<Vec3>>> {
    const KEY: &str = "normals";
    let of_strand = |strand: &Value| {
        let all = table.list(KEY, NORMALS, strand)?.iter();
        all.map(|normal| table.check_triple(KEY, normal, &Range::ANY)).collect()
    };
    table.list(KEY, NORMALS, value)?.iter().map(of_strand).collect()
}
