//! Device time by timestamps at the ends of passes.

use std::time::Duration;

use super::device::Gpu;
use super::readback;
use crate::error::Result;

/// Times stretches of a submission on the device.
pub(super) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    nanoseconds: f64,
}

impl Timer {
    /// A timer of at most so many stretches a submission, where the GPU has a clock.
    pub fn new(gpu: &Gpu, stretches: u32) -> Option<Timer> {
        gpu.report.timestamps.then(|| Timer {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count: 2 * stretches,
            }),
            resolved: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: 16 * u64::from(stretches),
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            nanoseconds: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// What a pass writes: a stretch's start if it is its first, the end if it is its last.
    pub fn writes(&self, stretch: u32, first: bool, last: bool) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        (first || last).then_some(wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: first.then_some(2 * stretch),
            end_of_pass_write_index: last.then_some(2 * stretch + 1),
        })
    }

    /// Ends a submission of so many stretches. (One that was never timed would be waited for in vain.)
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder, stretches: u32) {
        encoder.resolve_query_set(&self.queries, 0..2 * stretches, &self.resolved, 0);
    }

    /// What each of so many stretches of the last submission took; waits for it.
    pub fn read(&self, gpu: &Gpu, stretches: u32) -> Result<Vec<Duration>> {
        let bytes = readback::read(gpu, &self.resolved, 16 * u64::from(stretches))?;
        let ticks: Vec<u64> =
            bytes.chunks_exact(8).map(|c| u64::from_le_bytes(c.try_into().expect("eight bytes"))).collect();
        let time = |ends: &[u64]| (ends[1].saturating_sub(ends[0]) as f64 * self.nanoseconds) as u64;
        Ok(ticks.chunks_exact(2).map(|ends| Duration::from_nanos(time(ends))).collect())
    }
}
