//! Motion blur: what moves while the shutter is open, against what it is at each moment, and against closed forms.

use eyerays::cpu;
use eyerays::gpu::{self, AdapterRequest};
use eyerays::method::{Method, Traversal};
use eyerays::picture::Picture;
use eyerays::scene::{
    Camera, Instance, Integrator, Light, Material, Mesh, Motion, Object, PixelFilter, Primitives, Projection, Sampler,
    Scene, Settings, Transport, Visibility,
};
use eyerays_tests::model::{add_box, add_wall, empty, glass, glowing, lamp, matt, mirror, sun};
use eyerays_tests::{assert_same_bits, gpu, on_cpu, pack, quick_gpu, traversals};
use fastrand::Rng;
use glam::{DMat3, DQuat, DVec3, Vec3};

const SIZE: (u32, u32) = (40, 30);

fn unit(rng: &mut Rng) -> f64 {
    2.0 * rng.f64() - 1.0
}

fn point(rng: &mut Rng) -> DVec3 {
    DVec3::new(unit(rng), unit(rng), unit(rng))
}

fn object(name: &str, primitives: Primitives) -> Object {
    Object { name: name.into(), primitives, bounds: [Vec3::ZERO; 2], visibility: Visibility::default() }
}

/// Two far corners, so that a scene is normalised alike whatever moves in it.
fn frame(scene: &mut Scene) {
    for corner in [Vec3::splat(-9.0), Vec3::splat(9.0)] {
        add_box(scene, matt(Vec3::splat(0.4)), corner - 0.25, corner + 0.25);
    }
}

/// A heap of tetrahedra, each an object, of which some turn on their way, some change their shape, and some stand still, below a lamp
/// that moves, at a time of the shutter.
fn heap(seed: u64, time: f32) -> Scene {
    let mut rng = Rng::with_seed(seed);
    let mut scene = empty();
    frame(&mut scene);
    add_wall(&mut scene, mirror(Vec3::splat(0.7)), Vec3::new(0.0, 0.0, -3.0), 4.0);
    scene.objects = vec![object("ground", Primitives::Triangles(0..scene.mesh.triangles.len()))];
    for number in 0..24 {
        let colour = Vec3::new(rng.f32(), rng.f32(), rng.f32());
        let material = if number % 8 == 0 { glass(colour) } else { matt(colour) };
        let (at, size) = (point(&mut rng) * 2.5, 0.3 + 0.6 * rng.f64());
        let corners = [0; 4].map(|_| at + point(&mut rng) * size);
        let (way, bend) = (point(&mut rng), [0; 4].map(|_| point(&mut rng)));
        let moved = |corner: usize| {
            let shift = match number % 3 {
                0 => DVec3::ZERO,
                1 => way,
                _ => bend[corner],
            };
            (corners[corner] + shift * f64::from(time)).as_vec3()
        };
        let first = scene.mesh.triangles.len();
        let places = [0, 1, 2, 3].map(moved);
        eyerays_tests::model::add(&mut scene, material, &places, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]);
        scene.objects.push(object("tetrahedron", Primitives::Triangles(first..scene.mesh.triangles.len())));
    }
    scene.lights = vec![sun(Vec3::new(0.3, -1.0, -0.4)), lamp(Vec3::new(-2.0 + 3.0 * time, 4.0, 3.0))];
    let eye = Vec3::new(1.0, 2.5, 7.0);
    scene.cameras = vec![Camera::new("front", eye, Vec3::ZERO, Projection::Perspective { fov: 45.0 })];
    scene
}

/// A scene over the time of the shutter in so many steps.
fn over(scene: impl Fn(f32) -> Scene, steps: usize, exposure: f32) -> Scene {
    let later: Vec<Scene> = (1..=steps).map(|step| scene(step as f32 / steps as f32)).collect();
    let moved = scene(0.0).over(&later, exposure).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(moved.left, [""; 0]);
    moved.scene
}

