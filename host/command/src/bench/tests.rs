//! Rays, answers and tables of the Cornell box.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use eyerays_bvh::Quality;
use eyerays_shader::data::{Primitive, Tuning};
use eyerays_shader::ray::Ray;
use glam::Vec3;

use super::answers::Hash;
use super::rays::{AO_RAYS, CameraRays, PrimaryHits, diagonal};
use super::*;
use eyerays::job::Job;
use eyerays::method::{Layout, Method, Order, Scheduling, TriangleTest};
use eyerays::scene::{self, Scene, Settings};
use eyerays::scene_io;
use eyerays::stream::{Stream, StreamRay};
use eyerays::view::View;

fn scene() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/cornell.toml");
    scene_io::load(&path).unwrap().0
}

/// The Cornell box as its first camera sees it.
pub(super) fn cornell(size: (u32, u32)) -> (Job, View) {
    let scene = scene();
    let settings = Settings { size, samples: 1, ..scene.settings };
    let packed = Job::with_wide_nodes(&scene, settings, Quality::Medium).unwrap();
    let view = View::new(&packed, &scene.cameras[0]).unwrap();
    (packed, view)
}

fn rays(sight: &PrimaryHits<'_>, kind: Kind) -> Vec<StreamRay> {
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
    let (packed, view) = cornell((64, 48));
    let sight = PrimaryHits::new(&packed, &CameraRays::of(&packed, &view, Order::Tiled), 1).unwrap();
    let hashes: Vec<String> =
        Kind::ALL.iter().map(|&kind| hash(&sight.rays(kind, 0.125).unwrap()).to_string()).collect();
    let recorded = [
        "a89f532445d04191",
        "3394c2aec6674008",
        "6bf98bfeb6c9f9b4",
        "f1f4cccf677cd63c",
        "a94034104b73fee2",
        "5d6be02a19b20ecc",
    ];
    assert_eq!(hashes, recorded);
    let threads = PrimaryHits::new(&packed, &CameraRays::of(&packed, &view, Order::Tiled), 3).unwrap();
    for (&kind, expected) in Kind::ALL.iter().zip(&hashes) {
        assert_eq!(hash(&threads.rays(kind, 0.125).unwrap()).to_string(), *expected, "{kind:?}");
    }
}

#[test]
fn rays_are_unit_and_leave_what_they_start_from() {
    let (packed, view) = cornell((64, 48));
    let sight = PrimaryHits::new(&packed, &CameraRays::of(&packed, &view, Order::Tiled), 0).unwrap();
    for kind in Kind::ALL {
        for ray in rays(&sight, kind) {
            assert!((ray.direction.length() - 1.0).abs() < 1e-6, "{kind:?}: {ray:?}");
            assert_eq!(ray.source_primitive == StreamRay::NOWHERE, kind == Kind::Primary);
            assert!(ray.origin.is_finite() && ray.limit > 0.0);
        }
    }
}

#[test]
fn every_hit_has_its_rays() {
    let (packed, view) = cornell((64, 48));
    let sight = PrimaryHits::new(&packed, &CameraRays::of(&packed, &view, Order::Tiled), 0).unwrap();
    let count = |kind| rays(&sight, kind).len();
    let hits = sight.hits();
    assert!(hits > 64 * 48 / 2);
    assert_eq!((count(Kind::Primary), count(Kind::Reflection), count(Kind::Diffuse)), (64 * 48, hits, hits));
    assert_eq!(count(Kind::Ao), AO_RAYS as usize * hits);
    assert!(count(Kind::Refraction) <= hits && count(Kind::Shadow) <= packed.lights().len() * hits);
    assert!(rays(&sight, Kind::Ao).iter().all(|ray| ray.limit == 0.125));
    assert!(
        rays(&sight, Kind::Ao)
            .chunks(4)
            .all(|four| four.iter().all(|ray| ray.source_primitive == four[0].source_primitive))
    );
}

