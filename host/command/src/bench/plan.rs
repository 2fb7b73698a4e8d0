//! What is measured.

use std::path::PathBuf;

use eyerays_bvh::Quality;
use eyerays_shader::data::Tuning;

use super::Kind;
use crate::error::Error;
use eyerays::gpu::Gpu;
use eyerays::job::Job;
use eyerays::method::{Coherence, Layout, Method, Order, Processor, Scheduling, Traversal, TriangleTest};
use eyerays::scene::{Camera, Scene};

/// What is measured in every scene.
pub struct Plan {
    /// Kinds of rays.
    pub kinds: Vec<Kind>,
    /// Methods; [`Method::Auto`] is the one that it stands for.
    pub methods: Vec<Method>,
    /// How a GPU's subgroups come by rays; [`Scheduling::Auto`] is what it stands for.
    pub schedulings: Vec<Scheduling>,
    /// Orders of pixels.
    pub orders: Vec<Order>,
    /// Layouts of triangles.
    pub layouts: Vec<Layout>,
    /// Triangle tests of fast precision; exact precision has one.
    pub triangles: Vec<TriangleTest>,
    /// When a hybrid's packet splits.
    pub tuning: Tuning,
    /// Does a GPU trace in exact precision?
    pub exact: bool,
    /// Does it in fast precision?
    pub fast: bool,
    /// A GPU to measure.
    pub gpu: Option<Gpu>,
    /// Is the CPU measured?
    pub cpu: bool,
    /// CPU threads; 0 is one a core.
    pub threads: usize,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// How often a stream is traced after a warm-up.
    pub repeat: u32,
    /// Length of ambient occlusion rays in world units; by default [`super::rays::AO_SHARE`] of the diagonal.
    pub ao_length: Option<f64>,
    /// Quality of the hierarchies.
    pub quality: Quality,
}

/// A scene and its views.
pub struct Subject {
    /// As tables call it.
    pub name: String,
    /// Where it came from, for errors.
    pub file: PathBuf,
    /// The scene.
    pub scene: Scene,
    /// Those of its cameras that are measured.
    pub cameras: Vec<Camera>,
}

/// One way to trace a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Trial {
    pub processor: Processor,
    pub exact: bool,
    pub traversal: Traversal,
    /// Is it what `auto` takes?
    pub is_auto: bool,
}

impl Plan {
    /// Every way to trace rays of a kind, each once; calls `note` for those that are left out.
    pub(super) fn trials(&self, packed: &Job, kind: Kind, order: Order, note: &mut dyn FnMut(String)) -> Vec<Trial> {
        let mut trials: Vec<Trial> = Vec::new();
        for (processor, exact) in self.processors() {
            for wanted in self.wishes(exact, order) {
                match self.resolved(packed, processor, wanted, kind.coherence()) {
                    Err(why) => note(why),
                    Ok((traversal, is_auto)) => {
                        let trial = Trial { processor, exact, traversal, is_auto };
                        if !trials.contains(&trial) {
                            trials.push(trial);
                        }
                    }
                }
            }
        }
        trials
    }

    /// Every combination of switches, as they were asked for.
    fn wishes(&self, exact: bool, order: Order) -> Vec<Traversal> {
        let tests = if exact { &[TriangleTest::Watertight][..] } else { &self.triangles };
        let mut wishes = Vec::new();
        for (&triangle, &layout) in tests.iter().flat_map(|test| self.layouts.iter().map(move |l| (test, l))) {
            for &method in &self.methods {
                let wish = |&scheduling| Traversal { method, tuning: self.tuning, scheduling, order, layout, triangle };
                wishes.extend(self.schedulings.iter().map(wish));
            }
        }
        wishes
    }

    fn processors(&self) -> Vec<(Processor, bool)> {
        let gpu = [true, false].into_iter().filter(|&exact| if exact { self.exact } else { self.fast });
        let mut all: Vec<_> = gpu.filter(|_| self.gpu.is_some()).map(|exact| (Processor::Gpu, exact)).collect();
        all.extend(self.cpu.then_some((Processor::Cpu, true)));
        all
    }

    /// What a request resolves to, and whether `auto` is the same; or why it can't be measured.
    fn resolved(
        &self,
        packed: &Job,
        processor: Processor,
        wanted: Traversal,
        coherence: Coherence,
    ) -> Result<(Traversal, bool), String> {
        let resolved = |wanted: Traversal| match (&self.gpu, processor) {
            (Some(gpu), Processor::Gpu) => gpu.resolved(wanted, coherence).map_err(|e| Error::from(e).to_string()),
            // On a CPU there is only one way to distribute rays to threads.
            _ => Ok(Traversal { scheduling: Scheduling::Grid, ..wanted.resolved(processor, coherence) }),
        };
        let traversal = resolved(wanted)?;
        if traversal.method == Method::Wide && packed.wide().is_empty() {
            return Err("wide is left out: there is no hierarchy of wide nodes".to_owned());
        }
        let auto = Traversal { method: Method::Auto, scheduling: Scheduling::Auto, ..wanted };
        Ok((traversal, resolved(auto)? == traversal))
    }
}