/// The same with copies of a box that turn and stretch, in `steps` steps.
fn with_copies(seed: u64, steps: usize, exposure: f32) -> Scene {
    let mut scene = over(|time| heap(seed, time), steps, exposure);
    let mut rng = Rng::with_seed(seed + 100);
    let mut motion = scene.motion.take().unwrap();
    let mut own = empty();
    add_box(&mut own, matt(Vec3::ONE), Vec3::splat(-0.5), Vec3::splat(0.5));
    let (vertex, triangle) = (scene.mesh.positions.len(), scene.mesh.triangles.len());
    let Mesh { positions, triangles, .. } = own.mesh;
    scene.mesh.positions.extend(positions);
    scene.mesh.triangles.extend(triangles.iter().map(|corners| corners.map(|corner| vertex as u32 + corner)));
    scene.mesh.materials.resize(scene.mesh.triangles.len(), 3);
    let mesh = scene.shared.len() as u32;
    scene.shared.push(eyerays::scene::SharedMesh {
        vertices: vertex..scene.mesh.positions.len(),
        triangles: triangle..scene.mesh.triangles.len(),
    });
    let first = scene.instances.len();
    for _ in 0..8 {
        let mut copy = || {
            let turn = DMat3::from_quat(DQuat::from_scaled_axis(point(&mut rng) * 2.0)) * (0.4 + 0.4 * rng.f64());
            let rows = turn.transpose();
            let rows = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.as_vec3());
            Instance { mesh, rows, translation: (point(&mut rng) * 2.5).as_vec3() }
        };
        scene.instances.push(copy());
        motion.poses.iter_mut().for_each(|pose| pose.instances.push(copy()));
    }
    scene.objects.push(object("boxes", Primitives::Instances(first..first + 8)));
    scene.motion = Some(motion);
    scene
}

/// The scene as it is at a time, of which kernels say the step and the share of it, with nothing shared.
fn at(scene: &Scene, time: f32) -> Scene {
    let Motion { poses, .. } = scene.motion.as_ref().unwrap();
    let steps = poses.len();
    let step = ((time * steps as f32) as usize).min(steps - 1);
    let share = time * steps as f32 - step as f32;
    let line = |a: Vec3, b: Vec3| a + (b - a) * share;
    let mut still = Scene { motion: None, ..scene.clone() };
    for (place, &number) in scene.motion.iter().flat_map(|motion| motion.lights.iter().enumerate()) {
        let before = if step == 0 { &scene.lights[number as usize] } else { &poses[step - 1].lights[place] };
        let (Light::Point { position: from, .. }, Light::Point { position: to, .. }) =
            (before, &poses[step].lights[place])
        else {
            panic!("other lights turn, which rounds")
        };
        still.lights[number as usize] = lamp(line(*from, *to));
    }
    let from = |copy: usize| if step == 0 { scene.instances[copy] } else { poses[step - 1].instances[copy] };
    for (number, copy) in still.instances.iter_mut().enumerate() {
        let (a, b) = (from(number), poses[step].instances[number]);
        if poses.iter().any(|pose| pose.instances[number] != scene.instances[number]) {
            copy.rows = [0, 1, 2].map(|row| line(a.rows[row], b.rows[row]));
            copy.translation = line(a.translation, b.translation);
        }
    }
    for (place, (mesh, shape)) in poses[step].shapes.iter().enumerate() {
        let range = scene.shared[*mesh as usize].vertices.clone();
        let before = match step {
            0 => &scene.mesh.positions[range.clone()],
            _ => &poses[step - 1].shapes[place].1.positions[..],
        };
        let between = before.iter().zip(&shape.positions).map(|(&a, &b)| line(a, b));
        still.mesh.positions[range].iter_mut().zip(between).for_each(|(to, place)| *to = place);
    }
    still.flattened()
}

fn whitted(spp: u32) -> Settings {
    let (size, pixel_filter) = (SIZE, Some(PixelFilter::Box));
    Settings { size, spp, bounces: 4, sampler: Sampler::Sobol, pixel_filter, ..Settings::default() }
}

fn path(spp: u32) -> Settings {
    Settings { transport: Transport { integrator: Integrator::Path, ..Transport::default() }, ..whitted(spp) }
}

fn picture(scene: &Scene, settings: Settings) -> Picture {
    on_cpu(&pack(scene, &scene.cameras[0], settings)).0
}

/// With a rolling shutter that exposes each row for no time, a row is of one moment: of the very scene that is there then.
#[test]
fn each_row_has_the_bits_of_the_scene_at_its_moment() {
    for (seed, steps) in [(1, 1), (2, 3), (3, 4)] {
        let scene = with_copies(seed, steps, 0.0);
        let moved = scene.motion.as_ref().unwrap();
        assert!(moved.bent().count() >= 8 && scene.instances.len() >= 16 && moved.lights == [1]);
        for settings in [whitted(2), path(2)] {
            let got = picture(&scene, settings);
            let delay = 1.0 / SIZE.1 as f32;
            for row in (0..SIZE.1).step_by(7) {
                let want = picture(&at(&scene, row as f32 * delay), settings);
                for column in 0..SIZE.0 {
                    let [want, got] = [&want, &got].map(|of| of.pixel(column, row).unwrap().map(f32::to_bits));
                    assert_eq!(want, got, "seed {seed}, {steps} steps, pixel {column},{row}");
                }
            }
        }
    }
}

