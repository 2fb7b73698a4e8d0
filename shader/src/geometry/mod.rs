//! What rays meet: boxes, and primitives, each a file with its intersection; and the place where a surface was met.

mod crossing;
mod disk;
mod edge_on;
mod interaction;
mod moller_trumbore;
mod nearest;
mod slab;
mod sphere;
#[cfg(test)]
mod tests;
mod transform;
mod triangle;

pub use crossing::{Crossed, crosses};
pub use disk::{Crossing, intersect_disk};
pub(crate) use disk::{coordinates, tangents};
pub use edge_on::Passage;
pub use interaction::SurfaceInteraction;
pub(crate) use interaction::across;
pub use moller_trumbore::intersect_moller_trumbore;
pub use nearest::{FARTHEST, Nearest, nearest};
pub use slab::{Span, slab};
pub use sphere::{Chord, intersect_sphere};
pub(crate) use sphere::{octahedral, unit_of};
pub use transform::Transform;
pub use triangle::{Candidate, intersect_watertight, sheared};
