//! Scenes of triangles, spheres and disks: every way through every hierarchy finds what a test of all primitives finds.

use eyerays::cpu::{self, Isa};
use eyerays::device_scene::SceneView;
use eyerays::gpu::{AdapterRequest, Caster};
use eyerays::job::Job;
use eyerays::method::{Layout, Method, Scheduling, Traversal};
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays_bvh::Quality;
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{F32xN, U32xN, V3};
use eyerays_shader::stage::{SHADOWED, Segment};
use eyerays_shader::traverse::{self, Closest, Leaf, Occlusion, Primitives, leaf};
use eyerays_shader::warp::Alone;
use eyerays_tests::brute_force::{Found, brute_force, found};
use eyerays_tests::{count, gpu, traversals};

use super::scenes::{Kind, rays};

/// What a stream's rays find by a test of everything: closest hits, and whether anything opaque is before the limit.
struct Truth {
    closest: Vec<Found>,
    dark: Vec<bool>,
}

impl Truth {
    fn of(packed: &Job, stream: &Stream) -> Self {
        let (laid, frame) = (SceneView::new(packed, Traversal::default()), packed.stream_frame(stream.len()));
        let geometry = laid.stream(&frame);
        let dark = |i: u32| {
            let segment = Segment::<f32>::load(geometry.base.frame.slots, i, stream.words());
            let (ray, mut hit) = (segment.ray(), Hit::none(segment.limit));
            for slot in 0..packed.primitives().len() as u32 {
                Primitives::intersect::<Occlusion, f32>(&geometry, (slot, u32::MAX), &ray, &mut hit);
            }
            leaf::occluded(&hit)
        };
        Truth { closest: brute_force(packed, stream), dark: (0..stream.len() as u32).map(dark).collect() }
    }

    /// Asserts that answers are these.
    fn assert(&self, packed: &Job, answers: Answers, what: &str) {
        let (differing, of) = match answers {
            Answers::Closest(hits) => {
                let pairs = || hits.iter().map(|&hit| found(packed, hit)).zip(&self.closest);
                (pairs().filter(|(hit, want)| hit != *want).count(), hits.len())
            }
            Answers::Occlusion(dark) => {
                let pairs = dark.iter().map(|&answer| answer == SHADOWED).zip(&self.dark);
                (pairs.filter(|(dark, want)| dark != *want).count(), dark.len())
            }
        };
        assert!(differing == 0 && of == self.dark.len(), "{what}: {differing} of {of} answers differ");
    }
}

const QUESTIONS: [Question; 2] = [Question::Closest, Question::Occlusion];

#[test]
fn every_method_and_hierarchy_finds_what_brute_force_finds() {
    for kind in Kind::ALL {
        let mut truth = None;
        for quality in [Quality::Fast, Quality::Medium, Quality::High] {
            let packed = kind.pack(quality);
            let stream = rays(&packed, count::of(1_500, 200_000));
            let truth: &Truth = truth.get_or_insert_with(|| Truth::of(&packed, &stream));
            let hits = truth.closest.iter().filter(|found| found[3] != StreamRay::NOWHERE).count();
            assert!(5 * hits > 2 * stream.len(), "{kind:?}: {hits} of {} hit", stream.len());
            for (traversal, question) in traversals().into_iter().flat_map(|t| QUESTIONS.map(|q| (t, q))) {
                let (answers, _) = cpu::cast(&packed, traversal, 0, &stream, question).unwrap();
                truth.assert(&packed, answers, &format!("{kind:?}, {quality:?}, {traversal:?}, {question:?}"));
            }
        }
    }
}

#[test]
fn every_isa_and_layout_finds_what_brute_force_finds() {
    for kind in Kind::ALL {
        let packed = kind.pack(Quality::Medium);
        let stream = rays(&packed, count::of(501, 50_001));
        let truth = Truth::of(&packed, &stream);
        for (isa, method) in Isa::here().into_iter().flat_map(|isa| Method::ALL.map(|method| (isa, method))) {
            for (layout, question) in [(Layout::Indexed, QUESTIONS[0]), (Layout::Gathered, QUESTIONS[1])] {
                let traversal = Traversal { layout, ..method.into() };
                let (answers, _) = cpu::cast_by(isa, &packed, traversal, 0, &stream, question).unwrap();
                truth.assert(&packed, answers, &format!("{kind:?}, {isa:?}, {traversal:?}, {question:?}"));
            }
        }
    }
}

