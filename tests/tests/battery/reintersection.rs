//! Rays that leave a surface do not meet it again (PBRT's reintersection test), and light does not leak.

use eyerays::device_scene::SceneView;
use eyerays::job::Job;
use eyerays::scene::{Projection, Scene, Settings};
use eyerays::stream::StreamRay;
use eyerays_shader::data::Primitive;
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{Fast, Scalar, V3};
use eyerays_shader::traverse::{Closest, Leaf, Primitives};
use eyerays_tests::machine::Machine;
use eyerays_tests::model::{add, add_box, empty, glowing, lamp, matt};
use eyerays_tests::random::Random;
use eyerays_tests::surface::Surface;
use eyerays_tests::{count, pack};
use glam::{DMat3, DVec3, Vec3};

/// Where coordinates lie: 10 to a power in this range, of either sign.
const POWERS: (f64, f64) = (-8.0, 8.0);

/// A triangle alone in a scene that reaches as far as `end`: to a triangle without extent, which no ray meets.
fn alone(vertices: [Vec3; 3], end: Vec3) -> Job {
    let mut scene = empty();
    add(&mut scene, matt(Vec3::ONE), &vertices, &[[0, 1, 2]]);
    add(&mut scene, matt(Vec3::ONE), &[end], &[[0, 0, 0]]);
    pack(&scene, &scene.cameras[0], scene.settings).packed
}

/// Rays that met the triangle again which they left, of how many.
#[derive(Default)]
struct Returned {
    /// Without regard to the number of the triangle that they leave, as they start.
    by_start: usize,
    /// Those of them from triangles no thinner than a fifth of their length, of how many.
    by_start_of_stout: usize,
    stout: usize,
    /// As renderings trace them.
    met: usize,
    rays: usize,
}

