//! Copies of meshes: pictures of them have the bits of the same scene flattened.

use eyerays::cpu;
use eyerays::device_scene::fitted;
use eyerays::gpu::{self, AdapterRequest};
use eyerays::job::Job;
use eyerays::method::{Method, Traversal};
use eyerays::scene::{
    Camera, Instance, Integrator, Material, Mesh, Object, Physical, Primitives, Projection, Sampler, Scene, Settings,
    SharedMesh, Sphere, Transport, Visibility,
};
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays_bvh::Quality;
use eyerays_tests::model::{add_box, add_wall, empty, glass, lamp, matt, mirror, sun};
use eyerays_tests::{Posed, assert_same_bits, gpu, on_cpu, pack, pack_in, quick_gpu, traversals};
use fastrand::Rng;
use glam::{DMat3, DQuat, DVec3, Vec2, Vec3};

const SIZE: (u32, u32) = (48, 36);

fn unit(rng: &mut Rng) -> f64 {
    2.0 * rng.f64() - 1.0
}

fn point(rng: &mut Rng) -> DVec3 {
    DVec3::new(unit(rng), unit(rng), unit(rng))
}

/// A ball of so many rings, with normals and texture coordinates, or a heap of triangles without.
fn mesh(rng: &mut Rng, material: u32, smooth: bool) -> Mesh {
    let (rings, around) = (6, 9);
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        for step in 0..=around {
            let (a, b) = (f64::from(ring) / f64::from(rings), f64::from(step) / f64::from(around));
            let (polar, turn) = (a * std::f64::consts::PI, b * std::f64::consts::TAU);
            let place = DVec3::new(polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin());
            let bump = if smooth { 1.0 } else { 0.6 + 0.4 * rng.f64() };
            mesh.positions.push((place * bump).as_vec3());
            mesh.normals.push(if smooth { place.normalize_or(DVec3::Y).as_vec3() } else { Vec3::ZERO });
            mesh.coordinates[0].push(Vec2::new(b as f32, a as f32));
        }
    }
    for ring in 0..rings {
        for step in 0..around {
            let at = ring * (around + 1) + step;
            let (a, b, c, d) = (at, at + 1, at + around + 2, at + around + 1);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.materials = vec![material; mesh.triangles.len()];
    mesh
}

/// Adds a mesh that stands nowhere yet, and gives its number.
fn share(scene: &mut Scene, other: &Mesh) -> u32 {
    let own = &mut scene.mesh;
    let (vertex, triangle) = (own.positions.len(), own.triangles.len());
    own.normals.resize(vertex, Vec3::ZERO);
    own.coordinates[0].resize(vertex, Vec2::ZERO);
    own.positions.extend(&other.positions);
    own.normals.extend(&other.normals);
    own.coordinates[0].extend(&other.coordinates[0]);
    own.triangles.extend(other.triangles.iter().map(|corners| corners.map(|corner| vertex as u32 + corner)));
    own.materials.extend(&other.materials);
    let shared = SharedMesh { vertices: vertex..own.positions.len(), triangles: triangle..own.triangles.len() };
    scene.shared.push(shared);
    scene.shared.len() as u32 - 1
}

/// A turn, perhaps a stretch and perhaps a mirror, of some size.
fn linear(rng: &mut Rng, size: f64) -> DMat3 {
    let turn = DQuat::from_scaled_axis(point(rng) * 3.0);
    let stretch = if rng.bool() { DVec3::ONE } else { DVec3::new(0.5 + rng.f64(), 0.5 + rng.f64(), 0.5 + rng.f64()) };
    let mirror = if rng.u8(0..4) == 0 { DVec3::new(-1.0, 1.0, 1.0) } else { DVec3::ONE };
    DMat3::from_quat(turn) * DMat3::from_diagonal(stretch * mirror * size)
}

fn instance(mesh: u32, linear: DMat3, at: DVec3) -> Instance {
    let rows = linear.transpose();
    let rows = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.as_vec3());
    Instance { mesh, rows, translation: at.as_vec3() }
}

