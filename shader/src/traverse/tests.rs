//! The same hit as brute force, on triangles that tie, overlap and degenerate.

use super::lanes::RayLanes;
use super::leaf::{Leaf, Primitives, occluded};
use super::resumable::Resumable;
use super::{
    Bvh8Method, Closest, Cut, CwbvhMethod, Hybrid, IfIf, Interleaved, Method, Occlusion, Packet, Query, Sequential,
    Speculative, StackMax, WhileWhile,
};
use crate::bvh8::{Bvh8Node, Bvh8Ref, Bvh8View, LeafKind, MOST, Triangle4};
use crate::data::{
    CentredPair, CwbvhNode, Effects, Frame, MAX_LEAF, NodePair, NodeRef, Primitive, Specialisation, Tuning,
};
use crate::ray::{Hit, Ray};
use crate::real::{F32xN, Fast, Lanes, Real, Scalar, V3};
use crate::scene::{LaunchContext, TraceContext};
use crate::stage::{SHADOWED, Segment, persistent, shadow_together, trace_together};
use crate::warp::Alone;
use bytemuck::Zeroable;
use core::cell::{Cell, RefCell};
use glam::{UVec4, Vec3};
use proptest::prelude::*;

/// A hierarchy made by halving the list: bad trees must find the same hits.
fn build(triangles: &[Primitive]) -> Vec<NodePair> {
    fn child(triangles: &[Primitive], first: u32, nodes: &mut Vec<NodePair>) -> (Vec3, Vec3, NodeRef) {
        let (least, greatest) = triangles
            .iter()
            .map(Primitive::bounds)
            .reduce(|(a, b), (c, d)| (a.min(c), b.max(d)))
            .expect("a child has triangles");
        let count = triangles.len() as u32;
        let node =
            if count <= MAX_LEAF { NodeRef::leaf(first, count) } else { NodeRef::inner(pair(triangles, first, nodes)) };
        (least, greatest, node)
    }
    fn pair(triangles: &[Primitive], first: u32, nodes: &mut Vec<NodePair>) -> u32 {
        let place = nodes.len();
        nodes.push(NodePair::zeroed());
        let (left, right) = triangles.split_at(triangles.len() / 2);
        let left_child = child(left, first, nodes);
        let right_child = child(right, first + left.len() as u32, nodes);
        nodes[place] = NodePair::new(left_child, right_child);
        place as u32
    }
    let mut nodes = Vec::new();
    pair(triangles, 0, &mut nodes);
    nodes
}

/// A wide hierarchy made by splitting the list in eighths, its nodes in breadth-first order. Every box is the whole
/// grid, so it tests only whether all nodes and triangles are visited.
fn build_cwbvh(triangles: &[Primitive]) -> Vec<CwbvhNode> {
    let all = 0..triangles.len() as u32;
    let mut open = vec![all];
    let mut nodes = Vec::new();
    while nodes.len() < open.len() {
        let range = open[nodes.len()].clone();
        let step = range.len().div_ceil(CwbvhNode::ARITY).max(3) as u32;
        let (first_child, mut inner, mut all) = (open.len() as u32, 0, 0);
        // Leaves lie behind inner nodes: the last part alone may be shorter than the others.
        let last = range.start + (range.len() as u32 - 1) / step * step;
        let leaves = if step <= CwbvhNode::MAX_LEAF { range.start } else { last };
        for (slot, first) in range.clone().step_by(step as usize).enumerate() {
            let part = first..(first + step).min(range.end);
            if part.len() as u32 <= CwbvhNode::MAX_LEAF {
                all |= ((1 << part.len()) - 1) << (3 * slot);
            } else {
                inner |= 1 << slot;
                open.push(part);
            }
        }
        let exponent = 127 + 2;
        nodes.push(CwbvhNode {
            grid: crate::data::pack(Vec3::splat(-2.0), inner << 24 | exponent << 16 | exponent << 8 | exponent),
            children: UVec4::new(first_child, leaves, all, 0),
            low_x_low_y: UVec4::ZERO,
            low_z_high_x: UVec4::new(0, 0, u32::MAX, u32::MAX),
            high_y_high_z: UVec4::MAX,
        });
    }
    nodes
}

