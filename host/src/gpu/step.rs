//! Kernels beside those of a plan, with bindings of their own: a uniform record and buffers.

use eyerays_shader::launch::{ROW, WORKGROUP};
use wgpu::BufferUsages as Use;

use super::device::Gpu;
use super::pipeline::{Pipeline, READ, WRITE};
use super::readback;
use crate::error::Result;

/// A dispatch.
#[derive(Clone)]
pub(super) struct Step {
    pipeline: Pipeline,
    group: wgpu::BindGroup,
    threads: u32,
}

impl Step {
    /// Records it.
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.pipeline.set(pass, &self.group);
        pass.dispatch_workgroups(self.threads.min(ROW).div_ceil(WORKGROUP), self.threads.div_ceil(ROW), 1);
    }
}

/// Submits dispatches, one after the other.
///
/// # Errors
/// What the GPU reports.
pub(super) fn run<'s>(gpu: &Gpu, steps: impl IntoIterator<Item = &'s Step>) -> Result<()> {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    steps.into_iter().for_each(|step| step.record(&mut pass));
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    gpu.check()
}

/// A buffer of so many bytes.
pub(super) fn empty(gpu: &Gpu, name: &str, size: u64) -> wgpu::Buffer {
    let usage = Use::STORAGE | Use::COPY_DST;
    gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(name), size, usage, mapped_at_creation: false })
}

/// One of these bytes.
pub(super) fn filled(gpu: &Gpu, name: &str, bytes: &[u8]) -> wgpu::Buffer {
    let buffer = empty(gpu, name, bytes.len() as u64);
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}

/// A uniform record.
pub(super) fn uniform(gpu: &Gpu, told: &impl bytemuck::NoUninit) -> wgpu::Buffer {
    let (label, size, usage) = (Some("told"), size_of_val(told) as u64, Use::UNIFORM | Use::COPY_DST);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false });
    gpu.queue.write_buffer(&buffer, 0, bytemuck::bytes_of(told));
    buffer
}

/// A kernel that takes a uniform record and buffers.
pub(super) struct Kernel(Pipeline);

impl Kernel {
    /// By its name in a module, with whether it writes each of its buffers.
    pub fn new(gpu: &Gpu, module: &[u8], name: &str, writes: &[bool]) -> Kernel {
        let storage = |&writes: &bool| if writes { WRITE } else { READ };
        let types = [wgpu::BufferBindingType::Uniform].into_iter().chain(writes.iter().map(storage));
        let words: Vec<u32> = readback::words(module).collect();
        Kernel(Pipeline::new(gpu, &words, name, types))
    }

    /// A dispatch of so many threads over buffers, after the uniform record.
    pub fn step(&self, gpu: &Gpu, uniform: &wgpu::Buffer, buffers: &[&wgpu::Buffer], threads: u32) -> Step {
        let group = self.0.group(gpu, [uniform].into_iter().chain(buffers.iter().copied()));
        Step { pipeline: self.0.clone(), group, threads }
    }
}
