//! What a picture takes: steps in their order, and the memory that they exchange. Both devices run this list.

mod run;

use eyerays_shader::data::{Launch, Specialisation};
use eyerays_shader::resources::binding;
use eyerays_shader::stage::RECORDS;

pub use run::{Executor, run};

use crate::device_scene::DeviceScene;
use crate::error::Result;
use crate::integrator::{Needs, Waves, whitted};
use crate::method::{Coherence, Method, Traversal};

/// Bytes of a record of three numbers and an integer.
const RECORD: u64 = 16;

/// What a step does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Turns to the next wave.
    Advance,
    /// Follows the rays of a wave.
    Trace,
    /// Follows the shadow rays of its hits.
    Shadow,
    /// Shades its hits.
    Shade,
    /// Adds what slots have summed to the film.
    Gather,
}

impl Stage {
    /// The last part of its kernels' paths.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Advance => "advance",
            Stage::Trace => "trace",
            Stage::Shadow => "shadow",
            Stage::Shade => "shade",
            Stage::Gather => "gather",
        }
    }
}

/// One dispatch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Step {
    /// What it does.
    pub stage: Stage,
    /// How rays are followed, of a stage that does: never `auto`.
    pub traversal: Option<Traversal>,
    /// What its kernel is compiled for.
    pub spec: Specialisation,
}

/// What a picture takes; nothing for an effect that the scene does not have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// For the camera's rays.
    pub first: Vec<Step>,
    /// For the rays of each further wave.
    pub further: Vec<Step>,
    /// Once no ray is left.
    pub last: Vec<Step>,
    /// How many further waves there are.
    pub waves: Waves,
    /// Shadow rays of a hit.
    pub shadow_rays: u32,
    /// Bytes that a sample in flight takes of each buffer, by its binding.
    pub slot_bytes: Vec<(u32, u64)>,
}

impl Plan {
    /// Bytes that a pixel takes of the film.
    pub const FILM_BYTES: u64 = RECORD;

    /// For a scene by Whitted's model. `resolve` tells the method for rays of some coherence.
    ///
    /// # Errors
    /// Those of `resolve`.
    pub fn new(
        packed: &DeviceScene,
        traversal: &Traversal,
        resolve: impl Fn(Coherence) -> Result<Traversal>,
    ) -> Result<Plan> {
        Plan::of(&whitted(packed), packed.specialisation(traversal), resolve)
    }

    /// For what an integrator needs.
    ///
    /// # Errors
    /// Those of `resolve`.
    pub fn of(needs: &Needs, spec: Specialisation, resolve: impl Fn(Coherence) -> Result<Traversal>) -> Result<Plan> {
        let Needs { shadow_rays, paths, waves } = *needs;
        let wave = |spec, traced, shadowed| -> Result<Vec<Step>> {
            let follows = |stage, coherence| Ok(Step { stage, traversal: Some(resolve(coherence)?), spec });
            let mut steps = vec![follows(Stage::Trace, traced)?];
            if shadow_rays > 0 {
                steps.push(follows(Stage::Shadow, shadowed)?);
            }
            steps.push(Step { stage: Stage::Shade, traversal: None, spec });
            Ok(steps)
        };
        let plain = |stage, spec| Step { stage, traversal: None, spec };
        let mut further = Vec::new();
        if waves != Waves::AtMost(0) {
            let spec = spec.with_launch(Launch::SECONDARY);
            further.push(plain(Stage::Advance, spec));
            further.extend(wave(spec, Coherence::Secondary, Coherence::Secondary)?);
        }
        let queue = if further.is_empty() { 0 } else { 4 };
        let slot_bytes = [
            (binding::PATHS, u64::from(paths) * u64::from(RECORDS) * RECORD),
            (binding::HITS, RECORD),
            (binding::SHADOWS, 4 * u64::from(shadow_rays)),
            (binding::SUMS, RECORD),
            (binding::QUEUE, queue),
            (binding::NEXT, queue),
        ];
        Ok(Plan {
            first: wave(spec, Coherence::Primary, Coherence::Shadow)?,
            further,
            last: vec![plain(Stage::Gather, spec)],
            waves,
            shadow_rays,
            slot_bytes: slot_bytes.into_iter().filter(|&(_, bytes)| bytes > 0).collect(),
        })
    }

    /// Bytes that a sample in flight takes of a resource, 0 if the plan has not got it.
    pub fn bytes_of(&self, binding: u32) -> u64 {
        self.slot_bytes.iter().find(|(own, _)| *own == binding).map_or(0, |&(_, bytes)| bytes)
    }

    /// Every step, in the order of the first launches.
    pub fn steps(&self) -> impl Iterator<Item = &Step> {
        self.first.iter().chain(&self.further).chain(&self.last)
    }

    /// Does some step walk the hierarchy of pairs of nodes?
    pub fn walks_pairs(&self) -> bool {
        self.methods().any(|method| method != Method::Wide)
    }

    /// Does some step walk the hierarchy of nodes of eight children?
    pub fn walks_wide(&self) -> bool {
        self.methods().any(|method| method == Method::Wide)
    }

    fn methods(&self) -> impl Iterator<Item = Method> + '_ {
        self.steps().filter_map(|step| step.traversal).map(|traversal| traversal.method)
    }
}

#[cfg(test)]
mod tests {
    use eyerays_shader::data::Effects;

    use super::*;
    use crate::method::Processor;

    fn plan(needs: Needs) -> Plan {
        let effects = Effects(Effects::LIT | Effects::SMOOTH);
        let spec = Specialisation { effects, ..Specialisation::default() };
        Plan::of(&needs, spec, |coherence| Ok(Traversal::default().resolved(Processor::Gpu, coherence))).unwrap()
    }

    fn stages(steps: &[Step]) -> Vec<Stage> {
        steps.iter().map(|step| step.stage).collect()
    }

    #[test]
    fn rays_that_do_not_go_on_take_one_wave_and_no_queue() {
        let plan = plan(Needs { shadow_rays: 2, paths: 0, waves: Waves::AtMost(0) });
        assert_eq!(stages(&plan.first), [Stage::Trace, Stage::Shadow, Stage::Shade]);
        assert_eq!((stages(&plan.further), stages(&plan.last)), (vec![], vec![Stage::Gather]));
        assert_eq!(plan.slot_bytes, [(binding::HITS, 16), (binding::SHADOWS, 8), (binding::SUMS, 16)]);
    }

    /// A path that samples one light at each of its vertices runs in the same order.
    #[test]
    fn one_light_sample_a_vertex_takes_no_more_memory_for_more_lights() {
        let plan = plan(Needs { shadow_rays: 1, paths: 1, waves: Waves::AtMost(5) });
        assert_eq!(stages(&plan.further), [Stage::Advance, Stage::Trace, Stage::Shadow, Stage::Shade]);
        assert!(plan.slot_bytes.contains(&(binding::SHADOWS, 4)));
        assert!(plan.slot_bytes.contains(&(binding::PATHS, 48)));
    }
}
