//! Which kernel runs a step: an entry point of a committed module, and the constants that are written into it.

use std::sync::LazyLock;

use eyerays_passes::{Kernel, Kernels};
use eyerays_shader::data::{Effects, Launch, Specialisation};

use crate::method::Scheduling;
use crate::plan::{Stage, Step};

/// A committed module, parsed when the first kernel is cut out of it.
type Module = LazyLock<Kernels>;

static EXACT: Module = LazyLock::new(|| parse(eyerays_modules::exact()));
static FAST: Module = LazyLock::new(|| parse(eyerays_modules::fast()));

fn parse(module: &[u8]) -> Kernels {
    Kernels::parse(module).unwrap_or_else(|e| panic!("a committed module: {e}"))
}

/// Begins to parse the module of a precision on a thread of its own: it is there by the time that a driver has opened its device.
pub(super) fn parse_ahead(exact: bool) {
    let module: &'static Module = if exact { &EXACT } else { &FAST };
    // Without a thread, whoever cuts the first kernel parses it.
    let _ = std::thread::Builder::new().spawn(|| LazyLock::force(module));
}

/// Which of a step's kernels a device takes.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Exact precision, or the device's own arithmetic.
    pub exact: bool,
    /// Can lanes of a subgroup vote?
    pub subgroups: bool,
}

/// A kernel that is not compiled yet.
#[derive(Clone)]
pub struct Recipe {
    /// The step that it runs.
    pub step: Step,
    /// The path of its entry point.
    pub name: String,
    /// What it is compiled for.
    pub spec: Specialisation,
    module: &'static Module,
}

impl Recipe {
    /// The kernel of a step.
    pub fn new(step: Step, target: Target) -> Self {
        let (module, precision) = if target.exact { (&EXACT, "exact") } else { (&FAST, "fast") };
        let subgroup = if step.traversal.is_some_and(|traversal| traversal.votes()) { "subgroup_" } else { "" };
        let method = step.traversal.map(|traversal| traversal.path()).unwrap_or_default();
        let name = format!("{subgroup}{precision}::{method}{}", step.stage.name());
        // A subgroup adds its slots to the next wave at once.
        let votes = if target.subgroups && goes_on(&step) { Launch::SUBGROUPS } else { 0 };
        // Scattering is the same in every wave.
        let same = if step.stage == Stage::Scatter { Launch::SECONDARY } else { 0 };
        let spec = step.spec.with_launch(votes).without_launch(same);
        Recipe { step, name, spec, module }
    }

    /// Is it the same kernel?
    pub fn is_like(&self, other: &Recipe) -> bool {
        (&self.name, self.spec, self.is_persistent()) == (&other.name, other.spec, other.is_persistent())
    }

    /// Does it take rays until none is left, instead of one a thread?
    pub fn is_persistent(&self) -> bool {
        self.step.traversal.is_some_and(|traversal| traversal.scheduling == Scheduling::Persistent)
    }

    /// The kernel as a module of its own: what the scene does not ask for is not in it.
    pub fn cut(&self) -> Kernel {
        let constants = self.spec.constants();
        self.module.cut(&self.name, &constants).unwrap_or_else(|e| panic!("a committed module: {e}"))
    }
}

fn goes_on(step: &Step) -> bool {
    match step.stage {
        Stage::Shade => step.spec.effects.has(Effects::REFLECTION | Effects::REFRACTION),
        Stage::Scatter => step.spec.launch.has(Launch::GOES_ON),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{Coherence, Method, Processor, Traversal};

    /// Every method in both precisions has its kernels; their paths are made here and in the shader's table of methods.
    #[test]
    fn every_way_to_follow_rays_has_its_kernels() {
        let mut recipes = Vec::new();
        for (exact, subgroups) in [(true, true), (true, false), (false, true), (false, false)] {
            let target = Target { exact, subgroups };
            let mut spec = eyerays_shader::data::Specialisation::default();
            spec.effects.0 |= Effects::REFLECTION;
            for method in Method::ALL {
                for scheduling in [Scheduling::Grid, Scheduling::Persistent] {
                    let traversal = Traversal { scheduling, ..method.into() };
                    let traversal = Some(traversal.resolved(Processor::Gpu, Coherence::Primary));
                    for stage in [Stage::Trace, Stage::Shadow] {
                        recipes.push(Recipe::new(Step { stage, traversal, spec }, target));
                    }
                }
            }
            for stage in [Stage::Advance, Stage::Shade, Stage::Gather] {
                recipes.push(Recipe::new(Step { stage, traversal: None, spec }, target));
            }
        }
        for recipe in recipes {
            assert!(recipe.cut().instructions() > 10, "{}", recipe.name);
        }
    }
}
