//! One picture from GPU and CPU, in every bit. Without a GPU these tests do nothing, see [`gpu`].

use eyerays::choice::Named;
use eyerays::error::{Content, Error};
use eyerays::gpu::{AdapterRequest, Gpu, Renderer};
use eyerays::integrator;
use eyerays::method::{Method, Order, Traversal};
use eyerays::scene::{Background, Light, Material, Projection, Sampler, Scene, Settings};
use eyerays::view::View;
use eyerays_tests::model::{add_box, add_wall, empty, glass, glowing, lamp, matt, mirror, sun};
use eyerays_tests::{Posed, assert_same_bits, gpu, on_cpu, pack, settings, shipped, traversals};
use glam::Vec3;

/// Size and samples: with and without whole blocks of pixels.
const PICTURES: [((u32, u32), u32); 3] = [((96, 72), 1), ((37, 23), 2), ((21, 40), 3)];

fn exact() -> Option<Gpu> {
    gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() })
}

fn assert_same_by(gpu: &Gpu, packed: &Posed, traversals: &[Traversal], what: &str) {
    let (picture, rays) = on_cpu(packed);
    assert_eq!(rays.non_finite, 0, "{what}");
    for &traversal in traversals {
        let what = format!("{what}, {traversal:?}");
        let mut renderer = Renderer::new(gpu, packed, true, traversal).unwrap_or_else(|e| panic!("{what}: {e}"));
        let rendering = renderer.render(&packed.view, &|_| ()).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_same_bits(&rendering.film.develop().unwrap(), &picture, &what);
        assert_eq!(rendering.film.rays(), rays, "{what}");
    }
}

/// The GPU against the CPU by the default method.
fn assert_same(gpu: &Gpu, packed: &Posed, what: &str) {
    assert_same_by(gpu, packed, &[Traversal::default()], what);
}

/// Every camera of a shipped scene.
fn assert_scene(name: &str) {
    let Some(gpu) = exact() else { return };
    let scene = shipped(name);
    for camera in &scene.cameras {
        for (size, samples) in PICTURES {
            let packed = pack(&scene, camera, settings(&scene, size, samples));
            assert_same(&gpu, &packed, &format!("{name}, camera {}, {size:?} x {samples}", camera.name));
        }
    }
}

#[test]
fn cornell() {
    assert_scene("cornell");
}

#[test]
fn whitted() {
    assert_scene("whitted");
}

#[test]
fn glass_study() {
    assert_scene("glass");
}

#[test]
fn lights() {
    assert_scene("lights");
}

#[test]
fn twice_in_a_row() {
    let Some(gpu) = exact() else { return };
    let scene = shipped("whitted");
    let packed = pack(&scene, &scene.cameras[2], settings(&scene, (70, 50), 2));
    let mut renderer = Renderer::new(&gpu, &packed, true, Traversal::default()).unwrap();
    let [first, second] = [0, 1].map(|_| renderer.render(&packed.view, &|_| ()).unwrap().film);
    assert_same_bits(&first.develop().unwrap(), &second.develop().unwrap(), "twice");
    assert_eq!(first.rays(), second.rays());
}

/// Settings that take other kernels, buffers or waves than the shipped ones.
#[test]
fn every_setting() {
    let Some(gpu) = exact() else { return };
    let scene = shipped("whitted");
    let own = settings(&scene, (50, 38), 1);
    let mut dark = scene.clone();
    dark.lights.clear();
    for (what, scene, settings) in [
        ("no bounces", &scene, Settings { bounces: 0, ..own }),
        ("one bounce", &scene, Settings { bounces: 1, ..own }),
        ("every contribution", &scene, Settings { min_contribution: 0.0, bounces: 7, ..own }),
        ("no contribution", &scene, Settings { min_contribution: 1.0, ..own }),
        ("culling", &scene, Settings { culling: true, ..own }),
        ("one pixel", &scene, Settings { size: (1, 1), samples: 5, ..own }),
        ("one row", &scene, Settings { size: (301, 1), ..own }),
        ("one column", &scene, Settings { size: (1, 301), ..own }),
        ("no lights", &dark, own),
        ("glass without bounces", &shipped("glass"), Settings { bounces: 0, size: (40, 30), ..own }),
    ] {
        assert_same(&gpu, &pack(scene, &scene.cameras[0], settings), what);
    }
}

