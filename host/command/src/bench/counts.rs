//! The work of a method for a ray: calls of the kernels' own hooks, counted on the CPU over a sample of a stream.

use std::cell::Cell;
use std::iter::Sum;
use std::marker::PhantomData;
use std::ops::{Add, Range};

use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{F32xN, Real, U32xN, V3};
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::Segment;
use eyerays_shader::traverse::{
    self, Closest, Cut, CwbvhMethod, Hybrid, IfIf, Interleaved, Occlusion, Packet, Primitives, Query, Sequential,
    Speculative, StackMax, WhileWhile,
};
use eyerays_shader::warp::Alone;
use rayon::prelude::*;

use crate::error::Result;
use eyerays::cpu;
use eyerays::device_scene::SceneView;
use eyerays::follower;
use eyerays::job::Job;
use eyerays::method::{Layout, Method, Traversal};
use eyerays::stream::{Question, Stream, StreamRay};

/// Rays of a packet: a subgroup of most GPUs.
const PACKET: usize = 32;
/// Packets that are counted, of those in the stream, at most.
const SAMPLE: usize = 1024;

/// Calls of the kernels' hooks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Calls {
    /// Visits, boxes and primitives, each times the rays that it is charged to.
    visits: u64,
    boxes: u64,
    primitives: u64,
    /// Children that packets visited, and how many of their rays hit them.
    children: u64,
    lanes: u64,
}

impl Add for Calls {
    type Output = Calls;

