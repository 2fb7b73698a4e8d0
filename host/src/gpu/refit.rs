//! Scenes on a GPU whose triangles move: vertices are uploaded, and the hierarchy is fitted to them there.

use eyerays_bvh::refit::runs;
use eyerays_shader::data::Effects;
use eyerays_shader::launch::{ROW, WORKGROUP};
use eyerays_shader::refit::{Refit, blocks, level, levels};
use eyerays_shader::resources::binding;
use glam::{UVec4, Vec3};
use rayon::prelude::*;
use wgpu::BufferUsages as Use;

use super::device::Gpu;
use super::scene::SceneBuffers;
use super::{module, readback};
use crate::device_scene::flushed;
use crate::error::{Error, Result};
use crate::job::Job;
use crate::method::Layout;
use crate::scene::Scene;

/// What a scene takes to be moved.
pub(super) struct Moving {
    positions: wgpu::Buffer,
    normals: Option<wgpu::Buffer>,
    /// Vertices of the scene.
    vertices: usize,
    steps: Vec<Step>,
}

/// A dispatch.
struct Step {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    threads: u32,
}

impl Moving {
    /// Prepares a scene that is on the device for vertices elsewhere.
    ///
    /// # Errors
    /// It has more than triangles that stand where they are, its triangles are split or shine, or its layout or hierarchy is no plain one.
    pub fn new(gpu: &Gpu, job: &Job, layout: Layout, scene: &Scene, buffers: &SceneBuffers) -> Result<Moving> {
        check(job, layout, scene)?;
        let (Some(nodes), Some(primitives)) = (buffers.find(binding::NODES), buffers.find(binding::PRIMITIVES)) else {
            return Err(Error::new("the hierarchy of pairs is not on the device: choose another method than wide"));
        };
        let (slots, pairs) = (job.primitives().len() as u32, job.nodes().len() as u32);
        let corner = |primitive: &eyerays_shader::data::Primitive| {
            let [a, b, c] = scene.mesh.triangles[primitive.number() as usize];
            UVec4::new(a, b, c, 0)
        };
        let corners: Vec<UVec4> = job.primitives().par_iter().map(corner).collect();
        let corners = filled(gpu, "corners", bytemuck::cast_slice(&corners));
        let runs = filled(gpu, "runs", bytemuck::cast_slice(&runs(job.nodes())));
        let vertices = scene.mesh.positions.len();
        let vectors = |name| empty(gpu, name, 12 * vertices as u64);
        let normals = job.effects().has(Effects::SMOOTH).then(|| buffers.find(binding::NORMALS)).flatten();
        let all = empty(gpu, "blocks", 32 * u64::from(blocks(slots)));
        let told = Refit { slots, pairs, level: 0, unused: 0 };
        let (positions, turned) = (vectors("positions"), normals.map(|_| vectors("vertex normals")));
        gpu.check()?;
        let kernel = |name, writes: &[bool]| Kernel::new(gpu, name, writes);
        let (merge, uniform) = (kernel("refit::merge", &[true]), uniform(gpu, &told));
        let place = kernel("refit::place", &[false, false, true, true]);
        let mut steps = vec![place.step(gpu, &uniform, &[&corners, &positions, primitives, &all], slots)];
        if let (Some(normals), Some(vectors)) = (normals, &turned) {
            let turn = kernel("refit::turn", &[false, false, true]);
            steps.push(turn.step(gpu, &uniform, &[&corners, vectors, normals], slots));
        }
        for number in 1..levels(slots) {
            let told = self::uniform(gpu, &Refit { level: number, ..told });
            steps.push(merge.step(gpu, &told, &[&all], level(slots, number).1));
        }
        let fit = kernel("refit::fit", &[false, false, true]);
        steps.push(fit.step(gpu, &uniform, &[&runs, &all, nodes], pairs));
        gpu.check()?;
        Ok(Moving { positions, normals: turned, vertices, steps })
    }

