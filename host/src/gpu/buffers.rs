//! Device memory of launches.

use eyerays_shader::data::Frame;
use eyerays_shader::launch::{WORKGROUP, binding, counter};
use eyerays_shader::stage::RECORDS;

use super::device::Gpu;
use super::scene::SceneBuffers;
use crate::error::{Content, Error, Result};
use crate::pack::Packed;

/// What stands for a buffer that the scene does not need: as large as the largest record, since a kernel may be
/// validated against its size.
pub(super) const DUMMY: u64 = 128;
/// Bytes of a record.
const RECORD: u64 = 16;
/// The most memory one kind of record takes; a larger picture is rendered in more bands.
const MOST: u64 = 1 << 30;
/// The most rays a dispatch traces, so that no watchdog takes it for hung.
const RAYS: u64 = 1 << 22;

/// What a binding is called by people.
pub fn name(binding: u32) -> &'static str {
    match binding {
        binding::FRAME => "frame",
        binding::NODES => "hierarchy",
        binding::TRIANGLES => "triangles",
        binding::NORMALS => "normals",
        binding::MATERIALS => "materials",
        binding::LIGHTS => "lights",
        binding::PATHS => "paths",
        binding::HITS => "hits",
        binding::SHADOWS => "shadows",
        binding::FILM => "film",
        binding::QUEUE => "queue",
        binding::NEXT => "next queue",
        binding::COUNTERS => "counters",
        binding::WIDE => "wide hierarchy",
        binding::BOUNDS => "bounds",
        _ => "unknown",
    }
}

/// What a slot takes of each buffer of a launch, in bytes.
struct Share {
    paths: u64,
    shadows: u64,
}

impl Share {
    fn of(packed: &Packed) -> Share {
        Share {
            paths: u64::from(packed.levels()) * u64::from(RECORDS) * RECORD,
            shadows: 4 * packed.lights.len() as u64,
        }
    }
}

/// The most slots of a launch on this GPU.
///
/// # Errors
/// If not even a block of pixels fits.
pub(super) fn most_slots(gpu: &Gpu, packed: &Packed) -> Result<u32> {
    let limit = gpu.report.max_binding.min(gpu.report.max_buffer);
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    if packed.lights.len() as u64 > u64::from(most) {
        return Err(Error::TooManyLights {
            device: gpu.report.name.clone(),
            lights: packed.lights.len(),
            most: most.into(),
        });
    }
    let share = Share::of(packed);
    let memory = limit.min(MOST) / share.paths.max(share.shadows).max(RECORD);
    let threads = u64::from(most) * u64::from(WORKGROUP);
    let slots = memory.min(threads).min(RAYS / (packed.lights.len() as u64).max(1)) / 32 * 32;
    if memory < 32 {
        return Err(Error::TooLarge {
            device: gpu.report.name.clone(),
            what: Content::Block,
            bytes: 32 * share.paths.max(share.shadows),
            limit,
        });
    }
    Ok(slots.max(32) as u32)
}

/// Bytes of the memory that the stages of a launch exchange.
#[derive(Default)]
pub(super) struct Room {
    pub paths: u64,
    pub hits: u64,
    pub shadows: u64,
    pub film: u64,
    pub queue: u64,
}

impl Room {
    /// For launches of `slots` slots and `pixels` pixels.
    pub fn of(packed: &Packed, slots: u64, pixels: u64) -> Room {
        let share = Share::of(packed);
        Room {
            paths: share.paths * slots,
            hits: RECORD * slots,
            shadows: share.shadows * slots,
            film: RECORD * pixels,
            queue: if packed.has_secondary_rays() { 4 * slots } else { 0 },
        }
    }
}

/// The memory of launches, bound together with a scene.
pub(super) struct Buffers {
    pub frame: wgpu::Buffer,
    pub paths: wgpu::Buffer,
    pub hits: wgpu::Buffer,
    pub shadows: wgpu::Buffer,
    pub film: wgpu::Buffer,
    pub counters: wgpu::Buffer,
    /// A copy of the counters for indirect dispatches, which a buffer in use can't serve.
    pub arguments: wgpu::Buffer,
    /// Two, since each wave's next queue is the queue of the following.
    pub groups: [wgpu::BindGroup; 2],
}

impl Buffers {
    /// Takes the memory of launches in a scene.
    pub fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, scene: &SceneBuffers, room: &Room) -> Result<Buffers> {
        use wgpu::BufferUsages as Use;
        let empty = |name, size: u64, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(name),
                size: size.max(DUMMY),
                usage,
                mapped_at_creation: false,
            })
        };
        let frame = empty("frame", size_of::<Frame>() as u64, Use::UNIFORM | Use::COPY_DST);
        let paths = empty("paths", room.paths, Use::STORAGE | Use::COPY_DST);
        let hits = empty("hits", room.hits, Use::STORAGE | Use::COPY_SRC);
        let shadows = empty("shadows", room.shadows, Use::STORAGE | Use::COPY_SRC);
        let film = empty("film", room.film, Use::STORAGE | Use::COPY_SRC | Use::COPY_DST);
        let queues = [empty("queue", room.queue, Use::STORAGE), empty("queue", room.queue, Use::STORAGE)];
        let words = 4 * u64::from(counter::LENGTH);
        let counters = empty("counters", words, Use::STORAGE | Use::COPY_SRC | Use::COPY_DST);
        let arguments = empty("arguments", words, Use::INDIRECT | Use::COPY_DST);
        let groups = [0, 1].map(|turn| {
            let launch = [
                (binding::FRAME, &frame),
                (binding::PATHS, &paths),
                (binding::HITS, &hits),
                (binding::SHADOWS, &shadows),
                (binding::FILM, &film),
                (binding::QUEUE, &queues[turn]),
                (binding::NEXT, &queues[1 - turn]),
                (binding::COUNTERS, &counters),
            ];
            let entries: Vec<_> = (launch.into_iter().chain(scene.bound()))
                .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
                .collect();
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        });
        gpu.check()?;
        Ok(Buffers { frame, paths, hits, shadows, film, counters, arguments, groups })
    }
}

/// The layout that every stage shares.
pub(super) fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    use wgpu::BufferBindingType::{Storage, Uniform};
    let entries: Vec<_> = (0..binding::COUNT)
        .map(|binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match binding {
                    binding::FRAME => Uniform,
                    binding::NODES..=binding::LIGHTS | binding::WIDE | binding::BOUNDS => Storage { read_only: true },
                    _ => Storage { read_only: false },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("eyerays"), entries: &entries })
}
