//! Rays against boxes and triangles.

mod slab;
mod triangle;

pub use slab::{Span, slab, span};
#[cfg(not(target_arch = "spirv"))]
pub use triangle::cross_cycled;
pub use triangle::{Crossing, cross};
