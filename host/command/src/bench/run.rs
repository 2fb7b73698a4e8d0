//! Measures every scene, view and kind of rays in every way.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::answers::{self, Hash};
use super::counts::{Counts, counts};
use super::device::{OnGpu, Run, Uploaded, on_cpu};
use super::plan::Trial;
use super::rays::{AO_SHARE, CameraRays, PrimaryHits, diagonal};
use super::{Kind, Plan, Record, Report, SceneRow, Subject, ViewRow};
use crate::error::Result;
use crate::preset::name;
use eyerays::cpu;
use eyerays::job::Job;
use eyerays::method::{Coherence, Layout, Method, Order, Processor, Traversal};
use eyerays::scene::{Camera, Settings};
use eyerays::stream::{Answers, Question, Stream};
use eyerays::view::View;

/// Measures all that is planned. `begins` is called with every stream before it is traced.
///
/// # Errors
/// A scene that can't be packed or that no device holds, unless another one was measured before: then
/// the measurements are kept, and the report holds the fault.
pub fn run(plan: &Plan, subjects: &[Subject], begins: &dyn Fn(&str)) -> Result<Report> {
    let mut report = Report { setup: plan.setup(), ..Report::default() };
    for subject in subjects {
        match scene(plan, subject, &mut report, begins) {
            Err(error) if report.records.is_empty() => return Err(error.of(&subject.file)),
            Err(error) => report.faults.push(error.of(&subject.file).to_string()),
            Ok(()) => {}
        }
    }
    Ok(report)
}

fn scene(plan: &Plan, subject: &Subject, report: &mut Report, begins: &dyn Fn(&str)) -> Result<()> {
    let settings = Settings { size: plan.size, samples: 1, culling: false, ..subject.scene.settings };
    let packed = Job::with_wide_nodes(&subject.scene, settings, plan.quality)?;
    let mut views = Vec::new();
    for &order in &plan.orders {
        for camera in &subject.cameras {
            views.push((camera, order, CameraRays::of(&packed, &View::new(&packed, camera)?, order)));
        }
    }
    let bench = Bench::new(plan, subject, &packed, report)?;
    views.into_iter().try_for_each(|(camera, order, view)| bench.view(camera, order, &view, report, begins))
}

/// How many streams [`run`] calls `begins` for.
pub fn streams(plan: &Plan, subjects: &[Subject]) -> usize {
    let views: usize = subjects.iter().map(|subject| subject.cameras.len()).sum();
    views * plan.orders.len() * plan.kinds.len()
}

/// A scene, ready to be measured.
struct Bench<'a> {
    plan: &'a Plan,
    subject: &'a Subject,
    packed: &'a Job,
    gpu: Option<OnGpu<'a>>,
    /// In the normalised scene.
    ao_length: f32,
}

/// A stream and what is known of it.
struct Asked<'s> {
    kind: Kind,
    camera: &'s Camera,
    stream: &'s Stream,
    reference: Answers,
    hash: Hash,
    counts: HashMap<(Method, Layout), Counts>,
}

impl<'a> Bench<'a> {
    fn new(plan: &'a Plan, subject: &'a Subject, packed: &'a Job, report: &mut Report) -> Result<Self> {
        let ao_length = plan.ao_length.unwrap_or(AO_SHARE * diagonal(packed) / packed.normalisation().scale);
        let statistics = &packed.statistics();
        report.scenes.push(SceneRow {
            scene: subject.name.clone(),
            primitives: statistics.primitives,
            references: statistics.references,
            nodes: statistics.nodes,
            leaves: statistics.leaves,
            depth: statistics.depth,
            wide_nodes: packed.wide().len(),
            build_ms: packed.build_time().as_secs_f64() * 1e3,
            ao_length,
        });
        let gpu = match plan.gpu.as_ref().map(|gpu| OnGpu::new(gpu, packed, &plan.layouts)).transpose() {
            Err(error) if plan.cpu => {
                report.note(format!("{}: the GPU is left out: {error}", subject.name));
                None
            }
            gpu => gpu?,
        };
        let ao_length = (ao_length * packed.normalisation().scale).clamp(1e-30, 1e30) as f32;
        Ok(Bench { plan, subject, packed, gpu, ao_length })
    }

