//! Kernels beside those of a plan, with bindings of their own: a uniform record and buffers.

use eyerays_shader::launch::{ROW, WORKGROUP};
use wgpu::BufferUsages as Use;

use super::device::Gpu;
use super::{module, readback};
use crate::error::Result;

/// A dispatch.
#[derive(Clone)]
pub(super) struct Step {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    threads: u32,
}

impl Step {
    /// Records it.
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
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
pub(super) struct Kernel {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Kernel {
    /// By its name in a module, with whether it writes each of its buffers.
    pub fn new(gpu: &Gpu, module: &[u8], name: &str, writes: &[bool]) -> Kernel {
        let storage = |&writes: &bool| wgpu::BufferBindingType::Storage { read_only: !writes };
        let types = [wgpu::BufferBindingType::Uniform].into_iter().chain(writes.iter().map(storage));
        let entries: Vec<_> = types
            .zip(0..)
            .map(|(ty, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                count: None,
            })
            .collect();
        let layout = &wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        let layout = gpu.device.create_bind_group_layout(layout);
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let words: Vec<u32> = readback::words(module).collect();
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&pipeline_layout),
            module: &module::create(gpu, &words, name),
            entry_point: Some(name),
            compilation_options: Default::default(),
            cache: None,
        });
        Kernel { layout, pipeline }
    }

    /// A dispatch of so many threads over buffers, after the uniform record.
    pub fn step(&self, gpu: &Gpu, uniform: &wgpu::Buffer, buffers: &[&wgpu::Buffer], threads: u32) -> Step {
        let all = [&uniform].into_iter().chain(buffers).zip(0..);
        let entries: Vec<_> = all
            .map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let (layout, entries) = (&self.layout, &entries[..]);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries });
        Step { pipeline: self.pipeline.clone(), group, threads }
    }
}
