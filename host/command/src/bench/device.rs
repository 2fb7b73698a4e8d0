//! Streams on one device or the other, several times.

use std::time::{Duration, Instant};

use super::{Plan, Timing};
use crate::error::{Error, Result};
use eyerays::cpu;
use eyerays::gpu::{Cast, Caster, Gpu};
use eyerays::job::Job;
use eyerays::method::{Layout, Traversal};
use eyerays::stream::{Answers, Question, Stream};

/// Rays of a subgroup, at a multiple of which a stream is split.
const SUBGROUP: usize = 128;

/// What repetitions of a stream took, and what the last one answered.
pub(super) struct Run {
    pub timing: Timing,
    pub answers: Answers,
}

/// A scene on a GPU, in each layout that is measured.
pub(crate) struct OnGpu<'a> {
    gpu: &'a Gpu,
    casters: Vec<(Layout, Caster)>,
}

/// A stream on a GPU, in parts if its buffers are too small for all of it.
pub(crate) struct Uploaded(Vec<(Layout, Vec<Cast>)>);

impl<'a> OnGpu<'a> {
    pub fn new(gpu: &'a Gpu, packed: &'a Job, layouts: &[Layout]) -> Result<Self> {
        let casters = layouts.iter().map(|&layout| Ok((layout, Caster::new(gpu, packed, layout)?)));
        Ok(OnGpu { gpu, casters: casters.collect::<Result<_>>()? })
    }

    pub fn upload(&self, stream: &Stream) -> Result<Uploaded> {
        let bytes = self.gpu.report.max_binding.min(self.gpu.report.max_buffer);
        // A ray takes 32 bytes of a buffer.
        let most = (usize::try_from(bytes / 32).unwrap_or(usize::MAX) / SUBGROUP * SUBGROUP).max(SUBGROUP);
        let parts = |caster: &Caster| -> Result<Vec<Cast>> {
            if stream.len() <= most {
                return Ok(vec![caster.upload(stream)?]);
            }
            let starts = (0..stream.len()).step_by(most);
            starts.map(|start| Ok(caster.upload(&stream.part(start..stream.len().min(start + most)))?)).collect()
        };
        Ok(Uploaded(self.casters.iter().map(|(layout, c)| Ok((*layout, parts(c)?))).collect::<Result<_>>()?))
    }

    /// Traces a stream `repeat` times once the GPU is warm.
    pub(super) fn run(&self, on: &Uploaded, exact: bool, how: Traversal, ask: Question, repeat: u32) -> Result<Run> {
        let (caster, casts) = self.laid(on, how.layout)?;
        let mut times = vec![Duration::ZERO; repeat as usize];
        for cast in casts {
            let of_part = self.times(caster, cast, (exact, how, ask), repeat)?;
            times.iter_mut().zip(of_part).for_each(|(sum, time)| *sum += time);
        }
        Ok(Run { timing: Timing::of(&times), answers: answers(caster, casts, ask)? })
    }

    /// Traces a stream once, without taking the time.
    pub fn once(&self, on: &Uploaded, exact: bool, how: Traversal, ask: Question) -> Result<Answers> {
        let (caster, casts) = self.laid(on, how.layout)?;
        casts.iter().try_for_each(|cast| caster.trace(cast, exact, how, ask).map(drop))?;
        answers(caster, casts, ask)
    }

    /// What holds the scene and a stream in a layout.
    fn laid<'b>(&'b self, on: &'b Uploaded, layout: Layout) -> Result<(&'b Caster, &'b [Cast])> {
        let caster = self.casters.iter().find(|(of, _)| *of == layout).map(|(_, caster)| caster);
        let casts = on.0.iter().find(|(of, _)| *of == layout).map(|(_, casts)| casts.as_slice());
        caster.zip(casts).ok_or_else(|| Error::new("a layout is not on the GPU"))
    }

    /// Device times of dispatches; without a clock, wall-clock time around each.
    fn times(
        &self,
        caster: &Caster,
        cast: &Cast,
        (exact, how, ask): (bool, Traversal, Question),
        repeat: u32,
    ) -> Result<Vec<Duration>> {
        let report = &self.gpu.report;
        // A software device has no clocks to raise, and warming up would take minutes.
        if report.timestamps && !report.is_software() {
            return Ok(caster.measure(cast, exact, how, ask, repeat)?);
        }
        caster.trace(cast, exact, how, ask)?;
        let time = |_| {
            let start = Instant::now();
            let device_time = caster.trace(cast, exact, how, ask)?;
            Ok(if report.timestamps { device_time } else { start.elapsed() })
        };
        (0..repeat).map(time).collect()
    }
}

/// The last answers to all parts of a stream.
fn answers(caster: &Caster, casts: &[Cast], ask: Question) -> Result<Answers> {
    Ok(joined(casts.iter().map(|cast| Ok(caster.answers(cast, ask)?)).collect::<Result<Vec<_>>>()?))
}

/// The answers of all parts of a stream.
fn joined(parts: Vec<Answers>) -> Answers {
    let mut parts = parts.into_iter();
    let mut all = parts.next().unwrap_or(Answers::Occlusion(Vec::new()));
    for part in parts {
        match (&mut all, part) {
            (Answers::Closest(all), Answers::Closest(more)) => all.extend(more),
            (Answers::Occlusion(all), Answers::Occlusion(more)) => all.extend(more),
            _ => unreachable!("all parts were asked the same"),
        }
    }
    all
}

/// Traces a stream on the CPU once to warm up and then as often as planned.
pub(super) fn on_cpu(plan: &Plan, packed: &Job, stream: &Stream, how: Traversal, ask: Question) -> Result<Run> {
    let cast = || cpu::cast(packed, how, plan.threads, stream, ask);
    let (mut answers, _) = cast()?;
    let mut times = Vec::new();
    for _ in 0..plan.repeat.max(1) {
        let time;
        (answers, time) = cast()?;
        times.push(time);
    }
    Ok(Run { timing: Timing::of(&times), answers })
}
