//! The functions of exact arithmetic on the GPU, one at a time.

use eyerays_shader::launch::WORKGROUP;
use glam::UVec4;
use wgpu::BufferUsages as Use;

use super::device::Gpu;
use super::{module, readback};
use crate::error::{Error, Result};

/// The most operations at once.
pub const MOST_OPERATIONS: usize = 1 << 21;

/// The values of at most [`MOST_OPERATIONS`] operations, see [`eyerays_shader::numerics::evaluate`].
///
/// # Errors
/// If there are more, or what the GPU reports.
pub fn evaluate(gpu: &Gpu, operations: &[UVec4]) -> Result<Vec<u32>> {
    if operations.is_empty() {
        return Ok(Vec::new());
    }
    if operations.len() > MOST_OPERATIONS {
        return Err(Error::new(format!("{} operations are more than {MOST_OPERATIONS} at once", operations.len())));
    }
    let buffer = |size: usize, usage| {
        let (size, label) = (size as u64, Some("numerics"));
        gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
    };
    let input = buffer(size_of_val(operations), Use::STORAGE | Use::COPY_DST);
    let values = buffer(4 * operations.len(), Use::STORAGE | Use::COPY_SRC);
    gpu.queue.write_buffer(&input, 0, bytemuck::cast_slice(operations));
    let layout = layout(gpu);
    let entries = [(0, &input), (1, &values)]
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
    let group =
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries });
    let pipeline = pipeline(gpu, &layout);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups((operations.len() as u32).div_ceil(WORKGROUP), 1, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    gpu.check()?;
    let bytes = readback::read(gpu, &values, 4 * operations.len() as u64)?;
    Ok(readback::words(&bytes).collect())
}

/// Operations to read and values to write.
fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let entries = [(0, true), (1, false)].map(|(binding, read_only)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    });
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}

fn pipeline(gpu: &Gpu, bindings: &wgpu::BindGroupLayout) -> wgpu::ComputePipeline {
    let name = "numerics::evaluate";
    let words: Vec<u32> = readback::words(eyerays_modules::NUMERICS).collect();
    let module = module::create(gpu, &words, name);
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(bindings)],
        immediate_size: 0,
    });
    gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(name),
        layout: Some(&layout),
        module: &module,
        entry_point: Some(name),
        compilation_options: Default::default(),
        cache: None,
    })
}
