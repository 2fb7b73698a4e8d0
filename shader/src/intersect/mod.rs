//! Intersection of rays with boxes and triangles.

mod moller_trumbore;
mod slab;
mod triangle;

pub use moller_trumbore::intersect_moller_trumbore;
pub use slab::{Span, slab};
pub use triangle::{Candidate, intersect_watertight, sheared, straddles_origin};
