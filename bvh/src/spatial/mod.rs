//! Which triangles to split, and where (Stich, Friedrich and Dietrich, Spatial Splits in Bounding Volume
//! Hierarchies, 2009).
//!
//! A tree is grown from the root down. Each node takes the cheapest of binned planes by the surface area
//! heuristic, among those between triangles and those through them. The leaves' parts become the scene's
//! references, and builds start from the tree: a bottom-up builder over the same references gains
//! little from them (on Conference and Sibenik it visits as many nodes as over whole triangles), and
//! splits chosen without a tree (Karras and Aila, Fast Parallel Construction of High-Quality Bounding
//! Volume Hierarchies, 2013) even cost it visits.

mod bins;
mod grow;
mod many;
mod part;
mod through;

use eyerays_shader::data::Primitive;
use rayon::prelude::*;

use crate::{Reference, References, tree::filled};
use part::Part;

/// Splits triangles in the normalised scene into at most `room` references more than there are
/// triangles.
pub(crate) fn references(triangles: &[Primitive], room: usize) -> References {
    let mut parts = filled(Part::NONE, triangles.len() + room);
    let whole = |(number, (part, triangle)): (usize, (&mut Part, _))| *part = Part::whole(number as u32, triangle);
    parts.par_iter_mut().zip(triangles).enumerate().for_each(whole);
    let grown = grow::grow(triangles, &mut parts, triangles.len());
    let (pairs, list) = grown.flat(Reference::NONE);
    References { list, pairs }
}