/// The same in full precision, by eighths down to four triangles, with the boxes' real bounds.
fn build_bvh8(triangles: &[Primitive]) -> (Vec<Bvh8Node>, Vec<Triangle4>) {
    let (mut nodes, mut blocks) = (vec![Bvh8Node::EMPTY], Vec::new());
    let mut open = vec![(0, 0..triangles.len())];
    while let Some((node, range)) = open.pop() {
        let step = range.len().div_ceil(8).max(MOST);
        for (child, first) in range.clone().step_by(step).enumerate() {
            let part = first..(first + step).min(range.end);
            let boxes = triangles[part.clone()].iter().map(Primitive::bounds);
            let (least, greatest) = boxes.reduce(|(a, b), (c, d)| (a.min(c), b.max(d))).expect("a part has triangles");
            let planes = [least - Bvh8Node::MARGIN, greatest + Bvh8Node::MARGIN];
            for (axis, side) in (0..6).map(|i| (i / 2, i % 2)) {
                nodes[node].planes[axis][side][child] = planes[side][axis];
            }
            nodes[node].children[child] = if part.len() <= MOST {
                blocks.push(Triangle4::of(part.map(|slot| (slot as u32, &triangles[slot]))));
                Bvh8Ref::leaf(LeafKind::Triangles, blocks.len() as u32 - 1)
            } else {
                nodes.push(Bvh8Node::EMPTY);
                open.push((nodes.len() - 1, part));
                Bvh8Ref::inner(nodes.len() as u32 - 1)
            };
        }
    }
    (nodes, blocks)
}

struct World {
    triangles: Vec<Primitive>,
    nodes: Vec<CentredPair>,
    wide: Vec<CwbvhNode>,
    bvh8: (Vec<Bvh8Node>, Vec<Triangle4>),
    words: Vec<UVec4>,
    frame: Frame,
    effects: Effects,
}

impl World {
    fn new(triangles: Vec<Primitive>, effects: u32) -> Self {
        let nodes = build(&triangles).iter().map(CentredPair::from).collect();
        let words = bytemuck::cast_slice(&triangles).to_vec();
        let (wide, bvh8) = (build_cwbvh(&triangles), build_bvh8(&triangles));
        World { triangles, nodes, wide, bvh8, words, frame: Frame::zeroed(), effects: Effects(effects) }
    }

    fn context(&self) -> TraceContext<'_> {
        let spec = Specialisation { effects: self.effects, tuning: Tuning::new(2, 60), ..Specialisation::default() };
        TraceContext {
            base: LaunchContext { frame: &self.frame, spec, primitives: &self.words },
            nodes: bytemuck::cast_slice(&self.nodes),
            wide: &self.wide,
            bvh8: Bvh8View { nodes: &self.bvh8.0, triangles: &self.bvh8.1, ..Bvh8View::default() },
            bounds: &[],
            cutout: Default::default(),
        }
    }

    fn trace<M: Method<R>, Q: Query, R: Real>(&self, ray: &Ray<R>, limit: f32) -> Hit<R> {
        let mut hit = Hit::none(R::splat(limit));
        M::traverse::<Q, Primitives>(&self.context(), ray, &mut hit);
        hit
    }

    fn brute_force<Q: Query, R: Scalar>(&self, ray: &Ray<R>, limit: f32) -> Hit<R> {
        let mut hit = Hit::none(R::splat(limit));
        for slot in (0..self.triangles.len() as u32).rev() {
            Primitives::intersect::<Q, R>(&self.context(), slot, ray, &mut hit);
        }
        hit
    }
}

fn ray<R: Scalar>(origin: [f32; 3], direction: [f32; 3]) -> Ray<R> {
    Ray::new(V3::splat(Vec3::from(origin)), V3::splat(Vec3::from(direction)))
}

/// Coordinates on a coarse grid, so that vertices, edges, planes and whole triangles coincide.
fn grid() -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3((-4i8..=4).prop_map(|k| f32::from(k) / 8.0))
}

fn soup() -> impl Strategy<Value = Vec<Primitive>> {
    prop::collection::vec((prop::array::uniform3(grid()), any::<bool>()), 2..80).prop_map(|soup| {
        let count = soup.len() as u32;
        soup.iter()
            .zip(0..)
            .map(|((t, clear), i)| {
                Primitive::triangle(
                    t.map(Vec3::from),
                    (i * 37) % count.next_power_of_two(),
                    0,
                    if *clear { Primitive::TRANSPARENT } else { 0 },
                )
            })
            .collect()
    })
}

