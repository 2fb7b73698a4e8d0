//! What a picture takes: steps in their order, and the memory that they exchange. Both devices run this list.

mod run;

use eyerays_shader::data::{Aovs, Caustics, Effects, Launch, Media, Specialisation};
use eyerays_shader::photon;
use eyerays_shader::resources::binding;
use eyerays_shader::stage::{FilmWords, Found, film_words, sum_records};

pub use run::{Executor, run};

use crate::error::Result;
use crate::integrator::{Needs, Waves, needs};
use crate::job::Job;
use crate::method::{Coherence, Method, Traversal};

/// What a step does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Starts paths with the camera's rays.
    Generate,
    /// Turns to the next wave.
    Advance,
    /// Follows the rays of a wave.
    Trace,
    /// Finds the next crossings of a stream's rays.
    Cross,
    /// Finds the triangles that are nearest to where a stream's rays start.
    Nearest,
    /// Follows the shadow rays of its hits.
    Shadow,
    /// Dims the light of shadow rays by what is between surfaces.
    Transmit,
    /// Shades its hits.
    Shade,
    /// Scatters its paths.
    Scatter,
    /// Starts photons at lamps.
    Emit,
    /// Puts those that have landed into lists.
    File,
    /// Adds what slots have summed to the film.
    Gather,
    /// The same, with the light that their last vertices waited for.
    Accumulate,
}

impl Stage {
    /// The last part of its kernels' paths.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Generate => "generate",
            Stage::Advance => "advance",
            Stage::Trace => "trace",
            Stage::Cross => "cross",
            Stage::Nearest => "nearest",
            Stage::Shadow => "shadow",
            Stage::Transmit => "transmit",
            Stage::Shade => "shade",
            Stage::Scatter => "scatter",
            Stage::Emit => "emit",
            Stage::File => "file",
            Stage::Gather => "gather",
            Stage::Accumulate => "accumulate",
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
    /// Words of 4 bytes that a pixel takes of the film.
    pub film_words: FilmWords,
}

impl Plan {
    /// Bytes of a record of three numbers and an integer.
    pub const RECORD_BYTES: u64 = 16;

    /// For a scene by the integrator of its settings. `resolve` tells the method for rays of some coherence.
    ///
    /// # Errors
    /// Those of `resolve`.
    pub fn new(packed: &Job, traversal: &Traversal, resolve: impl Fn(Coherence) -> Result<Traversal>) -> Result<Plan> {
        Plan::of(&needs(packed), packed.specialisation(traversal), packed.aov_count(), resolve)
    }

    /// For what an integrator needs, with films of so many arbitrary output variables.
    ///
    /// # Errors
    /// Those of `resolve`.
    pub fn of(
        needs: &Needs,
        spec: Specialisation,
        aovs: u32,
        resolve: impl Fn(Coherence) -> Result<Traversal>,
    ) -> Result<Plan> {
        let Needs { waves, shadow_rays, stages, .. } = *needs;
        let sums = sum_records(spec, aovs);
        let has_further = waves != Waves::AtMost(0);
        let spec = spec.with_launch(if has_further { stages.goes_on } else { 0 });
        // Rays are the same whatever films keep, and so are the kernels that follow them.
        let of_rays = |spec| Specialisation { aovs: Aovs(0), caustics: Caustics(0), ..spec };
        let plain = |stage, spec: Specialisation| {
            let spec = match stage {
                Stage::Scatter => spec,
                Stage::Accumulate => Specialisation { caustics: Caustics(0), ..spec },
                Stage::Generate => Specialisation { aovs: Aovs(0), ..spec },
                _ => of_rays(spec),
            };
            Step { stage, traversal: None, spec }
        };
        let wave = |spec: Specialisation, traced, shadowed| -> Result<Vec<Step>> {
            let step = |&stage: &Stage| {
                let coherence = match stage {
                    Stage::Trace => traced,
                    Stage::Shadow => shadowed,
                    Stage::Transmit => return Ok(plain(stage, of_rays(spec).with_launch(stages.rays))),
                    _ => return Ok(plain(stage, spec)),
                };
                Ok(Step { stage, traversal: Some(resolve(coherence)?), spec: of_rays(spec).with_launch(stages.rays) })
            };
            let there = |stage: &&Stage| match stage {
                Stage::Shadow => shadow_rays > 0,
                Stage::Transmit => shadow_rays > 0 && spec.media.has(Media::OPEN | Media::GRIDS),
                _ => true,
            };
            stages.wave.iter().filter(there).map(step).collect()
        };
        let mut first = wave(spec, Coherence::Primary, Coherence::Shadow)?;
        if stages.generates || spec.launch.has(Launch::KEPT) {
            first.insert(0, plain(Stage::Generate, spec));
        }
        let mut further = Vec::new();
        if has_further {
            let spec = spec.with_launch(Launch::SECONDARY);
            further.push(plain(Stage::Advance, spec));
            further.extend(wave(spec, stages.further, stages.further)?);
        }
        let last = vec![plain(stages.last, spec)];
        // Rays of the camera that lie in memory take the place of a path.
        let paths = if spec.launch.has(Launch::KEPT) { needs.paths.max(1) } else { needs.paths };
        let has_photons = spec.caustics.has(Caustics::GATHERED);
        let records = Records { sums, hits: Found::<f32>::records(spec.effects), media: spec.media, has_photons };
        let slot_bytes = slot_bytes(&Needs { paths, ..*needs }, records, has_further);
        let film_words = FilmWords { light: film_words(spec.launch, stages.tells_noise), aovs };
        Ok(Plan { first, further, last, waves, shadow_rays, slot_bytes, film_words })
    }

