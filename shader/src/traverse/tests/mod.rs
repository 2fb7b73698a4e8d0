//! The same hit as brute force, on triangles that tie, overlap and degenerate.

mod world;

use core::cell::Cell;

use glam::Vec3;
use proptest::prelude::*;

use self::world::{World, grid, ray, soup};
use super::lanes::RayLanes;
use super::leaf::{Primitives, occluded};
use super::resumable::Resumable;
use super::{
    Bvh8Method, Closest, Cut, CwbvhMethod, Hybrid, IfIf, Interleaved, Method, Occlusion, Packet, Sequential,
    Speculative, StackMax, WhileWhile,
};
use crate::data::{Effects, Primitive};
use crate::ray::{Hit, Ray};
use crate::real::{F32xN, Fast, Lanes, Scalar, V3};
use crate::stage::{Found, SHADOWED, Segment, persistent, shadow_together, trace_together};
use crate::warp::Alone;

/// So many cases, or as many as an interpreter that watches every access has time for.
pub(super) fn cases(count: u32) -> ProptestConfig {
    ProptestConfig::with_cases(if cfg!(miri) { 4 } else { count })
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
    #![proptest_config(cases(20_000))]

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
    let (mut hits, mut answers) = (vec![Found::nothing(); count], vec![u32::MAX; count]);
    let context = world.context();
    trace_together::<f32, P, Packet<Alone>, Primitives>(&context, &segments, |i, hit| hits[i] = hit);
    shadow_together::<f32, P, Packet<Alone>, Primitives>(&context, &segments, |i, answer| answers[i] = answer);
    for (i, (origin, direction)) in rays[..count].iter().enumerate() {
        let alone = ray::<f32>(*origin, *direction);
        let want = world.trace::<Packet<Alone>, Closest, f32>(&alone, 0.5);
        let primitive = |slot: u32| world.triangles.get(slot as usize).map(Primitive::number);
        let weights = want.coordinates();
        assert_eq!((hits[i].t, hits[i].coordinates), (want.t, weights), "ray {i} of {count}");
        assert_eq!(primitive(hits[i].index), primitive(want.primitive_index), "ray {i} of {count}");
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
    #![proptest_config(cases(2_000))]

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

/// Whether a ray was traced, the distance and the primitive.
type Answer = Option<(bool, f32, u32)>;

/// Persistent lanes take rays until none is left: each is answered once, as a thread a ray answers it.
fn persistent_lanes<M: Method<f32> + Resumable<f32>>(world: &World, rays: &[Segment<f32>]) {
    let (next, mut seen) = (Cell::new(0), vec![None; rays.len()]);
    let take = |wants: bool| if wants { next.replace(next.get() + 1) } else { u32::MAX };
    // Every third ray is not to be traced.
    let load = |_: &[_], number: u32| (rays[number as usize].ray(), rays[number as usize].limit, number % 3 != 2);
    let store = |seen: &mut [Answer], number: u32, traced: bool, _: &Ray<f32>, hit: &Hit<f32>| {
        let before = seen[number as usize].replace((traced, hit.t, hit.primitive));
        assert!(before.is_none(), "{number} is answered twice");
    };
    let count = rays.len() as u32;
    persistent::<f32, M, Primitives, Closest, Alone, _>(&world.context(), (count, &mut seen), take, load, store);
    for (number, answer) in seen.into_iter().enumerate() {
        let (ray, limit, wanted) = load(&[], number as u32);
        let want = world.trace::<M, Closest, f32>(&ray, limit);
        let want = if wanted { (true, want.t, want.primitive) } else { (false, limit, Hit::<f32>::NOTHING) };
        assert_eq!(answer, Some(want), "{number}");
    }
}

proptest! {
    #![proptest_config(cases(300))]

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
