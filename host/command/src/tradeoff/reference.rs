//! What pictures are compared with.

use super::setting::clamp;
use super::{Axes, Plan, Subject};
use crate::error::Result;
use eyerays::choice::Named;
use eyerays::compare::compare;
use eyerays::cpu;
use eyerays::job::Job;
use eyerays::method::Traversal;
use eyerays::picture::Picture;
use eyerays::render::{Backend, Precision};
use eyerays::scene::{Sampler, Settings, Transport};
use eyerays::view::View;

/// The most accurate picture, and others as far as they are of use.
pub struct References {
    /// What all are compared with.
    best: Picture,
    /// In double precision by samples of a pixel and sampler, where light is not sampled.
    alike: Vec<((u32, Sampler), Picture)>,
    /// Of `best` where light is sampled: root of the mean square over all channel values, in linear light.
    pub standard_error: Option<f64>,
}

/// What the pictures are rendered of, and on.
struct Studio<'a> {
    plan: &'a Plan,
    subject: &'a Subject,
    packed: Job,
    device: &'a Backend,
    begins: &'a dyn Fn(&str),
}

impl Studio<'_> {
    /// The scene by these settings, as it is seen; `step` is what begins.
    fn seen(&mut self, settings: Settings, step: &str) -> Result<View> {
        (self.begins)(step);
        self.packed = self.packed.with(settings)?;
        Ok(View::new(&self.packed, &self.subject.camera)?)
    }

    /// On the CPU.
    fn on_cpu<R: cpu::Number>(&self, view: &View) -> Result<Picture> {
        let threads = self.device.choice().threads;
        Ok(cpu::render::<R>(&self.packed, view, Traversal::default(), threads, &|_| ())?.0)
    }
}

impl References {
    /// How many pictures there are at most.
    pub fn steps(plan: &Plan) -> usize {
        if is_sampled(&plan.axes) { 2 } else { plan.axes.samples.len() * plan.axes.samplers.len() }
    }

    /// Renders them; `begins` is called with every step.
    ///
    /// # Errors
    /// Settings that the scene or the device refuses.
    pub fn new(
        plan: &Plan,
        subject: &Subject,
        (packed, device): (&Job, &Backend),
        begins: &dyn Fn(&str),
    ) -> Result<Self> {
        let studio = Studio { plan, subject, packed: packed.clone(), device, begins };
        if is_sampled(&plan.axes) { Self::sampled(studio) } else { Self::without_noise(studio) }
    }

    /// One for every number of samples, in double precision.
    fn without_noise(mut studio: Studio<'_>) -> Result<Self> {
        let axes = &studio.plan.axes;
        let best = axes.reference(studio.subject.settings);
        let mut render = |settings: Settings| -> Result<Picture> {
            let step = format!("reference, {} samples, {}", settings.samples_a_pixel(), settings.sampler);
            let view = studio.seen(settings, &step)?;
            studio.on_cpu::<f64>(&view)
        };
        let mut alike = Vec::new();
        let wanted = axes.samplers.iter().flat_map(|&sampler| {
            axes.samples.iter().map(move |&(samples, spp)| Settings { samples, spp, sampler, ..best })
        });
        for settings in wanted.filter(|settings| settings.grid().is_ok()) {
            alike.push(((settings.samples_a_pixel(), settings.sampler), render(settings)?));
        }
        let key = (best.samples_a_pixel(), best.sampler);
        let best = match alike.iter().find(|(of, _)| *of == key) {
            Some((_, picture)) => picture.clone(),
            None => render(best)?,
        };
        Ok(References { best, alike, standard_error: None })
    }

    /// The mean of two pictures in exact precision whose noise has nothing in common with each other's and with that of
    /// pictures which they judge: their difference tells the error of their mean, for samplers of every kind.
    fn sampled(mut studio: Studio<'_>) -> Result<Self> {
        let best = studio.plan.axes.reference(studio.subject.settings);
        let spp = halves(studio.plan);
        let mut half = |place: u32| -> Result<Picture> {
            let transport = Transport { seed: seed(best.transport.seed, place), ..best.transport };
            let settings = Settings { samples: 1, spp, sampler: Sampler::Sobol, transport, ..best };
            let view = studio.seen(settings, &format!("reference, {spp} samples, {place} of 2"))?;
            if studio.device.choice().precision == Precision::Exact {
                return Ok(studio.device.render(&studio.packed, &view, 1, &|_| ())?.picture);
            }
            // A device that was opened for fast precision may have no other.
            studio.on_cpu::<f32>(&view)
        };
        let (first, second) = (half(1)?, half(2)?);
        let standard_error = Some(compare(&first, &second)?.rmse / 2.0);
        let mean = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|i| 0.5 * a[i] + 0.5 * b[i]);
        let pixels = first.pixels.iter().zip(&second.pixels).map(mean).collect();
        let best = Picture::from_pixels(first.width, first.height, pixels)?;
        Ok(References { best, alike: Vec::new(), standard_error })
    }

    /// What all pictures are compared with.
    pub fn best(&self) -> &Picture {
        &self.best
    }

    /// The one of the same samples.
    pub fn alike(&self, settings: &Settings) -> Option<&Picture> {
        let key = (settings.samples_a_pixel(), settings.sampler);
        self.alike.iter().find(|(of, _)| *of == key).map(|(_, picture)| picture)
    }

    /// In a line.
    pub fn says(&self, plan: &Plan, subject: &Subject) -> String {
        let best = plan.axes.reference(subject.settings);
        let Settings { bounces, min_contribution, .. } = best;
        let Some(standard_error) = self.standard_error else {
            let samples = match best.spp {
                0 => format!("{0}x{0}", best.samples),
                spp => spp.to_string(),
            };
            return format!(
                "double precision, {samples} samples a pixel, at most {bounces} bounces, least contribution \
                 {min_contribution}"
            );
        };
        format!(
            "exact precision, {}, two pictures of {} samples a pixel with seeds of their own (sobol), at most {bounces} \
             bounces, {}; its standard error is {standard_error:.2e}",
            best.transport.integrator.name(),
            halves(plan),
            clamp(best.transport.clamp)
        )
    }
}

/// Does the integrator that leaves out least sample light?
fn is_sampled(axes: &Axes) -> bool {
    axes.integrators[0].samples()
}

/// Samples of a pixel in each of the two pictures.
fn halves(plan: &Plan) -> u32 {
    plan.reference_spp.div_ceil(2)
}

/// Another seed than the one of pictures that are judged.
fn seed(own: u32, place: u32) -> u32 {
    own.wrapping_add(place << 16)
}
