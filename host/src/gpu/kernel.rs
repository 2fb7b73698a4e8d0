//! Compiled kernels, and how many threads they are run with.

use eyerays_shader::launch::WORKGROUP;
use rayon::prelude::*;

use super::device::Gpu;
use super::hush::Hush;
use super::module;
use super::recipe::{Recipe, Step};

/// Workgroups of persistent subgroups: more than any GPU of today runs at once. Those too many find no
/// ray left.
const RESIDENT: u32 = 4096;

/// A step, compiled.
pub(super) struct Kernel {
    pub step: Step,
    pipeline: wgpu::ComputePipeline,
    persistent: bool,
}

impl Kernel {
    /// Runs a thread for each of `slots` slots in each of `rows` rows, or takes them in turn.
    pub fn run(&self, pass: &mut wgpu::ComputePass<'_>, slots: u32, rows: u32) {
        pass.set_pipeline(&self.pipeline);
        let groups = slots.div_ceil(WORKGROUP);
        if self.persistent {
            pass.dispatch_workgroups(groups.saturating_mul(rows).min(RESIDENT), 1, 1);
        } else {
            pass.dispatch_workgroups(groups, rows, 1);
        }
    }

    /// The same with numbers that a kernel has left at `offset` of a buffer.
    pub fn run_indirect(&self, pass: &mut wgpu::ComputePass<'_>, arguments: &wgpu::Buffer, offset: u64) {
        pass.set_pipeline(&self.pipeline);
        if self.persistent {
            pass.dispatch_workgroups(RESIDENT, 1, 1);
        } else {
            pass.dispatch_workgroups_indirect(arguments, offset);
        }
    }
}

/// Compiles kernels that share a layout of bindings, all at once: drivers take most of the time to a first picture.
pub(super) fn compile(gpu: &Gpu, bindings: &wgpu::BindGroupLayout, recipes: &[Recipe]) -> Vec<Kernel> {
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(bindings)],
        immediate_size: 0,
    });
    let _hush = Hush::new();
    recipes.par_iter().map(|recipe| one(gpu, &layout, recipe)).collect()
}

fn one(gpu: &Gpu, layout: &wgpu::PipelineLayout, recipe: &Recipe) -> Kernel {
    let module = module::create(gpu, &recipe.cut().words(), &recipe.name);
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(&recipe.name),
        layout: Some(layout),
        module: &module,
        entry_point: Some(&recipe.name),
        compilation_options: Default::default(),
        cache: None,
    });
    Kernel { step: recipe.step, pipeline, persistent: recipe.persistent }
}