    fn add(self, other: Calls) -> Calls {
        Calls {
            visits: self.visits + other.visits,
            boxes: self.boxes + other.boxes,
            primitives: self.primitives + other.primitives,
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
    /// What this thread has counted for the current rays.
    static CALLS: Cell<Calls> = Cell::default();
    /// Rays that are traced together: their work is charged to each.
    static TOGETHER: Cell<u64> = const { Cell::new(1) };
    /// Rays that the next call is charged to: those, or the single one that has left the packet.
    static CHARGED: Cell<u64> = const { Cell::new(1) };
}

/// Counts what `follow` does with this many rays together.
fn counted(together: usize, follow: impl FnOnce()) -> Calls {
    CALLS.set(Calls::default());
    TOGETHER.set(together as u64);
    CHARGED.set(together as u64);
    follow();
    CALLS.get()
}

/// A query whose hooks count.
struct Counted<Q>(PhantomData<Q>);

impl<Q: Query> Query for Counted<Q> {
    const ANY: bool = Q::ANY;

    fn on_boxes(tested: u32) {
        let rays = CHARGED.get();
        CALLS.set(CALLS.get() + Calls { visits: rays, boxes: rays * u64::from(tested), ..Calls::default() });
    }

    fn on_primitive() {
        CALLS.set(CALLS.get() + Calls { primitives: CHARGED.get(), ..Calls::default() });
    }

    fn on_child(lanes: impl FnOnce() -> u32) {
        CALLS.set(CALLS.get() + Calls { children: 1, lanes: u64::from(lanes()), ..Calls::default() });
    }

    fn on_parted(parted: bool) {
        CHARGED.set(if parted { 1 } else { TOGETHER.get() });
    }
}

/// The average work of a ray. A packet's work is charged to each of its rays; that of a ray that has left its packet,
/// to that ray only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Counts {
    /// Pairs of boxes visited, or wide nodes.
    pub visits: f64,
    /// Boxes tested: two a pair, eight a wide node.
    pub boxes: f64,
    /// Primitives tested.
    pub primitives: f64,
    /// The share of a packet's rays that hit a child it visits; `None` for single rays.
    pub simd_efficiency: Option<f64>,
}

/// Follows a group of rays and counts.
type Follow = fn(&TraceContext<'_>, &Stream, Range<usize>, Question) -> Calls;

/// How a method's rays are followed: by themselves or 32 together. Alone, `speculative` never speculates: its counts are those of
/// `while-while`.
fn follower(method: Method) -> Follow {
    use {packet as plainly, packet as together, single as alone};
    eyerays_shader::for_each_method!(follower method single::<CwbvhMethod>)
}

/// Counts what a method does for a sample of a stream, every so many of its groups of 32, with `threads`
/// threads (0: one a core).
///
/// # Errors
/// If the threads can't be had.
pub fn counts(
    packed: &Job,
    traversal: Traversal,
    threads: usize,
    stream: &Stream,
    question: Question,
) -> Result<Counts> {
    // The layout of triangles does not change which tests are made; the format of boxes does.
    let layout = if traversal.layout == Layout::Compact { Layout::Compact } else { Layout::Gathered };
    let laid = SceneView::new(packed, Traversal { layout, ..traversal });
    let frame = packed.stream_frame(stream.len());
    in_scene(&laid.stream(&frame), traversal.method, threads, stream, question)
}

fn in_scene(
    scene: &TraceContext<'_>,
    method: Method,
    threads: usize,
    stream: &Stream,
    question: Question,
) -> Result<Counts> {
    let groups = groups(stream.len());
    let rays: usize = groups.iter().map(Range::len).sum();
    let follow = follower(method);
    let calls: Calls = cpu::pool(threads)?
        .install(|| groups.par_iter().map(|group| follow(scene, stream, group.clone(), question)).sum());
    let each = |calls: u64| calls as f64 / rays.max(1) as f64;
    let efficiency = || calls.lanes as f64 / (PACKET as u64 * calls.children) as f64;
    Ok(Counts {
        visits: each(calls.visits),
        boxes: each(calls.boxes),
        primitives: each(calls.primitives),
        simd_efficiency: (calls.children > 0).then(efficiency),
    })
}

/// The groups of 32 rays that are counted. Their distance is odd, so that it shares no period with
/// the width of an image.
fn groups(rays: usize) -> Vec<Range<usize>> {
    let step = rays.div_ceil(PACKET).div_ceil(SAMPLE) | 1;
    (0..rays).step_by(PACKET * step).map(|first| first..rays.min(first + PACKET)).collect()
}

fn single<M: traverse::Method<f32>>(
    geometry: &TraceContext<'_>,
    stream: &Stream,
    rays: Range<usize>,
    question: Question,
) -> Calls {
    counted(1, || {
        for i in rays {
            let segment = Segment::<f32>::load(stream.len() as u32, i as u32, stream.words());
            traverse::<f32, M>(geometry, &segment.ray(), Hit::none(segment.limit), question);
        }
    })
}

fn packet<M: traverse::Method<F32xN<PACKET>>>(
    geometry: &TraceContext<'_>,
    stream: &Stream,
    rays: Range<usize>,
    question: Question,
) -> Calls {
    // Lanes without a ray have a limit that no box lies before.
    let nothing = StreamRay { limit: -1.0, ..stream.ray(rays.start) };
    let lanes: [StreamRay; PACKET] = std::array::from_fn(|lane| match rays.start + lane {
        i if i < rays.end => stream.ray(i),
        _ => nothing,
    });
    let origin = V3::of_lanes(|i| V3::splat(lanes[i].origin));
    let direction = V3::of_lanes(|i| V3::splat(lanes[i].direction));
    let ray = Ray::leaving(U32xN(lanes.map(|ray| ray.source_primitive)), origin, direction);
    let hit = Hit::none(F32xN(lanes.map(|ray| ray.limit)));
    counted(rays.len(), || traverse::<F32xN<PACKET>, M>(geometry, &ray, hit, question))
}

fn traverse<R: Real, M: traverse::Method<R>>(
    geometry: &TraceContext<'_>,
    ray: &Ray<R>,
    mut hit: Hit<R>,
    question: Question,
) {
    match question {
        Question::Closest => M::traverse::<Counted<Closest>, Primitives>(geometry, ray, &mut hit),
        Question::Occlusion => M::traverse::<Counted<Occlusion>, Primitives>(geometry, ray, &mut hit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays_shader::data::{CentredPair, Frame, Launch, NodePair, NodeRef, Primitive, Specialisation, Tuning};
    use eyerays_shader::scene::LaunchContext;
    use glam::{Vec3, vec3};

    /// Counts in a scene of four triangles in a row along x. The root has the first two on the left, in a pair of leaves,
    /// and the others on the right, in one leaf.
    fn in_row(traversal: Traversal, stream: &Stream, question: Question) -> Counts {
        let wall = |x: f32| [vec3(x, -0.1, -0.1), vec3(x, 0.1, -0.1), vec3(x, 0.0, 0.1)];
        let triangles: Vec<Primitive> =
            [0.1, 0.3, 0.5, 0.7].iter().zip(0..).map(|(&x, i)| Primitive::triangle(wall(x), i, 0, 0)).collect();
        let around = |of: &[Primitive], node| {
            let bounds = of.iter().map(Primitive::bounds);
            let (least, greatest) = bounds.reduce(|(a, b), (c, d)| (a.min(c), b.max(d))).unwrap();
            (least, greatest, node)
        };
        let leaf = |first: usize, count: usize| {
            around(&triangles[first..first + count], NodeRef::leaf(first as u32, count as u32))
        };
        let nodes = [
            NodePair::new(around(&triangles[..2], NodeRef::inner(1)), leaf(2, 2)),
            NodePair::new(leaf(0, 1), leaf(1, 1)),
        ];
        let nodes: Vec<CentredPair> = nodes.iter().map(CentredPair::from).collect();
        let frame = Frame { slots: stream.len() as u32, ..Frame::default() };
        let spec = Specialisation { tuning: traversal.tuning, ..Specialisation::default() }.with_launch(Launch::STREAM);
        let scene = TraceContext {
            base: LaunchContext::new(&frame, spec, bytemuck::cast_slice(&triangles), &[]),
            nodes: bytemuck::cast_slice(&nodes),
            wide: &[],
            bvh8: Default::default(),
            cutout: Default::default(),
        };
        in_scene(&scene, traversal.method, 1, stream, question).unwrap()
    }

    fn rays(directions: impl Fn(usize) -> Vec3, limit: f32) -> Stream {
        let ray =
            |i| StreamRay { origin: Vec3::ZERO, direction: directions(i), limit, source_primitive: StreamRay::NOWHERE };
        Stream::new((0..32).map(ray).collect::<Vec<_>>().into_iter())
    }

    fn of(method: Method, stream: &Stream, question: Question) -> Counts {
        in_row(method.into(), stream, question)
    }

    /// Every second ray hits nothing.
    fn halves() -> Stream {
        rays(|i| if i % 2 == 0 { Vec3::X } else { -Vec3::X }, 10.0)
    }

    #[test]
    fn a_single_ray_visits_the_boxes_that_it_meets() {
        let (along, away) = (rays(|_| Vec3::X, 10.0), rays(|_| -Vec3::X, 10.0));
        let short = rays(|_| Vec3::X, 0.2);
        for (stream, question, visits, triangles) in [
            (&along, Question::Closest, 2.0, 4.0),
            (&along, Question::Occlusion, 2.0, 1.0),
            (&short, Question::Closest, 2.0, 1.0),
            (&away, Question::Closest, 1.0, 0.0),
        ] {
            for method in [Method::IfIf, Method::WhileWhile] {
                let counts = of(method, stream, question);
                assert_eq!((counts.visits, counts.boxes, counts.primitives), (visits, 2.0 * visits, triangles));
                assert_eq!(counts.simd_efficiency, None);
            }
        }
    }

    #[test]
    fn a_packet_is_charged_to_each_of_its_rays() {
        let packet = of(Method::Packet, &halves(), Question::Closest);
        assert_eq!((packet.visits, packet.boxes, packet.primitives), (2.0, 4.0, 4.0));
        assert_eq!(packet.simd_efficiency, Some(0.5));
        let single = of(Method::IfIf, &halves(), Question::Closest);
        assert_eq!((single.visits, single.primitives), (1.5, 2.0));
    }

    #[test]
    fn parted_rays_are_charged_to_themselves() {
        // The packet splits at the pair on the left, while the leaf on the right is still to visit for all.
        let traversal = Traversal { tuning: Tuning::new(1, 0), ..Method::SequentialStack.into() };
        let counts = in_row(traversal, &halves(), Question::Closest);
        assert_eq!((counts.visits, counts.primitives, counts.simd_efficiency), (2.0, 3.0, Some(0.5)));
    }

    #[test]
    fn groups_lie_apart_by_an_odd_number_and_end_with_the_stream() {
        assert_eq!(groups(70), [0..32, 32..64, 64..70]);
        let sparse = groups(1 << 22);
        assert!(sparse.len() <= SAMPLE && (sparse[1].start / PACKET) % 2 == 1);
        assert!(groups(0).is_empty());
    }
}