    /// Moves the vertices, in world units, and fits the hierarchy.
    ///
    /// # Errors
    /// They are not as many as before, or leave the cube that the scene was normalised to; or what the GPU reports.
    pub fn go(&self, gpu: &Gpu, job: &Job, positions: &[Vec3], normals: &[Vec3]) -> Result<()> {
        let (count, vertices) = (positions.len(), self.vertices);
        if count != vertices || (self.normals.is_some() && normals.len() != vertices) {
            let own = normals.len();
            return Err(Error::new(format!(
                "the scene has {vertices} vertices and is given {count}, with {own} normals: give it as many"
            )));
        }
        let normalisation = job.normalisation();
        let placed: Vec<Vec3> = positions.par_iter().map(|&place| normalisation.place(place)).collect();
        let is_far = |place: &Vec3| !place.abs().cmple(Vec3::ONE).all();
        if let Some(vertex) = placed.par_iter().position_first(is_far) {
            return Err(Error::new(format!(
                "vertex {vertex} goes to {}, out of the box that the scene was packed in: pack it with all that it will reach",
                positions[vertex]
            )));
        }
        gpu.queue.write_buffer(&self.positions, 0, bytemuck::cast_slice(&placed));
        if let Some(buffer) = &self.normals {
            let flushed: Vec<Vec3> = normals.par_iter().map(|&normal| flushed(normal)).collect();
            gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(&flushed));
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for Step { pipeline, group, threads } in &self.steps {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups((*threads).min(ROW).div_ceil(WORKGROUP), threads.div_ceil(ROW), 1);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        gpu.check()
    }
}

/// Refuses what can't be moved so.
fn check(job: &Job, layout: Layout, scene: &Scene) -> Result<()> {
    let is_plain = scene.spheres.is_empty() && scene.disks.is_empty() && scene.instances.is_empty();
    let count = job.primitives().len();
    let refused = |why: &str| Err(Error::new(format!("the scene can't be moved on the device: {why}")));
    if !is_plain {
        return refused("it has spheres, disks or copies of meshes; pack it anew instead");
    }
    if count != scene.mesh.triangles.len() {
        return refused("its triangles are split; pack it with the hierarchy \"fast\"");
    }
    if layout != Layout::Gathered || !job.wide().is_empty() {
        return refused("its layout is no plain one; choose the layout \"gathered\", and pack it without wide nodes");
    }
    if job.emissive().is_some() {
        return refused("its triangles shine; pack it anew instead");
    }
    if job.effects().has(Effects::TANGENTS) {
        return refused("its triangles have tangents; pack it anew instead");
    }
    Ok(())
}

fn empty(gpu: &Gpu, name: &str, size: u64) -> wgpu::Buffer {
    let usage = Use::STORAGE | Use::COPY_DST;
    gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(name), size, usage, mapped_at_creation: false })
}

fn filled(gpu: &Gpu, name: &str, bytes: &[u8]) -> wgpu::Buffer {
    let buffer = empty(gpu, name, bytes.len() as u64);
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}

fn uniform(gpu: &Gpu, told: &Refit) -> wgpu::Buffer {
    let (label, size, usage) = (Some("refit"), size_of::<Refit>() as u64, Use::UNIFORM | Use::COPY_DST);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false });
    gpu.queue.write_buffer(&buffer, 0, bytemuck::bytes_of(told));
    buffer
}

/// A kernel that takes a uniform record and buffers.
struct Kernel {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Kernel {
    /// By its name, with whether it writes each of its buffers.
    fn new(gpu: &Gpu, name: &str, writes: &[bool]) -> Kernel {
        let storage = |&writes: &bool| wgpu::BufferBindingType::Storage { read_only: !writes };
        let types = [wgpu::BufferBindingType::Uniform].into_iter().chain(writes.iter().map(storage));
        let entries: Vec<_> = types
            .zip(0..)
            .map(|(ty, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                count: None,
            })
            .collect();
        let layout = &wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        let layout = gpu.device.create_bind_group_layout(layout);
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let words: Vec<u32> = readback::words(eyerays_modules::REFIT).collect();
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&pipeline_layout),
            module: &module::create(gpu, &words, name),
            entry_point: Some(name),
            compilation_options: Default::default(),
            cache: None,
        });
        Kernel { layout, pipeline }
    }

    /// A dispatch of so many threads over buffers, after the uniform record.
    fn step(&self, gpu: &Gpu, uniform: &wgpu::Buffer, buffers: &[&wgpu::Buffer], threads: u32) -> Step {
        let all = [&uniform].into_iter().chain(buffers).zip(0..);
        let entries: Vec<_> = all
            .map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let (layout, entries) = (&self.layout, &entries[..]);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries });
        Step { pipeline: self.pipeline.clone(), group, threads }
    }
}
