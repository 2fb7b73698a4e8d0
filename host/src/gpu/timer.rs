//! Device time by timestamps at the first and the last pass of a submission.

use std::time::Duration;

use super::device::Gpu;
use super::readback;
use crate::error::Result;

/// Adds up what submissions take on the device.
pub(super) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    nanoseconds: f64,
}

impl Timer {
    /// A timer, where the GPU has one.
    pub fn new(gpu: &Gpu) -> Option<Timer> {
        gpu.report.timestamps.then(|| Timer {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: 16,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            nanoseconds: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// What a pass writes: the start if it is the first, the end if it is the last.
    pub fn writes(&self, first: bool, last: bool) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        (first || last).then_some(wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: first.then_some(0),
            end_of_pass_write_index: last.then_some(1),
        })
    }

    /// Ends a submission.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
    }

    /// What the last submission took; waits for it.
    pub fn read(&self, gpu: &Gpu) -> Result<Duration> {
        let bytes = readback::read(gpu, &self.resolved, 16)?;
        let ticks: Vec<u64> =
            bytes.chunks_exact(8).map(|c| u64::from_le_bytes(c.try_into().expect("eight bytes"))).collect();
        Ok(Duration::from_nanos((ticks[1].saturating_sub(ticks[0]) as f64 * self.nanoseconds) as u64))
    }
}