    fn view(
        &self,
        camera: &Camera,
        order: Order,
        view: &CameraRays,
        report: &mut Report,
        begins: &dyn Fn(&str),
    ) -> Result<()> {
        let place = format!("{} {}", self.subject.name, camera.name);
        let sight = PrimaryHits::new(self.packed, view, self.plan.threads)?;
        let (mut hash, mut rays) = (Hash::default(), 0);
        for &kind in &self.plan.kinds {
            begins(&format!("{place} {}", kind.name()));
            let stream = sight.rays(kind, self.ao_length)?;
            if stream.is_empty() {
                report.note(format!("{place}: there are no {} rays", kind.name()));
                continue;
            }
            if kind == Kind::Shadow && sight.lights() < self.packed.lights().len() {
                report.note(format!("{place}: shadow rays go to the first {} lights", sight.lights()));
            }
            rays += stream.len();
            let of_kind = self.kind(kind, camera, order, &stream, report)?;
            hash.add(of_kind.0 as u32);
            hash.add((of_kind.0 >> 32) as u32);
        }
        let (width, height) = self.plan.size;
        report.views.push(ViewRow {
            scene: self.subject.name.clone(),
            view: camera.name.clone(),
            order: name(order),
            hit_share: sight.hits() as f64 / (f64::from(width) * f64::from(height)),
            rays,
            hash: hash.to_string(),
        });
        Ok(())
    }

    /// Measures a stream in every way, and returns the hash that exact answers have.
    fn kind(&self, kind: Kind, camera: &Camera, order: Order, stream: &Stream, report: &mut Report) -> Result<Hash> {
        let mut trials = self.plan.trials(self.packed, kind, order, &mut |note| report.note(note));
        trials.retain(|trial| trial.processor == Processor::Cpu || self.gpu.is_some());
        let asked = self.asked(kind, camera, stream, &trials)?;
        let uploaded = match &self.gpu {
            Some(gpu) if trials.iter().any(|trial| trial.processor == Processor::Gpu) => Some(gpu.upload(stream)?),
            _ => None,
        };
        for trial in &trials {
            let outcome = self.traced(trial, &asked, uploaded.as_ref());
            self.keep(trial, &asked, outcome, report);
        }
        Ok(asked.hash)
    }

    /// Keeps what was measured, and whether it failed or gave other answers than it must.
    fn keep(&self, trial: &Trial, asked: &Asked<'_>, outcome: Result<Run>, report: &mut Report) {
        match outcome {
            Err(error) => report.faults.push(format!("{}: {error}", self.describe(trial, asked))),
            Ok(run) => {
                let record = self.record(trial, asked, &run);
                if trial.exact && record.hash != asked.hash.to_string() {
                    report.faults.push(self.difference(trial, asked, &run.answers));
                }
                report.records.push(record);
            }
        }
    }

    /// The answers that all must give, by the CPU, and what each way counts.
    fn asked<'s>(&self, kind: Kind, camera: &'s Camera, stream: &'s Stream, trials: &[Trial]) -> Result<Asked<'s>> {
        let (packed, threads, ask) = (self.packed, self.plan.threads, kind.question());
        let traversal = Traversal::default().resolved(Processor::Cpu, Coherence::Scattered);
        let (reference, _) = cpu::cast(packed, traversal, threads, stream, ask)?;
        let mut by_way = HashMap::new();
        for trial in trials {
            if let Entry::Vacant(entry) = by_way.entry((trial.traversal.method, trial.traversal.layout)) {
                entry.insert(counts(packed, trial.traversal, threads, stream, ask)?);
            }
        }
        let hash = Hash::of(packed.primitives(), &reference);
        Ok(Asked { kind, camera, stream, reference, hash, counts: by_way })
    }

    fn traced(&self, trial: &Trial, asked: &Asked<'_>, uploaded: Option<&Uploaded>) -> Result<Run> {
        let ask: Question = asked.kind.question();
        match (&self.gpu, uploaded, trial.processor) {
            (Some(gpu), Some(uploaded), Processor::Gpu) => {
                gpu.run(uploaded, trial.exact, trial.traversal, ask, self.plan.repeat)
            }
            _ => on_cpu(self.plan, self.packed, asked.stream, trial.traversal, ask),
        }
    }

