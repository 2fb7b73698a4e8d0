//! Errors of hits: what primary rays meet, beside what they meet in double precision.

use eyerays_shader::real::Scalar;
use glam::UVec4;

use crate::bench::answers::primitive;
use crate::bench::rays::{CameraRays, PrimaryHits};
use crate::bench::{Kind, OnGpu};
use crate::error::Result;
use eyerays::cpu;
use eyerays::gpu::Gpu;
use eyerays::job::Job;
use eyerays::method::{Coherence, Order, Processor, Traversal};
use eyerays::render::{Choice, Precision};
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays::view::View;

/// How far hits are from those in double precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HitErrors {
    /// Share of the rays that met another primitive, or nothing where there is something, or the reverse.
    pub wrong: f64,
    /// Median error of the distance where both met the same primitive, in units of the last place of single
    /// precision.
    pub median_ulp: Option<f64>,
    /// The largest such error.
    pub max_ulp: Option<f64>,
}

impl HitErrors {
    /// Of distances and primitives ([`StreamRay::NOWHERE`] for none), ray by ray, beside the true ones.
    pub fn of(found: &[(f32, u32)], truth: &[(f64, u32)]) -> HitErrors {
        let pairs = || found.iter().zip(truth);
        let wrong = pairs().filter(|(found, truth)| found.1 != truth.1).count();
        let same = pairs().filter(|(found, truth)| found.1 == truth.1 && truth.1 != StreamRay::NOWHERE);
        let mut ulps: Vec<f64> =
            same.map(|(found, truth)| (f64::from(found.0) - truth.0).abs() / ulp(truth.0)).collect();
        ulps.sort_unstable_by(f64::total_cmp);
        HitErrors {
            wrong: wrong as f64 / truth.len().max(1) as f64,
            median_ulp: ulps.get(ulps.len() / 2).copied(),
            max_ulp: ulps.last().copied(),
        }
    }
}

/// A step from the single-precision number nearest to `x` to the next one above.
fn ulp(x: f64) -> f64 {
    let near = (x as f32).abs().min(f32::MAX.next_down());
    f64::from(near.next_up()) - f64::from(near)
}

/// The rays through the centres of a view's pixels, and what they meet in double precision.
pub struct Primary {
    stream: Stream,
    truth: Vec<(f64, u32)>,
}

impl Primary {
    /// Of a view: one ray a pixel, made in exact precision and then traced in double.
    ///
    /// # Errors
    /// If the threads can't be had.
    pub fn new(packed: &Job, view: &View, threads: usize) -> Result<Primary> {
        let sight = PrimaryHits::new(packed, &CameraRays::of(packed, view, Order::Tiled), threads)?;
        let stream = sight.rays(Kind::Primary, 0.0)?.into_owned();
        let traversal = Traversal::default().resolved(Processor::Cpu, Coherence::Scattered);
        let hits = cpu::closest::<f64>(packed, traversal, threads, &stream)?;
        let truth = hits
            .into_iter()
            .map(f64::load)
            .map(|(place, slot)| (place.x, primitive(packed.primitives(), slot)))
            .collect();
        Ok(Primary { stream, truth })
    }

    /// How far the hits of a choice in single precision are from the truth, on the GPU or else the CPU.
    ///
    /// # Errors
    /// What the device reports.
    pub fn errors(&self, packed: &Job, gpu: Option<&Gpu>, choice: &Choice) -> Result<HitErrors> {
        let on_cpu = choice.traversal.resolved(Processor::Cpu, Coherence::Primary);
        let hits = match gpu {
            Some(gpu) => self.on_gpu(gpu, packed, choice.precision == Precision::Exact, choice.traversal)?,
            None => cpu::closest::<f32>(packed, on_cpu, choice.threads, &self.stream)?,
        };
        let found: Vec<_> =
            hits.iter().map(|hit| (f32::from_bits(hit.x), primitive(packed.primitives(), hit.w))).collect();
        Ok(HitErrors::of(&found, &self.truth))
    }

    fn on_gpu(&self, gpu: &Gpu, packed: &Job, exact: bool, wanted: Traversal) -> Result<Vec<UVec4>> {
        let how = gpu.resolved(wanted, Coherence::Primary)?;
        let held = OnGpu::new(gpu, packed, &[how.layout])?;
        match held.once(&held.upload(&self.stream)?, exact, how, Question::Closest)? {
            Answers::Closest(hits) => Ok(hits),
            Answers::Occlusion(_) => unreachable!("the closest hits were asked for"),
        }
    }
}
