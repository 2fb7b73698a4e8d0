//! Bounding volume hierarchies for Eyerays.
//!
//! [`split`] turns triangles into references, once a scene; [`build`] turns references into the node
//! pairs that most traversal methods walk and the wide nodes that one walks, over one order of slots.
//! The tree that splits triangles is where builds begin; obvhs improves it, and clusters references that were not split.
//! This crate keeps away from it input that it cannot handle, bounds the depth, computes every box itself and validates
//! the result, because the kernels index without checks and cull without tolerance.
//!
//! The stages run one way, a file each: bounds, reference, spatial, search (with cluster, morton and reinsertion), topology,
//! depth, layout (with median), wide, validate.

mod bounds;
mod build;
mod cluster;
mod depth;
mod error;
mod kept;
mod layout;
mod median;
mod morton;
mod quality;
mod reference;
mod reinsertion;
mod search;
mod spatial;
mod statistics;
mod topology;
mod validate;
mod wide;

pub use build::{Bvh, build};
pub use depth::MAX_DEPTH;
pub use error::BuildError;
pub use quality::Quality;
pub use reference::{Reference, References, split};
pub use statistics::Statistics;
pub use validate::validate;
pub use wide::{Bvh8, MAX_WIDE_DEPTH, validate_wide};
