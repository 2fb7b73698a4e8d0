//! Eyerays as a library: scenes, packing, the CPU and GPU executors, films and images.

// A closed standard error makes these panic: the command speaks through `cli::console`.
#![cfg_attr(not(test), warn(clippy::print_stderr, clippy::print_stdout))]
// A test's expectation may err by a platform's last bit.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod bench;
pub mod cli;
pub mod compare;
pub mod cpu;
pub mod error;
pub mod film;
pub mod generate;
pub mod gpu;
pub mod image;
pub mod integrator;
pub mod math;
mod memory;
pub mod method;
pub mod output;
pub mod pack;
pub mod plan;
pub mod preset;
pub mod quality;
pub mod rays;
pub mod render;
pub mod scene;
pub mod stream;
pub mod tradeoff;
pub mod view;
