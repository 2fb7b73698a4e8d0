//! Device memory of a scene.

use bytemuck::NoUninit;
use eyerays_shader::data::Features;
use eyerays_shader::launch::binding;

use super::buffers::DUMMY;
use super::device::Gpu;
use crate::error::{Error, Result};
use crate::method::Layout;
use crate::pack::{NodeWords, Packed, TriangleWords};

/// What kernels read of a scene; a dummy for what they do not.
pub(super) struct SceneBuffers {
    nodes: wgpu::Buffer,
    wide: wgpu::Buffer,
    triangles: wgpu::Buffer,
    bounds: wgpu::Buffer,
    normals: wgpu::Buffer,
    materials: wgpu::Buffer,
    lights: wgpu::Buffer,
}

impl SceneBuffers {
    /// Uploads a scene in one of its layouts. A hierarchy that no method walks may be left
    /// out.
    ///
    /// # Errors
    /// If a part is larger than a buffer, or what the GPU reports.
    pub fn new(gpu: &Gpu, packed: &Packed, layout: Layout, hierarchies: Hierarchies) -> Result<SceneBuffers> {
        let nodes = NodeWords::of(packed, layout);
        let smooth = packed.features.has(Features::SMOOTH);
        Ok(SceneBuffers {
            nodes: upload(gpu, "hierarchy", if hierarchies.binary { &nodes.0 } else { &[] })?,
            wide: upload(gpu, "wide hierarchy", if hierarchies.wide { &packed.wide } else { &[] })?,
            triangles: upload(gpu, "triangles", &TriangleWords::of(packed, layout).0)?,
            bounds: upload(gpu, "bounds", &packed.bounds)?,
            normals: upload(gpu, "normals", if smooth { &packed.normals } else { &[] })?,
            materials: upload(gpu, "materials", &packed.materials)?,
            lights: upload(gpu, "lights", &packed.lights)?,
        })
    }

    /// Every buffer with its binding.
    pub fn bound(&self) -> [(u32, &wgpu::Buffer); 7] {
        [
            (binding::NODES, &self.nodes),
            (binding::WIDE, &self.wide),
            (binding::TRIANGLES, &self.triangles),
            (binding::BOUNDS, &self.bounds),
            (binding::NORMALS, &self.normals),
            (binding::MATERIALS, &self.materials),
            (binding::LIGHTS, &self.lights),
        ]
    }
}

/// Which hierarchies are walked.
#[derive(Clone, Copy, Default)]
pub(super) struct Hierarchies {
    pub binary: bool,
    pub wide: bool,
}

/// A read-only buffer of records, or a dummy of zeros.
fn upload<T: NoUninit>(gpu: &Gpu, name: &str, records: &[T]) -> Result<wgpu::Buffer> {
    let bytes: &[u8] = bytemuck::cast_slice(records);
    let limit = gpu.report.max_binding.min(gpu.report.max_buffer);
    if bytes.len() as u64 > limit {
        return Err(Error::new(format!(
            "the scene's {name} take {} bytes, but \"{}\" has buffers of at most {limit}: use --device cpu",
            bytes.len(),
            gpu.report.name
        )));
    }
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
