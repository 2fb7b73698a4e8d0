//! Reads scenes from files of every kind there is, and writes them: TOML, glTF, Wavefront, PLY, and a binary form.
//!
//! A scene file is TOML. All there is to say, as an example:
//!
//! ```toml
#![doc = include_str!("example.toml")]
//! ```

mod binary;
mod budget;
mod bump;
mod camera_table;
mod copies;
mod curves;
mod describe;
mod document;
mod face_areas;
mod face_sizes;
mod file;
mod files;
mod finish;
mod geometry;
mod gltf;
mod grid;
mod hair;
mod illuminant;
mod keys;
mod light_table;
mod light_unit;
mod lines;
mod lit;
mod load;
mod map;
mod material;
mod medium;
mod merge;
mod mesh_table;
mod moment;
mod mtl;
mod named;
mod neighbours;
mod obj;
mod object_table;
mod overlay;
mod physical;
mod ply;
mod polygon;
mod shape;
mod shutter;
mod source;
mod suggest;
mod surface;
mod table;
mod tally;
mod transform;
mod visible;
mod warning;
mod xyzr;

#[cfg(test)]
mod tests;

pub use binary::{ENDING, fingerprint, write};
pub use copies::Instancing;
pub use describe::{describe, describe_camera};
pub use light_unit::LightUnit;
pub use load::{Loading, load, load_as, read_as, read_table};
pub use moment::{AnimationWish, Instant, Moment, Shutter};
pub use overlay::overlay;
pub use suggest::{nearest, suggest};
pub use table::Table;
pub use warning::{Warning, WarningKind};
