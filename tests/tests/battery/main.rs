//! The battery: geometry, rays and places that renderers break on, on the CPU and the GPU, in exact and in fast
//! precision, each with its count.
//!
//! `cargo test --release -p eyerays-tests --test battery -- --nocapture | grep -o 'battery: .*' | sort` prints the counts
//! of samples, `EYERAYS_BATTERY=full` before it those of all there is. A software GPU, which ends loops after 65,535
//! rounds, is spared what takes more.

mod against;
mod garbage;
mod hierarchy;
mod leaks;
mod places;
mod rays;
mod reintersection;
mod triangles;
