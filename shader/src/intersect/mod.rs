//! Rays against boxes and triangles.

mod slab;
mod triangle;

pub use slab::{Span, slab};
pub use triangle::{Crossing, cross};