/// A mirror, a lens and a matt ground: every kind of ray, and few triangles.
fn still_life() -> Scene {
    let mut scene = empty();
    add_box(&mut scene, matt(Vec3::new(0.7, 0.6, 0.5)), Vec3::new(-3.0, -1.1, -6.0), Vec3::new(3.0, -1.0, 0.0));
    add_box(&mut scene, mirror(Vec3::splat(0.8)), Vec3::new(-1.2, -1.0, -4.5), Vec3::new(-0.1, 0.6, -3.5));
    add_box(&mut scene, glass(Vec3::new(0.9, 1.0, 0.9)), Vec3::new(0.1, -0.9, -3.4), Vec3::new(1.0, 0.3, -2.5));
    scene.background = Background::Gradient { horizon: Vec3::splat(0.6), zenith: Vec3::new(0.2, 0.3, 0.7) };
    scene.ambient = Vec3::splat(0.2);
    scene.lights = vec![lamp(Vec3::new(2.0, 3.0, 0.0)), sun(Vec3::new(-1.0, -2.0, -0.5))];
    scene.cameras[0].projection = Projection::Perspective { fov: 60.0 };
    scene.settings = Settings { size: (61, 45), bounces: 8, min_contribution: 0.001, ..scene.settings };
    scene
}

/// Every method, for every kind of ray.
#[test]
fn methods() {
    let Some(gpu) = exact() else { return };
    let scene = still_life();
    let packed = pack(&scene, &scene.cameras[0], scene.settings);
    assert_same_by(&gpu, &packed, &Method::ALL.map(Traversal::from), "methods");
}

/// Hybrids that part early and late, for primary rays alone: each compiles kernels of its own.
#[test]
fn tunings() {
    let Some(gpu) = exact() else { return };
    let mut scene = shipped("whitted");
    scene.lights.clear();
    let settings = Settings { bounces: 0, culling: true, ..settings(&scene, (61, 43), 1) };
    let packed = pack(&scene, &scene.cameras[2], settings);
    assert_same_by(&gpu, &packed, &traversals(), "tunings");
}

/// A GPU with less memory renders in more bands, down to one block of pixels each.
#[test]
fn bands() {
    let Some(mut gpu) = exact() else { return };
    let scene = still_life();
    let packed = pack(&scene, &scene.cameras[0], Settings { samples: 2, ..scene.settings });
    let block = u64::from(integrator::needs(&packed).paths) * 3 * 16 * 32;
    for blocks in [1, 2, 9, 40] {
        gpu.report.max_binding = blocks * block;
        assert_same(&gpu, &packed, &format!("{blocks} blocks a band"));
    }
    gpu.report.max_binding = block - 1;
    let error = Renderer::new(&gpu, &packed, true, Traversal::default()).err().expect("not even a block fits");
    let (device, limit) = (gpu.report.name.clone(), block - 1);
    assert_eq!(error, Error::TooLarge { device, what: Content::Block, bytes: block, limit });
    // The squares of a Morton curve are larger blocks.
    let (morton, block) = (Traversal { order: Order::Morton, ..Traversal::default() }, 128 * block);
    gpu.report.max_binding = block;
    assert_same_by(&gpu, &packed, &[morton], "one square");
    gpu.report.max_binding = block - 1;
    assert!(Renderer::new(&gpu, &packed, true, morton).is_err());
}

/// So many lights that a launch has few pixels. Lavapipe ends loops after 65,535 rounds in all, which would
/// be too few for twice as many.
#[test]
fn thousands_of_lights() {
    let Some(gpu) = exact() else { return };
    let mut scene = still_life();
    let place = |i: u16| Vec3::new(f32::from(i % 64) / 8.0 - 4.0, f32::from(i / 64) / 8.0 - 3.5, 1.0);
    let light = |i| Light::Point {
        position: place(i),
        colour: Vec3::splat(1.0 / 1024.0),
        group: String::new(),
        illuminant: None,
    };
    scene.lights = (0..4096).map(light).collect();
    let settings = Settings { size: (48, 36), bounces: 1, ..scene.settings };
    assert_same(&gpu, &pack(&scene, &scene.cameras[0], settings), "4096 lights");
}

