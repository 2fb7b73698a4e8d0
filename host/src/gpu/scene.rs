//! Device memory of a scene.

use eyerays_shader::data::{Effects, Media};
use eyerays_shader::resources::{RESOURCES, binding};

use super::adapter::AdapterReport;
use super::device::Gpu;
use super::linear::Linear;
use crate::device_scene::{NodeWords, PrimitiveWords};
use crate::error::{Content, Error, Result};
use crate::job::Job;
use crate::method::{Layout, Method};
use crate::plan::Plan;

/// The records of a scene as kernels read them, before they are uploaded.
pub(super) struct SceneRecords<'a> {
    packed: &'a Job,
    nodes: Option<NodeWords>,
    primitives: PrimitiveWords,
    wide: bool,
}

impl<'a> SceneRecords<'a> {
    /// A scene in one of its layouts. A hierarchy that no method walks is left out.
    pub fn new(packed: &'a Job, layout: Layout, hierarchies: Hierarchies) -> Self {
        // What is left open a device builds, in the layout that it knows.
        let is_open = packed.is_left_open() && layout == Layout::Gathered;
        let nodes = (hierarchies.binary && !is_open).then(|| NodeWords::of(packed, layout));
        SceneRecords { packed, nodes, primitives: PrimitiveWords::of(packed, layout), wide: hierarchies.wide }
    }

    /// Every binding with its bytes, none where the scene has no use for it.
    pub fn bytes(&self) -> [(u32, &[u8]); 26] {
        let (packed, textures) = (self.packed, self.packed.textures());
        let wide = if self.wide { packed.wide() } else { &[] };
        let is_chosen = packed.settings().transport.integrator.chooses_lights();
        let lighting = is_chosen.then(|| packed.lighting());
        let physicals = if packed.effects().has(Effects::PHYSICAL) { packed.physicals() } else { &[] };
        let finishes = if packed.finish_bits().any() { packed.finishes() } else { &[] };
        let normals = if packed.effects().has(Effects::SMOOTH) { packed.normals() } else { &[] };
        let media = if packed.media_bits().has(Media::PRESENT) { packed.media() } else { &[] };
        let casters = if packed.has_photons() { packed.casters() } else { &[] };
        let grids = if packed.media_bits().has(Media::GRIDS) { packed.grids() } else { &[] };
        [
            (binding::NODES, self.nodes.as_ref().map_or(&[], |nodes| bytemuck::cast_slice(nodes.words(packed)))),
            (binding::WIDE, bytemuck::cast_slice(wide)),
            (binding::PRIMITIVES, bytemuck::cast_slice(self.primitives.words(packed))),
            (binding::INSTANCES, bytemuck::cast_slice(packed.instances())),
            (binding::NORMALS, bytemuck::cast_slice(normals)),
            (binding::MATERIALS, bytemuck::cast_slice(packed.materials())),
            (binding::LIGHTS, bytemuck::cast_slice(packed.lights())),
            (binding::EMITTERS, lighting.map_or(&[], |lighting| bytemuck::cast_slice(&lighting.emitters))),
            (binding::LIGHT_NODES, lighting.map_or(&[], |lighting| bytemuck::cast_slice(&lighting.nodes))),
            (binding::EMISSIONS, lighting.map_or(&[], |lighting| bytemuck::cast_slice(&lighting.emissions))),
            (binding::PHYSICALS, bytemuck::cast_slice(physicals)),
            (binding::FINISHES, bytemuck::cast_slice(finishes)),
            (binding::MAPS, bytemuck::cast_slice(&textures.maps)),
            (binding::TEXTURES, bytemuck::cast_slice(&textures.textures)),
            (binding::TEXELS, bytemuck::cast_slice(&textures.texels)),
            (binding::COORDINATES, bytemuck::cast_slice(&textures.coordinates)),
            (binding::COLOURS, bytemuck::cast_slice(&textures.colours)),
            (binding::TANGENTS, bytemuck::cast_slice(&textures.tangents)),
            (binding::OPACITIES, bytemuck::cast_slice(&textures.opacities)),
            (binding::ENVIRONMENT, bytemuck::cast_slice(packed.environment())),
            (binding::ALBEDOS, bytemuck::cast_slice(packed.albedos())),
            (binding::MEDIA, bytemuck::cast_slice(media)),
            (binding::GRIDS, bytemuck::cast_slice(grids)),
            (binding::SPECTRA, bytemuck::cast_slice(packed.spectra())),
            (binding::CASTERS, bytemuck::cast_slice(casters)),
            (binding::OPTICS, bytemuck::cast_slice(packed.optic_tables())),
        ]
    }
}

/// What kernels read of a scene, and nothing else.
#[derive(Default)]
pub(super) struct SceneBuffers(Vec<(u32, wgpu::Buffer)>);

impl SceneBuffers {
    /// Uploads what a job asks of its scene, in one of the scene's layouts. A hierarchy that no method walks may be left out.
    ///
    /// # Errors
    /// If a part is larger than a buffer or all of it than the GPU's memory, before anything is uploaded; or what the GPU
    /// reports.
    pub fn new(gpu: &Gpu, job: &Job, layout: Layout, hierarchies: Hierarchies) -> Result<SceneBuffers> {
        let mut buffers = SceneBuffers::default();
        buffers.complete(gpu, job, layout, hierarchies)?;
        Ok(buffers)
    }

