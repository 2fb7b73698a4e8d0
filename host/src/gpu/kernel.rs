//! Compiled kernels, and how many threads they are run with.

use std::cell::Cell;

use eyerays_shader::data::Features;
use eyerays_shader::launch::WORKGROUP;

use super::device::Gpu;
use super::module;
use super::scene::Hierarchies;
use crate::error::Result;
use crate::method::{Coherence, Method, Scheduling, Traversal};

/// Workgroups of persistent subgroups: more than any GPU of today runs at once. Those too many find no
/// ray left.
const RESIDENT: u32 = 4096;

/// A stage, compiled.
pub(super) struct Kernel {
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

/// Compiles the stages of one precision, method and set of switches.
pub(super) struct Compiler<'a> {
    gpu: &'a Gpu,
    layout: wgpu::PipelineLayout,
    exact: bool,
    traversal: Traversal,
    hierarchies: Cell<Hierarchies>,
}

impl<'a> Compiler<'a> {
    /// For kernels that share a layout of bindings.
    pub fn new(gpu: &'a Gpu, layout: &wgpu::BindGroupLayout, exact: bool, traversal: Traversal) -> Self {
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        });
        Compiler { gpu, layout, exact, traversal, hierarchies: Cell::default() }
    }

    /// A stage that follows no ray; these are in the modules without votes.
    pub fn shading(&self, features: Features, stage: &str) -> Kernel {
        let plain = Traversal { method: Method::IfIf, scheduling: Scheduling::Grid, ..self.traversal };
        let (spirv, prefix) = plain.module(self.exact);
        self.stage(spirv, features, &format!("{prefix}_{stage}"), false)
    }

    /// A stage that follows rays.
    ///
    /// # Errors
    /// If the GPU can't run the method that was asked for.
    pub fn tracing(&self, features: Features, stage: &str, coherence: Coherence) -> Result<Kernel> {
        let traversal = self.gpu.resolved(self.traversal, coherence)?;
        let (spirv, prefix) = traversal.module(self.exact);
        let name = format!("{prefix}_{stage}_{}", traversal.entry());
        let Hierarchies { binary, wide } = self.hierarchies.get();
        let walks_wide = traversal.method == Method::Wide;
        self.hierarchies.set(Hierarchies { binary: binary || !walks_wide, wide: wide || walks_wide });
        Ok(self.stage(spirv, features, &name, traversal.scheduling == Scheduling::Persistent))
    }

    fn stage(&self, spirv: &[u8], features: Features, name: &str, persistent: bool) -> Kernel {
        let features = Features(features.0 | self.traversal.features().0);
        let module = module::create(self.gpu, &module::specialise(spirv, features, self.traversal.tuning), name);
        let pipeline = self.gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&self.layout),
            module: &module,
            entry_point: Some(name),
            compilation_options: Default::default(),
            cache: None,
        });
        Kernel { pipeline, persistent }
    }

    /// The hierarchies that the kernels compiled so far walk.
    pub fn hierarchies(&self) -> Hierarchies {
        self.hierarchies.get()
    }
}
