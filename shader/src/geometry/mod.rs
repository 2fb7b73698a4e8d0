//! What rays meet: boxes, and primitives, each a file with its intersection; and the place where a surface was met.

mod interaction;
mod moller_trumbore;
mod slab;
mod triangle;

pub use interaction::SurfaceInteraction;
pub use moller_trumbore::intersect_moller_trumbore;
pub use slab::{Span, slab};
pub use triangle::{Candidate, intersect_watertight, sheared, straddles_origin};
