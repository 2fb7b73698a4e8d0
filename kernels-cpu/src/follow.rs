//! Following the rays of many slots, one by one or side by side.

use std::marker::PhantomData;

use eyerays_shader::data::{Effects, Launch};
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{Native, Scalar, SimdIsa, Task};
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::{self, FACES_AWAY, Found, Segment, ShadowInputs};
use eyerays_shader::traverse::{
    self, Bvh8Method, Closest, Cut, Hybrid, IfIf, Interleaved, Leaf, Occlusion, Packet, Primitives, Sequential,
    Speculative, StackMax, Together, Triangles, WhileWhile,
};
use eyerays_shader::warp::Alone;

use crate::isa::Isa;
use crate::way::Way;

/// What is asked of the rays of some slots, and where the answers go, in the order of the slots.
pub enum Query<'a, R: Scalar> {
    /// Their closest hits, of paths or a stream's rays, in the place of those before at whose times the rays are.
    Trace(&'a [R::Record], &'a mut [Found<R>]),
    /// Whether something is on their way to a light, or before the ends of a stream's rays.
    Shadow(ShadowInputs<'a, R>, u32, &'a mut [u32]),
}

/// How a CPU follows rays by a method, from the shader's table.
macro_rules! follows {
    ([$way:ident $R:ident $L:ident] $(#[$help:meta] $variant:ident $path:ident $name:literal:
        gpu($($gpu:tt)*), persistent($($persistent:tt)*), cpu($how:ident $(, $type:ty)?);)*) => {
        match $way {
            $(Way::$variant => $how::<$R, $L $(, $type)?>,)*
        }
    };
}

/// Follows the rays of slots by a method, with the instructions of an [`Isa`]. Neighbours of several times go alone.
pub fn follow<R: Scalar>(isa: Isa, way: Way, geometry: &TraceContext<'_>, slots: &[u32], query: Query<'_, R>) {
    let way = if geometry.base.spec.launch.has(Launch::MOVING) { way.alone() } else { way };
    let follows = if geometry.base.spec.effects.has(Effects::SPHERE | Effects::DISK | Effects::INSTANCED) {
        among::<R, Primitives>(way)
    } else {
        among::<R, Triangles>(way)
    };
    follows(isa, geometry, slots, query);
}

/// How slots' rays are followed: see [`follow`].
type Follows<R> = fn(Isa, &TraceContext<'_>, &[u32], Query<'_, R>);

/// Follows rays by a method among leaves of these.
fn among<R: Scalar, L: Leaf>(way: Way) -> Follows<R> {
    eyerays_shader::for_each_method!(follows way R L)
}

/// The slots of a task.
struct Slots<'a, R: Scalar, L, M> {
    geometry: TraceContext<'a>,
    slots: &'a [u32],
    query: Query<'a, R>,
    how: PhantomData<(L, M)>,
}

impl<'a, R: Scalar, L, M> Slots<'a, R, L, M> {
    fn new(geometry: &TraceContext<'a>, slots: &'a [u32], query: Query<'a, R>) -> Self {
        Slots { geometry: *geometry, slots, query, how: PhantomData }
    }
}

/// Every ray by itself.
struct EachAlone<'a, R: Scalar, L, M>(Slots<'a, R, L, M>);

fn alone<R: Scalar, L: Leaf, M: traverse::Method<R>>(
    isa: Isa,
    geometry: &TraceContext<'_>,
    slots: &[u32],
    query: Query<'_, R>,
) {
    isa.run::<R>(EachAlone::<R, L, M>(Slots::new(geometry, slots, query)));
}

impl<R: Scalar, L: Leaf, M: traverse::Method<R>> Task<R> for EachAlone<'_, R, L, M> {
    #[inline(always)]
    fn run<V: SimdIsa<R>>(self) {
        one_by_one::<R, L, M>(&self.0.geometry, self.0.slots, self.0.query);
    }
}

/// Every ray by itself through nodes of eight children, whose boxes and triangles take all lanes.
struct Nodes<'a, R: Scalar, L>(Slots<'a, R, L, ()>);

fn nodes<R: Scalar, L: Leaf>(isa: Isa, geometry: &TraceContext<'_>, slots: &[u32], query: Query<'_, R>) {
    isa.run::<R>(Nodes::<R, L>(Slots::new(geometry, slots, query)));
}

impl<R: Scalar, L: Leaf> Task<R> for Nodes<'_, R, L> {
    #[inline(always)]
    fn run<V: SimdIsa<R>>(self) {
        let Slots { geometry, slots, query, .. } = self.0;
        let is_large = geometry.bvh8.bytes() > CACHED;
        match query {
            Query::Trace(paths, hits) if is_large => {
                let mut rays = Traced { geometry: &geometry, slots, paths, hits };
                traverse::interleaved::<Closest, L, R, V>(&geometry, slots.len(), &mut rays);
            }
            Query::Shadow(asking, _, answers) if is_large && geometry.base.spec.launch.has(Launch::STREAM) => {
                let mut rays = Asked { geometry: &geometry, slots, asking, answers };
                traverse::interleaved::<Occlusion, L, R, V>(&geometry, slots.len(), &mut rays);
            }
            query => one_by_one::<R, L, Bvh8Method<V>>(&geometry, slots, query),
        }
    }
}

