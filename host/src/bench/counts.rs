//! What methods do for a ray: the kernels' own hooks, counted on the CPU over a sample of a stream.

use std::cell::Cell;
use std::iter::Sum;
use std::marker::PhantomData;
use std::ops::{Add, Range};

use bytemuck::Zeroable;
use eyerays_shader::data::{Features, Frame};
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{Real, V3, Wide, WideIndex};
use eyerays_shader::scene::Geometry;
use eyerays_shader::stage::Segment;
use eyerays_shader::traverse::{
    self, Closest, Cut, Hybrid, IfIf, Interleaved, Occlusion, Packet, Query, Sequential, Speculative, StackMax,
    WhileWhile, WideNodes,
};
use eyerays_shader::warp::Alone;
use glam::UVec4;
use rayon::prelude::*;

use crate::cpu;
use crate::error::Result;
use crate::method::{Layout, Method, Traversal};
use crate::pack::{Packed, TriangleWords};
use crate::stream::{Question, Stream, StreamRay};

/// Rays of a packet: a subgroup of most GPUs.
const PACKET: usize = 32;
/// Packets that are counted, of those in the stream, at most.
const SAMPLE: usize = 1024;

/// Calls of the kernels' hooks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Calls {
    visits: u64,
    boxes: u64,
    triangles: u64,
    children: u64,
    lanes: u64,
}

impl Add for Calls {
    type Output = Calls;

    fn add(self, other: Calls) -> Calls {
        Calls {
            visits: self.visits + other.visits,
            boxes: self.boxes + other.boxes,
            triangles: self.triangles + other.triangles,
            children: self.children + other.children,
            lanes: self.lanes + other.lanes,
        }
    }
}

impl Sum for Calls {
    fn sum<I: Iterator<Item = Calls>>(calls: I) -> Calls {
        calls.fold(Calls::default(), Add::add)
    }
}

thread_local! {
    static CALLS: Cell<Calls> = const { Cell::new(Calls { visits: 0, boxes: 0, triangles: 0, children: 0, lanes: 0 }) };
}

/// Counts one call of a hook on this thread.
fn count(calls: Calls) {
    CALLS.set(CALLS.get() + calls);
}

/// A query whose hooks count.
struct Counted<Q>(PhantomData<Q>);

impl<Q: Query> Query for Counted<Q> {
    const ANY: bool = Q::ANY;

    fn on_boxes(tested: u32) {
        count(Calls { visits: 1, boxes: u64::from(tested), ..Calls::default() });
    }

    fn on_triangle() {
        count(Calls { triangles: 1, ..Calls::default() });
    }

    fn on_child(lanes: impl FnOnce() -> u32) {
        count(Calls { children: 1, lanes: u64::from(lanes()), ..Calls::default() });
    }
}

/// What a ray takes on average. What a packet does is charged to each of its rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Counts {
    /// Pairs of boxes visited, or wide nodes.
    pub visits: f64,
    /// Boxes tested: two a pair, eight a wide node.
    pub boxes: f64,
    /// Triangles tested.
    pub triangles: f64,
    /// Of the rays of a packet that goes to a child, the share that wants it; none for single rays.
    pub simd_efficiency: Option<f64>,
}

