//! Compiled kernels: how many threads they are run with, and what they bind.

use eyerays_shader::launch::WORKGROUP;
use eyerays_shader::resources::{Access, RESOURCES, binding};

use super::deep::on_deep_stacks;
use super::device::Gpu;
use super::pipeline::{Pipeline, READ, WRITE};
use super::recipe::Recipe;
use crate::plan::{Plan, Stage};

/// Workgroups of persistent subgroups: more than any GPU of today runs at once. Those too many find no
/// ray left.
const RESIDENT: u32 = 4096;

/// A step, compiled.
#[derive(Clone)]
pub(super) struct Kernel {
    pub stage: Stage,
    pipeline: Pipeline,
    /// What it binds, by the numbers of the table of resources: its own binding `i` is the `i`th.
    bindings: Vec<u32>,
    persistent: bool,
}

impl Kernel {
    /// Binds buffers to it; `buffer` gives that of a resource.
    pub fn group<'b>(&self, gpu: &Gpu, buffer: impl Fn(u32) -> Option<&'b wgpu::Buffer>) -> wgpu::BindGroup {
        let buffer = |&binding: &u32| {
            let name = RESOURCES[binding as usize].name;
            buffer(binding).unwrap_or_else(|| panic!("the plan has no {name} for {:?}", self.stage))
        };
        self.pipeline.group(gpu, self.bindings.iter().map(buffer))
    }

    /// Does it bind this resource?
    pub fn binds(&self, binding: u32) -> bool {
        self.bindings.contains(&binding)
    }

    /// The resource whose buffer it takes in the place of another: shadow rays that lie in memory are followed as a stream's.
    pub fn source(&self, binding: u32, plan: &Plan) -> u32 {
        let is_stored = self.stage == Stage::Shadow && plan.bytes_of(binding::SEGMENTS) > 0;
        if is_stored && binding == binding::PATHS { binding::SEGMENTS } else { binding }
    }

    /// Runs a thread for each of `slots` slots in each of `rows` rows, or takes them in turn.
    pub fn run(&self, pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup, slots: u32, rows: u32) {
        self.pipeline.set(pass, group);
        let groups = slots.div_ceil(WORKGROUP);
        if self.persistent {
            pass.dispatch_workgroups(groups.saturating_mul(rows).min(RESIDENT), 1, 1);
        } else {
            pass.dispatch_workgroups(groups, rows, 1);
        }
    }

    /// The same with numbers that a kernel has left at word `offset` of a buffer.
    pub fn run_indirect(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        group: &wgpu::BindGroup,
        arguments: &wgpu::Buffer,
        offset: u32,
    ) {
        self.pipeline.set(pass, group);
        if self.persistent {
            pass.dispatch_workgroups(RESIDENT, 1, 1);
        } else {
            pass.dispatch_workgroups_indirect(arguments, 4 * u64::from(offset));
        }
    }
}

/// Kernels that were compiled, with what they were made of.
#[derive(Default)]
pub(super) struct Known(Vec<(Recipe, Kernel)>);

impl Known {
    /// The kernels of recipes. Those that are not known yet are compiled all at once and each once: drivers take most of the time to
    /// a first picture.
    pub fn compile(&mut self, gpu: &Gpu, recipes: Vec<Recipe>) -> Vec<Kernel> {
        let mut new: Vec<Recipe> = Vec::new();
        for recipe in &recipes {
            if self.find(recipe).is_none() && !new.iter().any(|other| other.is_like(recipe)) {
                new.push(recipe.clone());
            }
        }
        let _around = gpu.around.filter(|_| !new.is_empty()).map(|begin| begin());
        let compiled = on_deep_stacks(&new, |recipe| one(gpu, recipe));
        self.0.extend(new.into_iter().zip(compiled));
        let known = |recipe| self.find(recipe).expect("it was compiled");
        recipes.iter().map(|recipe| known(recipe).clone()).collect()
    }

    fn find(&self, recipe: &Recipe) -> Option<&Kernel> {
        self.0.iter().find(|(own, _)| own.is_like(recipe)).map(|(_, kernel)| kernel)
    }
}

fn one(gpu: &Gpu, recipe: &Recipe) -> Kernel {
    let cut = recipe.cut();
    let bindings = cut.bindings().to_vec();
    let types = bindings.iter().map(|&binding| match RESOURCES[binding as usize].access {
        Access::Uniform => wgpu::BufferBindingType::Uniform,
        Access::Read => READ,
        Access::Write => WRITE,
    });
    let pipeline = Pipeline::new(gpu, &cut.words(), &recipe.name, types);
    Kernel { stage: recipe.step.stage, pipeline, bindings, persistent: recipe.is_persistent() }
}
