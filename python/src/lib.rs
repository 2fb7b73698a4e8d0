//! What Python's package `eyerays` has of Rust: surfaces that are asked with arrays of rays. Arrays are checked there, and once more here
//! for what would be unsafe.

mod arrays;
mod blocks;
mod error;
mod fields;
mod gpu;
mod meshes;
mod pictures;
mod rays;
mod surfaces;
mod table;
mod told;

/// Ray queries and pictures.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use super::pictures::{Studio, png};
    #[pymodule_export]
    use super::surfaces::Surfaces;
}
