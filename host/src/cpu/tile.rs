//! A tile of the picture: small launches, a sample each, whose sums are added in the order of the samples.

use std::ops::Range;

use eyerays_shader::camera;
use eyerays_shader::data::{Frame, Launch as Bits};
use eyerays_shader::integrator::{self, Exchange, Wave};
use eyerays_shader::real::{Scalar, SimdIsa, Task, V3};
use eyerays_shader::resources::binding;
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::{self, ShadowInputs};

use super::follow::{Job, follow};
use super::isa::Isa;
use crate::device_scene::SceneView;
use crate::error::Result;
use crate::method::{Method, Processor};
use crate::plan::{self, Executor, Plan, Stage, Step};
use crate::view::{Region, View};

/// Where a launch's rays are after a wave; tests read it to see why two pictures differ.
pub trait Observer<R: Scalar>: Sync {
    /// Is called when a wave has been traced and before it is shaded.
    fn wave(&self, scene: &TraceContext<'_>, slots: &[u32], records: &Records<R>);
}

/// Looks at nothing.
impl<R: Scalar> Observer<R> for () {
    fn wave(&self, _: &TraceContext<'_>, _: &[u32], _: &Records<R>) {}
}

/// The memory that the stages of a launch exchange.
pub struct Records<R: Scalar> {
    /// Paths by level, record and slot; empty without secondary rays.
    pub paths: Vec<R::Record>,
    /// (t, u, v) and triangle by slot.
    pub hits: Vec<R::Record>,
    /// Answers of the shadow stage by light and slot.
    pub shadows: Vec<u32>,
    /// Shadow rays by record and slot, where the integrator samples.
    pub segments: Vec<R::Record>,
    /// Colour and counts by slot.
    pub sums: Vec<R::Record>,
}

impl<R: Scalar> Records<R> {
    fn new(plan: &Plan, slots: u32) -> Self {
        let count = |binding, bytes| (plan.bytes_of(binding) / bytes) as usize * slots as usize;
        let records = |binding| vec![R::store(V3::zero(), 0); count(binding, 16)];
        Records {
            paths: records(binding::PATHS),
            hits: records(binding::HITS),
            shadows: vec![0; count(binding::SHADOWS, 4)],
            segments: records(binding::SEGMENTS),
            sums: records(binding::SUMS),
        }
    }
}

/// A scene with the plan of its pictures.
pub struct Planned<'a> {
    /// The scene.
    pub laid: SceneView<'a>,
    pub(super) plan: Plan,
    pub(super) isa: Isa,
}

impl<'a> Planned<'a> {
    /// Plans pictures of a scene, with the instructions of an Isa.
    pub fn new(laid: SceneView<'a>, isa: Isa) -> Self {
        let traversal = laid.traversal;
        let plan = Plan::new(laid.packed, &traversal, |coherence| Ok(traversal.resolved(Processor::Cpu, coherence)));
        Planned { laid, plan: plan.expect("a CPU has every method"), isa }
    }

    /// An empty film for a region.
    pub fn film<R: Scalar>(&self, region: Region) -> Vec<R::Record> {
        let records = self.plan.film_bytes / Plan::RECORD_BYTES;
        vec![R::store(V3::zero(), 0); (records * region.pixels()) as usize]
    }