#[test]
fn every_method_and_device_shows_the_same_blur() {
    let scene = with_copies(5, 3, 0.4);
    let posed = pack(&scene, &scene.cameras[0], whitted(4));
    let want = on_cpu(&posed).0;
    for traversal in traversals() {
        let got = cpu::render::<f32>(&posed.packed, &posed.view, traversal, 0, &|_| ()).unwrap().0;
        assert_same_bits(&want, &got, &format!("{traversal:?}"));
    }
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    for method in [Method::IfIf, Method::WhileWhile, Method::Wide, Method::Packet, Method::InterleavedCut] {
        let mut renderer = gpu::Renderer::new(&gpu, &posed.packed, true, method).unwrap();
        let got = renderer.render(&posed.view, &|_| ()).unwrap().film.develop().unwrap();
        assert_same_bits(&want, &got, &format!("{method:?}"));
    }
}

/// A camera that moves and turns, too.
fn panned(scene: Scene, steps: usize) -> Scene {
    let camera = |time: f32| {
        let eye = Vec3::new(1.0 + time, 2.5, 7.0 - time);
        Camera::new("front", eye, Vec3::new(time, 0.0, 0.0), Projection::Perspective { fov: 45.0 })
    };
    let mut motion = scene.motion.unwrap();
    motion.cameras = vec![camera(0.0)];
    motion.poses.iter_mut().zip(1..).for_each(|(pose, step)| pose.cameras = vec![camera(step as f32 / steps as f32)]);
    Scene { motion: Some(motion), cameras: vec![camera(0.0)], ..scene }
}

#[test]
fn a_gpu_traces_paths_before_a_camera_that_moves() {
    let Some(gpu) = quick_gpu() else { return };
    let scene = panned(with_copies(6, 2, 1.0), 2);
    let posed = pack(&scene, &scene.cameras[0], path(4));
    let want = on_cpu(&posed).0;
    assert!(!want.bits_equal(&picture(&Scene { motion: None, ..scene.clone() }, path(4))));
    let mut renderer = gpu::Renderer::new(&gpu, &posed.packed, true, Traversal::default()).unwrap();
    let got = renderer.render(&posed.view, &|_| ()).unwrap().film.develop().unwrap();
    assert_same_bits(&want, &got, "paths");
}

#[test]
fn what_stands_still_has_no_motion() {
    let still = heap(4, 0.0);
    let moved = still.clone().over(&[still.clone(), still.clone()], 1.0).unwrap();
    assert_eq!(moved.scene, still);
    let other = Scene { objects: Vec::new(), ..still.clone() };
    assert!(still.clone().over(&[other], 1.0).unwrap_err().message().contains("other objects"));
    let more = vec![still.clone(); Motion::MOST_STEPS + 1];
    assert!(still.over(&more, 1.0).unwrap_err().message().contains("64 are the most"));
}

/// Bright surfaces before black, seen from far in front, 4 units wide.
fn bright(scene: &mut Scene, corners: [Vec3; 4]) {
    let material = Material { visibility: Visibility::default(), ..glowing(Vec3::ONE) };
    eyerays_tests::model::add_quad(scene, material, corners);
    scene.objects.push(object("bright", Primitives::Triangles(0..2)));
    scene.ambient = Vec3::ONE;
    let projection = Projection::Orthographic { height: 3.0 };
    scene.cameras = vec![Camera::new("front", Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, projection)];
}

/// How much of a pixel a surface covers in the mean over time, by `inside` of places and times: by so many points each.
fn share(column: u32, row: u32, inside: impl Fn(f64, f64, f64) -> bool) -> f64 {
    const PLACES: u32 = 8;
    const TIMES: u32 = 256;
    let edge = 3.0 / f64::from(SIZE.1);
    let middle = |i: u32, of: u32| (f64::from(i) + 0.5) / f64::from(of);
    let mut covered = 0u32;
    for (x, y) in (0..PLACES).flat_map(|x| (0..PLACES).map(move |y| (x, y))) {
        let right = (f64::from(column) + middle(x, PLACES)) * edge - 2.0;
        let up = 1.5 - (f64::from(row) + middle(y, PLACES)) * edge;
        covered += (0..TIMES).filter(|&time| inside(right, up, middle(time, TIMES))).count() as u32;
    }
    f64::from(covered) / f64::from(PLACES * PLACES * TIMES)
}

