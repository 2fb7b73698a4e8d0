//! Eyerays: scenes, packing, the CPU and GPU executors, films and images.

// A library says nothing; and a closed standard error makes these panic.
#![cfg_attr(not(test), warn(clippy::print_stderr, clippy::print_stdout))]
// A test's expectation may err by a platform's last bit.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod batch;
pub mod choice;
pub mod compare;
pub mod cpu;
pub mod device_scene;
pub mod error;
pub mod film;
pub mod gpu;
pub mod image;
pub mod integrator;
pub mod line;
pub mod math;
mod memory;
pub mod method;
pub mod plan;
pub mod quality;
pub mod rays;
pub mod render;
pub mod scene;
pub mod stream;
pub mod view;
mod why;
