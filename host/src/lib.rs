//! Eyerays as a library: scenes, packing, the CPU and GPU executors, films and images.

pub mod bench;
pub mod cli;
pub mod compare;
pub mod cpu;
pub mod error;
pub mod film;
pub mod generate;
pub mod gpu;
pub mod image;
mod memory;
pub mod method;
pub mod output;
pub mod pack;
pub mod preset;
pub mod quality;
pub mod rays;
pub mod render;
pub mod scene;
pub mod stream;
pub mod tradeoff;
