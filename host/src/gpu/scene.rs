//! Device memory of a scene.

use eyerays_shader::data::Effects;
use eyerays_shader::resources::{RESOURCES, binding};

use super::device::Gpu;
use crate::device_scene::{DeviceScene, NodeWords, PrimitiveWords};
use crate::error::{Content, Error, Result};
use crate::method::Layout;
use crate::plan::Plan;

/// The records of a scene as kernels read them, before they are uploaded.
pub(super) struct SceneRecords<'a> {
    packed: &'a DeviceScene,
    nodes: Option<NodeWords<'a>>,
    primitives: PrimitiveWords<'a>,
    wide: bool,
}

impl<'a> SceneRecords<'a> {
    /// A scene in one of its layouts. A hierarchy that no method walks is left out.
    pub fn new(packed: &'a DeviceScene, layout: Layout, hierarchies: Hierarchies) -> Self {
        let nodes = hierarchies.binary.then(|| NodeWords::of(packed, layout));
        SceneRecords { packed, nodes, primitives: PrimitiveWords::of(packed, layout), wide: hierarchies.wide }
    }

    /// Every binding with its bytes, none where the scene has no use for it.
    pub fn bytes(&self) -> [(u32, &[u8]); 9] {
        let packed = self.packed;
        let wide = if self.wide { packed.wide() } else { &[] };
        let is_chosen = packed.settings().transport.integrator.chooses_lights();
        let (emitters, emissions): (&[_], &[_]) =
            if is_chosen { (&packed.lighting().emitters, &packed.lighting().emissions) } else { (&[], &[]) };
        let normals = if packed.effects().has(Effects::SMOOTH) { packed.normals() } else { &[] };
        [
            (binding::NODES, self.nodes.as_ref().map_or(&[], |nodes| bytemuck::cast_slice(&nodes.0))),
            (binding::WIDE, bytemuck::cast_slice(wide)),
            (binding::PRIMITIVES, bytemuck::cast_slice(&self.primitives.0)),
            (binding::BOUNDS, bytemuck::cast_slice(packed.bounds())),
            (binding::NORMALS, bytemuck::cast_slice(normals)),
            (binding::MATERIALS, bytemuck::cast_slice(packed.materials())),
            (binding::LIGHTS, bytemuck::cast_slice(packed.lights())),
            (binding::EMITTERS, bytemuck::cast_slice(emitters)),
            (binding::EMISSIONS, bytemuck::cast_slice(emissions)),
        ]
    }
}

/// What kernels read of a scene, and nothing else.
pub(super) struct SceneBuffers(Vec<(u32, wgpu::Buffer)>);

impl SceneBuffers {
    /// Uploads a scene in one of its layouts. A hierarchy that no method walks may be left
    /// out.
    ///
    /// # Errors
    /// If a part is larger than a buffer, or what the GPU reports.
    pub fn new(gpu: &Gpu, packed: &DeviceScene, layout: Layout, hierarchies: Hierarchies) -> Result<SceneBuffers> {
        let records = SceneRecords::new(packed, layout, hierarchies);
        let used = records.bytes().into_iter().filter(|(_, bytes)| !bytes.is_empty());
        used.map(|(binding, bytes)| Ok((binding, upload(gpu, binding, bytes)?)))
            .collect::<Result<_>>()
            .map(SceneBuffers)
    }

    /// The buffer of a resource.
    pub fn find(&self, binding: u32) -> Option<&wgpu::Buffer> {
        self.0.iter().find(|(own, _)| *own == binding).map(|(_, buffer)| buffer)
    }
}

/// Which hierarchies are walked.
#[derive(Clone, Copy, Default)]
pub(super) struct Hierarchies {
    pub binary: bool,
    pub wide: bool,
}

impl From<&Plan> for Hierarchies {
    fn from(plan: &Plan) -> Self {
        Hierarchies { binary: plan.walks_pairs(), wide: plan.walks_wide() }
    }
}

/// A read-only buffer.
fn upload(gpu: &Gpu, binding: u32, bytes: &[u8]) -> Result<wgpu::Buffer> {
    let (limit, name) = (gpu.report.max_binding.min(gpu.report.max_buffer), RESOURCES[binding as usize].name);
    if bytes.len() as u64 > limit {
        return Err(Error::TooLarge {
            device: gpu.report.name.clone(),
            what: Content::Scene(name.to_owned()),
            bytes: bytes.len() as u64,
            limit,
        });
    }
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(name),
        size: bytes.len() as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: true,
    });
    gpu.check()?;
    let mapped = buffer.get_mapped_range_mut(..);
    mapped
        .map_err(|e| Error::DeviceFailed {
            device: gpu.report.name.clone(),
            message: format!("the {name} can't be uploaded: {e}"),
        })?
        .slice(..bytes.len())
        .copy_from_slice(bytes);
    buffer.unmap();
    Ok(buffer)
}
