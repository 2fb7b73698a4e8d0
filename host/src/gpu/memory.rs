//! Device memory of launches.

use eyerays_shader::camera;
use eyerays_shader::data::{Frame, Order};
use eyerays_shader::launch::{WORKGROUP, argument, counter};
use eyerays_shader::resources::{RESOURCES, binding};
use wgpu::BufferUsages as Use;

use super::device::Gpu;
use crate::error::{Content, Error, Result};
use crate::plan::Plan;

/// The most memory that one buffer of a launch takes; a larger picture is rendered in more launches.
const MOST: u64 = 2 << 30;
/// The most slots of a launch: with as many, waves of few rays take less of the time than those of many (on an H200, the
/// Cornell box takes 2.2 ms a launch and 0.4 ms a million slots).
const SLOTS: u64 = 1 << 22;
/// The most rays a dispatch traces, so that no watchdog takes it for hung.
const RAYS: u64 = 1 << 24;

/// The most slots of a launch on this GPU.
///
/// # Errors
/// If not even a block of pixels fits.
pub(super) fn most_slots(gpu: &Gpu, plan: &Plan, order: Order) -> Result<u32> {
    let (columns, block_rows) = camera::blocks(order);
    let block = u64::from(columns * block_rows);
    let limit = gpu.report.max_binding.min(gpu.report.max_buffer);
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    let rows = plan.shadow_rays;
    if rows > most {
        let device = gpu.report.name.clone();
        return Err(Error::TooManyLights { device, lights: rows as usize, most: most.into() });
    }
    let share = plan.slot_bytes.iter().map(|&(_, bytes)| bytes).max().unwrap_or(1);
    let memory = limit.min(MOST) / share;
    let threads = u64::from(most) * u64::from(WORKGROUP);
    let slots = memory.min(threads).min(SLOTS).min(RAYS / u64::from(rows).max(1)) / block * block;
    if memory < block {
        let device = gpu.report.name.clone();
        return Err(Error::TooLarge { device, what: Content::Block, bytes: block * share, limit });
    }
    Ok(slots.max(block) as u32)
}

/// A buffer of a resource.
pub(super) fn buffer(gpu: &Gpu, binding: u32, size: u64, usage: Use) -> wgpu::Buffer {
    let label = Some(RESOURCES[binding as usize].name);
    // A binding of no bytes is invalid.
    gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size: size.max(4), usage, mapped_at_creation: false })
}

/// What the steps of a launch exchange.
#[derive(Clone)]
pub(super) struct LaunchBuffers {
    /// For so many slots.
    pub slots: u32,
    buffers: Vec<(u32, wgpu::Buffer)>,
}

impl LaunchBuffers {
    /// For launches of at most `slots` slots.
    ///
    /// # Errors
    /// What the GPU reports, such as too little memory.
    pub fn new(gpu: &Gpu, slot_bytes: &[(u32, u64)], slots: u32) -> Result<Self> {
        let exchanged = slot_bytes.iter().map(|&(binding, bytes)| (binding, bytes * u64::from(slots)));
        let words = |count: u32| 4 * u64::from(count);
        let own = [
            (binding::FRAME, size_of::<Frame>() as u64),
            (binding::COUNTERS, words(counter::LENGTH)),
            (binding::ARGUMENTS, words(argument::LENGTH)),
        ];
        let usage = |binding| match binding {
            binding::FRAME => Use::UNIFORM | Use::COPY_DST,
            binding::ARGUMENTS => Use::STORAGE | Use::INDIRECT | Use::COPY_DST,
            _ => Use::STORAGE | Use::COPY_SRC | Use::COPY_DST,
        };
        let buffers = exchanged.chain(own).map(|(binding, size)| (binding, buffer(gpu, binding, size, usage(binding))));
        let buffers = buffers.collect();
        gpu.check()?;
        Ok(LaunchBuffers { slots, buffers })
    }

    /// The same with counters of their own.
    pub fn with_own_counters(&self, gpu: &Gpu) -> Self {
        let mut own = self.clone();
        let size = 4 * u64::from(counter::LENGTH);
        let usage = Use::STORAGE | Use::COPY_SRC | Use::COPY_DST;
        for (_, counters) in own.buffers.iter_mut().filter(|(own, _)| *own == binding::COUNTERS) {
            *counters = buffer(gpu, binding::COUNTERS, size, usage);
        }
        own
    }

    /// The buffer of a resource. Every second wave, the queue is what was the next queue of the wave before.
    pub fn find(&self, binding: u32, is_second: bool) -> Option<&wgpu::Buffer> {
        let binding = match (binding, is_second) {
            (binding::QUEUE, true) => binding::NEXT,
            (binding::NEXT, true) => binding::QUEUE,
            // What lands is looked through.
            (binding::PHOTONS, _) => binding::LANDED,
            (other, _) => other,
        };
        self.buffers.iter().find(|(own, _)| *own == binding).map(|(_, buffer)| buffer)
    }

    /// The buffer of a resource that every launch has.
    ///
    /// # Panics
    /// If the plan has not got it.
    pub fn of(&self, binding: u32) -> &wgpu::Buffer {
        self.find(binding, false).expect("every launch has it")
    }
}
