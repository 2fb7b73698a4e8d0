//! Hierarchies that a GPU builds over the triangles that it has.

use eyerays_modules::REFIT;
use eyerays_shader::linear::{CODE, DIGIT, Linear as Told, RUN, level, levels, runs};
use eyerays_shader::refit::{Refit, blocks};
use eyerays_shader::resources::binding;

use super::device::Gpu;
use super::refit::fitting;
use super::scene::SceneBuffers;
use super::step::{Kernel, Step, empty, run, uniform};
use crate::error::{Content, Error, Result};
use crate::job::Job;
use crate::method::Layout;

/// What builds a hierarchy of a scene, and what fits it to triangles that have moved since.
pub(super) struct Linear {
    nodes: wgpu::Buffer,
    build: Vec<Step>,
    fit: Vec<Step>,
}

impl Linear {
    /// Prepares that of a scene that is on the device.
    ///
    /// # Errors
    /// It has other primitives than triangles, or fewer than two; its layout is no plain one; or what it takes does not fit the GPU.
    pub fn new(gpu: &Gpu, job: &Job, layout: Layout, buffers: &SceneBuffers) -> Result<Linear> {
        let slots = job.primitives().len() as u32;
        let is_plain = job.primitives().iter().all(|primitive| primitive.is_triangle()) && job.instances().is_empty();
        if !is_plain || slots < 2 || layout != Layout::Gathered {
            let fault = "a device builds hierarchies of triangles alone, two at least, in the layout \"gathered\"";
            return Err(Error::new(format!("{fault}: choose that, or take the one that the scene was packed with")));
        }
        let primitives = buffers.find(binding::PRIMITIVES).expect("a scene has primitives");
        let pairs = slots - 1;
        let counts = {
            let (first, count) = level(slots, levels(slots) - 1);
            first + count
        };
        let sizes = [4 * u64::from(slots), 4 * u64::from(counts), 16 * u64::from(pairs)];
        let [words, counts, runs_size] = sizes;
        let (all, nodes) = (32 * u64::from(blocks(slots)), 64 * u64::from(pairs));
        let limit = gpu.report.max_binding.min(gpu.report.max_buffer);
        if all.max(nodes) > limit {
            let (device, what) = (gpu.report.name.clone(), Content::Scene("hierarchy".into()));
            return Err(Error::TooLarge { device, what, bytes: all.max(nodes), limit });
        }
        let keys = ["keys", "sorted keys"].map(|name| empty(gpu, name, words));
        let values = ["values", "sorted values"].map(|name| empty(gpu, name, words));
        let (counts, runs) = (empty(gpu, "counts", counts), empty(gpu, "runs", runs_size));
        let (all, nodes) = (empty(gpu, "blocks", all), empty(gpu, "hierarchy", nodes));
        gpu.check()?;
        let told = Told { slots, ..Told::default() };
        let first = uniform(gpu, &told);
        let code = Kernel::new(gpu, REFIT, "refit::code", &[false, true, true]);
        let mut build = vec![code.step(gpu, &first, &[primitives, &keys[0], &values[0]], slots)];
        build.extend(sorting(gpu, &told, (&keys, &values, &counts)));
        let tree = Kernel::new(gpu, REFIT, "refit::tree", &[false, false, true, true]);
        build.push(tree.step(gpu, &first, &[&keys[0], &values[0], &runs, &nodes], pairs));
        let leaves = Kernel::new(gpu, REFIT, "refit::leaves", &[false, false, true]);
        let mut fit = vec![leaves.step(gpu, &first, &[&values[0], primitives, &all], slots)];
        fit.extend(fitting(gpu, &Refit { slots, pairs, ..Refit::default() }, (&runs, &all, &nodes)));
        gpu.check()?;
        Ok(Linear { nodes, build, fit })
    }

    /// The nodes that it makes.
    pub fn nodes(&self) -> &wgpu::Buffer {
        &self.nodes
    }

    /// What fits it.
    pub fn fit(&self) -> &[Step] {
        &self.fit
    }

    /// Builds it.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn go(&self, gpu: &Gpu) -> Result<()> {
        run(gpu, self.build.iter().chain(&self.fit))
    }
}

/// Sorts keys with their values, from the lowest digit on: to and fro between both buffers of each, an even number of times.
fn sorting(
    gpu: &Gpu,
    told: &Told,
    (keys, values, counts): (&[wgpu::Buffer; 2], &[wgpu::Buffer; 2], &wgpu::Buffer),
) -> Vec<Step> {
    const { assert!(CODE.div_ceil(DIGIT).is_multiple_of(2)) };
    let slots = told.slots;
    let kernel = |name, writes: &[bool]| Kernel::new(gpu, REFIT, name, writes);
    let (count, scatter) =
        (kernel("refit::count", &[false, true]), kernel("refit::scatter", &[false, false, true, true, true]));
    let (sum, spread) = (kernel("refit::sum", &[true]), kernel("refit::spread", &[true]));
    let of_level = |number| uniform(gpu, &Told { level: number, ..*told });
    let threads = |number| level(slots, number).1;
    let sums = (1..levels(slots)).map(|number| sum.step(gpu, &of_level(number), &[counts], threads(number)));
    let spreads = (0..levels(slots)).rev();
    let spreads = spreads.map(|number| spread.step(gpu, &of_level(number), &[counts], threads(number).div_ceil(RUN)));
    let scan: Vec<Step> = sums.chain(spreads).collect();
    let mut steps = Vec::new();
    for (pass, shift) in (0..CODE).step_by(DIGIT as usize).enumerate() {
        let (from, to, record) = (pass % 2, 1 - pass % 2, uniform(gpu, &Told { shift, ..*told }));
        steps.push(count.step(gpu, &record, &[&keys[from], counts], runs(slots)));
        steps.extend(scan.iter().cloned());
        let buffers = [&keys[from], &values[from], counts, &keys[to], &values[to]];
        steps.push(scatter.step(gpu, &record, &buffers, runs(slots)));
    }
    steps
}
