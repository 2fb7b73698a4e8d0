//! A tile of the picture: small launches, a sample each, whose sums are added in the order of the samples.

use std::ops::Range;

use eyerays_kernels_cpu::{Between, Isa, Number, Query, Queues, Records, Shown};
use eyerays_shader::camera;
use eyerays_shader::data::{Frame, Launch as Bits};
use eyerays_shader::photon::Casters;
use eyerays_shader::real::V3;
use eyerays_shader::resources::binding;
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::{BLOCK, CameraTables, FilmWords, Found, ShadowInputs};

use super::photons::{Map, NONE};
use crate::device_scene::SceneView;
use crate::error::Result;
use crate::method::{Method, Processor};
use crate::plan::{self, Executor, Plan, Stage, Step};
use crate::view::{Region, View};

/// Where a launch's rays are after a wave; tests read it to see why two pictures differ.
pub trait Observer<R: Number>: Sync {
    /// Is called when a wave has been traced and before it is shaded.
    fn wave(&self, scene: &TraceContext<'_>, slots: &[u32], records: &Records<R>);
}

/// Looks at nothing.
impl<R: Number> Observer<R> for () {
    fn wave(&self, _: &TraceContext<'_>, _: &[u32], _: &Records<R>) {}
}

/// Empty records for the slots of a launch.
pub(super) fn records<R: Number>(plan: &Plan, slots: u32) -> Records<R> {
    let count = |binding, bytes| (plan.bytes_of(binding) / bytes) as usize * slots as usize;
    let records = |binding| vec![R::store(V3::zero(), 0); count(binding, 16)];
    Records {
        paths: records(binding::PATHS),
        hits: records(binding::HITS),
        shadows: vec![0; count(binding::SHADOWS, 4)],
        segments: records(binding::SEGMENTS),
        sums: records(binding::SUMS),
        landed: Vec::new(),
    }
}

/// A scene with the plan of its pictures.
pub struct Planned {
    /// The scene.
    pub laid: SceneView,
    pub(super) plan: Plan,
    /// For whole blocks of samples.
    blocks: Option<Plan>,
    /// For photons, where they tell of caustics.
    pub(super) photons: Option<Plan>,
    pub(super) isa: Isa,
}

impl Planned {
    /// Plans pictures of a scene, with the instructions of an Isa.
    pub fn new(laid: SceneView, isa: Isa) -> Self {
        let traversal = laid.traversal;
        let resolve = |coherence| Ok(traversal.resolved(Processor::Cpu, coherence));
        let plan = Plan::new(&laid.job, &traversal, resolve).expect("a CPU has every method");
        let photons = Plan::of_photons(&laid.job, &traversal, resolve).expect("a CPU has every method");
        let blocks = plan.in_blocks(0);
        Planned { laid, plan, blocks, photons, isa }
    }

    /// Words of a pixel of a film.
    pub fn film_words(&self) -> FilmWords {
        self.plan.film_words
    }

    /// An empty film for a region, for [`Planned::add`].
    pub fn film(&self, region: Region) -> Vec<u32> {
        vec![0; region.pixels() as usize * self.plan.film_words.all() as usize]
    }

    /// Adds samples of a region, wherever its edges are, to its film, and returns how many secondary rays they took. Samples that
    /// the view does not have are left out.
    ///
    /// # Panics
    /// If the film is not the region's.
    pub fn add<R: Number>(
        &self,
        view: &View,
        region: Region,
        samples: Range<u32>,
        film: &mut [u32],
        observer: &dyn Observer<R>,
    ) -> u64 {
        let samples = samples.start..samples.end.min(view.range().end);
        let maps = self.maps::<R>(view, samples.clone());
        self.add_by(view, region, (samples, &maps), film, observer)
    }

    /// The same with the photons of each sample, none where none tell of caustics.
    pub(super) fn add_by<R: Number>(
        &self,
        view: &View,
        region: Region,
        (samples, maps): (Range<u32>, &[Map]),
        film: &mut [u32],
        observer: &dyn Observer<R>,
    ) -> u64 {
        let order = self.laid.specialisation().order;
        let frame = |sample| view.launch(&self.laid.job, region, sample, 1, order);
        let map = |sample| maps.get((sample - samples.start) as usize).unwrap_or(&NONE);
        let frames = samples.clone().map(|sample| (frame(sample), map(sample)));
        self.run(&self.plan, frames, film, observer)
    }

    /// The film of whole blocks of samples of a region, which keeps the squares of blocks, and how many secondary rays they took.
    ///
    /// # Panics
    /// If the integrator does not sample.
    pub(super) fn blocks<R: Number>(
        &self,
        view: &View,
        region: Region,
        (samples, map): (Range<u32>, &Map),
    ) -> (Vec<u32>, u64) {
        let plan = self.blocks.as_ref().expect("noise is of integrators that sample");
        let order = self.laid.specialisation().order;
        let frame = |first| (view.launch(&self.laid.job, region, first, BLOCK, order), map);
        let mut film = self.film(region);
        let secondary = self.run::<R>(plan, samples.step_by(BLOCK as usize).map(frame), &mut film, &());
        (film, secondary)
    }

