//! The kernels on the CPU: tiles in parallel, each with the memory of a small launch.

mod cast;
mod follow;
mod level;
mod pool;
mod render;
mod tile;

pub use cast::{cast, cast_by, closest};
pub use level::Level;
pub use pool::pool;
pub use render::{Renderer, render};
pub use tile::{Observer, Records, render_tile, render_tile_by};
