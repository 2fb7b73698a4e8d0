//! Streams of rays on the CPU.

use std::ops::Range;
use std::time::{Duration, Instant};

use eyerays_kernels_cpu::{Isa, Number, Query};
use eyerays_shader::data::numbers;
use eyerays_shader::real::V3;
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::{Found, ShadowInputs};
use glam::UVec4;
use rayon::prelude::*;

use super::pool::pool;
use crate::batch::{Measure, Placed, Rays, place};
use crate::device_scene::SceneView;
use crate::error::Result;
use crate::job::Job;
use crate::method::{Method, Traversal};
use crate::stream::{Answers, Question, Stream};

/// Neighbouring rays that a task follows; a multiple of the rays that are followed together.
const TASK: usize = 1024;

/// Follows the rays of a stream with `threads` threads (0: one a core) in exact precision, and returns what
/// that took beside the answers.
///
/// # Errors
/// If the threads can't be had.
pub fn cast(
    packed: &Job,
    traversal: Traversal,
    threads: usize,
    stream: &Stream,
    question: Question,
) -> Result<(Answers, Duration)> {
    cast_by(Isa::best(), packed, traversal, threads, stream, question)
}

/// [`cast`] with the instructions of an ISA.
///
/// # Errors
/// As [`cast`].
pub fn cast_by(
    isa: Isa,
    packed: &Job,
    traversal: Traversal,
    threads: usize,
    stream: &Stream,
    question: Question,
) -> Result<(Answers, Duration)> {
    Ok(pool(threads)?.install(|| cast_here(isa, packed, traversal, stream, question)))
}

/// [`cast_by`] with the threads that it is called in.
fn cast_here(isa: Isa, packed: &Job, traversal: Traversal, stream: &Stream, question: Question) -> (Answers, Duration) {
    let (laid, frame) = (SceneView::new(packed, traversal), packed.stream_frame(stream.len()));
    let geometry = laid.stream(&frame);
    let slots: Vec<u32> = (0..stream.len() as u32).collect();
    let asking = ShadowInputs { lights: &[], paths: stream.words(), hits: &[] };
    match question {
        Question::Closest => {
            let mut hits = vec![Found::nothing(); stream.len()];
            let start = Instant::now();
            trace::<f32>(isa, traversal.method, &geometry, &slots, stream.words(), &mut hits);
            let time = start.elapsed();
            (Answers::Closest(records::<f32>(&geometry, &hits)), time)
        }
        Question::Occlusion => {
            let mut shadows = vec![0; stream.len()];
            let start = Instant::now();
            tasks(&slots, &mut shadows, |slots, shadows| {
                f32::follow(isa, traversal.method.way(), &geometry, slots, Query::Shadow(asking, 0, shadows));
            });
            (Answers::Occlusion(shadows), start.elapsed())
        }
    }
}

/// A scene through which rays are followed by whoever asks, some neighbours at a time.
pub(crate) struct Follower(SceneView);

impl Follower {
    /// By a method.
    pub fn new(packed: &Job, method: Method) -> Self {
        Follower(SceneView::new(packed, method.into()))
    }

    /// Shows how far the rays are moved, and what each meets first.
    pub fn closest(&self, rays: &impl Rays, range: Range<usize>, look: impl FnOnce(&[Measure], &[Found<f32>])) {
        self.follow(rays, range, |geometry, slots, stream, measures| {
            let mut found = vec![Found::nothing(); slots.len()];
            f32::follow(Isa::best(), self.0.traversal.method.way(), geometry, slots, Query::Trace(stream, &mut found));
            look(measures, &found);
        });
    }

    /// Shows whether the rays meet anything, as [`Answers::Occlusion`] has it.
    pub fn any(&self, rays: &impl Rays, range: Range<usize>, look: impl FnOnce(&[u32])) {
        self.follow(rays, range, |geometry, slots, stream, _| {
            let mut shadows = vec![0; slots.len()];
            let asking = ShadowInputs { lights: &[], paths: stream, hits: &[] };
            f32::follow(
                Isa::best(),
                self.0.traversal.method.way(),
                geometry,
                slots,
                Query::Shadow(asking, 0, &mut shadows),
            );
            look(&shadows);
        });
    }