/// Where a hierarchy is larger than what a core has to itself, rays take their steps in turn; else they would wait for each other and for
/// nothing else.
const CACHED: usize = 2 << 20;

/// Rays of a stream, before whose ends something may be.
struct Asked<'a, R: Scalar> {
    geometry: &'a TraceContext<'a>,
    slots: &'a [u32],
    asking: ShadowInputs<'a, R>,
    answers: &'a mut [u32],
}

impl<R: Scalar> traverse::Rays<R> for Asked<'_, R> {
    #[inline(always)]
    fn ray(&self, i: usize) -> (Ray<R>, R) {
        let (segment, _) = stage::shadow_ray(self.geometry, self.asking, self.slots[i], 0);
        (segment.ray(), segment.limit)
    }

    #[inline(always)]
    fn done(&mut self, i: usize, _: &Ray<R>, hit: &Hit<R>) {
        self.answers[i] = stage::visibility(hit);
    }
}

/// Slots' rays, whose closest hits are looked for.
struct Traced<'a, R: Scalar> {
    geometry: &'a TraceContext<'a>,
    slots: &'a [u32],
    paths: &'a [R::Record],
    hits: &'a mut [Found<R>],
}

impl<R: Scalar> traverse::Rays<R> for Traced<'_, R> {
    #[inline(always)]
    fn ray(&self, i: usize) -> (Ray<R>, R) {
        stage::ray::<R>(self.geometry, (self.slots[i], self.hits[i].time), self.paths)
    }

    #[inline(always)]
    fn done(&mut self, i: usize, ray: &Ray<R>, hit: &Hit<R>) {
        self.hits[i] = Found::of(self.geometry, ray, hit);
    }
}

#[inline(always)]
fn one_by_one<R: Scalar, L: Leaf, M: traverse::Method<R>>(
    geometry: &TraceContext<'_>,
    slots: &[u32],
    query: Query<'_, R>,
) {
    match query {
        Query::Trace(paths, hits) => {
            for (&slot, hit) in slots.iter().zip(hits) {
                *hit = stage::trace::<R, M, L>(geometry, (slot, hit.time), paths);
            }
        }
        Query::Shadow(asking, light, answers) => {
            for (&slot, answer) in slots.iter().zip(answers) {
                *answer = stage::shadow::<R, M, L>(geometry, asking, slot, light);
            }
        }
    }
}

/// Neighbours together.
struct Neighbours<'a, R: Scalar, L, M>(Slots<'a, R, L, M>);

fn together<R: Scalar, L: Leaf, M: Together>(
    isa: Isa,
    geometry: &TraceContext<'_>,
    slots: &[u32],
    query: Query<'_, R>,
) {
    isa.run::<R>(Neighbours::<R, L, M>(Slots::new(geometry, slots, query)));
}

/// As [`together`], with the instructions that every processor has and leaves that may hold anything: the hybrids are there to be
/// compared, and to compile them for every ISA and kind of leaf would take as long as all else.
// The table of methods gives every way a kind of leaf.
#[allow(clippy::extra_unused_type_parameters)]
fn plainly<R: Scalar, L, M: Together>(_: Isa, geometry: &TraceContext<'_>, slots: &[u32], query: Query<'_, R>) {
    Neighbours::<R, Primitives, M>(Slots::new(geometry, slots, query)).run::<Native>();
}

impl<R: Scalar, L: Leaf, M: Together> Task<R> for Neighbours<'_, R, L, M> {
    #[inline(always)]
    fn run<V: SimdIsa<R>>(self) {
        let Slots { geometry, slots, query, .. } = self.0;
        let most = stage::most::<R, V::Packet>();
        let mut segments: Vec<Segment<R>> = Vec::with_capacity(most);
        match query {
            Query::Trace(paths, hits) => {
                for (slots, hits) in slots.chunks(most).zip(hits.chunks_mut(most)) {
                    segments.clear();
                    segments.extend(slots.iter().map(|&slot| stage::traced::<R>(&geometry, slot, paths)));
                    stage::trace_together::<R, V::Packet, M, L>(&geometry, &segments, |i, found| hits[i] = found);
                }
            }
            Query::Shadow(asking, light, answers) => {
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
                        stage::shadow_together::<R, V::Packet, M, L>(&geometry, &segments, keep);
                    }
                }
            }
        }
    }
}
