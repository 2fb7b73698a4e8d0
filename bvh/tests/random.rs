//! Random meshes: the promises hold, and the tree depends on nothing but the mesh.

mod common;

use common::*;
use eyerays_bvh::{Bvh, Quality, build, split};
use eyerays_shader::data::Primitive;
use glam::Vec3;
use proptest::{
    collection::vec,
    prelude::*,
    test_runner::{FileFailurePersistence, RngSeed},
};
use rayon::ThreadPoolBuilder;

/// Coordinates among which ties, degenerate triangles and tiny distances are common.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        -1.0f32..=1.0,
        (-4i8..=4).prop_map(|i| f32::from(i) / 4.0),
        (-1e-6f32..=1e-6),
        (0u8..=120).prop_map(|k| 0.5f32.powi(i32::from(k))),
    ]
}

fn vertex() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from)
}

/// Triangles, each repeated a number of times.
fn any_mesh() -> impl Strategy<Value = Vec<Primitive>> {
    let repeated = ([vertex(), vertex(), vertex()], prop_oneof![9 => 1..2usize, 1 => 1..400usize]);
    vec(repeated, 1..400)
        .prop_map(|all| mesh(all.into_iter().flat_map(|(vertices, times)| std::iter::repeat_n(vertices, times))))
}

/// No split triangles as often as some and many.
fn budget() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0f32), Just(0.3), Just(1.0)]
}

fn quality() -> impl Strategy<Value = Quality> {
    (0..QUALITIES.len()).prop_map(|i| QUALITIES[i])
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn every_promise_holds(triangles in any_mesh(), budget in budget(), quality in quality()) {
        build_and_check(&split(&triangles, budget).unwrap(), quality);
    }
}

/// Builds on a pool of so many threads.
fn build_with(threads: usize, triangles: &[Primitive], budget: f32, quality: Quality) -> Bvh {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| build(&split(triangles, budget).unwrap(), quality).unwrap())
}

#[test]
fn threads_do_not_change_the_tree() {
    // More than 300,000 triangles, so that every parallel path is taken; the grid is full of ties.
    let mut triangles = grid(400);
    triangles.extend(scattered(20_000, 17));
    triangles.extend(grid(20));
    triangles.extend(slivers(200));
    for (quality, budget) in
        [(Quality::Fast, 0.0), (Quality::Medium, 0.0), (Quality::High, 0.0), (Quality::Medium, 0.1)]
    {
        let [one, two, seven] = [1, 2, 7].map(|n| build_with(n, &triangles, budget, quality));
        assert!(one == two && one == seven, "{quality:?}");
    }
}
