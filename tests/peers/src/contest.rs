//! Who follows rays, and how that is measured.

use std::time::Instant;

use eyerays::stream::{Question, Stream};
use rayon::prelude::*;

/// Neighbouring rays of a task; a multiple of every packet.
pub const TASK: usize = 1024;

/// What was found: how many rays hit something, and the sum of the distances to it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    pub hits: u64,
    pub distance: f64,
}

impl std::ops::Add for Found {
    type Output = Found;
    fn add(self, other: Found) -> Found {
        Found { hits: self.hits + other.hits, distance: self.distance + other.distance }
    }
}

/// Somebody who follows rays.
pub trait RayTracer: Sync {
    fn name(&self) -> &'static str;
    /// Does it follow neighbours together?
    fn is_packet(&self) -> bool {
        false
    }
    /// Follows every ray; seconds and what was found.
    fn cast(&self, pool: &rayon::ThreadPool, stream: &Stream, question: Question) -> (f64, Found);
}

/// Every task of a stream in parallel, with its answers: the distance, negative for none.
pub fn tasks(pool: &rayon::ThreadPool, stream: &Stream, task: impl Fn(usize, &mut [f32]) + Sync) -> (f64, Found) {
    let mut answers = vec![0f32; stream.len()];
    let seconds = pool.install(|| {
        let start = Instant::now();
        answers.par_chunks_mut(TASK).with_max_len(1).enumerate().for_each(|(i, answers)| task(i * TASK, answers));
        start.elapsed().as_secs_f64()
    });
    let found = answers.iter().filter(|&&t| t >= 0.0);
    (seconds, found.fold(Found::default(), |sum, &t| sum + Found { hits: 1, distance: f64::from(t) }))
}
