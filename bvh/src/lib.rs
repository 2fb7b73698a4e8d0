//! Bounding volume hierarchies for Eyerays.
//!
//! [`build`] turns triangles into the node pairs that every traversal method walks. obvhs searches
//! the topology by surface area; this crate keeps input that obvhs cannot digest away from it,
//! bounds the depth, computes every box itself and validates the result, because the kernels index
//! without checks and cull without tolerance.
//!
//! The stages run one way, a file each: bounds, cluster (with morton), search (with reinsertion),
//! topology, depth, layout (with median), validate.

mod bounds;
mod build;
mod cluster;
mod depth;
mod error;
mod layout;
mod median;
mod morton;
mod quality;
mod reinsertion;
mod search;
mod statistics;
mod topology;
mod validate;

pub use build::{Bvh, build};
pub use depth::MAX_DEPTH;
pub use error::BuildError;
pub use quality::Quality;
pub use statistics::Statistics;
pub use validate::validate;
