//! Which kernel a step runs: an entry point of a committed module, and the constants that are written into it.

use std::sync::LazyLock;

use eyerays_passes::{Kernel, Kernels};
use eyerays_shader::data::{Features, Tuning};
use eyerays_shader::launch::{FEATURES_ID, TUNING_ID};
use eyerays_shader::modules;

use crate::method::{Method, Scheduling, Traversal};

/// A committed module, parsed when the first kernel is cut out of it.
type Module = LazyLock<Kernels>;

static EXACT: Module = LazyLock::new(|| parse(modules::EXACT));
static FAST: Module = LazyLock::new(|| parse(modules::FAST));
static EXACT_SUBGROUP: Module = LazyLock::new(|| parse(modules::EXACT_SUBGROUP));
static FAST_SUBGROUP: Module = LazyLock::new(|| parse(modules::FAST_SUBGROUP));

fn parse(module: &[u8]) -> Kernels {
    Kernels::parse(module).unwrap_or_else(|e| panic!("a committed module: {e}"))
}

/// What a kernel of a rendering does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Step {
    /// Counts the slots of the next wave.
    Advance,
    /// Follows the rays of a wave.
    Trace,
    /// Follows the shadow rays of its hits.
    Shadow,
    /// Shades its hits.
    Shade,
}

impl Step {
    fn name(self) -> &'static str {
        match self {
            Step::Advance => "advance",
            Step::Trace => "trace",
            Step::Shadow => "shadow",
            Step::Shade => "shade",
        }
    }
}

/// A kernel that is not compiled yet.
#[derive(Clone)]
pub struct Recipe {
    /// What it does.
    pub step: Step,
    /// The name of its entry point.
    pub name: String,
    /// The method, of a step that follows rays.
    pub method: Option<Method>,
    /// Does it take rays until none is left, instead of one a thread?
    pub persistent: bool,
    module: &'static Module,
    constants: [(u32, u32); 2],
}

impl Recipe {
    /// A step that follows rays by a method that is named, in the exact or the fast precision.
    pub fn tracing(step: Step, features: Features, exact: bool, traversal: Traversal) -> Self {
        let persistent = traversal.scheduling == Scheduling::Persistent;
        let (module, prefix) = match (exact, traversal.votes()) {
            (true, false) => (&EXACT, "exact"),
            (false, false) => (&FAST, "fast"),
            (true, true) => (&EXACT_SUBGROUP, "subgroup_exact"),
            (false, true) => (&FAST_SUBGROUP, "subgroup_fast"),
        };
        let name = format!("{prefix}_{}_{}", step.name(), traversal.entry());
        let constants = constants(features, &traversal);
        Recipe { step, name, method: Some(traversal.method), persistent, module, constants }
    }

    /// A step that follows none.
    pub fn shading(step: Step, features: Features, exact: bool, traversal: &Traversal) -> Self {
        let (module, prefix) = if exact { (&EXACT, "exact") } else { (&FAST, "fast") };
        let name = format!("{prefix}_{}", step.name());
        Recipe { step, name, method: None, persistent: false, module, constants: constants(features, traversal) }
    }

    /// The kernel as a module of its own: what the scene does not ask for is not in it.
    pub fn cut(&self) -> Kernel {
        self.module.cut(&self.name, &self.constants).unwrap_or_else(|e| panic!("a committed module: {e}"))
    }
}

fn constants(features: Features, traversal: &Traversal) -> [(u32, u32); 2] {
    let Tuning(tuning) = traversal.tuning;
    [(FEATURES_ID, features.0 | traversal.features().0), (TUNING_ID, tuning)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Processor;

    /// Every method in both precisions has its kernels; the names are made here and in the shader's table of entries.
    #[test]
    fn every_way_to_follow_rays_has_its_kernels() {
        for method in Method::ALL {
            for scheduling in [Scheduling::Grid, Scheduling::Persistent] {
                let traversal = Traversal { scheduling, ..method.into() };
                let traversal = traversal.resolved(Processor::Gpu, crate::method::Coherence::Primary);
                for exact in [true, false] {
                    for step in [Step::Trace, Step::Shadow] {
                        let recipe = Recipe::tracing(step, Features(0), exact, traversal);
                        assert!(recipe.cut().instructions() > 100, "{}", recipe.name);
                    }
                }
            }
        }
        for exact in [true, false] {
            for step in [Step::Advance, Step::Shade] {
                Recipe::shading(step, Features(0), exact, &Traversal::default()).cut();
            }
        }
    }
}
