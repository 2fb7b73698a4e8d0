//! From device memory back to the host.

use super::device::Gpu;
use crate::error::{Error, Result};

/// The first `size` bytes of a buffer, once all that was submitted is done.
pub(super) fn read(gpu: &Gpu, buffer: &wgpu::Buffer, size: u64) -> Result<Vec<u8>> {
    Ok(read_all(gpu, &[(buffer, size)])?.remove(0))
}

/// The first bytes of several buffers, once all that was submitted is done: one wait for all.
pub(super) fn read_all(gpu: &Gpu, buffers: &[(&wgpu::Buffer, u64)]) -> Result<Vec<Vec<u8>>> {
    let staging = |&(_, size): &(&wgpu::Buffer, u64)| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    };
    let stagings: Vec<_> = buffers.iter().map(staging).collect();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for (&(buffer, size), staging) in buffers.iter().zip(&stagings) {
        encoder.copy_buffer_to_buffer(buffer, 0, staging, 0, size);
    }
    gpu.queue.submit([encoder.finish()]);
    for staging in &stagings {
        staging.map_async(wgpu::MapMode::Read, .., |_| {});
    }
    gpu.wait()?;
    let view = |staging: &wgpu::Buffer| {
        let view = staging.get_mapped_range(..).map_err(|e| Error::DeviceFailed {
            device: gpu.report.name.clone(),
            message: format!("a buffer can't be read: {e}"),
        })?;
        Ok(view.to_vec())
    };
    stagings.iter().map(view).collect()
}

/// Little-endian words.
pub(super) fn words(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    bytes.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]))
}
