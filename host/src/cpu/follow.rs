//! Following the rays of many slots, one by one or side by side.

use std::marker::PhantomData;

use eyerays_shader::real::{Native, Scalar, SimdIsa, Task};
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::{self, FACES_AWAY, Segment, ShadowInputs};
use eyerays_shader::traverse::{
    self, Bvh8Method, Cut, Hybrid, IfIf, Interleaved, Packet, Primitives, Sequential, Speculative, StackMax, Together,
    WhileWhile,
};
use eyerays_shader::warp::Alone;

use super::isa::Isa;
use crate::method::Method;

/// What is asked of the rays of some slots, and where the answers go, in the order of the slots.
pub enum Job<'a, R: Scalar> {
    /// Their closest hits, of paths or a stream's rays.
    Trace(&'a [R::Record], &'a mut [R::Record]),
    /// Whether something is on their way to a light, or before the ends of a stream's rays.
    Shadow(ShadowInputs<'a, R>, u32, &'a mut [u32]),
}

/// The way of a method on a CPU, from the shader's table.
macro_rules! way {
    ([$method:ident $R:ident] $(#[$help:meta] $variant:ident $path:ident $name:literal:
        gpu($($gpu:tt)*), persistent($($persistent:tt)*), cpu($way:ident $(, $type:ty)?);)*) => {
        match $method {
            Method::Auto => alone::<$R, IfIf>,
            $(Method::$variant => $way::<$R $(, $type)?>,)*
        }
    };
}

/// Follows the rays of slots by a method, with the instructions of an [`Isa`].
pub fn follow<R: Scalar>(isa: Isa, method: Method, geometry: &TraceContext<'_>, slots: &[u32], job: Job<'_, R>) {
    let way = eyerays_shader::for_each_method!(way method R);
    way(isa, geometry, slots, job);
}

/// The slots of a task.
struct Slots<'a, R: Scalar, M> {
    geometry: TraceContext<'a>,
    slots: &'a [u32],
    job: Job<'a, R>,
    method: PhantomData<M>,
}

impl<'a, R: Scalar, M> Slots<'a, R, M> {
    fn new(geometry: &TraceContext<'a>, slots: &'a [u32], job: Job<'a, R>) -> Self {
        Slots { geometry: *geometry, slots, job, method: PhantomData }
    }
}

/// Every ray by itself.
struct EachAlone<'a, R: Scalar, M>(Slots<'a, R, M>);

fn alone<R: Scalar, M: traverse::Method<R>>(isa: Isa, geometry: &TraceContext<'_>, slots: &[u32], job: Job<'_, R>) {
    isa.run::<R>(EachAlone::<R, M>(Slots::new(geometry, slots, job)));
}

impl<R: Scalar, M: traverse::Method<R>> Task<R> for EachAlone<'_, R, M> {
    #[inline(always)]
    fn run<V: SimdIsa<R>>(self) {
        one_by_one::<R, M>(&self.0.geometry, self.0.slots, self.0.job);
    }
}

/// Every ray by itself through nodes of eight children, whose boxes and triangles take all lanes.
struct Nodes<'a, R: Scalar>(Slots<'a, R, ()>);

fn nodes<R: Scalar>(isa: Isa, geometry: &TraceContext<'_>, slots: &[u32], job: Job<'_, R>) {
    isa.run::<R>(Nodes::<R>(Slots::new(geometry, slots, job)));
}

impl<R: Scalar> Task<R> for Nodes<'_, R> {
    #[inline(always)]
    fn run<V: SimdIsa<R>>(self) {
        one_by_one::<R, Bvh8Method<V>>(&self.0.geometry, self.0.slots, self.0.job);
    }
}

#[inline(always)]
fn one_by_one<R: Scalar, M: traverse::Method<R>>(geometry: &TraceContext<'_>, slots: &[u32], job: Job<'_, R>) {
    match job {
        Job::Trace(paths, hits) => {
            for (&slot, hit) in slots.iter().zip(hits) {
                *hit = stage::trace::<R, M, Primitives>(geometry, slot, paths);
            }
        }
        Job::Shadow(asking, light, answers) => {
            for (&slot, answer) in slots.iter().zip(answers) {
                *answer = stage::shadow::<R, M, Primitives>(geometry, asking, slot, light);
            }
        }
    }
}

/// Neighbours together.
struct Neighbours<'a, R: Scalar, M>(Slots<'a, R, M>);

fn together<R: Scalar, M: Together>(isa: Isa, geometry: &TraceContext<'_>, slots: &[u32], job: Job<'_, R>) {
    isa.run::<R>(Neighbours::<R, M>(Slots::new(geometry, slots, job)));
}

/// As [`together`], with the instructions that every processor has: the hybrids are there to be compared, and to
/// compile them for every ISA would take as long as all else.
fn plainly<R: Scalar, M: Together>(_: Isa, geometry: &TraceContext<'_>, slots: &[u32], job: Job<'_, R>) {
    Neighbours::<R, M>(Slots::new(geometry, slots, job)).run::<Native>();
}

impl<R: Scalar, M: Together> Task<R> for Neighbours<'_, R, M> {
    #[inline(always)]
    fn run<V: SimdIsa<R>>(self) {
        let Slots { geometry, slots, job, .. } = self.0;
        let most = stage::most::<R, V::Packet>();
        let mut segments: Vec<Segment<R>> = Vec::with_capacity(most);
        match job {
            Job::Trace(paths, hits) => {
                for (slots, hits) in slots.chunks(most).zip(hits.chunks_mut(most)) {
                    segments.clear();
                    segments.extend(slots.iter().map(|&slot| stage::traced::<R>(&geometry, slot, paths)));
                    stage::trace_together::<R, V::Packet, M, Primitives>(&geometry, &segments, |i, record| {
                        hits[i] = record
                    });
                }
            }
            Job::Shadow(asking, light, answers) => {
                let mut places = Vec::with_capacity(most);
                let mut rays = slots.iter().zip(answers).peekable();
                while rays.peek().is_some() {
                    segments.clear();
                    places.clear();
                    for (&slot, answer) in rays.by_ref() {
                        let (segment, faces) = stage::shadow_ray(&geometry, asking, slot, light);
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
                        stage::shadow_together::<R, V::Packet, M, Primitives>(&geometry, &segments, keep);
                    }
                }
            }
        }
    }
}