/// Nothing escapes a closed box of mirrors, and its bounces end at their limit.
#[test]
fn ten_thousand_bounces() {
    const BOUNCES: u32 = 10_000;
    let mut scene = empty();
    let inside = Material { ambient: Some(Vec3::splat(1e-4)), ..mirror(Vec3::ONE) };
    add_box(&mut scene, inside, Vec3::new(-1.1, -0.7, -1.3), Vec3::new(0.9, 1.2, 0.8));
    scene.ambient = Vec3::ONE;
    scene.background = Background::Colour(Vec3::splat(1e6));
    scene.cameras[0].projection = Projection::Perspective { fov: 70.0 };
    let settings = Settings { size: (9, 5), bounces: BOUNCES, ..scene.settings };
    let packed = pack(&scene, &scene.cameras[0], settings);
    let (picture, rays) = on_cpu(&packed);
    assert_eq!(rays.secondary, rays.primary * u64::from(BOUNCES));
    assert!(picture.pixels.iter().flatten().all(|channel| (channel - 1.0).abs() < 1e-3), "{:?}", picture.pixels);
    if let Some(gpu) = exact() {
        assert_same(&gpu, &packed, "mirrors");
    }
}

/// Every waiting ray of a deep tree has its place.
#[test]
fn deep_trees_of_glass() {
    let Some(gpu) = exact() else { return };
    let mut scene = still_life();
    for z in 0..6 {
        add_wall(&mut scene, glass(Vec3::ONE), Vec3::new(0.0, 0.0, -1.0 - 0.2 * z as f32), 0.5);
    }
    add_wall(&mut scene, glowing(Vec3::X), Vec3::new(0.0, 0.0, -2.4), 0.2);
    for (bounces, min_contribution) in [(9, 0.0), (10_000, 0.002)] {
        let settings = Settings { size: (19, 13), bounces, min_contribution, ..scene.settings };
        assert_same(&gpu, &pack(&scene, &scene.cameras[0], settings), &format!("{bounces} bounces"));
    }
}

#[test]
fn a_scene_larger_than_a_buffer_is_refused_with_both_numbers() {
    let Some(mut gpu) = exact() else { return };
    let scene = still_life();
    let packed = pack(&scene, &scene.cameras[0], Settings { bounces: 0, ..scene.settings });
    gpu.report.max_binding = 1000;
    let error = Renderer::new(&gpu, &packed, true, Traversal::default()).err().expect("it does not fit").to_string();
    let size = size_of_val(packed.nodes()).to_string();
    for part in ["hierarchy", &size, "1000", &gpu.report.name] {
        assert!(error.contains(part), "{error}: no {part}");
    }
}

/// Other rays than those of a regular grid, and the same ones on both devices.
#[test]
fn every_sampler() {
    let Some(gpu) = exact() else { return };
    let scene = shipped("whitted");
    let camera = &scene.cameras[0];
    let (regular, _) = on_cpu(&pack(&scene, camera, settings(&scene, (37, 23), 3)));
    for &sampler in Sampler::VARIANTS {
        for samples in [1, 3] {
            let packed = pack(&scene, camera, Settings { sampler, ..settings(&scene, (37, 23), samples) });
            assert_same(&gpu, &packed, &format!("{sampler:?} x {samples}"));
            let is_regular = on_cpu(&packed).0.bits_equal(&regular);
            assert_eq!(is_regular, sampler == Sampler::Regular && samples == 3, "{sampler:?} x {samples}");
        }
    }
}