    fn follow(
        &self,
        rays: &impl Rays,
        range: Range<usize>,
        work: impl FnOnce(&TraceContext<'_>, &[u32], &[UVec4], &[Measure]),
    ) {
        let count = range.len();
        let (mut words, mut measures) = (vec![UVec4::ZERO; 2 * count], vec![Measure::default(); count]);
        let (firsts, seconds) = words.split_at_mut(count);
        place(self.0.job.normalisation(), rays, range, Placed { firsts, seconds, measures: &mut measures });
        let slots: Vec<u32> = (0..count as u32).collect();
        work(&self.0.stream(&self.0.job.stream_frame(count)), &slots, &words, &measures);
    }
}

/// The next crossings of some rays of a stream, each past the one that is told of it, with the threads that it is called in.
pub(crate) fn cross_here(packed: &Job, stream: &Stream, slots: &[u32], found: &mut [Found<f32>]) {
    let (laid, frame) = (SceneView::new(packed, Method::WhileWhile.into()), packed.stream_frame(stream.len()));
    let geometry = laid.stream(&frame);
    tasks(slots, found, |slots, found| f32::cross(&geometry, slots, stream.words(), found));
}

/// What is nearest to where the rays of a stream start, with the threads that it is called in.
pub(crate) fn nearest_here(packed: &Job, stream: &Stream) -> Vec<Found<f32>> {
    let (laid, frame) = (SceneView::new(packed, Method::WhileWhile.into()), packed.stream_frame(stream.len()));
    let geometry = laid.stream(&frame);
    let slots: Vec<u32> = (0..stream.len() as u32).collect();
    let mut found = vec![Found::nothing(); stream.len()];
    tasks(&slots, &mut found, |slots, found| f32::nearest(&geometry, slots, stream.words(), found));
    found
}

/// The closest hits of a stream's rays in the arithmetic `R`, as [`cast`] finds them in exact precision: (t, u,
/// v) and the slot of the triangle.
///
/// # Errors
/// As [`cast`].
pub fn closest<R>(packed: &Job, traversal: Traversal, threads: usize, stream: &Stream) -> Result<Vec<R::Record>>
where
    R: Number,
{
    let (laid, frame) = (SceneView::new(packed, traversal), packed.stream_frame(stream.len()));
    let slots: Vec<u32> = (0..stream.len() as u32).collect();
    let rays: Vec<R::Record> = stream.words().iter().map(|&word| R::store(V3::splat(numbers(word)), word.w)).collect();
    let mut hits = vec![Found::<R>::nothing(); stream.len()];
    let (method, geometry) = (traversal.method, laid.stream(&frame));
    pool(threads)?.install(|| trace::<R>(Isa::best(), method, &geometry, &slots, &rays, &mut hits));
    Ok(records(&geometry, &hits))
}

/// Hits as they lie in memory.
fn records<R: Number>(geometry: &TraceContext<'_>, hits: &[Found<R>]) -> Vec<R::Record> {
    let rows = Found::<R>::records(geometry.base.spec.effects) as usize;
    let mut records = vec![R::Record::default(); rows * hits.len()];
    for (slot, hit) in hits.iter().enumerate() {
        hit.store(&geometry.base, slot as u32, &mut records);
    }
    records
}

fn trace<R>(
    isa: Isa,
    method: Method,
    geometry: &TraceContext<'_>,
    slots: &[u32],
    rays: &[R::Record],
    hits: &mut [Found<R>],
) where
    R: Number,
{
    tasks(slots, hits, |slots, hits| R::follow(isa, method.way(), geometry, slots, Query::Trace(rays, hits)));
}

/// Neighbours a task, so that no thread waits long for the last.
fn tasks<T: Send>(slots: &[u32], answers: &mut [T], task: impl Fn(&[u32], &mut [T]) + Sync) {
    let tasks = slots.par_chunks(TASK).zip(answers.par_chunks_mut(TASK));
    tasks.with_max_len(1).for_each(|(slots, answers)| task(slots, answers));
}