    /// Adds samples of a region, wherever its edges are, to its film (row-major; the integers count shadow rays; where the
    /// integrator samples, what rounding took off follows), and
    /// returns how many secondary rays they took. Samples that the view does not have are left out.
    ///
    /// # Panics
    /// If the film is not the region's.
    pub fn add<R: Scalar>(
        &self,
        view: &View,
        region: Region,
        samples: Range<u32>,
        film: &mut [R::Record],
        observer: &dyn Observer<R>,
    ) -> u64 {
        let order = self.laid.specialisation().order;
        let slots = view.launch(self.laid.packed, region, 0, 1, order).slots;
        let mut records = Records::new(&self.plan, slots);
        let mut secondary = 0;
        for sample in samples.start..samples.end.min(view.samples()) {
            let frame = view.launch(self.laid.packed, region, sample, 1, order);
            let pixels = (0..slots).filter(|&slot| camera::pixel(&frame, order, slot).inside);
            let (queue, next) = (pixels.collect(), Vec::new());
            let mut launch =
                Launch { planned: self, frame: &frame, queue, next, records, film, observer, secondary: 0 };
            plan::run(&self.plan, &mut launch).expect("a CPU reports no errors");
            secondary += launch.secondary;
            records = launch.records;
        }
        secondary
    }
}

/// One sample of a region.
struct Launch<'l, 'a, R: Scalar> {
    planned: &'l Planned<'a>,
    frame: &'l Frame,
    /// Slots of the wave.
    queue: Vec<u32>,
    /// Those of the next.
    next: Vec<u32>,
    records: Records<R>,
    film: &'l mut [R::Record],
    observer: &'l dyn Observer<R>,
    secondary: u64,
}

impl<R: Scalar> Executor for Launch<'_, '_, R> {
    fn step(&mut self, _: usize, step: &Step) -> Result<()> {
        let scene = self.planned.laid.context(self.frame, step.spec);
        let method = step.traversal.map(|traversal| traversal.method).unwrap_or_default();
        match step.stage {
            Stage::Advance => {
                std::mem::swap(&mut self.queue, &mut self.next);
                self.next.clear();
                self.secondary += self.queue.len() as u64;
            }
            Stage::Trace => self.trace(&scene, method),
            Stage::Shadow => self.shadow(&scene, method),
            Stage::Shade => self.shade(&scene),
            Stage::Generate => {
                for &slot in &self.queue {
                    stage::generate::<R>(self.frame, step.spec, slot, &mut self.records.paths);
                }
            }
            Stage::Scatter => self.scatter(&scene),
            Stage::Gather => {
                for slot in 0..self.frame.pixel_slots {
                    stage::gather::<R>(self.frame, step.spec.order, slot, &self.records.sums, self.film);
                }
            }
            Stage::Accumulate => {
                let Records { shadows, segments, sums, .. } = &self.records;
                for slot in 0..self.frame.pixel_slots {
                    stage::accumulate::<R>(self.frame, step.spec.order, slot, (sums, shadows, segments), self.film);
                }
            }
        }
        Ok(())
    }

    fn goes_on(&mut self) -> Result<bool> {
        Ok(!self.next.is_empty())
    }
}

impl<R: Scalar> Launch<'_, '_, R> {
    fn trace(&mut self, scene: &TraceContext<'_>, method: Method) {
        let mut hits = vec![R::store(V3::zero(), 0); self.queue.len()];
        let job = Job::Trace(&self.records.paths, &mut hits);
        follow::<R>(self.planned.isa, method, scene, &self.queue, job);
        for (&slot, hit) in self.queue.iter().zip(hits) {
            self.records.hits[slot as usize] = hit;
        }
    }

    fn shadow(&mut self, scene: &TraceContext<'_>, method: Method) {
        let Records { paths, hits, shadows, segments, .. } = &mut self.records;
        let paths = if scene.base.spec.launch.has(Bits::STREAM) { segments } else { paths };
        let mut answers = vec![0; self.queue.len()];
        for light in 0..self.frame.shadow_rays {
            let asking = ShadowInputs { lights: self.planned.laid.lights(), paths, hits };
            let job = Job::Shadow(asking, light, &mut answers);
            follow::<R>(self.planned.isa, method, scene, &self.queue, job);
            for (&slot, &answer) in self.queue.iter().zip(&answers) {
                shadows[(light * self.frame.slots + slot) as usize] = answer;
            }
        }
    }

    /// Puts the slots that go on in the next queue.
    fn shade(&mut self, scene: &TraceContext<'_>) {
        self.observer.wave(scene, &self.queue, &self.records);
        let Records { paths, hits, shadows, sums, .. } = &mut self.records;
        let (lights, shading) = (self.planned.laid.lights(), self.planned.laid.shading());
        let environment = self.planned.laid.packed.environment();
        self.next.extend(self.queue.iter().filter(|&&slot| {
            let wave = Wave::<R> { paths: &mut *paths, hits, shadows, lights, environment, sums: &mut *sums };
            integrator::shade(&scene.base, &shading, slot, wave)
        }));
    }

    /// Likewise.
    fn scatter(&mut self, scene: &TraceContext<'_>) {
        self.observer.wave(scene, &self.queue, &self.records);
        let (queue, next, records) = (&self.queue[..], &mut self.next, &mut self.records);
        self.planned.isa.run(Scatter { scene, laid: &self.planned.laid, queue, next, records });
    }
}

/// The scattering of a wave's paths, for the instructions of an ISA.
struct Scatter<'t, 'a, R: Scalar> {
    scene: &'t TraceContext<'t>,
    laid: &'t SceneView<'a>,
    queue: &'t [u32],
    next: &'t mut Vec<u32>,
    records: &'t mut Records<R>,
}

impl<R: Scalar> Task<R> for Scatter<'_, '_, R> {
    #[inline(always)]
    fn run<V: SimdIsa<R>>(self) {
        let Records { paths, hits, shadows, segments, sums } = self.records;
        let context = self.laid.scattering();
        for &slot in self.queue {
            let exchange =
                Exchange::<R> { paths: &mut *paths, hits, shadows, segments: &mut *segments, sums: &mut *sums };
            if integrator::scatter(&self.scene.base, &context, slot, exchange) {
                self.next.push(slot);
            }
        }
    }
}
