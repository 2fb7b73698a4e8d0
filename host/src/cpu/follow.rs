//! Following the rays of many slots, one by one or side by side.

use std::marker::PhantomData;

use eyerays_shader::real::Scalar;
use eyerays_shader::scene::Geometry;
use eyerays_shader::stage::{self, Asking, FACES_AWAY, Segment};
use eyerays_shader::traverse::{
    self, Cut, Hybrid, IfIf, Interleaved, Packet, Sequential, Speculative, StackMax, Together, WhileWhile, WideNodes,
};
use eyerays_shader::warp::Alone;

use super::level::{Level, Task};
use crate::method::Method;

/// What is asked of the rays of some slots, and where the answers go, in the order of the slots.
pub enum Job<'a, R: Scalar> {
    /// Their closest hits, of paths or a stream's rays.
    Trace(&'a [R::Record], &'a mut [R::Record]),
    /// Whether something is on their way to a light, or before the ends of a stream's rays.
    Shadow(Asking<'a, R>, u32, &'a mut [u32]),
}

/// Follows the rays of slots by a method, with the instructions of a level.
pub fn follow<R: Scalar>(level: Level, method: Method, geometry: &Geometry<'_>, slots: &[u32], job: Job<'_, R>) {
    let follow = match method {
        Method::Auto | Method::IfIf => alone::<R, IfIf>,
        Method::Wide => alone::<R, WideNodes>,
        Method::WhileWhile => alone::<R, WhileWhile>,
        Method::Speculative => alone::<R, Speculative<Alone>>,
        Method::Packet => together::<R, Packet<Alone>>,
        Method::SequentialStack => together::<R, Hybrid<Alone, StackMax, Sequential>>,
        Method::SequentialCut => together::<R, Hybrid<Alone, Cut, Sequential>>,
        Method::InterleavedStack => together::<R, Hybrid<Alone, StackMax, Interleaved>>,
        Method::InterleavedCut => together::<R, Hybrid<Alone, Cut, Interleaved>>,
    };
    follow(level, geometry, slots, job);
}

/// Every ray by itself.
struct EachAlone<'a, R: Scalar, M> {
    geometry: Geometry<'a>,
    slots: &'a [u32],
    job: Job<'a, R>,
    method: PhantomData<M>,
}

fn alone<R: Scalar, M: traverse::Method<R>>(level: Level, geometry: &Geometry<'_>, slots: &[u32], job: Job<'_, R>) {
    level.run::<R>(EachAlone::<R, M> { geometry: *geometry, slots, job, method: PhantomData });
}

impl<R: Scalar, M: traverse::Method<R>> Task for EachAlone<'_, R, M> {
    #[inline(always)]
    fn run<const N: usize>(self) {
        let Self { geometry, slots, job, .. } = self;
        match job {
            Job::Trace(paths, hits) => {
                for (&slot, hit) in slots.iter().zip(hits) {
                    *hit = stage::trace::<R, M>(&geometry, slot, paths);
                }
            }
            Job::Shadow(asking, light, answers) => {
                for (&slot, answer) in slots.iter().zip(answers) {
                    *answer = stage::shadow::<R, M>(&geometry, asking, slot, light);
                }
            }
        }
    }
}

/// Neighbours together.
struct Neighbours<'a, R: Scalar, M> {
    geometry: Geometry<'a>,
    slots: &'a [u32],
    job: Job<'a, R>,
    method: PhantomData<M>,
}

fn together<R: Scalar, M: Together>(level: Level, geometry: &Geometry<'_>, slots: &[u32], job: Job<'_, R>) {
    level.run::<R>(Neighbours::<R, M> { geometry: *geometry, slots, job, method: PhantomData });
}

impl<R: Scalar, M: Together> Task for Neighbours<'_, R, M> {
    #[inline(always)]
    fn run<const N: usize>(self) {
        let Self { geometry, slots, job, .. } = self;
        let most = stage::most::<R, R::Packet<N>>();
        let mut segments: Vec<Segment<R>> = Vec::with_capacity(most);
        match job {
            Job::Trace(paths, hits) => {
                for (slots, hits) in slots.chunks(most).zip(hits.chunks_mut(most)) {
                    segments.clear();
                    segments.extend(slots.iter().map(|&slot| stage::traced::<R>(&geometry, slot, paths)));
                    stage::trace_together::<R, R::Packet<N>, M>(&geometry, &segments, |i, record| hits[i] = record);
                }
            }
            Job::Shadow(asking, light, answers) => {
                let mut places = Vec::with_capacity(most);
                let mut rays = slots.iter().zip(answers).peekable();
                while rays.peek().is_some() {
                    segments.clear();
                    places.clear();
                    for (&slot, answer) in rays.by_ref() {
                        let (segment, faces) = stage::asked(&geometry, asking, slot, light);
                        *answer = FACES_AWAY;
                        if faces {
                            segments.push(segment);
                            places.push(answer);
                        }
                        if segments.len() == most {
                            break;
                        }
                    }
                    if !segments.is_empty() {
                        let keep = |i: usize, answer| *places[i] = answer;
                        stage::shadow_together::<R, R::Packet<N>, M>(&geometry, &segments, keep);
                    }
                }
            }
        }
    }
}