/// However samples come, in flight together or one by one, all at once or in parts.
#[test]
fn samples_in_parts() {
    let Some(mut gpu) = exact() else { return };
    let scene = still_life();
    let settings = Settings { samples: 3, sampler: Sampler::Sobol, bounces: 4, ..scene.settings };
    let packed = pack(&scene, &scene.cameras[0], settings);
    let (picture, rays) = on_cpu(&packed);
    let all = u64::from(integrator::needs(&packed).paths) * 3 * 16 * 61 * 45;
    for (max_binding, parts) in
        [(u64::MAX, &[9][..]), (u64::MAX, &[1, 2, 6]), (3 * all, &[9]), (2 * all, &[4, 5]), (all / 2, &[2, 7])]
    {
        gpu.report.max_binding = gpu.report.max_buffer.min(max_binding);
        let mut renderer = Renderer::new(&gpu, &packed, true, Traversal::default()).unwrap();
        // A picture that was started before, and pictures in between, change nothing.
        renderer.start(&packed.view).unwrap();
        renderer.add(0..1, &|_| ()).unwrap();
        renderer.start(&packed.view).unwrap();
        let none = renderer.film().unwrap().develop().unwrap();
        assert!(none.pixels.iter().all(|&pixel| pixel == [0.0; 3]));
        let mut first = 0;
        for &count in parts {
            renderer.add(first..first + count, &|_| ()).unwrap();
            first += count;
            renderer.film().unwrap();
        }
        let film = renderer.film().unwrap();
        assert_same_bits(&film.develop().unwrap(), &picture, &format!("{parts:?}, {max_binding}"));
        assert_eq!(film.rays(), rays, "{parts:?}, {max_binding}");
    }
}

/// One upload for every camera, size, number of samples and light that follows.
#[test]
fn views_of_one_upload() {
    let Some(gpu) = exact() else { return };
    let mut scene = shipped("lights");
    let packed = pack(&scene, &scene.cameras[0], settings(&scene, (40, 30), 1));
    let mut renderer = Renderer::new(&gpu, &packed, true, Traversal::default()).unwrap();
    for (camera, size, samples) in
        [(0, (40, 30), 1), (1, (40, 30), 1), (1, (13, 70), 2), (0, (8, 8), 1), (0, (50, 9), 3)]
    {
        let view = View::of(&packed, &scene.cameras[camera], size, samples).unwrap();
        let rendering = renderer.render(&view, &|_| ()).unwrap();
        let want = pack(&scene, &scene.cameras[camera], settings(&scene, size, samples));
        let (picture, rays) = on_cpu(&want);
        assert_same_bits(&rendering.film.develop().unwrap(), &picture, &format!("camera {camera}, {size:?}"));
        assert_eq!(rendering.film.rays(), rays);
    }
    for light in &mut scene.lights {
        let (Light::Point { colour, .. } | Light::Spot { colour, .. } | Light::Directional { colour, .. }) = light;
        *colour *= 0.25;
    }
    renderer.set_lights(&scene.lights).unwrap();
    let dimmed = pack(&scene, &scene.cameras[0], settings(&scene, (40, 30), 1));
    let rendering = renderer.render(&dimmed.view, &|_| ()).unwrap();
    assert_same_bits(&rendering.film.develop().unwrap(), &on_cpu(&dimmed).0, "dimmed");
}

/// Cameras far outside the scene, whose rays first come close to it.
#[test]
fn cameras_from_afar() {
    let Some(gpu) = exact() else { return };
    let mut scene = still_life();
    let ahead = Vec3::new(0.0, -0.2, -3.5);
    for distance in [5.0f32, 60.0, 4000.0, 1e6] {
        let aside = Vec3::new(0.4, 0.6, 1.0).normalize();
        let camera = &mut scene.cameras[0];
        (camera.eye, camera.target) = (ahead + aside * distance, ahead);
        camera.projection = Projection::Perspective { fov: 2.0 * (4.0 / distance).atan().to_degrees() };
        let packed = pack(&scene, &scene.cameras[0], scene.settings);
        assert_same(&gpu, &packed, &format!("{distance} away"));
        let (picture, rays) = on_cpu(&packed);
        assert!(rays.shadow > u64::from(61 * 45u32) / 2, "{distance} away, the scene fills the picture");
        assert!(picture.pixels.iter().flatten().all(|channel| channel.is_finite()));
    }
}