/// Compares each pixel with its share: by three standard errors of its samples, and what the points above are off.
fn compare(scene: &Scene, inside: impl Fn(f64, f64, f64) -> bool + Copy, off: f64) {
    let spp = 256;
    let got = picture(scene, whitted(spp));
    let (mut sum, mut want_sum) = (0.0, 0.0);
    for (column, row) in (0..SIZE.0).flat_map(|x| (0..SIZE.1).map(move |y| (x, y))) {
        let want = share(column, row, inside);
        let value = f64::from(got.pixel(column, row).unwrap()[0]);
        let error = (want * (1.0 - want) / f64::from(spp)).sqrt();
        assert!((value - want).abs() <= 3.0 * error + off, "{column},{row}: {value} instead of {want}");
        (sum, want_sum) = (sum + value, want_sum + want);
    }
    assert!((sum / want_sum - 1.0).abs() < 5e-3, "{sum} of {want_sum} in all");
}

#[test]
fn a_square_at_constant_speed_covers_pixels_for_its_share_of_the_time() {
    let way = Vec3::new(1.7, 0.6, 0.0);
    let scene = over(
        |time| {
            let mut scene = empty();
            let corner = |x: f32, y: f32| Vec3::new(x - 1.0, y - 0.3, 0.0) + way * time;
            bright(&mut scene, [corner(-0.4, -0.4), corner(0.4, -0.4), corner(0.4, 0.4), corner(-0.4, 0.4)]);
            scene
        },
        1,
        1.0,
    );
    let inside = |x: f64, y: f64, time: f64| {
        let way = way.as_dvec3() * time;
        (x + 1.0 - way.x).abs() < 0.4 && (y + 0.3 - way.y).abs() < 0.4
    };
    compare(&scene, inside, 0.01);
}

#[test]
fn a_bar_that_turns_covers_them_as_long_as_it_should() {
    let scene = over(
        |time| {
            let mut scene = empty();
            let turn = glam::Quat::from_rotation_z(2.0 * time);
            let corner = |x: f32, y: f32| turn * Vec3::new(x, y, 0.0);
            bright(&mut scene, [corner(-1.2, -0.15), corner(1.2, -0.15), corner(1.2, 0.15), corner(-1.2, 0.15)]);
            scene
        },
        16,
        1.0,
    );
    let inside = |x: f64, y: f64, time: f64| {
        let (sine, cosine) = (2.0 * time).sin_cos();
        (cosine * x + sine * y).abs() < 1.2 && (cosine * y - sine * x).abs() < 0.15
    };
    // Sixteen chords of 0.125 radians are 0.0024 units of 1.2 inside their arc.
    compare(&scene, inside, 0.04);
}

/// In free flight: the middle of a triangle falls by half of g t^2.
#[test]
fn what_falls_is_longer_where_it_is_slow() {
    let height = |time: f64| 1.0 - 2.2 * time * time;
    let scene = over(
        |time| {
            let mut scene = empty();
            let down = height(f64::from(time)) as f32;
            let corner = |x: f32, y: f32| Vec3::new(x, y + down, 0.0);
            bright(&mut scene, [corner(-0.3, -0.2), corner(0.3, -0.2), corner(0.3, 0.2), corner(-0.3, 0.2)]);
            scene
        },
        32,
        1.0,
    );
    compare(&scene, |x, y, time| x.abs() < 0.3 && (y - height(time)).abs() < 0.2, 0.02);
}

/// Everything moves as one with the camera: the picture is that of what stands still, but for rounding, which chance turns into noise.
#[test]
fn a_camera_that_goes_along_sees_no_motion() {
    let way = Vec3::new(3.0, -1.0, 2.0);
    let scene = |time: f32| {
        let mut scene = heap(7, 0.0);
        scene.mesh.positions.iter_mut().for_each(|place| *place += way * time);
        scene.lights = vec![sun(Vec3::new(0.3, -1.0, -0.4))];
        scene
            .cameras
            .iter_mut()
            .for_each(|camera| (camera.eye, camera.target) = (camera.eye + way * time, camera.target + way * time));
        scene
    };
    let moving = over(scene, 1, 1.0);
    assert_eq!(moving.motion.as_ref().unwrap().cameras.len(), 1);
    let [want, got] = [&scene(0.0), &moving].map(|scene| picture(scene, whitted(64)));
    let mut odd = 0;
    for (column, row) in (0..SIZE.0).flat_map(|x| (0..SIZE.1).map(move |y| (x, y))) {
        let [want, got] = [&want, &got].map(|of| Vec3::from(of.pixel(column, row).unwrap()));
        // Samples at edges fall to either side of them.
        odd += usize::from((want - got).abs().max_element() > 3.0 / 64.0);
    }
    assert!(odd <= 2, "{odd} pixels differ by more than three samples");
}
