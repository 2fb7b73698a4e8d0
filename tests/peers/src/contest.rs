//! Who follows rays, and how that is measured.

use std::time::Instant;

use eyerays::stream::{Question, Stream};
use rayon::prelude::*;

/// Neighbouring rays of a task; a multiple of every packet.
pub const TASK: usize = 1024;

/// What was found by ray: the distance, negative for nothing. Of an any-hit ray the distance is zero.
pub type Answers = Vec<f32>;

/// Somebody who follows rays.
pub trait RayTracer: Sync {
    fn name(&self) -> &'static str;
    /// Does it follow neighbours together?
    fn is_packet(&self) -> bool {
        false
    }
    /// Follows every ray; seconds and what was found.
    fn cast(&self, pool: &rayon::ThreadPool, stream: &Stream, question: Question) -> (f64, Answers);
}

/// Every task of a stream in parallel, each given its first ray and the place of its answers.
pub fn tasks(pool: &rayon::ThreadPool, stream: &Stream, task: impl Fn(usize, &mut [f32]) + Sync) -> (f64, Answers) {
    let mut answers = vec![0f32; stream.len()];
    let seconds = pool.install(|| {
        let start = Instant::now();
        answers.par_chunks_mut(TASK).with_max_len(1).enumerate().for_each(|(i, answers)| task(i * TASK, answers));
        start.elapsed().as_secs_f64()
    });
    (seconds, answers)
}

/// How many rays hit something.
pub fn hits(answers: &[f32]) -> usize {
    answers.iter().filter(|&&t| t >= 0.0).count()
}

/// How far apart two places may lie that count as one, in the normalised scene, which lies within [-1, 1].
pub const APART: f32 = 1e-5;

/// Of how many rays do two answers differ: in whether there is a hit, or in its place?
pub fn differing(stream: &Stream, ours: &[f32], theirs: &[f32]) -> usize {
    let differs = |i: usize, (a, b): (f32, f32)| {
        (a >= 0.0) != (b >= 0.0) || a >= 0.0 && (a - b).abs() * stream.ray(i).direction.length() > APART
    };
    let both = ours.iter().copied().zip(theirs.iter().copied());
    both.enumerate().filter(|&(i, both)| differs(i, both)).count()
}
