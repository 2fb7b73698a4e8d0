//! Bounding volume hierarchies for Eyerays.
//!
//! [`split`] turns primitives into references from left to right in a tree, and splits some of them; [`build`] makes node pairs of it,
//! which most traversal methods walk, once obvhs has improved it as far as wanted. [`Bvh::widen`] adds the nodes of eight
//! children that one method on a GPU walks, [`Bvh8`] has those that a CPU walks.
//! This crate bounds the depth, computes every box itself and validates the result, because the kernels index without checks
//! and cull without tolerance.
//!
//! The stages run one way, a file each: bounds, reference, spatial, search (with reinsertion), depth (with median), layout,
//! wide, validate. They share one form of a tree and how threads go through it (tree), and how threads grow one (branch).

mod bounds;
mod branch;
mod build;
mod depth;
mod error;
mod kept;
mod layout;
pub mod linear;
mod median;
mod quality;
mod reference;
pub mod refit;
mod reinsertion;
mod search;
mod spatial;
mod statistics;
mod tree;
mod validate;
mod wide;

pub use build::{Bvh, build, build_within};
pub use depth::{Limits, MAX_DEPTH};
pub use error::BuildError;
pub use quality::Quality;
pub use reference::{Reference, References, split};
pub use statistics::Statistics;
pub use validate::validate;
pub use wide::{Bvh8, MAX_WIDE_DEPTH, validate_wide};
