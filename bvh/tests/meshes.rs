//! Meshes on which builders lose boxes, levels or hours.

mod common;

use std::time::{Duration, Instant};

use common::*;
use eyerays_bvh::{BuildError, MAX_DEPTH, Quality, Statistics, build, split};
use eyerays_shader::data::{NodePair, Primitive};
use glam::{Vec3, vec3};

/// Many times what these builds take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(10);

/// Builds at every quality within [`PATIENCE`] and returns the greatest depth.
fn depth(triangles: &[Primitive]) -> u32 {
    let depth = |quality| {
        let start = Instant::now();
        let bvh = build_and_check(&whole(triangles), quality);
        assert!(start.elapsed() < PATIENCE, "{quality:?}: {:?}", start.elapsed());
        Statistics::of(&bvh, triangles).depth
    };
    QUALITIES.map(depth).into_iter().max().unwrap()
}

#[test]
fn no_triangles() {
    assert_eq!(split(&[], 0.0), Err(BuildError::NoPrimitives));
}

#[test]
fn few_triangles() {
    for count in 1..=12 {
        build_and_check_all(&whole(&scattered(count, 7)));
        build_and_check_all(&whole(&duplicates(count)));
    }
}

#[test]
fn one_triangle_has_an_empty_sibling() {
    let bvh = build(&whole(&scattered(1, 3)), Quality::Medium).unwrap();
    assert_eq!(bvh.nodes.len(), 1);
    assert_eq!(bvh.nodes[0].right(), NodePair::EMPTY.2);
}

#[test]
fn a_leaf_full_is_still_a_pair() {
    for count in 2..=5 {
        let bvh = build(&whole(&duplicates(count)), Quality::Medium).unwrap();
        assert_eq!(bvh.nodes.len(), 1);
        assert_eq!(bvh.nodes[0].left().count() + bvh.nodes[0].right().count(), count);
    }
}

#[test]
fn duplicates_are_halved() {
    assert_eq!(depth(&duplicates(100_000)), 15);
    assert_eq!(depth(&duplicates(1000)), 8);
}

#[test]
fn duplicates_amid_a_mesh() {
    let mut triangles = scattered(20_000, 11);
    triangles.extend(duplicates(30_000));
    triangles.extend(scattered(20_000, 12));
    depth(&triangles);
}

#[test]
fn fan_of_spokes() {
    depth(&fan(10_000));
}

#[test]
fn nested_triangles_reach_the_depth_limit_and_keep_to_it() {
    assert_eq!(depth(&nested(100_000)), MAX_DEPTH);
    assert_eq!(depth(&concentric(100_000)), MAX_DEPTH);
}

#[test]
fn collinear_triangles() {
    assert!(depth(&collinear(100_000)) < 20);
}

#[test]
fn grid_of_ties() {
    assert!(depth(&grid(300)) < 40);
}

#[test]
fn shrinking_triangles_reach_the_depth_limit_and_keep_to_it() {
    depth(&shrinking(100, 2));
    assert_eq!(depth(&shrinking(140, 7)), MAX_DEPTH);
    assert_eq!(depth(&shrinking(120, 300)), MAX_DEPTH);
}

#[test]
fn many_deep_corners() {
    let corners = (0..100u32).flat_map(|i| {
        let corner = vec3((i % 10) as f32, (i / 10) as f32, 0.0) * 0.2 - 1.0;
        shrinking(30, 8).into_iter().map(move |t| t.vertices().map(|v| corner + v * 0.1))
    });
    depth(&mesh(corners));
}

#[test]
fn triangles_that_span_the_scene() {
    let mut corners = scattered(9000, 23).into_iter();
    let spanning = std::iter::from_fn(|| {
        let mut corner = || corners.next().map(|t| t.vertices()[0]);
        Some([corner()?, corner()?, corner()?])
    });
    depth(&mesh(spanning));
}

#[test]
fn points_and_corners_of_the_scene() {
    let ends = [Vec3::NEG_ONE, Vec3::ONE, vec3(1.0, -1.0, 1.0), Vec3::ZERO];
    let points = (0..1000).map(|i| [ends[i % 4]; 3]);
    depth(&mesh(points));
}

#[test]
fn coordinates_outside_the_scene_are_refused_by_primitive() {
    let faults = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.0001, -3e38];
    for (fault, axis) in faults.into_iter().zip([0, 1, 2, 0, 1]) {
        let mut triangles = scattered(50, 9);
        let mut vertices = triangles[31].vertices();
        vertices[2][axis] = fault;
        triangles[31] = Primitive::triangle(vertices, 4711, 0, 0);
        let error = split(&triangles, 0.0).unwrap_err();
        assert_eq!(error, BuildError::Coordinate { primitive: 4711 });
        assert!(error.to_string().contains("primitive 4711"));
    }
}
