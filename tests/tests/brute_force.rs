//! The hits of every method and hierarchy against a test of every triangle, on scenes that the program generates.
//!
//! `EYERAYS_RAYS=1000000 cargo test --release -p eyerays-tests --test brute_force` traces a million rays a scene.

use std::path::Path;

use eyerays::cpu;
use eyerays::job::Job;
use eyerays::scene;
use eyerays::scene_io;
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays_bvh::Quality;
use eyerays_command::generate::{Files, Kind, Recipe};
use eyerays_tests::brute_force::{brute_force, found};
use eyerays_tests::traversals;
use glam::Vec3;

/// Rays of a scene, unless `EYERAYS_RAYS` says otherwise.
const RAYS: usize = 8_000;
/// Triangles of a scene.
const TRIANGLES: u64 = 20_000;

fn generated(kind: Kind, folder: &Path) -> scene::Scene {
    let mesh = folder.join(kind.name()).with_extension("obj");
    let files = Files::beside(&mesh).unwrap();
    Recipe { kind, triangles: TRIANGLES, seed: 3 }.write(&files).unwrap();
    scene_io::load(&mesh.with_extension("toml")).unwrap().0
}

fn pack(scene: &scene::Scene, quality: Quality) -> Job {
    Job::with_wide_nodes(scene, scene.settings, quality).unwrap()
}

/// A number in [0, 1) that depends on its place alone.
fn random(place: u32) -> f32 {
    let state = place.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    ((word >> 22) ^ word) as f32 / 4_294_967_296.0
}

/// From anywhere in the scene: to anywhere, along an axis, or at a vertex.
fn rays(packed: &Job) -> Stream {
    let count = std::env::var("EYERAYS_RAYS").map_or(RAYS, |n| n.parse().expect("a number of rays"));
    // In the scene's order, which no hierarchy changes.
    let mut triangles = packed.primitives().to_vec();
    triangles.sort_by_key(|t| t.number());
    triangles.dedup_by_key(|t| t.number());
    let vertices: Vec<Vec3> = triangles.iter().flat_map(|t| t.vertices()).collect();
    let (least, greatest) =
        vertices.iter().fold((Vec3::ONE, -Vec3::ONE), |(least, greatest), v| (least.min(*v), greatest.max(*v)));
    let ray = |i: usize| {
        let number = |k: u32| random(i as u32 * 8 + k);
        let place = |k: u32| least + (greatest - least) * Vec3::new(number(k), number(k + 1), number(k + 2));
        let origin = place(0);
        let target = match i % 4 {
            0 => vertices[(number(3) * vertices.len() as f32) as usize % vertices.len()],
            1 => origin + [Vec3::X, Vec3::Y, Vec3::Z][(number(3) * 3.0) as usize % 3] * (number(4) - 0.5),
            _ => place(3),
        };
        let direction = if target == origin { Vec3::X } else { target - origin };
        StreamRay { origin, direction, limit: f32::MAX, source_primitive: StreamRay::NOWHERE }
    };
    Stream::new((0..count).map(ray))
}

fn assert_every_method(kind: Kind) {
    let folder = tempfile::tempdir().unwrap();
    let scene = generated(kind, folder.path());
    let mut oracle = None;
    for quality in [Quality::Fast, Quality::Medium, Quality::High] {
        let packed = pack(&scene, quality);
        let stream = rays(&packed);
        let want = oracle.get_or_insert_with(|| brute_force(&packed, &stream));
        let hits = want.iter().filter(|found| found[3] != StreamRay::NOWHERE).count();
        assert!(2 * hits > want.len(), "{kind:?}: only {hits} rays of {} hit", want.len());
        for traversal in traversals() {
            let (answers, _) = cpu::cast(&packed, traversal, 0, &stream, Question::Closest).unwrap();
            let Answers::Closest(got) = answers else { unreachable!("this was asked for the closest hits") };
            let got = got.iter().map(|&hit| found(&packed, hit));
            let differing = got.zip(want.iter()).filter(|(got, want)| got != *want).count();
            assert_eq!(differing, 0, "{kind:?}, {quality:?}, {traversal:?}: differing hits of {}", want.len());
        }
    }
}

#[test]
fn hall() {
    assert_every_method(Kind::Hall);
}

#[test]
fn forest() {
    assert_every_method(Kind::Forest);
}

#[test]
fn cathedral() {
    assert_every_method(Kind::Cathedral);
}