/// Mirrored and sampled rays go on the viewer's side, refracted ones on the other.
#[test]
fn rays_go_to_their_side() {
    let (packed, view) = cornell((48, 48));
    let sight = PrimaryHits::new(&packed, &CameraRays::of(&packed, &view, Order::Tiled), 0).unwrap();
    let by_number: HashMap<u32, Primitive> = packed.primitives().iter().map(|p| (p.number(), *p)).collect();
    let primary = rays(&sight, Kind::Primary);
    assert_eq!(sight.hits(), primary.len(), "the box fills this view");
    for kind in [Kind::Reflection, Kind::Refraction, Kind::Diffuse] {
        let of = rays(&sight, kind);
        assert_eq!(of.len(), primary.len(), "all is seen from its front, so that nothing is totally reflected");
        for (from, ray) in primary.iter().zip(of) {
            let primitive = by_number[&(ray.source_primitive & !Ray::<f32>::INSIDE)];
            let [a, b, c] = primitive.vertices();
            let normal = if primitive.is_sphere() { ray.origin - primitive.centre() } else { (b - a).cross(c - a) };
            let same_side = normal.dot(from.direction) * normal.dot(ray.direction) > 0.0;
            assert_eq!(same_side, kind == Kind::Refraction, "{kind:?}: {ray:?}");
        }
    }
}

#[test]
fn every_order_has_the_same_rays() {
    let (packed, view) = cornell((70, 50));
    let all = |order| {
        let sight = PrimaryHits::new(&packed, &CameraRays::of(&packed, &view, order), 0).unwrap();
        let key = |ray: &StreamRay| [ray.origin, ray.direction].map(|v| v.to_array().map(f32::to_bits));
        Kind::ALL.map(|kind| rays(&sight, kind).iter().map(key).collect::<BTreeSet<_>>())
    };
    let tiled = all(Order::Tiled);
    assert!(tiled == all(Order::Linear) && tiled == all(Order::Morton));
}

#[test]
fn the_diagonal_is_that_of_the_box() {
    let (packed, _) = cornell((8, 8));
    assert!((diagonal(&packed) / packed.normalisation().scale - 12f64.sqrt()).abs() < 1e-3);
}

