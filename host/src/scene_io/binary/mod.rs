//! The binary form of a scene: what a text form says, at once where memory wants it.
//!
//! A file is a [`Header`], then sections that each begin at a multiple of 64 bytes: the description (TOML: all of a
//! [`Scene`](crate::scene::Scene) but its geometry and texels), positions, normals, two sets of texture coordinates, tangents, colours,
//! triangles, their materials, spheres, disks, instances, poses of what moves and the texels of each texture once, as [`Scene`](crate::scene::Scene) has them, and pairs, order and own boxes of a hierarchy, as
//! [`Bvh`](eyerays_bvh::Bvh) has them; little-endian, zeros between. Its hash and every number in it are
//! checked, and nothing is parsed but the description.

mod description;
mod grids;
mod header;
mod motion;
mod read;
mod textures;
mod write;

#[cfg(test)]
mod hostile;
#[cfg(test)]
mod tests;

pub(super) use read::load;
pub use write::{fingerprint, write};

/// How names of such files end.
pub const ENDING: &str = "eyerays";

// Sections are memory as it is.
const _: () = assert!(cfg!(target_endian = "little"), "binary scenes are little-endian");
