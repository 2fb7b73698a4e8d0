//! The hierarchy of eight children a node (Ylitie, Karras and Laine, Efficient Incoherent Ray
//! Traversal on GPUs Through Compressed Wide BVHs, 2017), made of the binary one.
//!
//! The stages run one way, a file each: binary (the tree that is collapsed), collapse (which of its nodes
//! become wide), and for a GPU octant (which child sits where), grid and record (how a node is stored), layout; for a CPU fill.

mod binary;
mod bvh8;
mod collapse;
mod fill;
mod grid;
mod layout;
mod octant;
mod record;
mod validate;

pub use bvh8::Bvh8;
pub use layout::MAX_WIDE_DEPTH;
pub use validate::validate_wide;

#[cfg(test)]
pub(crate) use grid::Grid;
pub(crate) use layout::{Wide, wide};
pub(crate) use record::{Child, Record};