/// A packet's hits, each with its ray's number.
fn assert_packets<const N: usize>(packed: &Job, stream: &Stream, truth: &Truth, what: &str) {
    let (laid, frame) = (SceneView::new(packed, Method::Packet.into()), packed.stream_frame(stream.len()));
    let geometry = laid.stream(&frame);
    for first in (0..stream.len() / N * N).step_by(N) {
        let ray = |i: usize| stream.ray(first + i);
        let packet = Ray::leaving(
            U32xN(std::array::from_fn(|i| ray(i).source_primitive)),
            V3::<F32xN<N>>::of_lanes(|i| V3::splat(ray(i).origin)),
            V3::<F32xN<N>>::of_lanes(|i| V3::splat(ray(i).direction)),
        );
        let none = || Hit::none(F32xN(std::array::from_fn(|i| ray(i).limit)));
        let (mut closest, mut dark) = (none(), none());
        trace::<Closest, N>(&geometry, &packet, &mut closest);
        trace::<Occlusion, N>(&geometry, &packet, &mut dark);
        for i in 0..N {
            let hit = closest.lane::<f32>(i);
            let (u, v) = hit.coordinates();
            let got = [hit.t.to_bits(), u.to_bits(), v.to_bits(), hit.primitive];
            let dark = leaf::occluded(&dark.lane::<f32>(i));
            assert_eq!((got, dark), (truth.closest[first + i], truth.dark[first + i]), "{what}, {N} lanes");
        }
    }
}

fn trace<Q: traverse::Query, const N: usize>(
    geometry: &eyerays_shader::scene::TraceContext<'_>,
    packet: &Ray<F32xN<N>>,
    hit: &mut Hit<F32xN<N>>,
) {
    <traverse::Packet<Alone> as traverse::Method<F32xN<N>>>::traverse::<Q, Primitives>(geometry, packet, hit);
}

#[test]
fn packets_of_any_width_find_what_brute_force_finds() {
    for kind in Kind::ALL {
        let packed = kind.pack(Quality::Medium);
        let stream = rays(&packed, count::of(512, 65_536));
        let (truth, what) = (Truth::of(&packed, &stream), format!("{kind:?}"));
        assert_packets::<4>(&packed, &stream, &truth, &what);
        assert_packets::<8>(&packed, &stream, &truth, &what);
        assert_packets::<16>(&packed, &stream, &truth, &what);
        assert_packets::<32>(&packed, &stream, &truth, &what);
    }
}

#[test]
fn the_gpu_finds_what_brute_force_finds() {
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    for kind in Kind::ALL {
        let packed = kind.pack(Quality::Medium);
        let stream = rays(&packed, count::of(2_000, 200_000));
        let truth = Truth::of(&packed, &stream);
        let caster = Caster::new(&gpu, &packed, Layout::Gathered).unwrap();
        let cast = caster.upload(&stream).unwrap();
        // A software device compiles each kernel slowly, and ends loops after 65,535 rounds in all: too few for all of a
        // persistent lane's rays.
        let grid = |method: Method| Traversal { scheduling: Scheduling::Grid, ..method.into() };
        let some = [Method::IfIf, Method::Wide, Method::Packet].map(grid).into_iter();
        let all = traversals().into_iter().filter(|t| t.layout == Layout::Gathered);
        let ways: Vec<Traversal> = if gpu.report.is_software() { some.collect() } else { all.collect() };
        for (traversal, question) in ways.into_iter().flat_map(|t| QUESTIONS.map(|q| (t, q))) {
            caster.trace(&cast, true, traversal, question).unwrap();
            let answers = caster.answers(&cast, question).unwrap();
            truth.assert(&packed, answers, &format!("{kind:?}, {traversal:?}, {question:?}"));
        }
    }
}
