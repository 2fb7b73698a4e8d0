//! Times and errors of settings.

use std::path::PathBuf;

use super::hits::{HitErrors, Primary};
use super::record::mark;
use super::reference::References;
use super::{Axes, Record, Report, Setting, Wish, recommended, search};
use crate::bench::{Timing, cpu_model};
use crate::error::{Error, Result};
use crate::remedy;
use eyerays::compare::compare;
use eyerays::job::Job;
use eyerays::method::{Layout, Method, Processor, TriangleTest};
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Precision};
use eyerays::scene::{Camera, Scene, Settings};
use eyerays::view::View;

/// What is measured, and how thoroughly.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The values that are tried.
    pub axes: Axes,
    /// How often a picture is rendered after a warm-up.
    pub repeat: u32,
    /// The most settings.
    pub trials: usize,
    /// Samples of a pixel of the reference where light is sampled.
    pub reference_spp: u32,
    /// What is to be recommended.
    pub wish: Option<Wish>,
}

/// A scene as it is seen.
pub struct Subject {
    /// As tables call it.
    pub name: String,
    /// Where it came from, for errors.
    pub file: PathBuf,
    /// The scene.
    pub scene: Scene,
    /// Where it is seen from.
    pub camera: Camera,
    /// Its own settings, in the size that is measured.
    pub settings: Settings,
}

/// The most steps that [`run`] reports.
pub fn steps(plan: &Plan) -> usize {
    References::steps(plan) + plan.trials
}

/// Renders a scene with settings of a plan, as [`search`] chooses them, on a device, and compares each picture with
/// one in double precision or, where light is sampled, of many samples. `begins` is called with every step.
///
/// # Errors
/// A scene that can't be packed, or the base, which all is compared with, fails on the device. Other settings that
/// fail are left out with a note.
pub fn run(plan: &Plan, subject: &Subject, device: Backend, begins: &dyn Fn(&str)) -> Result<Report> {
    let base = plan.axes.base(Setting::of(&subject.settings));
    let mut judge = Judge::new(plan, subject, device, begins).map_err(|error| error.of(&subject.file))?;
    let (mut records, stopped) = search(&plan.axes, base, plan.trials, &mut |setting| {
        begins(&setting.beside(&base));
        judge.tried(setting)
    })
    .map_err(|error| error.of(&subject.file))?;
    mark(&mut records);
    if let Some(best) = plan.wish.and_then(|wish| recommended(&records, wish)) {
        records[best].recommended = true;
    }
    let setup = setup(plan, subject, &judge);
    let mut notes = judge.notes;
    let least = records.iter().map(|record| record.rmse).fold(f64::INFINITY, f64::min);
    if judge.references.standard_error.is_some_and(|error| error > TELLING * least) {
        notes.push("the reference errs nearly as much as the best pictures: raise --reference-spp".to_owned());
    }
    if stopped {
        let note = format!("stopped after {} settings, the front may not be whole: raise --trials", plan.trials);
        notes.push(note);
    }
    Ok(Report { scene: subject.name.clone(), setup, base, records, notes })
}

/// The share of a picture's RMSE from which the reference's own error is told: a seventh of the RMSE is then the reference's.
const TELLING: f64 = 0.5;

/// Where pictures were rendered, and by which clock.
struct Place {
    processor: Processor,
    device: String,
    clock: &'static str,
}

/// What the hits of primary rays depend on.
type Seen = (Precision, TriangleTest, Method, Layout, Bvh);

/// What settings are measured by.
struct Judge<'a> {
    plan: &'a Plan,
    subject: &'a Subject,
    device: Backend,
    packed: Job,
    bvh: Bvh,
    primary: Primary,
    references: References,
    /// By settings that lead to the same hits.
    hits: Vec<(Seen, HitErrors)>,
    /// Of the first setting; one that runs elsewhere is left out.
    place: Option<Place>,
    notes: Vec<String>,
}

impl<'a> Judge<'a> {
    fn new(plan: &'a Plan, subject: &'a Subject, device: Backend, begins: &dyn Fn(&str)) -> Result<Self> {
        let best = plan.axes.reference(subject.settings);
        let (bvh, threads) = (Bvh::default(), device.choice().threads);
        let once = Settings { samples: 1, spp: 0, ..best };
        let packed = Job::with_wide_nodes(&subject.scene, once, bvh.quality())?;
        let primary = Primary::new(&packed, &View::new(&packed, &subject.camera)?, threads)?;
        let references = References::new(plan, subject, (&packed, &device), begins)?;
        let (hits, notes) = (Vec::new(), Vec::new());
        Ok(Judge { plan, subject, device, packed, bvh, primary, references, hits, place: None, notes })
    }