fn check<M: Method<R>, R: Scalar + PartialEq + core::fmt::Debug>(world: &World, origin: [f32; 3], direction: [f32; 3]) {
    let ray = ray::<R>(origin, direction);
    for limit in [f32::MAX, 0.5] {
        let (got, want) = (world.trace::<M, Closest, R>(&ray, limit), world.brute_force::<Closest, R>(&ray, limit));
        assert_eq!((got.t, got.u, got.v, got.primitive), (want.t, want.u, want.v, want.primitive));
        let (got, want) = (world.trace::<M, Occlusion, R>(&ray, limit), world.brute_force::<Occlusion, R>(&ray, limit));
        assert_eq!(occluded(&got), occluded(&want));
    }
}

fn every_method<R: Scalar + RayLanes + PartialEq + core::fmt::Debug>(
    world: &World,
    origin: [f32; 3],
    direction: [f32; 3],
) {
    check::<IfIf, R>(world, origin, direction);
    check::<WhileWhile<Alone>, R>(world, origin, direction);
    check::<CwbvhMethod, R>(world, origin, direction);
    check::<Bvh8Method, R>(world, origin, direction);
    check::<Speculative<Alone>, R>(world, origin, direction);
    check::<Packet<Alone>, R>(world, origin, direction);
    check::<Hybrid<Alone, StackMax, Sequential>, R>(world, origin, direction);
    check::<Hybrid<Alone, StackMax, Interleaved>, R>(world, origin, direction);
    check::<Hybrid<Alone, Cut, Sequential>, R>(world, origin, direction);
    check::<Hybrid<Alone, Cut, Interleaved>, R>(world, origin, direction);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn finds_what_brute_force_finds(
        triangles in soup(), origin in grid(), target in grid(), nudge in prop::array::uniform3(-1e-6f32..1e-6),
        culling: bool,
    ) {
        let direction: [f32; 3] = std::array::from_fn(|k| target[k] - origin[k]);
        prop_assume!(direction != [0.0; 3]);
        let effects = Effects::TRANSPARENT | if culling { Effects::CULLING } else { 0 };
        let world = World::new(triangles, effects);
        let beside: [f32; 3] = std::array::from_fn(|k| direction[k] + nudge[k]);
        for direction in [direction, beside] {
            every_method::<f32>(&world, origin, direction);
            every_method::<Fast>(&world, origin, direction);
            every_method::<f64>(&world, origin, direction);
        }
    }
}

type End = ([f32; 3], [f32; 3]);

/// Compares every lane of a packet, coherent or not, with the same ray traced alone.
fn check_packet<M: Method<F32xN<N>>, const N: usize>(world: &World, rays: &[End]) {
    let origins = V3::<F32xN<N>>::of_lanes(|i| V3::splat(Vec3::from(rays[i].0)));
    let directions = V3::<F32xN<N>>::of_lanes(|i| V3::splat(Vec3::from(rays[i].1)));
    let packet = Ray::new(origins, directions);
    let closest = world.trace::<M, Closest, F32xN<N>>(&packet, f32::MAX);
    let shadows = world.trace::<M, Occlusion, F32xN<N>>(&packet, 0.5);
    for (i, (origin, direction)) in rays[..N].iter().enumerate() {
        let alone = ray::<f32>(*origin, *direction);
        let (got, want) = (closest.lane::<f32>(i), world.brute_force::<Closest, f32>(&alone, f32::MAX));
        assert_eq!((got.t, got.u, got.v, got.primitive), (want.t, want.u, want.v, want.primitive), "lane {i} of {N}");
        let want = occluded(&world.brute_force::<Occlusion, f32>(&alone, 0.5));
        assert_eq!(occluded(&shadows.lane::<f32>(i)), want, "lane {i} of {N}");
    }
}

fn check_packets<const N: usize>(world: &World, rays: &[End]) {
    check_packet::<Packet<Alone>, N>(world, rays);
    check_packet::<Hybrid<Alone, StackMax, Sequential>, N>(world, rays);
    check_packet::<Hybrid<Alone, StackMax, Interleaved>, N>(world, rays);
    check_packet::<Hybrid<Alone, Cut, Sequential>, N>(world, rays);
    check_packet::<Hybrid<Alone, Cut, Interleaved>, N>(world, rays);
}

