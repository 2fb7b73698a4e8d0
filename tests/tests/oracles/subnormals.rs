//! No subnormal number is used but where it is flushed, so that a device which flushes all gives the same picture.

use eyerays::device_scene::SceneView;
use eyerays::method::Traversal;
use eyerays::stream::{Stream, StreamRay};
use eyerays_shader::ray::Hit;
use eyerays_shader::real::{Scalar, V3};
use eyerays_shader::stage::{self, Found};
use eyerays_shader::traverse::{self, CwbvhMethod, IfIf, Primitives};
use eyerays_tests::numbers::{Counting, Flushing, picture, subnormals};
use eyerays_tests::{Posed, SHIPPED, count, pack, settings, shipped};
use glam::{UVec4, Vec3};

use super::corpus::{Case, cases};
use super::hits::crossed;

/// The bits of a picture.
fn bits<R: Scalar>(packed: &Posed) -> Vec<[u32; 3]> {
    let pixel = |p: V3<R>| [p.x, p.y, p.z].map(|channel| channel.to_f32().to_bits());
    picture::<R>(packed).into_iter().map(pixel).collect()
}

/// The bits of (t, u, v) and the primitive of each ray.
fn hits<R: Scalar<Record = UVec4>, M: traverse::Method<R>>(case: &Case) -> Vec<UVec4> {
    let stream = Stream::new(case.rays.iter().copied());
    let (laid, frame) = (SceneView::new(&case.packed, Traversal::default()), case.packed.stream_frame(stream.len()));
    let geometry = laid.stream(&frame);
    // Parts of a split triangle are hit alike, so the slot is no part of the answer.
    let primitive = |slot: u32| case.packed.primitives().get(slot as usize).map_or(slot, |t| t.number());
    let hit = |slot: u32| {
        let Found { t, coordinates: (u, v), index, .. } =
            stage::trace::<R, M, Primitives>(&geometry, (slot, 0.0), stream.words());
        R::store(V3::new(t, u, v), primitive(index))
    };
    (0..stream.len() as u32).map(hit).collect()
}

/// One test for pictures and streams, since the counts are of the whole process.
#[test]
fn none_is_used_over_scenes_and_rays() {
    let edge = count::of(64, 512) as u32;
    let (mut pixels, mut rays) = (0, 0);
    for name in SHIPPED {
        let scene = shipped(name);
        for camera in &scene.cameras {
            let packed = pack(&scene, camera, settings(&scene, (edge, edge * 3 / 4), 1));
            let alone = bits::<f32>(&packed);
            assert!(bits::<Counting>(&packed) == alone, "{name}, camera {}", camera.name);
            assert!(bits::<Flushing>(&packed) == alone, "{name}, camera {}, on a device that flushes", camera.name);
            pixels += alone.len();
        }
    }
    for case in cases(count::of(10_000, 1_000_000)) {
        let alone = hits::<f32, IfIf>(&case);
        assert!(hits::<Counting, IfIf>(&case) == alone, "{}", case.name);
        assert!(hits::<Counting, CwbvhMethod>(&case) == alone, "{}", case.name);
        assert!(hits::<Flushing, IfIf>(&case) == alone, "{}, on a device that flushes", case.name);
        rays += alone.len();
    }
    let found = subnormals();
    println!("{} subnormal operands in {pixels} pixels and {rays} rays", found.values().sum::<u64>());
    assert!(found.is_empty(), "subnormal operands, by place in the kernels: {found:#?}");
}

/// Zero, or of a size between 2^-60, the least that a coordinate has, and 1; often beside another in the last places.
fn coordinate(rng: &mut fastrand::Rng) -> f32 {
    let size = match rng.u32(0..4) {
        0 => 0.0,
        1 => 2f32.powi(-60) * (1.0 + rng.u32(0..4) as f32 * f32::EPSILON),
        2 => 2f32.powi(rng.i32(-60..0)) * (1.0 + rng.u32(0..4) as f32 * f32::EPSILON),
        _ => 2f32.powf(-60.0 * rng.f32()),
    };
    if rng.bool() { size } else { -size }
}

/// Is a triangle hit, and the bits of the crossing if so.
fn crossing<R: Scalar>([origin, towards, a, b, c]: [Vec3; 5]) -> Option<[u32; 4]> {
    let ray = StreamRay { origin, direction: towards - origin, limit: f32::MAX, source_primitive: Hit::<f32>::NOTHING };
    let crossing = crossed::<R>([a, b, c], &ray);
    let found = [crossing.depth, crossing.area, crossing.u, crossing.v];
    crossing.inside.then_some(found.map(|x| x.to_f32().to_bits()))
}

/// The sheared vertices and the products of the edges are subnormal here; what is told of them is not.
#[test]
fn a_device_that_flushes_tells_the_same_of_tiny_triangles() {
    let mut rng = fastrand::Rng::with_seed(0x71_47);
    let count = count::of(4_000_000, 400_000_000);
    let (mut apart, mut inside) = (0, 0);
    for _ in 0..count {
        let mut points = [Vec3::ZERO; 5].map(|_| Vec3::from_array([0; 3].map(|_| coordinate(&mut rng))));
        if rng.bool() {
            points[1] = points[2 + rng.usize(0..3)];
        }
        let found = crossing::<f32>(points);
        inside += usize::from(found.is_some());
        apart += usize::from(found != crossing::<Flushing>(points));
    }
    println!("{apart} of {count} triangles are met otherwise on a device that flushes, {inside} are hit");
    assert!(apart == 0 && inside > count / 1000);
}
