//! Rays, answers and tables of the Cornell box.

use std::collections::BTreeSet;
use std::path::Path;

use eyerays_bvh::Quality;
use eyerays_shader::data::Tuning;
use glam::Vec3;

use super::answers::Hash;
use super::rays::{AO_RAYS, Sight, View, diagonal};
use super::*;
use crate::method::{Layout, Method, Order, Scheduling};
use crate::pack::Packed;
use crate::scene::{self, Scene, Settings};
use crate::stream::{Stream, StreamRay};

fn scene() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/cornell.toml");
    scene::load(&path).unwrap().0
}

/// The Cornell box as its first camera sees it.
pub(super) fn cornell(size: (u32, u32)) -> Packed {
    let scene = scene();
    let settings = Settings { size, samples: 1, ..scene.settings };
    Packed::new(&scene, &scene.cameras[0], settings, Quality::Medium).unwrap()
}

fn rays(sight: &Sight<'_>, kind: Kind) -> Vec<StreamRay> {
    let stream = sight.rays(kind, 0.125).unwrap();
    (0..stream.len()).map(|i| stream.ray(i)).collect()
}

fn hash(stream: &Stream) -> Hash {
    let mut hash = Hash::default();
    stream.words().iter().flat_map(|word| word.to_array()).for_each(|word| hash.add(word));
    hash
}

/// Whoever changes these changes every figure that was measured before.
#[test]
fn rays_have_the_same_bits_everywhere() {
    let packed = cornell((64, 48));
    let sight = Sight::new(&packed, &View::of(&packed, Order::Tiled), 1).unwrap();
    let hashes: Vec<String> =
        Kind::ALL.iter().map(|&kind| hash(&sight.rays(kind, 0.125).unwrap()).to_string()).collect();
    assert_eq!(hashes, [""; 6]);
    let threads = Sight::new(&packed, &View::of(&packed, Order::Tiled), 3).unwrap();
    for (&kind, expected) in Kind::ALL.iter().zip(&hashes) {
        assert_eq!(hash(&threads.rays(kind, 0.125).unwrap()).to_string(), *expected, "{kind:?}");
    }
}

#[test]
fn rays_are_unit_and_leave_what_they_start_from() {
    let packed = cornell((64, 48));
    let sight = Sight::new(&packed, &View::of(&packed, Order::Tiled), 0).unwrap();
    for kind in Kind::ALL {
        for ray in rays(&sight, kind) {
            assert!((ray.direction.length() - 1.0).abs() < 1e-6, "{kind:?}: {ray:?}");
            assert_eq!(ray.leaves == StreamRay::NOWHERE, kind == Kind::Primary);
            assert!(ray.origin.is_finite() && ray.limit > 0.0);
        }
    }
}

#[test]
fn every_hit_has_its_rays() {
    let packed = cornell((64, 48));
    let sight = Sight::new(&packed, &View::of(&packed, Order::Tiled), 0).unwrap();
    let count = |kind| rays(&sight, kind).len();
    let hits = sight.hits();
    assert!(hits > 64 * 48 / 2);
    assert_eq!((count(Kind::Primary), count(Kind::Reflection), count(Kind::Diffuse)), (64 * 48, hits, hits));
    assert_eq!(count(Kind::Ao), AO_RAYS as usize * hits);
    assert!(count(Kind::Refraction) <= hits && count(Kind::Shadow) <= packed.lights.len() * hits);
    assert!(rays(&sight, Kind::Ao).iter().all(|ray| ray.limit == 0.125));
    assert!(rays(&sight, Kind::Ao).chunks(4).all(|four| four.iter().all(|ray| ray.leaves == four[0].leaves)));
}

/// Mirrored and sampled rays go on the viewer's side, refracted ones on the other.
#[test]
fn rays_go_to_their_side() {
    let packed = cornell((64, 48));
    let sight = Sight::new(&packed, &View::of(&packed, Order::Tiled), 0).unwrap();
    let slots = packed.triangles.iter().map(|t| (t.primitive(), t.vertices()));
    let by_primitive: std::collections::HashMap<u32, [Vec3; 3]> = slots.collect();
    let primary = rays(&sight, Kind::Primary);
    for kind in [Kind::Reflection, Kind::Refraction, Kind::Diffuse] {
        let of = rays(&sight, kind);
        if of.len() != primary.len() {
            continue;
        }
        for (from, ray) in primary.iter().zip(of) {
            let [a, b, c] = by_primitive[&ray.leaves];
            let normal = (b - a).cross(c - a);
            let same_side = normal.dot(from.direction) * normal.dot(ray.direction) > 0.0;
            assert_eq!(same_side, kind == Kind::Refraction, "{kind:?}: {ray:?}");
        }
    }
}

#[test]
fn every_order_has_the_same_rays() {
    let packed = cornell((70, 50));
    let all = |order| {
        let sight = Sight::new(&packed, &View::of(&packed, order), 0).unwrap();
        let key = |ray: &StreamRay| [ray.origin, ray.direction].map(|v| v.to_array().map(f32::to_bits));
        Kind::ALL.map(|kind| rays(&sight, kind).iter().map(key).collect::<BTreeSet<_>>())
    };
    let tiled = all(Order::Tiled);
    assert!(tiled == all(Order::Linear) && tiled == all(Order::Morton));
}

#[test]
fn the_diagonal_is_that_of_the_box() {
    let packed = cornell((8, 8));
    assert!((diagonal(&packed) / packed.scale - 12f64.sqrt()).abs() < 1e-3);
}

fn plan() -> Plan {
    Plan {
        kinds: Kind::ALL.to_vec(),
        methods: Method::ALL.to_vec(),
        schedulings: vec![Scheduling::Auto],
        orders: vec![Order::Tiled, Order::Morton],
        layouts: vec![Layout::Gathered, Layout::Indexed],
        tuning: Tuning::default(),
        exact: true,
        fast: false,
        gpu: None,
        cpu: true,
        threads: 2,
        size: (40, 40),
        repeat: 1,
        ao_length: None,
        quality: Quality::Medium,
    }
}

fn subject() -> Subject {
    let scene = scene();
    let cameras = scene.cameras[..2].to_vec();
    Subject { name: "box".to_owned(), scene, cameras }
}

#[test]
fn a_run_measures_every_way_and_all_answer_alike() {
    let (plan, subjects) = (plan(), [subject()]);
    let begun = std::cell::Cell::new(0);
    let report = run(&plan, &subjects, &|_| begun.set(begun.get() + 1)).unwrap();
    assert_eq!(begun.get(), streams(&plan, &subjects));
    assert_eq!((report.faults.as_slice(), report.notes.as_slice()), (&[][..], &[][..]));
    assert_eq!((report.scenes.len(), report.views.len()), (1, 4));
    assert_eq!(report.records.len(), 2 * 2 * 6 * 9 * 2, "views, orders, kinds, methods, layouts");
    for record in &report.records {
        assert!(record.mrays_per_s > 0.0 && record.frames_per_s > 0.0 && record.visits >= 1.0);
        assert_eq!(record.differing, 0.0);
        assert_eq!(record.simd_efficiency.is_some(), record.method.contains('-') && !record.method.contains("if")
            && !record.method.contains("while") || record.method == "packet", "{}", record.method);
    }
}