/// The first `count` rays as a launch traces them together, also where some lanes have none.
fn check_together<P: Lanes<f32> + RayLanes>(world: &World, rays: &[End], count: usize) {
    let vector = |v: [f32; 3]| V3::splat(Vec3::from(v));
    let segments: Vec<Segment<f32>> = rays[..count]
        .iter()
        .map(|&(o, d)| Segment {
            origin: vector(o),
            direction: vector(d),
            limit: 0.5,
            source_primitive: Hit::<f32>::NOTHING,
        })
        .collect();
    let (mut hits, mut answers) = (vec![UVec4::ZERO; count], vec![u32::MAX; count]);
    let context = world.context();
    trace_together::<f32, P, Packet<Alone>, Primitives>(&context, &segments, |i, hit| hits[i] = hit);
    shadow_together::<f32, P, Packet<Alone>, Primitives>(&context, &segments, |i, answer| answers[i] = answer);
    for (i, (origin, direction)) in rays[..count].iter().enumerate() {
        let alone = ray::<f32>(*origin, *direction);
        let want = world.trace::<Packet<Alone>, Closest, f32>(&alone, 0.5);
        let primitive = |slot: u32| world.triangles.get(slot as usize).map(Primitive::number);
        let weights = want.coordinates();
        let got = crate::data::numbers(hits[i]);
        assert_eq!((got.x, got.y, got.z), (want.t, weights.0, weights.1), "ray {i} of {count}");
        assert_eq!(primitive(hits[i].w), primitive(want.primitive_index), "ray {i} of {count}");
        let want = occluded(&world.trace::<Packet<Alone>, Occlusion, f32>(&alone, 0.5));
        assert_eq!(answers[i] == SHADOWED, want, "ray {i} of {count}");
    }
}

