//! Errors of hits, and settings of the Cornell box as they are measured.

use std::path::Path;

use super::*;
use eyerays::compare::compare;
use eyerays::cpu;
use eyerays::job::Job;
use eyerays::method::Processor;
use eyerays::picture::Picture;
use eyerays::render::{Backend, Choice, DeviceWish};
use eyerays::scene::{self, Integrator, Sampler, Settings, Transport};
use eyerays::scene_io;
use eyerays::stream::StreamRay;
use eyerays::view::View;

const NOWHERE: u32 = StreamRay::NOWHERE;

#[test]
fn errors_of_hits_are_counted_in_units_of_the_last_place() {
    let step = 2f64.powi(-23);
    let truth = [(1.0, 7), (1.0 + 0.25 * step, 7), (4.0, 8), (5.0, NOWHERE), (2.0, 9), (3.0, NOWHERE)];
    let found = [(1.0, 7), (1.0, 7), (4.0f32.next_up(), 8), (5.0, NOWHERE), (2.0, 8), (3.0, 1)];
    let errors = HitErrors::of(&found, &truth);
    assert_eq!(errors, HitErrors { wrong: 2.0 / 6.0, median_ulp: Some(0.25), max_ulp: Some(1.0) });
    let nothing = HitErrors::of(&[(1.0, NOWHERE)], &[(1.0, NOWHERE)]);
    assert_eq!(nothing, HitErrors { wrong: 0.0, median_ulp: None, max_ulp: None });
    assert_eq!(HitErrors::of(&[], &[]).wrong, 0.0);
}

fn subject() -> Subject {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/cornell.toml");
    let (scene, _) = scene_io::load(&file).unwrap();
    let camera = scene.cameras[0].clone();
    let settings = Settings { size: (40, 36), ..scene.settings };
    Subject { name: "box".to_owned(), file, scene, camera, settings }
}

fn plan(axes: Axes) -> Plan {
    Plan { axes, repeat: 1, trials: 60, reference_spp: 64, wish: None }
}

fn on_cpu() -> Backend {
    Backend::new(&Choice { device: DeviceWish::Cpu, threads: 2, ..Choice::default() }).unwrap()
}

/// The picture of a setting, straight from the executor.
fn picture(subject: &Subject, setting: &Setting) -> Picture {
    let settings = setting.settings(subject.settings);
    let packed = Job::with_wide_nodes(&subject.scene, settings, setting.bvh.quality()).unwrap();
    let choice = Choice {
        device: DeviceWish::Cpu,
        precision: setting.precision,
        traversal: setting.traversal(Default::default()),
        ..Choice::default()
    };
    let view = View::new(&packed, &subject.camera).unwrap();
    Backend::new(&choice).unwrap().render(&packed, &view, 1, &|_| ()).unwrap().picture
}

fn reference(subject: &Subject, samples: u32) -> Picture {
    let settings = Settings { samples, ..subject.settings };
    let packed = Job::with_wide_nodes(&subject.scene, settings, Bvh::High.quality()).unwrap();
    let view = View::new(&packed, &subject.camera).unwrap();
    cpu::render::<f64>(&packed, &view, Method::IfIf, 0, &|_| ()).unwrap().0
}

#[test]
fn every_error_is_that_of_the_picture_beside_the_reference() {
    let subject = subject();
    let axes = Axes { methods: vec![Method::Auto, Method::IfIf], samples: vec![(2, 0), (1, 0)], ..axes() };
    let report = run(&plan(axes), &subject, on_cpu(), &|_| ()).unwrap();
    assert_eq!(report.base, Setting { samples: 1, ..setting() });
    assert!(report.notes.iter().all(|note| note.contains("raise --trials")), "{:?}", report.notes);
    let references = [reference(&subject, 1), reference(&subject, 2)];
    for record in &report.records {
        let picture = picture(&subject, &record.setting);
        let [alike, judged] = [&references[record.setting.samples as usize - 1], &references[1]]
            .map(|reference| compare(&picture, reference).unwrap());
        let what = record.setting.options();
        assert_eq!((record.rmse, record.psnr_db), (judged.rmse, judged.psnr), "{what}");
        assert_eq!(record.rmse_same_samples, Some(alike.rmse), "{what}");
        assert!(record.time_ms > 0.0 && record.slowest_ms >= record.time_ms);
        assert!(record.t_error_median_ulp <= record.t_error_max_ulp && record.t_error_max_ulp.is_some());
    }
    let points: Vec<_> = report.records.iter().map(|r| (r.time_ms, r.rmse)).collect();
    let members: Vec<_> = report.front().iter().map(|r| r.setting).collect();
    assert_eq!(members, front(&points).iter().map(|&i| report.records[i].setting).collect::<Vec<_>>());
}

