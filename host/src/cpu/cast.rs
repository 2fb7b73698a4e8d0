//! Streams of rays on the CPU.

use std::time::{Duration, Instant};

use bytemuck::Zeroable;
use eyerays_shader::data::{Features, Frame};
use eyerays_shader::scene::Geometry;
use eyerays_shader::stage::{self, Asking};
use eyerays_shader::traverse::{
    self, Cut, Hybrid, IfIf, Interleaved, Packet, Sequential, Speculative, StackMax, WhileWhile, WideNodes,
};
use eyerays_shader::warp::Alone;
use glam::UVec4;
use rayon::prelude::*;

use super::pool;
use crate::error::Result;
use crate::method::{Method, Traversal};
use crate::pack::{Packed, TriangleWords};
use crate::stream::{Answers, Question, Stream};

/// Neighbouring rays that a task follows.
const TASK: usize = 1024;

/// Follows the rays of a stream with `threads` threads (0: one a core) in exact precision, and returns what
/// that took beside the answers.
///
/// # Errors
/// If the threads can't be had.
pub fn cast(
    packed: &Packed,
    traversal: Traversal,
    threads: usize,
    stream: &Stream,
    question: Question,
) -> Result<(Answers, Duration)> {
    let words = TriangleWords::of(packed, traversal.layout);
    let frame =
        Frame { limits: UVec4::new(0, 0, stream.len() as u32, packed.triangles.len() as u32), ..Frame::zeroed() };
    let geometry = Geometry {
        frame: &frame,
        features: Features(packed.features.0 | traversal.features().0 | Features::STREAM),
        tuning: traversal.tuning,
        nodes: &packed.nodes,
        wide: &packed.wide,
        triangles: &words.0,
        bounds: &packed.bounds,
    };
    let follow = match traversal.method {
        Method::Auto | Method::IfIf => follow::<IfIf>,
        Method::WhileWhile => follow::<WhileWhile>,
        Method::Wide => follow::<WideNodes>,
        Method::Speculative => follow::<Speculative<Alone>>,
        Method::Packet => follow::<Packet<Alone>>,
        Method::SequentialStack => follow::<Hybrid<Alone, StackMax, Sequential>>,
        Method::SequentialCut => follow::<Hybrid<Alone, Cut, Sequential>>,
        Method::InterleavedStack => follow::<Hybrid<Alone, StackMax, Interleaved>>,
        Method::InterleavedCut => follow::<Hybrid<Alone, Cut, Interleaved>>,
    };
    pool(threads)?.install(|| Ok(follow(&geometry, stream, question)))
}

fn follow<M: traverse::Method<f32>>(
    geometry: &Geometry<'_>,
    stream: &Stream,
    question: Question,
) -> (Answers, Duration) {
    let mut answers = match question {
        Question::Closest => Answers::Closest(vec![UVec4::ZERO; stream.len()]),
        Question::Occlusion => Answers::Occlusion(vec![0; stream.len()]),
    };
    let start = Instant::now();
    match &mut answers {
        Answers::Closest(hits) => each(hits, |i| stage::trace::<f32, M>(geometry, i, stream.words())),
        Answers::Occlusion(shadows) => {
            let asking = Asking { lights: &[], paths: stream.words(), hits: &[] };
            each(shadows, |i| stage::shadow::<f32, M>(geometry, asking, i, 0));
        }
    }
    (answers, start.elapsed())
}

/// Fills in every answer, a task of neighbours at a time.
fn each<T: Send>(answers: &mut [T], answer: impl Fn(u32) -> T + Sync) {
    answers.par_chunks_mut(TASK).with_max_len(1).enumerate().for_each(|(task, answers)| {
        for (i, place) in answers.iter_mut().enumerate() {
            *place = answer((task * TASK + i) as u32);
        }
    });
}
