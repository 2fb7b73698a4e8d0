//! Every kind of ray by every method gets the same answers from GPU and CPU.

use eyerays::cpu;
use eyerays::gpu::{AdapterRequest, Caster, Gpu};
use eyerays::job::Job;
use eyerays::method::{Layout, Method, Order, Scheduling, Traversal};
use eyerays::stream::{Answers, Question, Stream};
use eyerays_command::bench::Kind;
use eyerays_command::bench::answers::first_difference;
use eyerays_command::bench::rays::{CameraRays, PrimaryHits, diagonal};
use eyerays_tests::{Posed, SHIPPED, gpu, pack, settings, shipped, traversals};

/// Rays through the middle of this many pixels.
const SIZE: (u32, u32) = (40, 30);

fn on_cpu(packed: &Job, traversal: Traversal, stream: &Stream, question: Question) -> Answers {
    cpu::cast(packed, traversal, 0, stream, question).unwrap().0
}

/// The GPU's answers by those of these traversals that take a layout.
fn assert_gpu(gpu: &Gpu, packed: &Posed, how: &[Traversal], layout: Layout, what: &str) {
    let caster = Caster::new(gpu, packed, layout).unwrap();
    let streams = streams(packed);
    for (kind, stream) in &streams {
        let want = on_cpu(packed, Method::IfIf.into(), stream, kind.question());
        let cast = caster.upload(stream).unwrap();
        for &traversal in how.iter().filter(|t| t.layout == layout && t.order == Order::Tiled) {
            caster.trace(&cast, true, traversal, kind.question()).unwrap();
            let got = caster.answers(&cast, kind.question()).unwrap();
            assert_eq!(first_difference(packed.primitives(), &got, &want), None, "{what}, {kind:?}, {traversal:?}");
        }
    }
}

fn streams(packed: &Posed) -> Vec<(Kind, Stream)> {
    let sight = PrimaryHits::new(packed, &CameraRays::of(packed, &packed.view, Order::Tiled), 0).unwrap();
    let length = 0.2 * diagonal(packed) as f32;
    Kind::ALL
        .into_iter()
        .map(|kind| (kind, sight.rays(kind, length).unwrap().into_owned()))
        .filter(|(_, stream)| !stream.is_empty())
        .collect()
}

#[test]
fn every_kind_by_every_method_on_the_cpu() {
    for name in SHIPPED {
        let scene = shipped(name);
        let packed = pack(&scene, &scene.cameras[0], settings(&scene, SIZE, 1));
        for (kind, stream) in streams(&packed) {
            let want = on_cpu(&packed, Method::IfIf.into(), &stream, kind.question());
            for traversal in traversals() {
                let got = on_cpu(&packed, traversal, &stream, kind.question());
                assert_eq!(first_difference(packed.primitives(), &got, &want), None, "{name}, {kind:?}, {traversal:?}");
            }
        }
    }
}

#[test]
fn every_kind_by_every_method_on_the_gpu() {
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    for name in SHIPPED {
        let scene = shipped(name);
        let packed = pack(&scene, &scene.cameras[0], settings(&scene, SIZE, 1));
        let few = [
            Method::Packet.into(),
            Traversal { scheduling: Scheduling::Persistent, ..Method::WhileWhile.into() },
            Traversal { scheduling: Scheduling::Persistent, ..Method::Wide.into() },
        ];
        assert_gpu(&gpu, &packed, &few, Layout::Gathered, name);
    }
    // Each kernel is compiled for its scene, which a software device takes its time for.
    let scene = shipped("whitted");
    let packed = pack(&scene, &scene.cameras[0], settings(&scene, SIZE, 1));
    for layout in [Layout::Gathered, Layout::Indexed, Layout::Compact] {
        assert_gpu(&gpu, &packed, &traversals(), layout, "whitted");
    }
}
