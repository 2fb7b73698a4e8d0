//! Rays against boxes and triangles.

mod slab;
mod triangle;

pub use slab::{Span, slab, span};
pub use triangle::{Crossing, cross};