    /// Uploads what another job of the scene asks for and is not there.
    ///
    /// # Errors
    /// As [`SceneBuffers::new`].
    pub fn complete(&mut self, gpu: &Gpu, job: &Job, layout: Layout, hierarchies: Hierarchies) -> Result<()> {
        if hierarchies.wide {
            job.check_walks(Method::Wide)?;
        }
        let records = SceneRecords::new(job, layout, hierarchies);
        let used: Vec<_> = records.bytes().into_iter().filter(|(_, bytes)| !bytes.is_empty()).collect();
        check(&gpu.report, &used)?;
        for (binding, bytes) in used {
            if self.find(binding).is_none() {
                self.0.push((binding, upload(gpu, binding, bytes)?));
            }
        }
        if hierarchies.binary && job.is_left_open() && self.find(binding::NODES).is_none() {
            let linear = Linear::new(gpu, job, layout, self)?;
            linear.go(gpu)?;
            self.0.push((binding::NODES, linear.nodes().clone()));
        }
        Ok(())
    }

    /// Takes another buffer in the place of a resource's.
    pub fn replace(&mut self, binding: u32, buffer: wgpu::Buffer) {
        self.0.retain(|(own, _)| *own != binding);
        self.0.push((binding, buffer));
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

/// Refuses what no buffer or not all of the memory can hold.
fn check(gpu: &AdapterReport, buffers: &[(u32, &[u8])]) -> Result<()> {
    let within = |what, bytes, limit| {
        if bytes <= limit { Ok(()) } else { Err(Error::TooLarge { device: gpu.name.clone(), what, bytes, limit }) }
    };
    let mut sum = 0;
    for &(binding, bytes) in buffers {
        let (name, bytes) = (RESOURCES[binding as usize].name, bytes.len() as u64);
        within(Content::Scene(name.to_owned()), bytes, gpu.max_binding.min(gpu.max_buffer))?;
        sum += bytes;
    }
    within(Content::WholeScene, sum, gpu.memory.unwrap_or(u64::MAX))
}

/// Bytes that are on their way to a GPU at a time: the host has a copy of them until they are there.
const PORTION: usize = 64 << 20;

/// A read-only buffer.
fn upload(gpu: &Gpu, binding: u32, bytes: &[u8]) -> Result<wgpu::Buffer> {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(RESOURCES[binding as usize].name),
        size: bytes.len() as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.check()?;
    for (number, portion) in bytes.chunks(PORTION).enumerate() {
        gpu.queue.write_buffer(&buffer, (number * PORTION) as u64, portion);
        if bytes.len() > PORTION {
            gpu.queue.submit([]);
            gpu.wait()?;
        }
    }
    Ok(buffer)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use eyerays_bvh::Quality;
    use glam::DVec3;

    use super::*;
    use crate::device_scene::Feature;
    use crate::scene::{Grid, Integrator, Medium, Settings, Transport, Volume};

    #[test]
    fn media_go_to_the_device_where_kernels_go_through_them_and_only_there() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/whitted.toml");
        let mut scene = crate::scene_io::load(path.as_ref()).unwrap().0;
        let by = |integrator| {
            let transport = Transport { integrator, ..scene.settings.transport };
            Settings { transport, ..scene.settings }
        };
        let (paths, occlusion) = (by(Integrator::Path), by(Integrator::Ao));
        let sizes = |job: &Job| {
            let records = SceneRecords::new(job, Layout::Gathered, Hierarchies::default());
            let bytes = records.bytes();
            [binding::MEDIA, binding::GRIDS].map(|wanted| bytes.iter().find(|(own, _)| *own == wanted).unwrap().1.len())
        };
        scene.fog = Some(Medium::default());
        let fog = Job::new(&scene, paths, Quality::Fast).unwrap();
        assert!(sizes(&fog)[0] > 0 && sizes(&fog)[1] == 0);
        let density = Grid::dense("smoke", [1, 1, 2], &[1.0, 2.0], [DVec3::ZERO, DVec3::ONE]);
        scene.materials[0].volume =
            Some(Volume { density: Some(Arc::new(density)), ..Volume::open(Medium::default()) });
        let smoke = Job::new(&scene, paths, Quality::Fast).unwrap();
        assert!(sizes(&smoke).iter().all(|&size| size > 0));
        assert_eq!(sizes(&smoke.showing(Some(Feature::Normal))), [0, 0]);
        assert_eq!(sizes(&smoke.with(occlusion).unwrap()), [0, 0]);
    }

    #[test]
    fn a_scene_over_a_buffer_or_over_the_memory_is_refused_with_both_numbers() {
        let report = AdapterReport {
            index: 0,
            name: "small".into(),
            backend: "Vulkan".into(),
            kind: "discrete",
            driver: String::new(),
            passthrough: true,
            exact: true,
            subgroup: (32, 32),
            max_buffer: 500,
            max_binding: 100,
            memory: Some(150),
            timestamps: true,
        };
        let buffers = |lengths: [usize; 2]| {
            let bytes = &[0; 200];
            check(&report, &[(binding::NODES, &bytes[..lengths[0]]), (binding::PRIMITIVES, &bytes[..lengths[1]])])
        };
        let refused = |lengths| buffers(lengths).expect_err("accepted").message();
        assert_eq!(buffers([100, 50]), Ok(()));
        let over = "the scene's hierarchy would take 101 bytes, but \"small\" has buffers of at most 100";
        assert_eq!(refused([101, 0]), over);
        assert_eq!(refused([100, 51]), "the scene takes 151 bytes, but \"small\" has 150 bytes of memory");
    }
}