/// A floor, a sphere and a pane, and copies of two meshes, each of several materials, heaped upon each other. `far` is where it all is.
fn heap(seed: u64, copies: usize, far: Vec3) -> Scene {
    let mut rng = Rng::with_seed(seed);
    let mut scene = empty();
    let physical = Physical { base: Vec3::new(0.7, 0.5, 0.3), roughness: 0.3, metallic: 1.0, ..Physical::default() };
    add_box(&mut scene, matt(Vec3::splat(0.6)), far + Vec3::new(-6.0, -1.5, -6.0), far + Vec3::new(6.0, -1.0, 6.0));
    add_wall(&mut scene, mirror(Vec3::splat(0.7)), far + Vec3::new(0.0, 1.0, -5.0), 3.0);
    scene.materials.push(matt(Vec3::new(0.8, 0.2, 0.1)));
    scene.materials.push(glass(Vec3::new(0.5, 0.9, 0.6)));
    scene.materials.push(Material { physical: Some(physical), ..matt(Vec3::splat(0.5)) });
    scene.spheres.push(Sphere { center: far + Vec3::new(1.0, 0.2, 1.0), radius: 0.6, material: 2 });
    let mut objects =
        vec![(Primitives::Triangles(0..scene.mesh.triangles.len()), "floor"), (Primitives::Spheres(0..1), "ball")];
    let meshes = [(2, true), (3, true), (4, false)].map(|(material, smooth)| {
        let mesh = mesh(&mut rng, material, smooth);
        share(&mut scene, &mesh)
    });
    for _ in 0..copies {
        let at = far.as_dvec3() + point(&mut rng) * DVec3::new(3.0, 1.0, 3.0);
        let size = 0.15 + 0.5 * rng.f64();
        scene.instances.push(instance(meshes[rng.usize(0..3)], linear(&mut rng, size), at));
    }
    let half = copies / 2;
    objects.push((Primitives::Instances(0..half), "some"));
    objects.push((Primitives::Instances(half..copies), "others"));
    scene.objects = objects
        .into_iter()
        .map(|(primitives, name)| {
            let (bounds, visibility) = ([Vec3::ZERO; 2], Visibility::default());
            Object { name: name.to_owned(), primitives, bounds, visibility }
        })
        .collect();
    scene.lights = vec![sun(Vec3::new(0.3, -1.0, -0.4)), lamp(far + Vec3::new(-2.0, 4.0, 3.0))];
    let eye = far + Vec3::new(1.0, 2.5, 7.0);
    scene.cameras = vec![Camera::new("front", eye, far, Projection::Perspective { fov: 45.0 })];
    scene
}

fn whitted() -> Settings {
    Settings { size: SIZE, samples: 2, bounces: 4, ..Settings::default() }
}

fn sampled(integrator: Integrator) -> Settings {
    Settings {
        size: SIZE,
        spp: 4,
        bounces: 4,
        sampler: Sampler::Sobol,
        transport: Transport { integrator, ..Transport::default() },
        ..Settings::default()
    }
}

/// The scene and the same flattened, before its camera.
fn both(scene: &Scene, settings: Settings) -> [Posed; 2] {
    let flat = scene.flattened();
    assert!(flat.instances.is_empty() && flat.mesh.triangles.len() as u64 == scene.copied_triangles() + 14);
    assert_eq!(scene.bounds(), flat.bounds(), "to the bit");
    [scene, &flat].map(|scene| pack(scene, &scene.cameras[0], settings))
}

#[test]
fn copies_have_the_bits_of_the_scene_flattened_by_every_method() {
    for (seed, far) in [(1, Vec3::ZERO), (2, Vec3::new(1000.0, 0.0, -3000.0))] {
        let [copied, flat] = both(&heap(seed, 24, far), whitted());
        assert_eq!((copied.instances().len(), flat.instances().len()), (24, 0));
        assert!(copied.primitives().len() < flat.primitives().len() / 2);
        let render =
            |posed: &Posed, traversal| cpu::render::<f32>(&posed.packed, &posed.view, traversal, 0, &|_| ()).unwrap();
        let (want, rays) = render(&flat, Traversal::default());
        for traversal in traversals() {
            let (picture, counted) = render(&copied, traversal);
            assert_same_bits(&want, &picture, &format!("{seed}, {traversal:?}"));
            assert_eq!(rays, counted);
        }
    }
}

