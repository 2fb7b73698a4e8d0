//! The kernels on the GPU, through wgpu.

mod adapter;
mod bands;
mod cast;
mod cost;
mod deep;
mod device;
mod kernel;
mod launch;
mod linear;
mod memory;
mod module;
pub mod numerics;
mod pipe;
mod pipeline;
mod readback;
mod recipe;
mod refit;
mod render;
mod scene;
mod screen;
mod step;
mod timer;
mod warm;

/// Of the version that devices are of.
pub use wgpu;

pub use adapter::{AdapterReport, adapters, flags};
pub use cast::{Cast, Caster};
pub use cost::{Cost, KernelCost};
pub use device::{AdapterRequest, Around, Gpu, Route};
pub(crate) use pipe::Chunk;
pub use recipe::{Recipe, Target};
pub use render::{GpuRendering, Renderer};
pub use warm::warm;