/// Follows a group of rays and counts.
type Follow = fn(&Geometry<'_>, &Stream, Range<usize>, Question) -> Calls;

/// How a method's rays are followed: by themselves or 32 together.
fn follower(method: Method) -> (Follow, bool) {
    match method {
        Method::Auto | Method::IfIf => (single::<IfIf>, false),
        Method::WhileWhile => (single::<WhileWhile>, false),
        // Alone it never speculates: its counts are those of while-while.
        Method::Speculative => (single::<Speculative<Alone>>, false),
        Method::Wide => (single::<WideNodes>, false),
        Method::Packet => (packet::<Packet<Alone>>, true),
        Method::SequentialStack => (packet::<Hybrid<Alone, StackMax, Sequential>>, true),
        Method::SequentialCut => (packet::<Hybrid<Alone, Cut, Sequential>>, true),
        Method::InterleavedStack => (packet::<Hybrid<Alone, StackMax, Interleaved>>, true),
        Method::InterleavedCut => (packet::<Hybrid<Alone, Cut, Interleaved>>, true),
    }
}

/// Counts what a method does for a sample of a stream, every so many of its groups of 32, with `threads`
/// threads (0: one a core); nothing for a stream without rays.
///
/// # Errors
/// If the threads can't be had.
pub fn counts(
    packed: &Packed,
    traversal: Traversal,
    threads: usize,
    stream: &Stream,
    question: Question,
) -> Result<Option<Counts>> {
    let words = TriangleWords::of(packed, Layout::Gathered);
    let frame =
        Frame { limits: UVec4::new(0, 0, stream.len() as u32, packed.triangles.len() as u32), ..Frame::zeroed() };
    let geometry = Geometry {
        frame: &frame,
        features: Features(packed.features.0 | Features::STREAM),
        tuning: traversal.tuning,
        nodes: &packed.nodes,
        wide: &packed.wide,
        triangles: &words.0,
        bounds: &packed.bounds,
    };
    let groups = groups(stream.len());
    let rays: usize = groups.iter().map(Range::len).sum();
    let (follow, together) = follower(traversal.method);
    let calls: Calls = cpu::pool(threads)?
        .install(|| groups.par_iter().map(|group| follow(&geometry, stream, group.clone(), question)).sum());
    let sharers = if together { groups.len() } else { rays };
    let each = |calls: u64| calls as f64 / sharers as f64;
    let efficiency = || calls.lanes as f64 / (PACKET as u64 * calls.children) as f64;
    Ok((rays > 0).then(|| Counts {
        visits: each(calls.visits),
        boxes: each(calls.boxes),
        triangles: each(calls.triangles),
        simd_efficiency: (calls.children > 0).then(efficiency),
    }))
}

/// The groups of 32 rays that are counted. Their distance is odd, so that it beats with no width of an image.
fn groups(rays: usize) -> Vec<Range<usize>> {
    let step = rays.div_ceil(PACKET).div_ceil(SAMPLE) | 1;
    (0..rays).step_by(PACKET * step).map(|first| first..rays.min(first + PACKET)).collect()
}

fn single<M: traverse::Method<f32>>(
    geometry: &Geometry<'_>,
    stream: &Stream,
    rays: Range<usize>,
    question: Question,
) -> Calls {
    CALLS.set(Calls::default());
    for i in rays {
        let segment = Segment::<f32>::load(geometry, i as u32, stream.words());
        traverse::<f32, M>(geometry, &segment.ray(), Hit::none(segment.limit), question);
    }
    CALLS.get()
}

fn packet<M: traverse::Method<Wide<PACKET>>>(
    geometry: &Geometry<'_>,
    stream: &Stream,
    rays: Range<usize>,
    question: Question,
) -> Calls {
    CALLS.set(Calls::default());
    // Lanes without a ray have a limit that no box lies before.
    let ray = |lane: usize| match rays.clone().nth(lane) {
        Some(i) => stream.ray(i),
        None => StreamRay { limit: -1.0, ..stream.ray(rays.start) },
    };
    let lanes: [StreamRay; PACKET] = std::array::from_fn(ray);
    let origin = V3::of_lanes(|i| V3::splat(lanes[i].origin));
    let direction = V3::of_lanes(|i| V3::splat(lanes[i].direction));
    let ray = Ray::leaving(WideIndex(lanes.map(|ray| ray.leaves)), origin, direction);
    traverse::<Wide<PACKET>, M>(geometry, &ray, Hit::none(Wide(lanes.map(|ray| ray.limit))), question);
    CALLS.get()
}

fn traverse<R: Real, M: traverse::Method<R>>(
    geometry: &Geometry<'_>,
    ray: &Ray<R>,
    mut hit: Hit<R>,
    question: Question,
) {
    match question {
        Question::Closest => M::traverse::<Counted<Closest>>(geometry, ray, &mut hit),
        Question::Occlusion => M::traverse::<Counted<Occlusion>>(geometry, ray, &mut hit),
    }
}