/// Is a triangle's height at least a fifth of its length? A start's error_offset is made for such. The normal of a thinner
/// one, whose edges nearly cancel in its product, may be any, and a step along it lead nowhere off the plane: it is
/// the number of the triangle that a ray can't meet again.
fn is_stout([a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length().max((c - a).length()).max((c - b).length());
    (b - a).cross(c - a).length() > 0.2 * longest * longest
}

/// Does a ray meet the only triangle of a scene?
fn meets<R: Scalar>(packed: &Job, ray: Ray<R>) -> bool {
    let (laid, frame) = (SceneView::new(packed, Default::default()), packed.stream_frame(1));
    let mut hit = Hit::none(R::splat(f32::MAX));
    Primitives::intersect::<Closest, R>(&laid.stream(&frame), (0, u32::MAX), &ray, &mut hit);
    hit.primitive_index != StreamRay::NOWHERE
}

/// Sends a ray at a triangle and, from where it meets it, `count` rays every way by each of the two starts.
fn leave<R: Scalar>(random: &mut Random, count: usize, returned: &mut Returned) {
    let place = |random: &mut Random| random.magnitudes(POWERS.0, POWERS.1);
    let vertices: [Vec3; 3] = std::array::from_fn(|_| place(random));
    let eye = place(random);
    let packed = alone(vertices, eye);
    let triangle: Primitive = packed.primitives()[0];
    let [a, b, c] = triangle.vertices().map(|v| v.as_dvec3());
    let [u, v, w] = random.weights();
    let origin = packed.normalisation().place(eye);
    let direction = (a * u + b * v + c * w - origin.as_dvec3()).normalize().as_vec3();
    let (origin, direction) = (V3::<R>::splat(origin), V3::<R>::splat(direction));
    let (laid, frame) = (SceneView::new(&packed, Default::default()), packed.stream_frame(1));
    let mut hit = Hit::none(R::splat(f32::MAX));
    Primitives::intersect::<Closest, R>(&laid.stream(&frame), (0, u32::MAX), &Ray::new(origin, direction), &mut hit);
    if hit.primitive_index == StreamRay::NOWHERE {
        return;
    }
    let (u, v) = hit.coordinates();
    let contact = SurfaceInteraction::new(packed.effects(), &triangle, (u, v), direction);
    let is_stout = is_stout([a, b, c]);
    for _ in 0..count {
        let out = V3::<R>::splat(random.direction().as_vec3()).normalised().0;
        for start in [contact.offset_ray_origin(out), contact.offset_ray_origin_along(out)] {
            let by_start = usize::from(meets(&packed, Ray::new(start, out)));
            returned.by_start += by_start;
            returned.by_start_of_stout += if is_stout { by_start } else { 0 };
            returned.stout += usize::from(is_stout);
            returned.met += usize::from(meets(&packed, Ray::leaving(triangle.number(), start, out)));
            returned.rays += 1;
        }
    }
}

fn assert_none_returns<R: Scalar>(machine: &str) {
    let (mut random, mut returned, mut left) = (Random::new(11), Returned::default(), 0);
    let (triangles, rays) = (count::of(500, 1000), count::of(200, 1000));
    // Some are missed: a triangle that is next to none has no inside.
    while left < triangles {
        let before = returned.rays;
        leave::<R>(&mut random, rays, &mut returned);
        left += usize::from(returned.rays > before);
    }
    count::line("self-hits, by the start alone", machine, returned.by_start, returned.rays);
    count::none("self-hits, by the start alone, stout", machine, returned.by_start_of_stout, returned.stout);
    count::none("self-hits", machine, returned.met, returned.rays);
}

#[test]
fn rays_that_leave_do_not_return() {
    assert_none_returns::<f32>("cpu exact");
    assert_none_returns::<Fast>("cpu fast");
}

/// Places, sizes and turns of a body.
fn placed(corners: &mut [Vec3], turn: f64, scale: f64, offset: DVec3) {
    let turn = DMat3::from_rotation_y(turn) * DMat3::from_rotation_x(0.7 * turn);
    corners.iter_mut().for_each(|corner| *corner = (turn * corner.as_dvec3() * scale + offset).as_vec3());
}

/// Turn, scale and offset.
const PLACES: [(f64, f64, DVec3); 5] = [
    (0.0, 1.0, DVec3::ZERO),
    (0.6, 1.0, DVec3::ZERO),
    (0.3, 1e-6, DVec3::ZERO),
    (0.9, 1e6, DVec3::ZERO),
    (0.4, 1.0, DVec3::new(1000.0, -300.0, 500.0)),
];

/// A closed room on a floor that goes on outside.
fn room() -> Scene {
    let mut scene = empty();
    add_box(&mut scene, matt(Vec3::ONE), Vec3::NEG_ONE, Vec3::ONE);
    let floor = Surface::plane(DVec3::NEG_Y, 6.0, 9);
    add(&mut scene, matt(Vec3::ONE), &floor.positions, &floor.triangles);
    scene.settings = Settings { size: (count::of(48, 512) as u32, count::of(36, 384) as u32), ..scene.settings };
    scene
}

/// Lights a room from a place that is seen from none of its other side: the picture is exactly black.
fn assert_dark(what: &str, machine: Machine, light: Vec3, eye: Vec3, target: Vec3) {
    let (mut lit, mut pixels) = (0, 0);
    for (turn, scale, offset) in PLACES {
        let mut scene = room();
        let mut points = [light, eye, target];
        placed(&mut scene.mesh.positions, turn, scale, offset);
        placed(&mut points, turn, scale, offset);
        scene.lights = vec![lamp(points[0])];
        (scene.cameras[0].eye, scene.cameras[0].target, scene.cameras[0].projection) =
            (points[1], points[2], Projection::Perspective { fov: 80.0 });
        let packed = pack(&scene, &scene.cameras[0], scene.settings);
        let (picture, rays) = machine.render(&packed);
        assert!(rays.shadow > 0 && rays.non_finite == 0, "{what}, {machine}: {rays:?}");
        lit += picture.pixels.iter().filter(|pixel| **pixel != [0.0; 3]).count();
        pixels += picture.pixels.len();
    }
    count::none(format_args!("leaks of light, {what}"), machine, lit, pixels);
}

#[test]
fn light_does_not_leak() {
    for machine in Machine::all() {
        let (inside, corner) = (Vec3::new(0.2, 0.1, -0.3), Vec3::new(0.9, -0.9, 0.9));
        let outside = Vec3::new(3.0, 1.5, 2.5);
        assert_dark("out of a closed box", machine, inside, outside, corner);
        assert_dark("into a closed box", machine, outside, inside, corner);
        assert_dark("into a closed box, low", machine, Vec3::new(2.5, -0.9, 2.0), inside, corner);
    }
}

/// Pixels of a convex body that its own triangles shadow from a light at the eye: none.
#[test]
fn no_acne() {
    for machine in Machine::all() {
        let (mut dark, mut seen) = (0, 0);
        for (turn, scale, offset) in PLACES {
            let mut body = empty();
            add_box(&mut body, matt(Vec3::ONE), Vec3::new(-1.0, -0.5, -0.7), Vec3::new(1.0, 0.6, 0.8));
            placed(&mut body.mesh.positions, turn, scale, offset);
            let eye = (DVec3::new(1.7, 1.1, 2.1) * scale + offset).as_vec3();
            (body.cameras[0].eye, body.cameras[0].target, body.cameras[0].projection) =
                (eye, offset.as_vec3(), Projection::Perspective { fov: 50.0 });
            body.settings.size = (count::of(64, 512) as u32, count::of(48, 384) as u32);
            let mut shape = body.clone();
            shape.materials = vec![glowing(Vec3::ONE)];
            shape.ambient = Vec3::ONE;
            body.lights = vec![lamp(eye)];
            let picture = |scene: &Scene| machine.render(&pack(scene, &scene.cameras[0], scene.settings)).0;
            let (lit, shape) = (picture(&body), picture(&shape));
            let pixels = || lit.pixels.iter().zip(&shape.pixels).filter(|(_, shape)| shape[0] > 0.0);
            dark += pixels().filter(|(lit, _)| lit[0] == 0.0).count();
            seen += pixels().count();
        }
        count::none("self-hits, dark pixels of a lit body", machine, dark, seen);
    }
}