    /// What the photons take that tell of caustics before a launch of a job, in the memory of its plan; none where there are none.
    ///
    /// # Errors
    /// Those of `resolve`.
    pub fn of_photons(
        packed: &Job,
        traversal: &Traversal,
        resolve: impl Fn(Coherence) -> Result<Traversal>,
    ) -> Result<Option<Plan>> {
        if !packed.has_photons() {
            return Ok(None);
        }
        let spec = packed.specialisation(traversal);
        // Of a camera and of films photons know nothing.
        let samplers = Launch::JITTERED | Launch::RANDOM | Launch::SOBOL;
        let kept = Launch::MOLLER | samplers | Launch::NEAREST | Launch::MIPMAPPED | Launch::MOVING;
        let spec = Specialisation {
            launch: Launch(spec.launch.0 & kept).with(Launch::GOES_ON),
            aovs: Aovs(0),
            caustics: Caustics(Caustics::PHOTONS),
            ..spec
        };
        let of_rays = Specialisation { caustics: Caustics(0), ..spec };
        let plain = |stage, spec| Step { stage, traversal: None, spec };
        let wave = |launch: u32| -> Result<[Step; 2]> {
            let traversal = Some(resolve(Coherence::Scattered)?);
            let trace = Step { stage: Stage::Trace, traversal, spec: of_rays.with_launch(launch | Launch::STREAM) };
            Ok([trace, plain(Stage::Scatter, spec.with_launch(launch))])
        };
        let advance = plain(Stage::Advance, of_rays.with_launch(Launch::SECONDARY));
        // A photon may be mirrored as often as a path, and then meets what has it.
        let is_open = packed.media_bits().has(Media::OPEN);
        let waves = if is_open { Waves::Branching } else { Waves::AtMost(packed.settings().bounces) };
        Ok(Some(Plan {
            first: [&[plain(Stage::Emit, spec)][..], &wave(0)?].concat(),
            further: [&[advance][..], &wave(Launch::SECONDARY)?].concat(),
            last: vec![plain(Stage::File, of_rays)],
            waves,
            shadow_rays: 0,
            slot_bytes: Vec::new(),
            film_words: FilmWords::of_light(0),
        }))
    }

    /// The same for whole blocks of samples, whose film keeps the squares of blocks; with `launch`, what else its launches are. None of an
    /// integrator that does not sample.
    pub fn in_blocks(&self, launch: u32) -> Option<Plan> {
        let mut plan = self.clone();
        plan.first.iter_mut().filter(|step| step.stage == Stage::Generate).for_each(|step| {
            step.spec = step.spec.with_launch(launch);
        });
        let film = plan.last.iter_mut().find(|step| step.stage == Stage::Accumulate)?;
        film.spec = film.spec.with_launch(Launch::BLOCKS);
        Some(plan)
    }