/// 32 rays from eight; some components of their directions are zero.
fn rays_of(ends: [([f32; 3], [f32; 3]); 8], same_origin: bool) -> Vec<End> {
    (0..32)
        .map(|i| {
            let origin = if same_origin { ends[0].0 } else { ends[i % 8].0 };
            let to = ends[(i + i / 8) % 8].1;
            let direction: [f32; 3] = std::array::from_fn(|k| to[k] - origin[k]);
            (origin, if direction == [0.0; 3] { [1.0, 0.0, 0.0] } else { direction })
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn packets_find_what_their_rays_find(
        triangles in soup(), ends in prop::array::uniform8((grid(), grid())), same_origin: bool, count in 1usize..=32,
    ) {
        let rays = rays_of(ends, same_origin);
        let world = World::new(triangles, Effects::TRANSPARENT);
        check_packets::<4>(&world, &rays);
        check_packets::<8>(&world, &rays);
        check_packets::<16>(&world, &rays);
        check_packets::<32>(&world, &rays);
        check_together::<F32xN<8>>(&world, &rays, count);
        check_together::<F32xN<16>>(&world, &rays, count);
        check_together::<f32>(&world, &rays, count.min(4));
    }

    /// The AVX2 registers.
    #[cfg(target_arch = "x86_64")]
    #[test]
    fn registers_find_what_brute_force_finds(
        triangles in soup(), ends in prop::array::uniform8((grid(), grid())), count in 1usize..=32,
    ) {
        use crate::real::{Avx2, SimdIsa};
        type Register = <Avx2 as SimdIsa<f32>>::Eight;
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            let rays = rays_of(ends, false);
            let world = World::new(triangles, Effects::TRANSPARENT);
            for (origin, direction) in &rays {
                check::<Bvh8Method<Avx2>, f32>(&world, *origin, *direction);
            }
            check_together::<Register>(&world, &rays, count);
        }
    }
}

#[test]
fn ties_go_to_the_least_primitive_in_any_leaf_order() {
    let t = [Vec3::new(-0.5, -0.5, 0.0), Vec3::new(0.5, -0.5, 0.0), Vec3::new(0.0, 0.5, 0.0)];
    for order in [[7u32, 3, 9, 5, 8, 6, 4], [3, 4, 5, 6, 7, 8, 9], [9, 8, 7, 6, 5, 4, 3]] {
        let world = World::new(order.iter().map(|&id| Primitive::triangle(t, id, 0, 0)).collect(), 0);
        let hit = world.trace::<IfIf, Closest, f32>(&ray([0.0, 0.0, 0.5], [0.0, 0.0, -1.0]), f32::MAX);
        assert_eq!((hit.primitive, hit.t), (3, 0.5));
    }
}

#[test]
fn culling_hides_backs_from_sight_but_not_from_light() {
    let t = [Vec3::new(-0.5, -0.5, 0.0), Vec3::new(0.5, -0.5, 0.0), Vec3::new(0.0, 0.5, 0.0)];
    let world = World::new(vec![Primitive::triangle(t, 0, 0, 0), Primitive::triangle(t, 1, 0, 0)], Effects::CULLING);
    let from = |z: f32| ray::<f32>([0.0, 0.0, z], [0.0, 0.0, -z]);
    assert_eq!(world.trace::<IfIf, Closest, f32>(&from(0.5), f32::MAX).primitive, 0);
    assert_eq!(world.trace::<IfIf, Closest, f32>(&from(-0.5), f32::MAX).primitive, Hit::<f32>::NOTHING);
    assert!(occluded(&world.trace::<IfIf, Occlusion, f32>(&from(-0.5), f32::MAX)));
    let glass = World::new(vec![Primitive::triangle(t, 4, 0, Primitive::TRANSPARENT); 2], Effects::CULLING);
    assert_eq!(glass.trace::<IfIf, Closest, f32>(&from(-0.5), f32::MAX).primitive, 4, "glass has an inside");
}

#[test]
fn light_passes_transparent_triangles_only() {
    let t = [Vec3::new(-0.5, -0.5, 0.0), Vec3::new(0.5, -0.5, 0.0), Vec3::new(0.0, 0.5, 0.0)];
    let down = ray::<f32>([0.0, 0.0, 0.5], [0.0, 0.0, -1.0]);
    for (flags, blocked) in [(0, true), (Primitive::TRANSPARENT, false)] {
        let world = World::new(
            vec![Primitive::triangle(t, 0, 0, flags), Primitive::triangle(t, 1, 0, flags)],
            Effects::TRANSPARENT,
        );
        assert_eq!(occluded(&world.trace::<IfIf, Occlusion, f32>(&down, f32::MAX)), blocked);
        assert!(!occluded(&world.trace::<IfIf, Occlusion, f32>(&down, 0.5)), "a triangle at the limit does not block");
    }
}

/// Persistent lanes take rays until none is left: each is answered once, as a thread a ray answers it.
fn persistent_lanes<M: Method<f32> + Resumable<f32>>(world: &World, rays: &[Segment<f32>]) {
    let (next, seen) = (Cell::new(0), RefCell::new(vec![None; rays.len()]));
    let take = |wants: bool| if wants { next.replace(next.get() + 1) } else { u32::MAX };
    // Every third ray is not to be traced.
    let load = |number: u32| (rays[number as usize].ray(), rays[number as usize].limit, number % 3 != 2);
    let store = |number: u32, traced: bool, _: &Ray<f32>, hit: &Hit<f32>| {
        let before = seen.borrow_mut()[number as usize].replace((traced, hit.t, hit.primitive));
        assert!(before.is_none(), "{number} is answered twice");
    };
    persistent::<f32, M, Primitives, Closest, Alone>(&world.context(), rays.len() as u32, take, load, store);
    for (number, answer) in seen.into_inner().into_iter().enumerate() {
        let (ray, limit, wanted) = load(number as u32);
        let want = world.trace::<M, Closest, f32>(&ray, limit);
        let want = if wanted { (true, want.t, want.primitive) } else { (false, limit, Hit::<f32>::NOTHING) };
        assert_eq!(answer, Some(want), "{number}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn persistent_lanes_find_what_a_thread_a_ray_finds(
        triangles in soup(), rays in prop::collection::vec((grid(), grid()), 0..40),
    ) {
        let world = World::new(triangles, 0);
        let segment = |(origin, direction): ([f32; 3], [f32; 3])| Segment {
            origin: V3::splat(Vec3::from(origin)),
            direction: V3::splat(Vec3::from(direction) + Vec3::new(0.01, 0.02, 0.03)),
            limit: 2.0,
            source_primitive: Hit::<f32>::NOTHING,
        };
        let rays: Vec<Segment<f32>> = rays.into_iter().map(segment).collect();
        persistent_lanes::<IfIf>(&world, &rays);
        persistent_lanes::<WhileWhile<Alone>>(&world, &rays);
        persistent_lanes::<CwbvhMethod>(&world, &rays);
    }
}
