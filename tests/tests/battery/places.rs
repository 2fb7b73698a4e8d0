//! Scenes of any size at any place, against double precision on the same single-precision mesh.
//!
//! The bound of t: a sheared vertex is off by less than 8 roundoffs of its distance from the origin, and a weight by
//! as much, times how thin the triangle is; both move the hit along the plane, and the ray by as much over its cosine.

use eyerays::cpu;
use eyerays::job::Job;
use eyerays::method::{Method, Order};
use eyerays::picture::Picture;
use eyerays::scene::{Light, Projection, Scene};
use eyerays::stream::{Stream, StreamRay};
use eyerays_command::bench::Kind;
use eyerays_command::bench::rays::{CameraRays, PrimaryHits};
use eyerays_shader::data::Primitive;
use eyerays_shader::real::Scalar;
use eyerays_tests::machine::Machine;
use eyerays_tests::model::{add, empty, glowing, lamp, matt, sun};
use eyerays_tests::surface::Surface;
use eyerays_tests::{count, differences, in_double_precision, pack, shipped};
use glam::{DVec3, Vec3};

use crate::against::is_crowded;

/// Half the distance from 1 to the next number.
const ROUNDOFF: f64 = 1.0 / (1 << 24) as f64;

/// A shipped scene at another size and place.
fn moved(scale: f64, offset: DVec3) -> Scene {
    let mut scene = shipped("whitted");
    let place = |p: Vec3| (p.as_dvec3() * scale + offset).as_vec3();
    scene.mesh.positions.iter_mut().for_each(|p| *p = place(*p));
    for sphere in &mut scene.spheres {
        (sphere.center, sphere.radius) = (place(sphere.center), (f64::from(sphere.radius) * scale) as f32);
    }
    for camera in &mut scene.cameras {
        (camera.eye, camera.target) = (place(camera.eye), place(camera.target));
    }
    for light in &mut scene.lights {
        match light {
            Light::Point { position, .. } => *position = place(*position),
            Light::Spot { position, target, .. } => (*position, *target) = (place(*position), place(*target)),
            Light::Directional { .. } => {}
        }
    }
    scene.materials.iter_mut().filter_map(|m| m.checker.as_mut()).for_each(|c| c.size *= scale as f32);
    scene
}

/// The largest error of t that is promised for a hit.
fn bound(triangle: &Primitive, ray: &StreamRay) -> f64 {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let [a, b, c] = triangle.vertices().map(|v| v.as_dvec3() - origin);
    let reach = a.length().max(b.length()).max(c.length());
    let longest = (b - a).length().max((c - a).length()).max((c - b).length());
    let normal = (b - a).cross(c - a);
    let cosine = (normal.normalize().dot(direction) / direction.length()).abs();
    let thinness = longest * longest / normal.length();
    16.0 * ROUNDOFF * reach * thinness / cosine / direction.length()
}

/// What was found over rays: those that hit another triangle or none, and the largest error of t over its bound.
struct Apart {
    others: usize,
    error: f64,
    rays: usize,
}

fn compare(machine: Machine, packed: &Job, stream: &Stream) -> Apart {
    let truth = cpu::closest::<f64>(packed, Method::IfIf.into(), 0, stream).expect("threads");
    let got = machine.tracer(packed).closest(Method::Packet.into(), stream);
    let mut apart = Apart { others: 0, error: 0.0, rays: stream.len() };
    for (i, (hit, &record)) in got.iter().zip(&truth).enumerate() {
        let (place, slot) = f64::load(record);
        let triangle = |slot: u32| packed.primitives().get(slot as usize);
        match (triangle(hit.w), triangle(slot)) {
            (Some(a), Some(b)) if a.number() == b.number() => {
                let error = (f64::from(f32::from_bits(hit.x)) - place.x).abs() / bound(b, &stream.ray(i));
                apart.error = apart.error.max(error);
            }
            (None, None) => {}
            _ => apart.others += 1,
        }
    }
    apart
}

/// Pixels whose channels differ by more than a step of 8 bits.
fn visibly_apart(a: &Picture, b: &Picture) -> usize {
    differences(a, b).iter().filter(|&&d| d > 1.0 / 255.0).count()
}

