//! Hierarchies that are fitted to triangles which have moved find what new ones find.

use eyerays::cpu;
use eyerays::gpu::{self, AdapterRequest};
use eyerays::job::Job;
use eyerays::method::Method;
use eyerays::quality::Bvh;
use eyerays::scene::{Camera, Integrator, Projection, Sampler, Scene, Settings, Transport};
use eyerays::stream::{Question, Stream, StreamRay};
use eyerays_bvh::Quality;
use eyerays_tests::model::{add, empty, glass, lamp, matt, mirror, sun};
use eyerays_tests::{assert_same_bits, gpu, on_cpu, pack_in, quick_gpu};
use fastrand::Rng;
use glam::{DVec2, Vec3};

/// A wavy sheet of so many squares an edge over a mirror, with normals if it is smooth, at a time.
fn sheet(edge: u32, smooth: bool, time: f64) -> Scene {
    let mut scene = empty();
    let height = |at: DVec2| 0.3 * (4.0 * at.x + 3.0 * time).sin() * (5.0 * at.y - 2.0 * time).cos();
    let (mut corners, mut normals) = (Vec::new(), Vec::new());
    for (row, column) in (0..=edge).flat_map(|row| (0..=edge).map(move |column| (row, column))) {
        let at = DVec2::new(f64::from(column), f64::from(row)) * (4.0 / f64::from(edge)) - 2.0;
        corners.push(Vec3::new(at.x as f32, height(at) as f32, at.y as f32));
        let slope = |aside: DVec2| (height(at + aside) - height(at - aside)) / 2e-4;
        let normal = Vec3::new(-slope(DVec2::X * 1e-4) as f32, 1.0, -slope(DVec2::Y * 1e-4) as f32);
        normals.push(if smooth { normal.normalize() } else { Vec3::ZERO });
    }
    let at = |row: u32, column: u32| row * (edge + 1) + column;
    let squares = (0..edge).flat_map(|row| (0..edge).map(move |column| (row, column)));
    let triangles: Vec<[u32; 3]> = squares
        .flat_map(|(row, column)| {
            let [a, b, c, d] = [at(row, column), at(row + 1, column), at(row + 1, column + 1), at(row, column + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    add(&mut scene, matt(Vec3::new(0.7, 0.4, 0.2)), &corners, &triangles);
    let floor = [
        Vec3::new(-5.0, -1.0, 5.0),
        Vec3::new(5.0, -1.0, 5.0),
        Vec3::new(5.0, -1.0, -5.0),
        Vec3::new(-5.0, -1.0, -5.0),
    ];
    add(&mut scene, mirror(Vec3::splat(0.8)), &floor, &[[0, 1, 2], [0, 2, 3]]);
    let ball: Vec<Vec3> =
        [0.0f32, 2.1, 4.2].map(|turn| Vec3::new(turn.cos(), 0.8 + 0.1 * time as f32, turn.sin())).to_vec();
    add(&mut scene, glass(Vec3::splat(0.9)), &ball, &[[0, 1, 2]]);
    if smooth {
        normals.resize(scene.mesh.positions.len(), Vec3::Y);
        scene.mesh.normals = normals;
    }
    scene.lights = vec![sun(Vec3::new(0.3, -1.0, -0.4)), lamp(Vec3::new(-2.0, 4.0, 3.0))];
    let projection = Projection::Perspective { fov: 45.0 };
    scene.cameras = vec![Camera::new("front", Vec3::new(0.5, 2.5, 6.0), Vec3::ZERO, projection)];
    scene
}

fn whitted() -> Settings {
    Settings { size: (64, 48), samples: 2, bounces: 4, ..Settings::default() }
}

fn path() -> Settings {
    let transport = Transport { integrator: Integrator::Path, ..Transport::default() };
    Settings { spp: 4, sampler: Sampler::Sobol, transport, ..whitted() }
}

/// Rays from everywhere to places of the triangles, and to their edges and vertices.
fn rays(job: &Job, count: usize, rng: &mut Rng) -> Stream {
    let aimed = |_| {
        let [a, b, c] = job.primitives()[rng.usize(0..job.primitives().len())].vertices();
        let (u, v) = match rng.u8(0..4) {
            0 => (0.0, 0.0),
            1 => (rng.f32(), 0.0),
            _ => (rng.f32(), rng.f32()),
        };
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let origin = Vec3::new(rng.f32(), rng.f32(), rng.f32()) * 2.0 - 1.0;
        let direction = a + (b - a) * u + (c - a) * v - origin;
        StreamRay { origin, direction, limit: f32::MAX, source_primitive: StreamRay::NOWHERE }
    };
    let rays: Vec<StreamRay> = (0..count).map(aimed).filter(|ray| ray.direction != Vec3::ZERO).collect();
    Stream::new(rays.into_iter())
}

/// What rays find, by the numbers of primitives, whose slots are others.
fn hits(job: &Job, stream: &Stream, method: Method) -> Vec<[u32; 4]> {
    let eyerays::stream::Answers::Closest(words) =
        cpu::cast(job, method.into(), 0, stream, Question::Closest).unwrap().0
    else {
        panic!("hits")
    };
    let number = |slot: u32| job.primitives().get(slot as usize).map_or(u32::MAX, |primitive| primitive.number());
    words[..stream.len()].iter().map(|hit| [hit.x, hit.y, hit.z, number(hit.w)]).collect()
}

#[test]
fn a_million_rays_find_the_same_in_a_tree_that_was_fitted_and_in_a_new_one() {
    let mut rng = Rng::with_seed(1);
    for (edge, quality) in [(3, Bvh::Fast), (40, Bvh::Fast), (40, Bvh::Medium), (40, Bvh::High)] {
        let first = Job::new(&sheet(edge, true, 0.0), whitted(), quality.quality()).unwrap();
        let scene = sheet(edge, true, 0.1);
        let (fitted, new) =
            (first.moved(&scene, whitted()).unwrap(), Job::new(&scene, whitted(), quality.quality()).unwrap());
        assert!(fitted.scene().is_fitted() || quality != Bvh::Fast, "{quality:?}");
        let count = eyerays_tests::count::of(50_000, 1_000_000);
        let stream = rays(&new, count, &mut rng);
        for method in [Method::IfIf, Method::Wide, Method::Packet] {
            let (want, got) = (hits(&new, &stream, method), hits(&fitted, &stream, method));
            let odd = (0..stream.len()).filter(|&ray| want[ray] != got[ray]).count();
            assert_eq!(odd, 0, "{quality:?}, {method:?}");
            assert!(want.iter().filter(|hit| hit[3] != u32::MAX).count() > stream.len() / 2);
        }
    }
}

#[test]
fn a_tree_that_is_worn_or_of_another_scene_is_built_anew() {
    let first = Job::new(&sheet(30, false, 0.0), whitted(), Quality::Fast).unwrap();
    let moved = |scene: &Scene| first.moved(scene, whitted()).unwrap();
    assert!(moved(&sheet(30, false, 0.2)).scene().is_fitted());
    assert!(!moved(&sheet(31, false, 0.2)).scene().is_fitted(), "of other triangles");
    // Thrown into a heap.
    let mut rng = Rng::with_seed(2);
    let mut heap = sheet(30, false, 0.0);
    heap.mesh.positions.iter_mut().for_each(|place| *place = Vec3::new(rng.f32(), rng.f32(), rng.f32()) * 3.0);
    let anew = moved(&heap);
    assert!(!anew.scene().is_fitted(), "worn");
    let want = Job::new(&heap, whitted(), Quality::Fast).unwrap();
    assert_eq!(anew.nodes(), want.nodes());
    // Small steps wear it out as one large step does: it counts from where it was built.
    let mut job = first.clone();
    for step in 1..=40 {
        let share = step as f32 / 40.0;
        let mut between = sheet(30, false, 0.0);
        between.mesh.positions.iter_mut().zip(&heap.mesh.positions).for_each(|(a, b)| *a += (*b - *a) * share);
        job = job.moved(&between, whitted()).unwrap();
        if !job.scene().is_fitted() {
            return;
        }
    }
    panic!("it never wore out");
}

#[test]
fn pictures_of_a_scene_that_moves_are_those_of_new_scenes() {
    for settings in [whitted(), path()] {
        let mut job = Job::new(&sheet(24, true, 0.0), settings, Quality::Fast).unwrap();
        for step in 1..4 {
            let scene = sheet(24, true, f64::from(step) * 0.1);
            job = job.moved(&scene, settings).unwrap();
            let view = eyerays::view::View::new(&job, &scene.cameras[0]).unwrap();
            let got = cpu::render::<f32>(&job, &view, Method::Auto, 0, &|_| ()).unwrap().0;
            let want = on_cpu(&pack_in(&scene, &scene.cameras[0], settings, Quality::Fast)).0;
            assert_same_bits(&want, &got, &format!("step {step}"));
        }
    }
}

/// The scene is packed with two far triangles, so that no vertex leaves its box.
fn framed(edge: u32, smooth: bool, time: f64) -> Scene {
    let mut scene = sheet(edge, smooth, time);
    for corner in [Vec3::splat(-7.0), Vec3::splat(7.0)] {
        add(&mut scene, matt(Vec3::ONE), &[corner, corner * 0.99, corner * Vec3::new(0.99, 1.0, 1.0)], &[[0, 1, 2]]);
    }
    scene
}

#[test]
fn a_gpu_fits_its_own_hierarchy() {
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    for (edge, smooth) in [(1, false), (20, false), (37, true)] {
        let first = framed(edge, smooth, 0.0);
        let job = Job::new(&first, whitted(), Quality::Fast).unwrap();
        let view = eyerays::view::View::new(&job, &first.cameras[0]).unwrap();
        for method in [Method::WhileWhile, Method::Packet] {
            let mut renderer = gpu::Renderer::new(&gpu, &job, true, method).unwrap();
            for time in [0.4, 1.0, 0.0] {
                let scene = framed(edge, smooth, time);
                renderer.deform(&first, &scene.mesh.positions, &scene.mesh.normals).unwrap();
                let got = renderer.render(&view, &|_| ()).unwrap().film.develop().unwrap();
                let want = on_cpu(&pack_in(&scene, &scene.cameras[0], whitted(), Quality::Fast)).0;
                assert_same_bits(&want, &got, &format!("{edge}, {method:?} at {time}"));
            }
        }
    }
}

#[test]
fn a_gpu_builds_a_hierarchy_of_its_own_and_fits_that() {
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    for (edge, smooth, quality) in [(1, false, Quality::Fast), (37, true, Quality::Medium), (60, true, Quality::Fast)] {
        let first = framed(edge, smooth, 0.0);
        let job = Job::new(&first, whitted(), quality).unwrap();
        let view = eyerays::view::View::new(&job, &first.cameras[0]).unwrap();
        let picture = |scene: &Scene| on_cpu(&pack_in(scene, &scene.cameras[0], whitted(), quality)).0;
        for method in [Method::IfIf, Method::Packet] {
            let mut renderer = gpu::Renderer::new(&gpu, &job, true, method).unwrap();
            let render =
                |renderer: &mut gpu::Renderer| renderer.render(&view, &|_| ()).unwrap().film.develop().unwrap();
            let before = render(&mut renderer);
            renderer.rebuild().unwrap();
            let what = format!("{edge}, {method:?}");
            assert_same_bits(&before, &render(&mut renderer), &what);
            // What is split has several slots of a triangle, which can't be moved.
            if quality != Quality::Fast {
                continue;
            }
            let later = framed(edge, smooth, 0.7);
            renderer.deform(&first, &later.mesh.positions, &later.mesh.normals).unwrap();
            let want = picture(&later);
            assert_same_bits(&want, &render(&mut renderer), &format!("{what}, fitted"));
            renderer.rebuild().unwrap();
            assert_same_bits(&want, &render(&mut renderer), &format!("{what}, built anew"));
        }
    }
}

/// Many triangles of one code, and of none: those that lie in each other, and those without extent.
#[test]
fn triangles_in_one_place_are_a_tree_too() {
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    let mut scene = framed(3, false, 0.0);
    let mut rng = Rng::with_seed(4);
    for _ in 0..3000 {
        let at = Vec3::new(0.1, 0.9, 0.0);
        let corner =
            |rng: &mut Rng| at + Vec3::new(rng.f32(), rng.f32(), rng.f32()) * if rng.bool() { 0.2 } else { 0.0 };
        let corners = [corner(&mut rng), corner(&mut rng), corner(&mut rng)];
        add(&mut scene, matt(Vec3::new(0.2, 0.9, 0.4)), &corners, &[[0, 1, 2]]);
    }
    let job = Job::new(&scene, whitted(), Quality::Fast).unwrap();
    let view = eyerays::view::View::new(&job, &scene.cameras[0]).unwrap();
    let mut renderer = gpu::Renderer::new(&gpu, &job, true, Method::IfIf).unwrap();
    renderer.rebuild().unwrap();
    let got = renderer.render(&view, &|_| ()).unwrap().film.develop().unwrap();
    assert_same_bits(&on_cpu(&pack_in(&scene, &scene.cameras[0], whitted(), Quality::Fast)).0, &got, "a heap");
}

#[test]
fn what_a_gpu_cannot_move_is_told() {
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    let deform = |scene: &Scene, quality, positions: &[Vec3]| {
        let job = Job::new(scene, whitted(), quality).unwrap();
        let mut renderer = gpu::Renderer::new(&gpu, &job, true, Method::IfIf).unwrap();
        renderer.deform(scene, positions, &scene.mesh.normals).expect_err("refused").message()
    };
    let scene = framed(4, false, 0.0);
    let mut far = scene.mesh.positions.clone();
    far[3] = Vec3::splat(1e3);
    assert!(deform(&scene, Quality::Fast, &far).contains("vertex 3 goes to [1000, 1000, 1000], out of the box"));
    assert!(deform(&scene, Quality::Fast, &far[1..]).contains("give it as many"));
    let mut round = scene.clone();
    round.spheres.push(eyerays::scene::Sphere { center: Vec3::ZERO, radius: 0.2, material: 0 });
    assert!(deform(&round, Quality::Fast, &scene.mesh.positions).contains("it has spheres"));
    let job = Job::new(&round, whitted(), Quality::Fast).unwrap();
    let mut renderer = gpu::Renderer::new(&gpu, &job, true, Method::IfIf).unwrap();
    assert!(renderer.rebuild().unwrap_err().message().contains("hierarchies of triangles alone"));
}

/// A scene that is packed for a device that builds has the bits of any other, also where a CPU must do it after all.
#[test]
fn a_scene_whose_hierarchy_is_left_open_looks_like_any_other() {
    for (edge, smooth) in [(1, false), (30, true)] {
        let scene = framed(edge, smooth, 0.3);
        let want = on_cpu(&pack_in(&scene, &scene.cameras[0], path(), Quality::Fast)).0;
        let open = || Job::new(&scene, path(), Bvh::Device.quality()).unwrap();
        let view = eyerays::view::View::new(&open(), &scene.cameras[0]).unwrap();
        for method in [Method::Auto, Method::IfIf, Method::Packet] {
            let got = cpu::render::<f32>(&open(), &view, method, 0, &|_| ()).unwrap().0;
            assert_same_bits(&want, &got, &format!("{edge}, {method:?} on a CPU"));
        }
        assert_eq!(open().scene().primitive_count(), scene.mesh.triangles.len());
        assert!(open().statistics().depth < 64);
        let Some(gpu) = quick_gpu() else { continue };
        let job = open();
        let mut renderer = gpu::Renderer::new(&gpu, &job, true, Method::Auto).unwrap();
        let got = renderer.render(&view, &|_| ()).unwrap().film.develop().unwrap();
        assert_same_bits(&want, &got, &format!("{edge} on a GPU"));
        let later = framed(edge, smooth, 0.6);
        renderer.deform(&scene, &later.mesh.positions, &later.mesh.normals).unwrap();
        let got = renderer.render(&view, &|_| ()).unwrap().film.develop().unwrap();
        assert_same_bits(&on_cpu(&pack_in(&later, &later.cameras[0], path(), Quality::Fast)).0, &got, "moved");
    }
    // What a device can't build is built as any other.
    let mut round = sheet(4, false, 0.0);
    round.spheres.push(eyerays::scene::Sphere { center: Vec3::ZERO, radius: 0.2, material: 0 });
    let [want, got] =
        [Bvh::Fast, Bvh::Device].map(|bvh| on_cpu(&pack_in(&round, &round.cameras[0], whitted(), bvh.quality())).0);
    assert_same_bits(&want, &got, "with a ball");
}
