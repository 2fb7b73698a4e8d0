//! The kernels on the CPU: tiles in parallel, each with the memory of a small launch.

mod cast;
mod follow;
mod isa;
mod pool;
mod render;
mod tile;

pub use cast::{cast, cast_by, closest};
pub use isa::Isa;
pub use pool::pool;
pub use render::{Picture, Renderer, render};
pub use tile::{Observer, Planned, Records};