    fn record(&self, trial: &Trial, asked: &Asked<'_>, run: &Run) -> Record {
        let (traversal, timing) = (trial.traversal, run.timing);
        let (device, driver) = self.plan.device(trial.processor);
        let counts = asked.counts[&(traversal.method, traversal.layout)];
        let rays = asked.stream.len();
        Record {
            scene: self.subject.name.clone(),
            view: asked.camera.name.clone(),
            kind: asked.kind,
            method: name(traversal.method),
            auto: trial.is_auto,
            scheduling: (trial.processor == Processor::Gpu).then(|| name(traversal.scheduling)),
            order: name(traversal.order),
            layout: name(traversal.layout),
            triangle: name(traversal.triangle),
            bvh: self.plan.bvh(),
            stack_max: traversal.tuning.stack_max(),
            cut: traversal.tuning.cut(),
            processor: processor(trial.processor),
            device,
            driver,
            precision: if trial.exact { "exact" } else { "fast" },
            width: self.plan.size.0,
            height: self.plan.size.1,
            rays,
            repeat: self.plan.repeat,
            median_seconds: timing.median,
            spread: timing.spread,
            mrays_per_s: rays as f64 / timing.median / 1e6,
            frames_per_s: 1.0 / timing.median,
            visits: counts.visits,
            boxes: counts.boxes,
            primitive_tests: counts.primitives,
            simd_efficiency: counts.simd_efficiency,
            hash: Hash::of(self.packed.primitives(), &run.answers).to_string(),
            differing: answers::differing(self.packed.primitives(), &asked.reference, &run.answers),
        }
    }

    fn describe(&self, trial: &Trial, asked: &Asked<'_>) -> String {
        let Traversal { method, scheduling, order, layout, triangle, .. } = trial.traversal;
        let how = [name(method), name(scheduling), name(order), name(layout), name(triangle)].join(" ");
        let precision = if trial.exact { "exact" } else { "fast" };
        let (place, kind) = (format!("{} {}", self.subject.name, asked.camera.name), asked.kind.name());
        format!("{place} {kind}: {how} in {precision} precision on {}", self.plan.device(trial.processor).0)
    }

    fn difference(&self, trial: &Trial, asked: &Asked<'_>, answers: &Answers) -> String {
        let how = self.describe(trial, asked);
        match answers::first_difference(self.packed.primitives(), &asked.reference, answers) {
            Some(ray) => format!("{how}: ray {ray} of {} differs first", asked.stream.len()),
            None => format!("{how}: there are fewer answers than rays"),
        }
    }
}

fn processor(processor: Processor) -> &'static str {
    match processor {
        Processor::Gpu => "gpu",
        Processor::Cpu => "cpu",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::{plan, subject};
    use crate::error::Error;

    #[test]
    fn another_answer_in_exact_precision_is_a_fault_that_names_the_ray() {
        let (plan, subject, mut report) = (plan(), subject(), Report::default());
        let packed = Job::with_wide_nodes(&subject.scene, subject.scene.settings, plan.quality).unwrap();
        let bench = Bench::new(&plan, &subject, &packed, &mut report).unwrap();
        let view = View::new(&packed, &subject.cameras[0]).unwrap();
        let sight = PrimaryHits::new(&packed, &CameraRays::of(&packed, &view, Order::Tiled), 0).unwrap();
        let stream = sight.rays(Kind::Ao, bench.ao_length).unwrap();
        let trial = plan.trials(&packed, Kind::Ao, Order::Tiled, &mut |_| ())[4];
        let asked = bench.asked(Kind::Ao, &subject.cameras[0], &stream, &[trial]).unwrap();
        let traced = || bench.traced(&trial, &asked, None).unwrap();
        bench.keep(&trial, &asked, Ok(traced()), &mut report);
        assert_eq!((report.faults.len(), report.records.len()), (0, 1));
        let mut wrong = traced();
        let Answers::Occlusion(answers) = &mut wrong.answers else { panic!("these were asked for") };
        answers[77] ^= 1;
        bench.keep(&trial, &asked, Ok(wrong), &mut report);
        bench.keep(&trial, &asked, Err(Error::new("the device was lost")), &mut report);
        assert_eq!((report.faults.len(), report.records.len()), (2, 2));
        let start = "box front ao: packet grid tiled gathered watertight in exact precision on ";
        assert!(report.faults.iter().all(|fault| fault.starts_with(start)), "{:?}", report.faults);
        assert!(report.faults[0].ends_with(&format!(": ray 77 of {} differs first", stream.len())));
        assert!(report.faults[1].ends_with(": the device was lost"));
        assert!(report.records[1].differing > 0.0 && report.records[0].hash != report.records[1].hash);
    }
}
