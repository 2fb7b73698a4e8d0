//! Device memory: the scene's, and a launch's.

use bytemuck::NoUninit;
use eyerays_shader::data::{Features, Frame};
use eyerays_shader::launch::{WORKGROUP, binding, counter};
use eyerays_shader::stage::RECORDS;

use super::device::Gpu;
use crate::error::{Error, Result};
use crate::pack::Packed;

/// What stands for a buffer that the scene does not need.
const DUMMY: u64 = 16;
/// Bytes of a record.
const RECORD: u64 = 16;
/// The most memory one kind of record takes; a larger picture is rendered in more bands.
const MOST: u64 = 1 << 30;
/// The most rays a dispatch traces, so that no watchdog takes it for hung.
const RAYS: u64 = 1 << 22;

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
/// If not even a block of pixels fits, or the scene is larger than a buffer.
pub(super) fn most_slots(gpu: &Gpu, packed: &Packed) -> Result<u32> {
    let limit = gpu.report.max_binding.min(gpu.report.max_buffer);
    let scene = [
        ("hierarchy", size_of_val(packed.nodes.as_slice())),
        ("triangles", size_of_val(packed.triangles.as_slice())),
        ("normals", size_of_val(packed.normals.as_slice())),
    ];
    for (name, size) in scene {
        if size as u64 > limit {
            return Err(Error::new(format!(
                "the scene's {name} take {size} bytes, but \"{}\" has buffers of at most {limit}: use --device cpu",
                gpu.report.name
            )));
        }
    }
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    if packed.lights.len() as u64 > u64::from(most) {
        return Err(Error::new(format!(
            "the scene has {} lights, but \"{}\" takes at most {most}: remove some, or use --device cpu",
            packed.lights.len(),
            gpu.report.name
        )));
    }
    let share = Share::of(packed);
    let memory = limit.min(MOST) / share.paths.max(share.shadows).max(RECORD);
    let threads = u64::from(most) * u64::from(WORKGROUP);
    let slots = memory.min(threads).min(RAYS / (packed.lights.len() as u64).max(1)) / 32 * 32;
    if memory < 32 {
        return Err(Error::new(format!(
            "a block of pixels needs buffers of {} bytes, but \"{}\" has at most {limit}: lower --bounces, remove lights, or use --device cpu",
            32 * share.paths.max(share.shadows),
            gpu.report.name
        )));
    }
    Ok(slots.max(32) as u32)
}

/// The buffers of a renderer, bound.
pub(super) struct Buffers {
    pub frame: wgpu::Buffer,
    pub film: wgpu::Buffer,
    pub counters: wgpu::Buffer,
    /// A copy of the counters for indirect dispatches, which a buffer in use can't serve.
    pub arguments: wgpu::Buffer,
    /// Two, since each wave's next queue is the queue of the following.
    pub groups: [wgpu::BindGroup; 2],
}

impl Buffers {
    /// Uploads the scene and takes the memory of launches of `slots` slots and `pixels` pixels.
    pub fn new(gpu: &Gpu, packed: &Packed, layout: &wgpu::BindGroupLayout, slots: u64, pixels: u64) -> Result<Buffers> {
        use wgpu::BufferUsages as Use;
        let share = Share::of(packed);
        let queue = if packed.has_secondary_rays() { 4 * slots } else { 0 };
        let empty = |name, size: u64, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(name),
                size: size.max(DUMMY),
                usage,
                mapped_at_creation: false,
            })
        };
        let nodes = upload(gpu, "nodes", &packed.nodes)?;
        let triangles = upload(gpu, "triangles", &packed.triangles)?;
        let smooth = packed.features.has(Features::SMOOTH);
        let normals = upload(gpu, "normals", if smooth { &packed.normals } else { &[] })?;
        let materials = upload(gpu, "materials", &packed.materials)?;
        let lights = upload(gpu, "lights", &packed.lights)?;
        let frame = empty("frame", size_of::<Frame>() as u64, Use::UNIFORM | Use::COPY_DST);
        let paths = empty("paths", share.paths * slots, Use::STORAGE);
        let hits = empty("hits", RECORD * slots, Use::STORAGE);
        let shadows = empty("shadows", share.shadows * slots, Use::STORAGE);
        let film = empty("film", RECORD * pixels, Use::STORAGE | Use::COPY_SRC | Use::COPY_DST);
        let queues = [empty("queue", queue, Use::STORAGE), empty("queue", queue, Use::STORAGE)];
        let words = 4 * u64::from(counter::LENGTH);
        let counters = empty("counters", words, Use::STORAGE | Use::COPY_SRC | Use::COPY_DST);
        let arguments = empty("arguments", words, Use::INDIRECT | Use::COPY_DST);
        let groups = [0, 1].map(|turn| {
            let bound = [
                (binding::FRAME, &frame),
                (binding::NODES, &nodes),
                (binding::TRIANGLES, &triangles),
                (binding::NORMALS, &normals),
                (binding::MATERIALS, &materials),
                (binding::LIGHTS, &lights),
                (binding::PATHS, &paths),
                (binding::HITS, &hits),
                (binding::SHADOWS, &shadows),
                (binding::FILM, &film),
                (binding::QUEUE, &queues[turn]),
                (binding::NEXT, &queues[1 - turn]),
                (binding::COUNTERS, &counters),
            ];
            let entries =
                bound.map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        });
        gpu.check()?;
        Ok(Buffers { frame, film, counters, arguments, groups })
    }
}

/// The layout that every stage shares.
pub(super) fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    use wgpu::BufferBindingType::{Storage, Uniform};
    let entries: Vec<_> = (binding::FRAME..=binding::COUNTERS)
        .map(|binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match binding {
                    binding::FRAME => Uniform,
                    binding::NODES..=binding::LIGHTS => Storage { read_only: true },
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

/// A read-only buffer of records, or a dummy of zeros.
fn upload<T: NoUninit>(gpu: &Gpu, name: &str, records: &[T]) -> Result<wgpu::Buffer> {
    let bytes: &[u8] = bytemuck::cast_slice(records);
    // A dummy has room for the largest record, since a kernel may be validated against its size.
    let size = (bytes.len() as u64).max(DUMMY).max(size_of::<T>() as u64);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(name),
        size,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: true,
    });
    gpu.check()?;
    let mapped = buffer.get_mapped_range_mut(..);
    mapped
        .map_err(|e| Error::new(format!("can't upload the {name} to \"{}\": {e}", gpu.report.name)))?
        .slice(..bytes.len())
        .copy_from_slice(bytes);
    buffer.unmap();
    Ok(buffer)
}
