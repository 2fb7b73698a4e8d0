//! Meshes that drive builders into chains: within the stack's depth, with no triangle lost, and soon.

use std::time::Duration;

use eyerays::job::Job;
use eyerays::stream::{Stream, StreamRay};
use eyerays_bvh::{MAX_DEPTH, Quality};
use eyerays_tests::count;
use eyerays_tests::surface::{Surface, triangles};
use glam::Vec3;

use crate::against::{assert_like_brute_force, ray, rays};

/// Many times what a build takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(30);

/// Triangles around one corner, `levels` sizes of them, two of each.
fn chain(levels: u32, ratio: f32) -> Surface {
    let corners = |i: u32| {
        let size = ratio.powi((i / 2) as i32) * if i.is_multiple_of(2) { 1.0 } else { 0.8 };
        [Vec3::X * size, Vec3::Y * size, Vec3::Z * size]
    };
    let positions = (0..2 * levels).flat_map(corners).collect();
    Surface { positions, triangles: (0..2 * levels).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect() }
}

/// A ray from just before each triangle, which no other is nearer to.
fn at_each(packed: &Job) -> Vec<StreamRay> {
    let at = |vertices: [Vec3; 3]| {
        let centre = (vertices[0] + vertices[1] + vertices[2]) / 3.0;
        ray(centre * 1.001, -centre)
    };
    triangles(packed).iter().map(|t| at(t.vertices())).filter(|ray| ray.direction != Vec3::ZERO).collect()
}

/// Builds at every quality and traces the deepest; returns its depth.
fn depth(levels: u32, ratio: f32) -> u32 {
    let scene = chain(levels, ratio).scene();
    let what = format!("hierarchy, chain of {levels} by {ratio}");
    let built = [Quality::Fast, Quality::Medium, Quality::High].map(|quality| {
        let packed = Job::with_wide_nodes(&scene, scene.settings, quality).unwrap();
        assert!(packed.build_time() < PATIENCE, "{what}, {quality:?}: {:?}", packed.build_time());
        packed
    });
    let packed = built.into_iter().max_by_key(|packed| packed.statistics().depth).expect("three were built");
    let anywhere = rays(&packed, count::of(200, 10_000));
    let anywhere = (0..anywhere.len()).map(|i| anywhere.ray(i)).collect();
    assert_like_brute_force(&what, &packed, &Stream::of_parts(&[at_each(&packed), anywhere]), 0);
    let depth = packed.statistics().depth;
    println!("battery: {what}: depth {depth} of at most {MAX_DEPTH}");
    assert!(depth <= MAX_DEPTH, "{what}: {depth}");
    depth
}

#[test]
fn chains() {
    let halves = [63, 64, 65, 1000].map(|levels| depth(levels, 0.5));
    let slow =
        [(63, 0.82), (64, 0.82), (65, 0.82), (1000, 0.7), (1000, 0.987)].map(|(levels, ratio)| depth(levels, ratio));
    let deepest = halves.into_iter().chain(slow).max();
    assert_eq!(deepest, Some(MAX_DEPTH), "no chain fills a traversal's stack");
}
