//! The same answers whatever instructions the processor has, and however rays share its vectors.

use eyerays::cpu::{self, Isa};
use eyerays::device_scene::SceneView;
use eyerays::job::Job;
use eyerays::method::{Layout, Method, Traversal};
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays::view::Region;
use eyerays_tests::{SHIPPED, pack, settings, shipped, traversals};
use glam::Vec3;

/// No multiple of any packet.
const RAYS: usize = 2013;

/// Rays from places in the scene every way, some along axes and planes; every seventh ends soon.
fn stream() -> Stream {
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut vector = || Vec3::new(random(), random(), random());
    let rays: Vec<StreamRay> = (0..RAYS)
        .map(|i| {
            let (origin, mut direction) = (vector() * 0.5, vector());
            if i % 3 == 0 {
                direction[i % 2] = 0.0;
            }
            if i % 5 == 0 {
                direction[2] = -0.0;
            }
            let direction = if direction == Vec3::ZERO { Vec3::X } else { direction };
            let limit = if i % 7 == 0 { 0.25 } else { f32::MAX };
            StreamRay { origin, direction, limit, source_primitive: StreamRay::NOWHERE }
        })
        .collect();
    Stream::new(rays.into_iter())
}

/// What must not change: a split triangle may be met at any of its slots.
fn settled(packed: &Job, answers: Answers) -> Vec<[u32; 4]> {
    match answers {
        Answers::Closest(hits) => {
            let primitive = |slot: u32| packed.primitives().get(slot as usize).map_or(slot, |t| t.number());
            hits.iter().map(|hit| [hit.x, hit.y, hit.z, primitive(hit.w)]).collect()
        }
        Answers::Occlusion(answers) => answers.iter().map(|&answer| [answer, 0, 0, 0]).collect(),
    }
}

#[test]
fn every_isa_and_method_answers_alike() {
    let stream = stream();
    for name in SHIPPED {
        let scene = shipped(name);
        let packed = pack(&scene, &scene.cameras[0], settings(&scene, (8, 8), 1));
        for question in [Question::Closest, Question::Occlusion] {
            let cast = |isa, traversal, threads| {
                let cast = cpu::cast_by(isa, &packed, traversal, threads, &stream, question);
                settled(&packed, cast.unwrap_or_else(|e| panic!("{e}")).0)
            };
            let wanted = cast(Isa::Baseline, Traversal::from(Method::IfIf), 1);
            for isa in Isa::here() {
                for traversal in traversals() {
                    for layout in [Layout::Gathered, Layout::Indexed] {
                        let traversal = Traversal { layout, ..traversal };
                        let what = format!("{name}, {question:?}, {isa:?}, {traversal:?}");
                        assert!(cast(isa, traversal, 2) == wanted, "{what}");
                    }
                }
            }
        }
    }
}

#[test]
fn every_isa_renders_the_same_tile() {
    for name in SHIPPED {
        let scene = shipped(name);
        let packed = pack(&scene, &scene.cameras[0], settings(&scene, (37, 29), 1));
        let region = Region { x: 3, y: 2, width: 33, height: 26 };
        let tile = |isa, method| {
            let planned = cpu::Planned::new(SceneView::new(&packed, Traversal::from(method)), isa);
            let mut film = planned.film(region);
            let secondary = planned.add::<f32>(&packed.view, region, 0..1, &mut film, &());
            (film, secondary)
        };
        let wanted = tile(Isa::Baseline, Method::IfIf);
        for isa in Isa::here() {
            for method in Method::ALL {
                assert!(tile(isa, method) == wanted, "{name}, {isa:?}, {method:?}");
            }
        }
    }
}
