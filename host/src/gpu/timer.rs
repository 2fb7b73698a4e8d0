//! Device time by timestamps at the ends of passes.

use std::time::Duration;

use super::device::Gpu;
use super::readback;
use crate::error::Result;

/// Times passes on the device.
pub(super) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    nanoseconds: f64,
}

impl Timer {
    /// A timer of at most so many passes between two reads, where the GPU has a clock.
    pub fn new(gpu: &Gpu, passes: u32) -> Option<Timer> {
        gpu.report.timestamps.then(|| Timer {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count: 2 * passes,
            }),
            resolved: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: 16 * u64::from(passes),
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            nanoseconds: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// What a pass writes at its ends.
    pub fn writes(&self, pass: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        }
    }

    /// Hands over the times of the first `passes` passes; read [`Timer::resolved`] once that is done. (A pass that was
    /// never timed would be waited for in vain.)
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder, passes: u32) {
        encoder.resolve_query_set(&self.queries, 0..2 * passes, &self.resolved, 0);
    }

    /// Where [`Timer::resolve`] leaves the times of `passes` passes, and how many bytes they take.
    pub fn resolved(&self, passes: u32) -> (&wgpu::Buffer, u64) {
        (&self.resolved, 16 * u64::from(passes))
    }

    /// What each pass took, from the bytes of [`Timer::resolved`].
    pub fn times(&self, bytes: &[u8]) -> Vec<Duration> {
        let ticks: Vec<u64> =
            bytes.chunks_exact(8).map(|c| u64::from_le_bytes(c.try_into().expect("eight bytes"))).collect();
        let time = |ends: &[u64]| (ends[1].saturating_sub(ends[0]) as f64 * self.nanoseconds) as u64;
        ticks.chunks_exact(2).map(|ends| Duration::from_nanos(time(ends))).collect()
    }

    /// What each of the first `passes` passes took, after [`Timer::resolve`]; waits for all that was submitted.
    pub fn read(&self, gpu: &Gpu, passes: u32) -> Result<Vec<Duration>> {
        let (buffer, size) = self.resolved(passes);
        Ok(self.times(&readback::read(gpu, buffer, size)?))
    }
}
