//! The kernels on the GPU, through wgpu.

mod adapter;
mod buffers;
mod cast;
mod cost;
mod device;
mod hush;
mod kernel;
mod module;
pub mod numerics;
mod plan;
mod readback;
mod recipe;
mod render;
mod scene;
mod timer;
mod warm;

pub use adapter::{AdapterReport, adapters};
pub use cast::{Cast, Caster};
pub use cost::{Cost, KernelCost};
pub use device::{Gpu, Route, Want};
pub use plan::Plan;
pub use recipe::{Recipe, Step};
pub use render::{GpuRendering, Renderer};
pub use warm::warm;