    /// Runs launches of the same slots, and returns how many secondary rays they took.
    fn run<'m, R: Number>(
        &self,
        plan: &Plan,
        frames: impl Iterator<Item = (Frame, &'m Map)>,
        film: &mut [u32],
        observer: &dyn Observer<R>,
    ) -> u64 {
        let order = self.laid.specialisation().order;
        let (mut memory, mut secondary) = (None, 0);
        for (frame, map) in frames {
            let records = memory.take().unwrap_or_else(|| records(plan, frame.slots));
            let pixels = (0..frame.slots).filter(|&slot| camera::pixel(&frame, order, slot).inside);
            let mut launch = Launch::new((self, &frame), pixels.collect(), (records, film), observer, map);
            plan::run(plan, &mut launch).expect("a CPU reports no errors");
            secondary += launch.secondary;
            memory = Some(launch.records);
        }
        secondary
    }
}

/// One sample of a region.
pub(super) struct Launch<'l, R: Number> {
    planned: &'l Planned,
    frame: &'l Frame,
    /// Slots of the wave.
    queue: Vec<u32>,
    /// Those of the next.
    next: Vec<u32>,
    records: Records<R>,
    film: &'l mut [u32],
    observer: &'l dyn Observer<R>,
    /// The photons of its samples.
    map: &'l Map,
    secondary: u64,
}

impl<'l, R: Number> Launch<'l, R> {
    /// One of some slots, with its memory.
    pub fn new(
        (planned, frame): (&'l Planned, &'l Frame),
        queue: Vec<u32>,
        (records, film): (Records<R>, &'l mut [u32]),
        observer: &'l dyn Observer<R>,
        map: &'l Map,
    ) -> Self {
        Launch { planned, frame, queue, next: Vec::new(), records, film, observer, map, secondary: 0 }
    }

    /// What it has left in its memory.
    pub fn into_records(self) -> Records<R> {
        self.records
    }
}

impl<R: Number> Executor for Launch<'_, R> {
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
            Stage::Transmit => self.transmit(&scene),
            Stage::Shade => self.shade(&scene),
            Stage::Generate => {
                let job = &self.planned.laid.job;
                let tables = CameraTables { cells: &[], optics: job.optic_tables(), instances: job.instances() };
                R::generate(self.frame, step.spec, tables, &self.queue, &mut self.records);
            }
            Stage::Scatter => self.scatter(&scene),
            Stage::Emit => self.emit(&scene),
            // A map has its lists made when all photons have landed, and of streams alone is asked what they cross or are near to.
            Stage::File | Stage::Cross | Stage::Nearest => {}
            Stage::Gather => R::gather(self.frame, step.spec, &self.records, self.film),
            Stage::Accumulate => R::accumulate(self.frame, step.spec, &mut self.records, self.film),
        }
        Ok(())
    }

    fn goes_on(&mut self) -> Result<bool> {
        Ok(!self.next.is_empty())
    }
}

impl<R: Number> Launch<'_, R> {
    fn trace(&mut self, scene: &TraceContext<'_>, method: Method) {
        let hits = &self.records.hits;
        let timed = |&slot: &u32| Found { time: Found::<R>::time(&scene.base, slot, hits), ..Found::nothing() };
        let mut hits: Vec<Found<R>> = self.queue.iter().map(timed).collect();
        let query = Query::Trace(&self.records.paths, &mut hits);
        R::follow(self.planned.isa, method.way(), scene, &self.queue, query);
        for (&slot, hit) in self.queue.iter().zip(hits) {
            hit.store(&scene.base, slot, &mut self.records.hits);
        }
    }

    fn shadow(&mut self, scene: &TraceContext<'_>, method: Method) {
        let Records { paths, hits, shadows, segments, .. } = &mut self.records;
        let paths = if scene.base.spec.launch.has(Bits::STREAM) { segments } else { paths };
        let mut answers = vec![0; self.queue.len()];
        for light in 0..self.frame.shadow_rays {
            let asking = ShadowInputs { lights: self.planned.laid.lights(), paths, hits };
            let query = Query::Shadow(asking, light, &mut answers);
            R::follow(self.planned.isa, method.way(), scene, &self.queue, query);
            for (&slot, &answer) in self.queue.iter().zip(&answers) {
                shadows[(light * self.frame.slots + slot) as usize] = answer;
            }
        }
    }

    fn transmit(&mut self, scene: &TraceContext<'_>) {
        let job = &self.planned.laid.job;
        let (materials, media, grids, spectra) = (job.materials(), job.media(), job.grids(), job.spectra());
        let between = Between { materials, media, grids, spectra };
        R::transmit(scene, &between, &self.queue, &mut self.records);
    }

    /// Puts the slots that go on in the next queue.
    fn shade(&mut self, scene: &TraceContext<'_>) {
        self.observer.wave(scene, &self.queue, &self.records);
        let laid = &self.planned.laid;
        let (lights, environment) = (laid.lights(), laid.job.environment());
        let shown = Shown { launch: scene.base, shading: laid.shading(), lights, environment };
        R::shade(&shown, Queues { now: &self.queue, next: &mut self.next }, &mut self.records);
    }

    /// Likewise.
    fn scatter(&mut self, scene: &TraceContext<'_>) {
        self.observer.wave(scene, &self.queue, &self.records);
        let (isa, context) = (self.planned.isa, self.planned.laid.scattering());
        let queues = Queues { now: &self.queue, next: &mut self.next };
        R::scatter(isa, &scene.base, &context, (queues, self.map.photons()), &mut self.records);
    }

    fn emit(&mut self, scene: &TraceContext<'_>) {
        let (laid, casters) = (&self.planned.laid, Casters { records: self.planned.laid.job.casters() });
        R::emit(&scene.base, &laid.scattering().lighting, &casters, &self.queue, &mut self.records);
    }
}
