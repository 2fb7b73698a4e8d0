//! Rays against boxes and triangles.

mod moller;
mod slab;
mod triangle;

pub use moller::moller;
pub use slab::{Span, slab};
pub use triangle::{Crossing, cross, sheared, spans};