#[test]
fn integrators_that_sample_tell_no_difference_and_neither_does_double_precision() {
    let scene = heap(3, 16, Vec3::ZERO);
    for integrator in [Integrator::Path, Integrator::Ao, Integrator::Distributed] {
        let [copied, flat] = both(&scene, sampled(integrator));
        assert_same_bits(&on_cpu(&flat).0, &on_cpu(&copied).0, &format!("{integrator:?}"));
    }
    let [copied, flat] = both(&scene, whitted());
    let [want, got] = [&flat, &copied].map(eyerays_tests::in_double_precision);
    assert_same_bits(&want.0, &got.0, "double precision");
}

#[test]
fn whatever_the_quality_of_the_hierarchies() {
    let scene = heap(4, 30, Vec3::ZERO);
    let render = |scene: &Scene, quality| on_cpu(&pack_in(scene, &scene.cameras[0], whitted(), quality)).0;
    let want = render(&scene.flattened(), Quality::Medium);
    for quality in [Quality::Fast, Quality::Medium, Quality::High] {
        assert_same_bits(&want, &render(&scene, quality), &format!("{quality:?}"));
    }
    let photons = Settings { caustics: 1.0, ..sampled(Integrator::Path) };
    let render = |quality| on_cpu(&pack_in(&scene, &scene.cameras[0], photons, quality)).0;
    let want = render(Quality::Fast);
    for quality in [Quality::Medium, Quality::High] {
        assert_same_bits(&want, &render(quality), &format!("photons, {quality:?}"));
    }
}

/// What rays find, by the number of the primitive: t, coordinates and number.
fn hits(packed: &Job, answers: &Answers, count: usize) -> Vec<[u32; 4]> {
    let Answers::Closest(words) = answers else { panic!("hits") };
    let number = |ray: usize| {
        let local = packed.primitives().get(words[ray].w as usize)?.number();
        let copy = words.get(count + ray).and_then(|copy| packed.instances().get(copy.w as usize));
        Some(copy.map_or(local, |copy| copy.number(local)))
    };
    let hit = |ray: usize| {
        number(ray).map_or([0, 0, 0, u32::MAX], |number| [words[ray].x, words[ray].y, words[ray].z, number])
    };
    (0..count).map(hit).collect()
}

/// Rays from everywhere to vertices, edges and places of the copies, where rounding would tell first.
fn rays(flat: &Job, count: usize, rng: &mut Rng) -> Stream {
    let aimed = |_| {
        let [a, b, c] = flat.primitives()[rng.usize(0..flat.primitives().len())].vertices();
        let (u, v) = match rng.u8(0..4) {
            0 => (0.0, 0.0),
            1 => (rng.f32(), 0.0),
            _ => (rng.f32(), rng.f32()),
        };
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let origin = point(rng).as_vec3();
        let at = a + (b - a) * u + (c - a) * v;
        // Some along the triangle's plane.
        let origin = if rng.u8(0..4) == 0 { (at + (b - a) * 3.0).clamp(Vec3::NEG_ONE, Vec3::ONE) } else { origin };
        StreamRay { origin, direction: at - origin, limit: f32::MAX, source_primitive: StreamRay::NOWHERE }
    };
    let rays: Vec<StreamRay> = (0..count).map(aimed).filter(|ray| ray.direction != Vec3::ZERO).collect();
    Stream::new(rays.into_iter())
}

#[test]
fn rays_at_edges_and_vertices_find_the_same_numbers_distances_and_places() {
    let mut rng = Rng::with_seed(9);
    for seed in 10..14 {
        let scene = heap(seed, 40, Vec3::ZERO);
        let [copied, flat] = both(&scene, whitted());
        let stream = rays(&flat, eyerays_tests::count::of(20_000, 1_000_000), &mut rng);
        let cast =
            |packed: &Job, method: Method, question| cpu::cast(packed, method.into(), 0, &stream, question).unwrap().0;
        let want = hits(&flat, &cast(&flat, Method::Wide, Question::Closest), stream.len());
        let dark = cast(&flat, Method::Wide, Question::Occlusion);
        assert!(want.iter().filter(|hit| hit[3] != u32::MAX).count() > stream.len() / 2);
        for method in [Method::IfIf, Method::Wide, Method::Packet] {
            let got = hits(&copied, &cast(&copied, method, Question::Closest), stream.len());
            let odd = (0..stream.len()).find(|&ray| want[ray] != got[ray]);
            assert_eq!(
                odd,
                None,
                "{method:?}, seed {seed}: {:?}",
                odd.map(|ray| (stream.ray(ray), want[ray], got[ray]))
            );
            assert_eq!(dark, cast(&copied, method, Question::Occlusion), "{method:?}");
        }
    }
}