    /// Bytes that a pixel takes of the film.
    pub fn film_bytes(&self) -> u64 {
        4 * u64::from(self.film_words.all())
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
        // The hierarchies of meshes that are copied are of pairs, whatever the method.
        let has_copies = self.steps().any(|step| step.spec.effects.has(Effects::INSTANCED));
        has_copies
            || self.steps().any(|step| step.stage == Stage::Transmit)
            || self.methods().any(|method| method != Method::Wide)
    }

    /// Does some step walk the hierarchy of nodes of eight children?
    pub fn walks_wide(&self) -> bool {
        self.methods().any(|method| method == Method::Wide)
    }

    fn methods(&self) -> impl Iterator<Item = Method> + '_ {
        self.steps().filter_map(|step| step.traversal).map(|traversal| traversal.method)
    }
}

/// Records of a slot.
struct Records {
    sums: u32,
    hits: u32,
    media: Media,
    has_photons: bool,
}

/// Bytes that a sample in flight takes of each buffer, none of those that it has no use for.
fn slot_bytes(needs: &Needs, Records { sums, hits, media, has_photons }: Records, has_queue: bool) -> Vec<(u32, u64)> {
    let Needs { shadow_rays, paths, stages, .. } = *needs;
    let records = |count: u32| u64::from(count) * Plan::RECORD_BYTES;
    let queue = if has_queue { 4 } else { 0 };
    let all = [
        (binding::PATHS, records(paths * (stages.path_records)(media))),
        (binding::HITS, records(hits)),
        (binding::SHADOWS, 4 * u64::from(shadow_rays)),
        (binding::SEGMENTS, records((stages.shadow_records)(media))),
        (binding::SUMS, records(sums)),
        (binding::QUEUE, queue),
        (binding::NEXT, queue),
        (binding::LANDED, if has_photons { records(photon::RECORDS) } else { 0 }),
        (binding::HEADS, if has_photons { 4 * u64::from(photon::LISTS) } else { 0 }),
    ];
    all.into_iter().filter(|&(_, bytes)| bytes > 0).collect()
}

#[cfg(test)]
mod tests {
    use eyerays_shader::stage::NOISY_FILM_WORDS;

    use super::*;
    use crate::integrator::{SAMPLED, WHITTED};
    use crate::method::Processor;

    fn plan(needs: Needs) -> Plan {
        let effects = Effects(Effects::LIT | Effects::SMOOTH);
        let spec = Specialisation { effects, ..Specialisation::default() };
        Plan::of(&needs, spec, 0, |coherence| Ok(Traversal::default().resolved(Processor::Gpu, coherence))).unwrap()
    }

    fn stages(steps: &[Step]) -> Vec<Stage> {
        steps.iter().map(|step| step.stage).collect()
    }

    #[test]
    fn rays_that_do_not_go_on_take_one_wave_and_no_queue() {
        let plan = plan(Needs { shadow_rays: 2, paths: 0, waves: Waves::AtMost(0), stages: &WHITTED });
        assert_eq!(stages(&plan.first), [Stage::Trace, Stage::Shadow, Stage::Shade]);
        assert_eq!((stages(&plan.further), stages(&plan.last)), (vec![], vec![Stage::Gather]));
        assert_eq!(plan.slot_bytes, [(binding::HITS, 16), (binding::SHADOWS, 8), (binding::SUMS, 16)]);
    }

    /// A vertex is scattered before its shadow ray is followed, whose light the next stage of the slot adds.
    #[test]
    fn paths_are_generated_scattered_and_accumulated() {
        let plan = plan(Needs { shadow_rays: 1, paths: 1, waves: Waves::AtMost(5), stages: &SAMPLED });
        assert_eq!(stages(&plan.first), [Stage::Generate, Stage::Trace, Stage::Scatter, Stage::Shadow]);
        assert_eq!(stages(&plan.further), [Stage::Advance, Stage::Trace, Stage::Scatter, Stage::Shadow]);
        assert_eq!(stages(&plan.last), [Stage::Accumulate]);
        for bytes in [(binding::SHADOWS, 4), (binding::PATHS, 64), (binding::SEGMENTS, 48)] {
            assert!(plan.slot_bytes.contains(&bytes), "{bytes:?}");
        }
        assert_eq!(plan.film_words, FilmWords::of_light(NOISY_FILM_WORDS));
        let streams = plan.steps().filter(|step| step.spec.launch.has(Launch::STREAM));
        assert!(streams.map(|step| step.stage).all(|stage| matches!(stage, Stage::Trace | Stage::Shadow)));
    }
}
