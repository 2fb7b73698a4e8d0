//! Other numbers for the kernels' own source: what it computes on them tells how well it computes on `f32`.

pub mod exact;
mod interval;
mod picture;
mod watched;

pub use interval::Interval;
pub use picture::picture;
pub use watched::{Counting, Flushing, Watch, Watched, subnormals};

/// How many samples a test takes: `sampled`, or `full` if `EYERAYS_BATTERY` is `full`.
pub fn samples(sampled: usize, full: usize) -> usize {
    if is_full() { full } else { sampled }
}

/// Do tests take all samples?
pub fn is_full() -> bool {
    std::env::var("EYERAYS_BATTERY").is_ok_and(|value| value == "full")
}
