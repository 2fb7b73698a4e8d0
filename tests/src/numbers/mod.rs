//! Other numbers for the kernels' own source: what it computes on them tells how well it computes on `f32`.

pub mod exact;
mod interval;
mod picture;
pub mod round;
mod watched;

pub use interval::Interval;
pub use picture::picture;
pub use watched::{Counting, Flushing, Watch, Watched, subnormals};
