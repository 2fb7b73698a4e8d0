//! Pipelines that compute: a kernel of a module, and which buffers it binds.

use wgpu::BufferBindingType;

use super::device::Gpu;
use super::module;

/// Buffers that kernels read.
pub(super) const READ: BufferBindingType = BufferBindingType::Storage { read_only: true };
/// Buffers that kernels write, too.
pub(super) const WRITE: BufferBindingType = BufferBindingType::Storage { read_only: false };

/// A compiled kernel.
#[derive(Clone)]
pub(super) struct Pipeline {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Pipeline {
    /// Compiles a kernel by its name in a module that binds buffers of these types, by their numbers, and nothing else.
    pub fn new(gpu: &Gpu, words: &[u32], name: &str, types: impl IntoIterator<Item = BufferBindingType>) -> Self {
        let entry = |(ty, binding)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let entries: Vec<_> = types.into_iter().zip(0..).map(entry).collect();
        let layout = &wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        let layout = gpu.device.create_bind_group_layout(layout);
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&pipeline_layout),
            module: &module::create(gpu, words, name),
            entry_point: Some(name),
            compilation_options: Default::default(),
            cache: None,
        });
        Pipeline { layout, pipeline }
    }

    /// Binds buffers, by their numbers.
    pub fn group<'b>(&self, gpu: &Gpu, buffers: impl IntoIterator<Item = &'b wgpu::Buffer>) -> wgpu::BindGroup {
        let entry = |(buffer, binding): (&'b wgpu::Buffer, u32)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        };
        let entries: Vec<_> = buffers.into_iter().zip(0..).map(entry).collect();
        let (layout, entries) = (&self.layout, &entries[..]);
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries })
    }

    /// The next dispatches of a pass are of it.
    pub fn set(&self, pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
    }
}