pub(super) fn plan() -> Plan {
    Plan {
        kinds: Kind::ALL.to_vec(),
        methods: Method::ALL.to_vec(),
        schedulings: vec![Scheduling::Auto],
        orders: vec![Order::Tiled, Order::Morton],
        layouts: vec![Layout::Gathered, Layout::Indexed, Layout::Compact],
        triangles: vec![TriangleTest::Watertight],
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

pub(super) fn subject() -> Subject {
    let scene = scene();
    let cameras = scene.cameras[..2].to_vec();
    Subject { name: "box".to_owned(), file: "box.toml".into(), scene, cameras }
}

#[test]
fn a_run_measures_every_way_and_all_answer_alike() {
    let (plan, subjects) = (plan(), [subject()]);
    let begun = std::cell::Cell::new(0);
    let report = run(&plan, &subjects, &|_| begun.set(begun.get() + 1)).unwrap();
    assert_eq!(begun.get(), streams(&plan, &subjects));
    assert_eq!((report.faults.as_slice(), report.notes.as_slice()), (&[][..], &[][..]));
    assert_eq!((report.scenes.len(), report.views.len()), (1, 4));
    assert_eq!(report.records.len(), 2 * 2 * 6 * 9 * 3, "views, orders, kinds, methods, layouts");
    for record in &report.records {
        assert!(record.mrays_per_s > 0.0 && record.frames_per_s > 0.0 && record.visits >= 1.0);
        assert_eq!(record.differing, 0.0);
        let packets = ["packet", "sequential", "interleaved"].iter().any(|part| record.method.contains(part));
        assert_eq!(record.simd_efficiency.is_some(), packets, "{}", record.method);
    }
    let hashes: BTreeSet<_> = report.records.iter().map(|r| (&r.view, &r.order, r.kind, &r.hash)).collect();
    assert_eq!(hashes.len(), 2 * 2 * 6);
    assert_ne!(report.views[0].hash, report.views[1].hash);
}

#[test]
fn kinds_without_rays_are_left_out_with_a_note() {
    let mut subject = subject();
    subject.scene.lights.clear();
    subject.cameras.truncate(1);
    let (eye, target) = (subject.cameras[0].eye, subject.cameras[0].target);
    let plan = Plan { orders: vec![Order::Tiled], layouts: vec![Layout::Gathered], ..plan() };
    let kinds = |report: &Report| report.records.iter().map(|r| r.kind).collect::<BTreeSet<_>>();
    let dark = run(&plan, std::slice::from_ref(&subject), &|_| ()).unwrap();
    assert_eq!(dark.notes, ["box front: there are no shadow rays"]);
    assert_eq!(kinds(&dark).len(), 5);
    subject.cameras[0].target = eye + (eye - target);
    let blind = run(&plan, &[subject], &|_| ()).unwrap();
    assert_eq!(blind.notes.len(), 5);
    assert_eq!(kinds(&blind), [Kind::Primary].into());
    assert_eq!(blind.views[0].hit_share, 0.0);
}

#[test]
fn a_scene_that_can_not_be_measured_is_an_error_or_a_fault_beside_others() {
    let plan = Plan { methods: vec![Method::IfIf], kinds: vec![Kind::Primary], ..plan() };
    let mut far = subject();
    far.file = "far.toml".into();
    far.scene.lights = vec![scene::Light::Point {
        position: Vec3::splat(1e30),
        colour: Vec3::ONE,
        group: String::new(),
        illuminant: None,
    }];
    let error = run(&plan, std::slice::from_ref(&far), &|_| ()).unwrap_err();
    assert!(error.to_string().starts_with("far.toml: light 1 is too far away"), "{error}");
    let report = run(&plan, &[subject(), far], &|_| ()).unwrap();
    assert_eq!(report.faults, [error.to_string()]);
    assert_eq!(report.records.len(), 2 * 2 * 3);
}

/// Two views of a scene, on a GPU with two methods.
fn report() -> Report {
    let record = |view: &str, method: &str, mrays_per_s: f64| Record {
        scene: "a|b".to_owned(),
        view: view.to_owned(),
        kind: Kind::Primary,
        method: method.to_owned(),
        auto: method == "packet",
        scheduling: Some("grid".to_owned()),
        order: "tiled".to_owned(),
        layout: "indexed".to_owned(),
        triangle: "watertight".to_owned(),
        bvh: "medium".to_owned(),
        stack_max: 8,
        cut: 25,
        processor: "gpu",
        device: "A, \"GPU\"".to_owned(),
        driver: "1.0".to_owned(),
        precision: "fast",
        width: 1000,
        height: 1000,
        rays: 1_000_000,
        repeat: 3,
        median_seconds: 1.0 / mrays_per_s,
        spread: 0.015,
        mrays_per_s,
        frames_per_s: mrays_per_s,
        visits: 12.5,
        boxes: 25.0,
        primitive_tests: 3.0,
        simd_efficiency: (method == "packet").then_some(0.75),
        hash: "0123456789abcdef".to_owned(),
        differing: 0.000_002,
    };
    Report {
        setup: vec![("program".to_owned(), "eyerays".to_owned())],
        records: vec![record("one", "packet", 1500.0), record("two", "packet", 500.0), record("one", "if-if", 8.25)],
        faults: vec!["a ray".to_owned()],
        ..Report::default()
    }
}

#[test]
fn tables_have_a_method_a_row_and_a_view_a_column() {
    let text = markdown(&report());
    for part in [
        "| program | eyerays |\n",
        "\n| method | primary |\n|---|---|\n| packet, indexed | **1000** * |\n| if-if, indexed | 8.25 |\n",
        "\n## Primary rays (thesis table 7.2)\n",
        "\n**a\\|b**, primary rays, A, \"GPU\" in fast precision; spread at most 1.5 %\n",
        "\n| method | one | two | mean |\n|---|---|---|---|\n\
         | packet, indexed * | 1500 / 1500 | 500 / 500 | 1000 / 1000 |\n\
         | if-if, indexed | 8.25 / 8.25 | - | 8.25 / 8.25 |\n",
        "| a\\|b | primary | packet, indexed | 12.50 | 25.00 | 3.00 | 0.75 |\n",
        "| a\\|b | primary | if-if, indexed | 12.50 | 25.00 | 3.00 | - |\n",
        "| a\\|b | one | primary | 2 | 1,000,000 | 2.00e-6 |\n",
        "\n## Faults\n\n- a ray\n",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert!(!text.contains("Notes") && !text.contains("7.3"), "{text}");
}

#[test]
fn a_line_of_csv_has_the_fields_of_a_record() {
    let report = report();
    let text = csv(&report);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 1 + report.records.len());
    let json = serde_json::to_value(&report.records[0]).unwrap();
    let fields: BTreeSet<&str> = json.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(lines[0].split(',').collect::<BTreeSet<_>>(), fields);
    let start = "a|b,one,primary,packet,true,grid,tiled,indexed,watertight,medium,8,25,gpu,\"A, \"\"GPU\"\"\",1.0,fast,1000,1000,1000000,3,";
    assert!(lines[1].starts_with(start), "{text}");
    assert!(lines[3].ends_with(",12.5,25,3,,0123456789abcdef,0.000002"), "{text}");
}
