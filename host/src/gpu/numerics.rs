//! The functions of exact arithmetic on the GPU, one at a time.

use eyerays_shader::launch::WORKGROUP;
use glam::UVec4;
use wgpu::BufferUsages as Use;

use super::device::Gpu;
use super::pipeline::{Pipeline, READ, WRITE};
use super::readback;
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
    let module: Vec<u32> = readback::words(eyerays_modules::NUMERICS).collect();
    let pipeline = Pipeline::new(gpu, &module, "numerics::evaluate", [READ, WRITE]);
    let group = pipeline.group(gpu, [&input, &values]);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pipeline.set(&mut pass, &group);
    pass.dispatch_workgroups((operations.len() as u32).div_ceil(WORKGROUP), 1, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    gpu.check()?;
    let bytes = readback::read(gpu, &values, 4 * operations.len() as u64)?;
    Ok(readback::words(&bytes).collect())
}