    /// Measures a setting; the first one must not fail.
    fn tried(&mut self, setting: &Setting) -> Result<Option<Record>> {
        match self.measured(setting) {
            Err(error) if self.place.is_some() => {
                self.notes.push(format!("{} is left out: {error}", setting.options()));
                Ok(None)
            }
            result => result.map(Some),
        }
    }

    fn measured(&mut self, setting: &Setting) -> Result<Record> {
        self.pack(setting)?;
        let traversal = setting.traversal(self.device.choice().traversal);
        self.device.turn(setting.precision, traversal);
        let view = View::new(&self.packed, &self.subject.camera)?;
        let rendering = self.device.measure(&self.packed, &view, self.plan.repeat)?;
        let elsewhere = self.place.as_ref().is_some_and(|place| place.processor != rendering.processor);
        if elsewhere {
            return Err(Error::new(format!("it runs on {}: {}", rendering.device, remedy::why(&rendering))));
        }
        let hits = self.hits(setting, rendering.processor)?;
        let timing = Timing::of(&rendering.times);
        let slowest = rendering.times.iter().max().map_or(0.0, |time| time.as_secs_f64());
        let judged = compare(&rendering.picture, self.references.best())?;
        let alike = self.references.alike(self.packed.settings());
        let alike = alike.map(|alike| compare(&rendering.picture, alike)).transpose()?;
        self.place.get_or_insert(Place {
            processor: rendering.processor,
            clock: if rendering.device_time.is_some() { "device time, by timestamps" } else { "wall-clock time" },
            device: rendering.device,
        });
        Ok(Record {
            setting: *setting,
            time_ms: timing.median * 1e3,
            spread: timing.spread,
            slowest_ms: slowest * 1e3,
            build_ms: self.packed.build_time().as_secs_f64() * 1e3,
            wrong_primitives: hits.wrong,
            t_error_median_ulp: hits.median_ulp,
            t_error_max_ulp: hits.max_ulp,
            rmse: judged.rmse,
            psnr_db: judged.psnr,
            rmse_same_samples: alike.map(|alike| alike.rmse),
            front: None,
            recommended: false,
        })
    }

    /// Packs the scene for a setting, with another hierarchy only where it must be.
    fn pack(&mut self, setting: &Setting) -> Result<()> {
        let Subject { scene, .. } = self.subject;
        let settings = setting.settings(self.subject.settings);
        if self.bvh != setting.bvh {
            self.packed = Job::with_wide_nodes(scene, settings, setting.bvh.quality())?;
            self.bvh = setting.bvh;
        }
        self.packed = self.packed.with(settings)?;
        Ok(())
    }

    /// What a setting's primary rays meet does not depend on what follows.
    fn hits(&mut self, setting: &Setting, processor: Processor) -> Result<HitErrors> {
        let key = (setting.precision, setting.triangle, setting.method, setting.layout, setting.bvh);
        if let Some((_, errors)) = self.hits.iter().find(|(of, _)| *of == key) {
            return Ok(*errors);
        }
        let gpu = self.device.gpu().filter(|_| processor == Processor::Gpu);
        let errors = self.primary.errors(&self.packed, gpu, self.device.choice())?;
        self.hits.push((key, errors));
        Ok(errors)
    }
}

/// Names and values of all that figures depend on.
fn setup(plan: &Plan, subject: &Subject, judge: &Judge<'_>) -> Vec<(String, String)> {
    let (width, height) = subject.settings.size;
    let (device, clock) = judge.place.as_ref().map_or(("", ""), |place| (place.device.as_str(), place.clock));
    let triangles = subject.scene.mesh.triangles.len();
    let lines = [
        ("program", format!("eyerays {}", env!("CARGO_PKG_VERSION"))),
        ("machine", format!("{}, {} {}", cpu_model(), std::env::consts::OS, std::env::consts::ARCH)),
        ("device", device.to_owned()),
        ("scene", format!("{}, {triangles} triangles, camera {}", subject.file.display(), subject.camera.name)),
        ("size", format!("{width}x{height} pixels")),
        ("reference", judge.references.says(plan, subject)),
        ("time", format!("{clock}, median of {} after a warm-up; without building", plan.repeat)),
    ];
    lines.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}