#[test]
fn a_gpu_sees_what_a_cpu_sees() {
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    let scene = heap(5, 24, Vec3::ZERO);
    let [copied, flat] = both(&scene, whitted());
    let want = on_cpu(&flat).0;
    for method in [Method::IfIf, Method::WhileWhile, Method::Wide, Method::Packet, Method::InterleavedCut] {
        let mut renderer = gpu::Renderer::new(&gpu, &copied.packed, true, method).unwrap();
        let picture = renderer.render(&copied.view, &|_| ()).unwrap().film.develop().unwrap();
        assert_same_bits(&want, &picture, &format!("{method:?}"));
    }
}

#[test]
fn a_gpu_traces_their_paths_too() {
    let Some(gpu) = quick_gpu() else { return };
    let scene = heap(6, 16, Vec3::ZERO);
    let [copied, flat] = both(&scene, sampled(Integrator::Path));
    let want = on_cpu(&flat).0;
    let mut renderer = gpu::Renderer::new(&gpu, &copied.packed, true, Traversal::default()).unwrap();
    assert_same_bits(&want, &renderer.render(&copied.view, &|_| ()).unwrap().film.develop().unwrap(), "paths");
}

/// A matrix without an inverse, mirrors, a copy that is next to nothing, and one that is far larger than what it stands on.
#[test]
fn any_transform_will_do() {
    let mut scene = heap(7, 12, Vec3::ZERO);
    let at = |x, y, z| DVec3::new(x, y, z);
    let all = [
        instance(0, DMat3::from_diagonal(at(0.4, 0.0, 0.4)), at(0.5, 0.2, 1.0)),
        instance(1, DMat3::from_diagonal(at(0.4, 0.3, 0.0)), at(-0.5, 0.4, 2.0)),
        instance(2, DMat3::from_diagonal(DVec3::splat(1e-7)), at(0.9, 1.0, 1.0)),
        instance(0, DMat3::ZERO, DVec3::ONE),
        instance(1, DMat3::from_diagonal(at(-0.5, 0.5, 0.5)), at(0.0, 1.0, 0.0)),
        instance(2, DMat3::from_diagonal(DVec3::splat(80.0)), at(0.0, -90.0, 0.0)),
        instance(0, DMat3::from_cols(at(0.3, 0.2, 0.0), at(0.31, 0.2, 0.0), at(0.0, 0.0, 0.4)), DVec3::ZERO),
    ];
    scene.instances[..all.len()].copy_from_slice(&all);
    let [copied, flat] = both(&scene, whitted());
    let want = on_cpu(&flat).0;
    for method in [Method::IfIf, Method::Wide, Method::Packet] {
        let picture = cpu::render::<f32>(&copied.packed, &copied.view, Traversal::from(method), 0, &|_| ()).unwrap().0;
        assert_same_bits(&want, &picture, &format!("{method:?}"));
    }
}

#[test]
fn copies_that_emit_light_do_so_where_they_stand() {
    for (seed, shining) in [(8, 2), (9, 0)] {
        let mut scene = heap(seed, 12, Vec3::ZERO);
        scene.materials[shining].emission = Vec3::splat(3.0);
        assert_eq!(fitted(scene.clone()).instances.len(), 12);
        for integrator in [Integrator::Path, Integrator::Distributed] {
            let posed = both(&scene, sampled(integrator));
            let lamps = posed.each_ref().map(|posed| posed.lighting().emitters.len());
            assert!(lamps[0] == lamps[1] && lamps[0] > 10, "{lamps:?}");
            let [copied, flat] = posed.map(|posed| on_cpu(&posed).0);
            assert_same_bits(&flat, &copied, &format!("{seed}, {integrator}"));
        }
    }
}
