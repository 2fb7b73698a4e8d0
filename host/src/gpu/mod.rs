//! The kernels on the GPU, through wgpu.

mod adapter;
mod buffers;
mod device;
mod module;
mod readback;
mod render;
mod timer;

pub use adapter::{AdapterReport, adapters};
pub use device::{Gpu, Route, Want};
pub use module::specialise;
pub use render::{GpuRendering, Renderer};
