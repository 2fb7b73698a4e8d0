//! Scenes on a GPU whose triangles move: vertices are uploaded, and the hierarchy is fitted to them there.

use eyerays_bvh::refit::runs;
use eyerays_modules::REFIT;
use eyerays_shader::data::Effects;
use eyerays_shader::refit::{Refit, blocks, level, levels};
use eyerays_shader::resources::binding;
use glam::{UVec4, Vec3};
use rayon::prelude::*;

use super::device::Gpu;
use super::linear::Linear;
use super::scene::SceneBuffers;
use super::step::{Kernel, Step, empty, filled, run, uniform};
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
    /// What puts vertices where they are.
    gather: Vec<Step>,
    /// What fits the hierarchy that the scene was packed with.
    fit: Vec<Step>,
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
        let (slots, pairs) =
            (job.primitives().len() as u32, if job.is_left_open() { 0 } else { job.nodes().len() as u32 });
        let corner = |primitive: &eyerays_shader::data::Primitive| {
            let [a, b, c] = scene.mesh.triangles[primitive.number() as usize];
            UVec4::new(a, b, c, 0)
        };
        let corners: Vec<UVec4> = job.primitives().par_iter().map(corner).collect();
        // Kernels read vertices by them without checking them again.
        let vertices = scene.mesh.positions.len();
        if corners.par_iter().any(|corners| corners.max_element() as usize >= vertices) {
            return Err(Error::new("a triangle names a vertex that the scene has not: give the scene that was packed"));
        }
        let corners = filled(gpu, "corners", bytemuck::cast_slice(&corners));
        // Of what the device has built it knows the runs.
        let runs = if job.is_left_open() { Vec::new() } else { runs(job.nodes()) };
        let runs = (!runs.is_empty()).then(|| filled(gpu, "runs", bytemuck::cast_slice(&runs)));
        let vectors = |name| empty(gpu, name, 12 * vertices as u64);
        let normals = job.effects().has(Effects::SMOOTH).then(|| buffers.find(binding::NORMALS)).flatten();
        let all = empty(gpu, "blocks", 32 * u64::from(blocks(slots)));
        let told = Refit { slots, pairs, level: 0, unused: 0 };
        let (positions, turned) = (vectors("positions"), normals.map(|_| vectors("vertex normals")));
        gpu.check()?;
        let kernel = |name, writes: &[bool]| Kernel::new(gpu, REFIT, name, writes);
        let uniform = uniform(gpu, &told);
        let place = kernel("refit::place", &[false, false, true, true]);
        let mut gather = vec![place.step(gpu, &uniform, &[&corners, &positions, primitives, &all], slots)];
        if let (Some(normals), Some(vectors)) = (normals, &turned) {
            let turn = kernel("refit::turn", &[false, false, true]);
            gather.push(turn.step(gpu, &uniform, &[&corners, vectors, normals], slots));
        }
        let fit = runs.map_or_else(Vec::new, |runs| fitting(gpu, &told, (&runs, &all, nodes)));
        gpu.check()?;
        Ok(Moving { positions, normals: turned, vertices, gather, fit })
    }

    /// Moves the vertices, in world units, and fits the hierarchy: that of the device, if it has built one.
    ///
    /// # Errors
    /// They are not as many as before, or leave the cube that the scene was normalised to; or what the GPU reports.
    pub fn go(
        &self,
        (gpu, job): (&Gpu, &Job),
        linear: Option<&Linear>,
        positions: &[Vec3],
        normals: &[Vec3],
    ) -> Result<()> {
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
        match linear {
            Some(linear) => run(gpu, self.gather.iter().chain(linear.fit())),
            None => run(gpu, self.gather.iter().chain(&self.fit)),
        }
    }
}

/// What fits the boxes of nodes to the blocks of slots, of which each has its own: `runs` are those below the nodes.
pub(super) fn fitting(
    gpu: &Gpu,
    told: &Refit,
    (runs, blocks, nodes): (&wgpu::Buffer, &wgpu::Buffer, &wgpu::Buffer),
) -> Vec<Step> {
    let merge = Kernel::new(gpu, REFIT, "refit::merge", &[true]);
    let merged = (1..levels(told.slots)).map(|number| {
        let record = uniform(gpu, &Refit { level: number, ..*told });
        merge.step(gpu, &record, &[blocks], level(told.slots, number).1)
    });
    let fit = Kernel::new(gpu, REFIT, "refit::fit", &[false, false, true]);
    let fit = fit.step(gpu, &uniform(gpu, told), &[runs, blocks, nodes], told.pairs);
    merged.chain([fit]).collect()
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