/// In exact precision method, layout and hierarchy leave a picture and its hits as they are, to the last bit.
#[test]
fn what_is_free_changes_no_error_and_what_trades_does() {
    let subject = subject();
    let arithmetic = vec![(Precision::Exact, TriangleTest::Watertight)];
    let axes = Axes { arithmetic, samples: vec![(1, 0)], methods: Method::ALL.to_vec(), ..axes() };
    let report = run(&plan(axes), &subject, on_cpu(), &|_| ()).unwrap();
    let of = |r: &Record| (r.rmse, r.wrong_primitives, r.t_error_median_ulp, r.t_error_max_ulp);
    let base = of(&report.records[0]);
    let (mut free, mut trading) = (0, 0);
    for record in &report.records {
        let whole = record.setting.bounces == 8 && record.setting.min_contribution == report.base.min_contribution;
        if whole {
            assert_eq!(of(record), base, "{}", record.setting.options());
            free += 1;
        } else if record.setting.bounces == 0 {
            assert!(record.rmse > 2.0 * base.0, "{}", record.setting.options());
            assert_eq!(record.wrong_primitives, base.1);
            trading += 1;
        }
    }
    assert!(free >= 1 + 8 + 1 + 2 && trading >= 1);
    assert!(base.0 > 0.0 && base.0 < 0.05, "single precision is not double: {base:?}");
}

#[test]
fn exact_hits_are_right_but_for_edges() {
    let subject = subject();
    let settings = Settings { samples: 1, ..subject.settings };
    let packed = Job::with_wide_nodes(&subject.scene, settings, Bvh::Medium.quality()).unwrap();
    let view = View::new(&packed, &subject.camera).unwrap();
    let primary = super::super::hits::Primary::new(&packed, &view, 2).unwrap();
    let errors = primary.errors(&packed, None, &Choice::default()).unwrap();
    assert!(errors.wrong < 0.01, "{errors:?}");
    assert!(errors.max_ulp.unwrap() < 64.0 && errors.median_ulp.unwrap() < 2.0, "{errors:?}");
    let rays = crate::bench::rays::CameraRays::of(&packed, &view, eyerays::method::Order::Tiled);
    let sight = crate::bench::rays::PrimaryHits::new(&packed, &rays, 2).unwrap();
    let stream = sight.rays(crate::bench::Kind::Primary, 0.0).unwrap();
    let [first, second] =
        [Method::IfIf, Method::Wide].map(|method| cpu::closest::<f64>(&packed, method.into(), 2, &stream).unwrap());
    assert!(first == second, "every method finds the same in double precision, too");
    let exact = eyerays::method::Traversal::default().resolved(Processor::Cpu, eyerays::method::Coherence::Primary);
    let (answers, _) = cpu::cast(&packed, exact, 2, &stream, eyerays::stream::Question::Closest).unwrap();
    assert_eq!(eyerays::stream::Answers::Closest(cpu::closest::<f32>(&packed, exact, 2, &stream).unwrap()), answers);
}

/// A scene that no device can hold has no base, and says which file is to blame.
#[test]
fn a_scene_that_can_not_be_packed_is_an_error() {
    let mut subject = subject();
    let (position, colour) = (glam::Vec3::splat(1e30), glam::Vec3::ONE);
    subject.scene.lights = vec![scene::Light::Point { position, colour, group: String::new(), illuminant: None }];
    let error = run(&plan(axes()), &subject, on_cpu(), &|_| ()).unwrap_err();
    assert!(error.file == Some(subject.file) && error.message.contains("too far away"), "{error}");
}

/// What a reference tells of its own error is what it adds to the error of pictures, and more samples make it less.
#[test]
fn a_reference_of_samples_tells_its_own_error() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/bleeding.toml");
    let (scene, _) = scene_io::load(&file).unwrap();
    let camera = scene.cameras[0].clone();
    let transport = Transport { clamp: 0.0, ..scene.settings.transport };
    let settings = Settings { size: (96, 72), spp: 4, bounces: 3, transport, ..scene.settings };
    let subject = Subject { name: "walls".to_owned(), file, scene, camera, settings };
    let of = |reference_spp: u32| {
        let axes = Axes {
            arithmetic: vec![(Precision::Exact, TriangleTest::Watertight)],
            methods: vec![Method::Auto],
            layouts: vec![Layout::Gathered],
            bvhs: vec![Bvh::Medium],
            integrators: vec![Integrator::Path],
            samplers: vec![Sampler::Random],
            samples: vec![(1, 16), (1, 4)],
            bounces: vec![3],
            roulettes: vec![Settings::MOST_BOUNCES],
            clamps: vec![0.0],
            ..axes()
        };
        let report = run(&Plan { reference_spp, ..plan(axes) }, &subject, on_cpu(), &|_| ()).unwrap();
        let line = &report.setup.iter().find(|(name, _)| name == "reference").unwrap().1;
        let error: f64 = line.rsplit(' ').next().unwrap().parse().unwrap();
        let rmse = |spp: u32| report.records.iter().find(|r| r.setting.spp == spp).unwrap().rmse;
        assert!(report.records.iter().all(|record| record.rmse_same_samples.is_none()));
        (error, rmse(16), rmse(4), report.notes.len())
    };
    let (fine, fine_16, fine_4, told) = of(512);
    let (coarse, coarse_16, ..) = of(16);
    assert!(fine < 0.3 * coarse, "{fine} {coarse}");
    assert!((fine_4 / fine_16 - 2.0).abs() < 0.3, "noise of random samples: {fine_4} {fine_16}");
    let expected = (fine_16 * fine_16 + coarse * coarse).sqrt();
    assert!((coarse_16 / expected - 1.0).abs() < 0.2, "{coarse_16} {expected}");
    assert_eq!(told, 0);
    assert_eq!(of(2).3, 1, "a reference that errs as much as what it judges is told");
}