/// At most these shares may hit another triangle and look otherwise.
fn assert_near(what: &str, mut scene: Scene, (others, pixels): (f64, f64)) {
    scene.settings.size = (32, 24);
    let mut packed = pack(&scene, &scene.cameras[0], scene.settings);
    // A sample has to do where each ray meets most triangles.
    if count::full() && !is_crowded(&packed) {
        scene.settings.size = (640, 480);
        packed = pack(&scene, &scene.cameras[0], scene.settings);
    }
    let sight = PrimaryHits::new(&packed, &CameraRays::of(&packed, &packed.view, Order::Tiled), 0).unwrap();
    let truth = in_double_precision(&packed).0;
    for machine in Machine::all() {
        if machine.is_software() && is_crowded(&packed) {
            println!("battery: places, {what}, {machine}: left out, since software ends loops early");
            continue;
        }
        for kind in [Kind::Primary, Kind::Diffuse] {
            let stream = sight.rays(kind, 1.0).unwrap();
            let apart = compare(machine, &packed, &stream);
            let what = format!("places, {what}, {kind:?} rays");
            count::line(format_args!("{what} with another triangle"), machine, apart.others, apart.rays);
            println!("battery: {what}, {machine}: largest error of t {:.3} of its bound", apart.error);
            assert!(apart.others as f64 <= others * apart.rays as f64, "{what}, {machine}: {}", apart.others);
            assert!(apart.error <= 1.0, "{what}, {machine}: {} of the bound", apart.error);
        }
        if machine.is_software() && !count::full() {
            // It would compile the kernels of every scene.
            continue;
        }
        let (picture, rays) = machine.render(&packed);
        let (apart, total) = (visibly_apart(&picture, &truth), picture.pixels.len());
        count::none(format_args!("places, {what}, pixels that lost light"), machine, rays.non_finite as usize, total);
        count::line(format_args!("places, {what}, pixels that look otherwise"), machine, apart, total);
        assert!(apart as f64 <= pixels * total as f64, "{what}, {machine}: {apart} of {total}");
    }
}

#[test]
fn scales() {
    for scale in [1e-6, 1.0, 1e4, 1e8] {
        assert_near(&format!("scale {scale:e}"), moved(scale, DVec3::ZERO), (0.01, 0.01));
    }
}

#[test]
fn offsets() {
    for (offset, others, pixels) in
        [(1e3, 0.01, 0.01), (1e4, 0.01, 0.02), (1e5, 0.01, 0.1), (1e6, 0.05, 0.5), (1e7, 0.2, 1.0)]
    {
        let scene = moved(1.0, DVec3::new(1.0, 0.3, -0.7) * offset);
        assert_near(&format!("offset {offset:e}"), scene, (others, pixels));
    }
}

/// A ball of radius 1e-4 beside a wall of edge 1e6.
fn small_beside_large() -> Scene {
    let mut scene = empty();
    let ball = Surface::sphere(DVec3::ZERO, 1e-4, 20);
    add(&mut scene, matt(Vec3::new(0.9, 0.5, 0.4)), &ball.positions, &ball.triangles);
    let wall = [Vec3::new(-5e5, -5e5, -5e5), Vec3::new(5e5, -5e5, -5e5), Vec3::new(0.0, 5e5, -5e5)];
    add(&mut scene, glowing(Vec3::X), &wall, &[[0, 1, 2]]);
    let camera = &mut scene.cameras[0];
    (camera.eye, camera.target, camera.projection) =
        (Vec3::new(1e-4, 2e-4, 5e-4), Vec3::ZERO, Projection::Perspective { fov: 50.0 });
    scene.ambient = Vec3::splat(0.2);
    scene.lights = vec![sun(Vec3::new(-0.5, -1.0, -0.6)), lamp(Vec3::new(3e-4, 4e-4, 2e-4))];
    scene
}

/// Triangles of the ball are 1e-12 of the scene.
#[test]
fn small_and_large() {
    let mut scene = small_beside_large();
    let slab = Surface::plane(DVec3::Y * -1e-4, 1e-3, 8);
    add(&mut scene, matt(Vec3::ONE), &slab.positions, &slab.triangles);
    assert_near("1e-4 beside 1e6", scene, (0.005, 0.01));
}

/// A floor whose triangles are 1e9 times the ball is known to single precision only: what lies on it is off by more
/// than the ball, within the bound, and its light is anything.
#[test]
fn small_on_large() {
    let mut scene = small_beside_large();
    let floor = Surface::plane(DVec3::Y * -1e-4, 1e6, 4);
    add(&mut scene, matt(Vec3::ONE), &floor.positions, &floor.triangles);
    assert_near("1e-4 on 1e6", scene, (0.005, 1.0));
}
