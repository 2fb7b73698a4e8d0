//! The kernels on the CPU: tiles in parallel, each with the memory of a small launch.

mod cast;
mod cells;
mod enclosing;
mod photons;
mod pool;
mod render;
mod tile;
mod watched;

pub use eyerays_kernels_cpu::{Isa, Number, Records};

pub(crate) use cast::{Follower, cross_here, nearest_here};
pub use cast::{cast, cast_by, closest};
pub(crate) use enclosing::enclosing;
pub use pool::pool;
pub use render::{Renderer, render};
pub use tile::{Observer, Planned};
pub(crate) use watched::OnCpu;
