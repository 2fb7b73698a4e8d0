//! From device memory back to the host.

use super::device::Gpu;
use crate::error::{Error, Result};

/// Memory of the host that the device copies into, kept from one reading to the next: to take it takes longer than to copy.
pub(super) struct Readback {
    staging: wgpu::Buffer,
}

impl Readback {
    /// For at most so many bytes.
    pub fn new(gpu: &Gpu, size: u64) -> Self {
        let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Readback { staging }
    }

    /// How many bytes there is room for.
    pub fn size(&self) -> u64 {
        self.staging.size()
    }

    /// Records that the first bytes of a buffer are copied here, from `offset` on.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer, offset: u64, size: u64) {
        encoder.copy_buffer_to_buffer(buffer, 0, &self.staging, offset, size);
    }

    /// Waits for all that was submitted, and shows the first `size` bytes to `look`.
    pub fn read<T>(&self, gpu: &Gpu, size: u64, look: impl FnOnce(&[u8]) -> T) -> Result<T> {
        self.map(gpu, size, || gpu.wait(), look)
    }

    /// Waits for the submission that copies them, and shows the first `size` bytes to `look`.
    pub fn receive<T>(
        &self,
        gpu: &Gpu,
        submission: wgpu::SubmissionIndex,
        size: u64,
        look: impl FnOnce(&[u8]) -> T,
    ) -> Result<T> {
        self.map(gpu, size, || gpu.wait_for(submission), look)
    }

    fn map<T>(
        &self,
        gpu: &Gpu,
        size: u64,
        wait: impl FnOnce() -> Result<()>,
        look: impl FnOnce(&[u8]) -> T,
    ) -> Result<T> {
        self.staging.map_async(wgpu::MapMode::Read, ..size, |_| {});
        let done = wait();
        let seen = match self.staging.get_mapped_range(..size) {
            Ok(view) => Ok(look(&view)),
            Err(e) => {
                let message = format!("a buffer can't be read: {e}");
                Err(Error::DeviceFailed { device: gpu.report.name.clone(), message })
            }
        };
        self.staging.unmap();
        done.and(seen)
    }
}

/// The first `size` bytes of a buffer, once all that was submitted is done.
pub(super) fn read(gpu: &Gpu, buffer: &wgpu::Buffer, size: u64) -> Result<Vec<u8>> {
    let readback = Readback::new(gpu, size);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    readback.copy(&mut encoder, buffer, 0, size);
    gpu.queue.submit([encoder.finish()]);
    readback.read(gpu, size, <[u8]>::to_vec)
}

/// Little-endian words.
pub(super) fn words(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    bytes.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]))
}
