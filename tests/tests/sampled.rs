//! One picture of sampled light from GPU and CPU, in every bit, however its samples come. Without a GPU most of these tests do
//! nothing, see [`gpu`]. Lavapipe's optimizer needs minutes for paths' kernels, whose divisions and roots it copies to wherever they
//! are used: there these tests take ambient occlusion alone, unless `GALLIVM_PERF=nopt` turns the optimizer off.

use eyerays::cpu;
use eyerays::device_scene::Feature;
use eyerays::gpu::{AdapterRequest, Gpu, Renderer};
use eyerays::method::{Method, Traversal};
use eyerays::quality::Bvh;
use eyerays::scene::{
    Background, Direct, Falloff, Filter, Integrator, Lens, Light, Mapping, Matte, PixelFilter, Projection, Sampler,
    Scene, Settings, Stereo, StereoLayout, Transport, Visibility,
};
use eyerays_tests::covered::covered;
use eyerays_tests::{Posed, SAMPLED, assert_same_bits, gpu, on_cpu, pack, pack_in, quick_gpu, shipped};
use glam::Vec3;

fn exact() -> Option<Gpu> {
    gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() })
}

/// Of the scene's own, as many samples as this.
fn settings(scene: &Scene, size: (u32, u32), spp: u32) -> Settings {
    Settings { size, spp, sampler: Sampler::Sobol, ..scene.settings }
}

fn assert_same(gpu: &Gpu, packed: &Posed, traversal: Traversal, what: &str) {
    let (picture, rays) = on_cpu(packed);
    assert_eq!(rays.non_finite, 0, "{what}");
    assert!(picture.pixels.iter().any(|&pixel| pixel != [0.0; 3]), "{what} is black");
    let mut renderer = Renderer::new(gpu, packed, true, traversal).unwrap_or_else(|e| panic!("{what}: {e}"));
    let rendering = renderer.render(&packed.view, &|_| ()).unwrap_or_else(|e| panic!("{what}: {e}"));
    let developed = rendering.film.develop().unwrap();
    assert_same_bits(&developed, &picture, what);
    assert_eq!((rendering.film.rays(), developed.noise()), (rays, picture.noise()), "{what}");
}

#[test]
fn walls_that_throw_colours() {
    let Some(gpu) = quick_gpu() else { return };
    let scene = shipped("bleeding");
    let packed = pack(&scene, &scene.cameras[0], settings(&scene, (45, 37), 3));
    assert_same(&gpu, &packed, Traversal::default(), "bleeding");
}

#[test]
fn ambient_occlusion() {
    let Some(gpu) = exact() else { return };
    let scene = shipped("occlusion");
    let packed = pack(&scene, &scene.cameras[0], settings(&scene, (45, 37), 3));
    assert_same(&gpu, &packed, Method::Packet.into(), "occlusion");
}

#[test]
fn shipped_scenes() {
    let Some(gpu) = quick_gpu() else { return };
    for (name, method) in SAMPLED.into_iter().zip([Method::Auto, Method::Packet, Method::Wide, Method::IfIf]) {
        let scene = shipped(name);
        for (camera, size, spp) in [(0, (45, 37), 3), (scene.cameras.len() - 1, (16, 40), 1)] {
            let packed = pack(&scene, &scene.cameras[camera], settings(&scene, size, spp));
            assert_same(&gpu, &packed, method.into(), &format!("{name}, camera {camera}, {size:?} x {spp}"));
        }
    }
}

/// Lights with and without extent in one scene, before a sky that is light, with smooth and checkered surfaces, mirrors and
/// glass, by each way to find lights, with chance at every bounce and a limit to what it brings.
#[test]
fn everything_at_once() {
    let Some(gpu) = quick_gpu() else { return };
    let mut scene = shipped("glass");
    scene.background = Background::Gradient { horizon: Vec3::new(0.3, 0.2, 0.1), zenith: Vec3::new(0.1, 0.2, 0.5) };
    scene.lights.push(Light::Directional {
        direction: -Vec3::Y,
        colour: Vec3::splat(0.2),
        group: String::new(),
        illuminant: None,
    });
    let (position, target) = (Vec3::new(1.0, 4.0, 2.0), Vec3::ZERO);
    scene.lights.push(Light::Spot {
        position,
        target,
        colour: Vec3::splat(9.0),
        outer: 30.0,
        inner: 10.0,
        falloff: Falloff::Smooth,
        group: String::new(),
        illuminant: None,
    });
    scene.materials[0].emission = Vec3::new(0.2, 0.3, 0.1);
    for (direct, sampler) in [(Direct::Power, Sampler::Random), (Direct::Balance, Sampler::Jittered)] {
        let transport = Transport {
            integrator: Integrator::Path,
            direct,
            roulette: 0,
            clamp: 3.0,
            seed: 99,
            ..Transport::default()
        };
        let settings = Settings { transport, sampler, bounces: 6, ..settings(&scene, (40, 30), 4) };
        let packed = pack(&scene, &scene.cameras[0], settings);
        assert_same(&gpu, &packed, Traversal::default(), &format!("{direct:?}"));
    }
    // Ambient light and highlights, too; and rays that wait while others are followed.
    let transport = Transport { integrator: Integrator::Distributed, ..scene.settings.transport };
    let settings = Settings { transport, bounces: 6, ..settings(&scene, (40, 30), 4) };
    let packed = pack(&scene, &scene.cameras[0], settings);
    assert_same(&gpu, &packed, Traversal::default(), "distributed");
}

/// Physical materials, textures of every form by every filter, masks and blends below a picture of the sky, by every method that
/// follows rays otherwise.
#[test]
fn surfaces_and_surroundings() {
    let mut scene = covered();
    let ways = [
        (Integrator::Path, Filter::Mipmap, Method::Auto),
        (Integrator::Path, Filter::Nearest, Method::Packet),
        (Integrator::Path, Filter::Bilinear, Method::Wide),
        (Integrator::Distributed, Filter::Mipmap, Method::WhileWhile),
    ];
    let pictures: Vec<_> = ways
        .into_iter()
        .map(|(integrator, filter, method)| {
            let transport = Transport { integrator, ..scene.settings.transport };
            let settings = Settings { transport, filter, bounces: 4, ..settings(&scene, (40, 30), 4) };
            let packed = pack(&scene, &scene.cameras[0], settings);
            let what = format!("{integrator}, {filter}, {method}");
            if let Some(gpu) = quick_gpu() {
                assert_same(&gpu, &packed, method.into(), &what);
            }
            on_cpu(&packed).0
        })
        .collect();
    for pair in pictures.windows(2) {
        assert!(!pair[0].bits_equal(&pair[1]), "a filter or an integrator changes nothing");
    }
    // Whitted's model refuses light that surfaces send out.
    scene.materials.iter_mut().for_each(|material| material.emission = Vec3::ZERO);
    let settings = Settings { sampler: Sampler::Regular, spp: 4, size: (40, 30), bounces: 3, ..scene.settings };
    let packed = pack(&scene, &scene.cameras[0], settings);
    let Some(gpu) = exact() else { return };
    let (picture, _) = on_cpu(&packed);
    let mut renderer = Renderer::new(&gpu, &packed, true, Traversal::default()).unwrap();
    let film = renderer.render(&packed.view, &|_| ()).unwrap().film;
    assert_same_bits(&film.develop().unwrap(), &picture, "whitted");
}

/// Of everything that surfaces may have, however it is traced and whatever light the picture had.
#[test]
fn what_the_camera_sees_first() {
    let Some(gpu) = exact() else { return };
    let mut scene = covered();
    // Whitted's model refuses light that surfaces send out.
    scene.settings.transport.integrator = Integrator::Path;
    for (feature, spp, method) in
        [(Feature::Albedo, 3, Method::Auto), (Feature::Normal, 3, Method::Wide), (Feature::Place, 1, Method::Packet)]
    {
        let mut packed = pack(&scene, &scene.cameras[0], settings(&scene, (45, 37), spp));
        packed.packed = packed.packed.showing(Some(feature));
        assert_same(&gpu, &packed, method.into(), &format!("{feature:?}"));
    }
}

/// In flight together or one by one, all at once or in parts.
#[test]
fn samples_in_parts() {
    let scene = shipped("bleeding");
    let packed = pack(&scene, &scene.cameras[0], settings(&scene, (61, 45), 16));
    let (picture, rays) = on_cpu(&packed);
    let renderer = cpu::Renderer::new(&packed, Traversal::default(), 2).unwrap();
    for parts in [&[8, 8][..], &[1, 3, 12]] {
        let (mut film, mut first) = (renderer.start(&packed.view), 0);
        for &count in parts {
            let part = packed.view.samples_of(first..first + count);
            renderer.add::<f32>(&packed.view, &mut film, part, &|_| (), &()).unwrap();
            first += count;
        }
        assert_same_bits(&film.develop().unwrap(), &picture, &format!("CPU, {parts:?}"));
        assert_eq!(film.rays(), rays);
    }
    let Some(mut gpu) = quick_gpu() else { return };
    let sample = 64 * 64 * 48;
    for (in_flight, parts) in [(16, &[16][..]), (16, &[8, 8]), (4, &[16]), (1, &[16]), (1, &[5, 11])] {
        gpu.report.max_binding = gpu.report.max_buffer.min(in_flight * sample);
        let mut renderer = Renderer::new(&gpu, &packed, true, Traversal::default()).unwrap();
        renderer.start(&packed.view).unwrap();
        let mut first = 0;
        for &count in parts {
            renderer.add(first..first + count, &|_| ()).unwrap();
            first += count;
            renderer.film().unwrap();
        }
        let film = renderer.film().unwrap();
        assert_same_bits(&film.develop().unwrap(), &picture, &format!("{in_flight} in flight, {parts:?}"));
        assert_eq!(film.rays(), rays);
    }
}

/// 262,144 samples that are all alike, where every rounding goes the same way: their mean errs by one rounding, a plain sum by more
/// than a two thousandth.
#[test]
fn long_sums_keep_their_digits() {
    const RADIANCE: f32 = 1.0 / 3.0;
    const SAMPLES: u32 = 1 << 18;
    let mut scene = eyerays_tests::model::empty();
    scene.background = Background::Colour(Vec3::splat(RADIANCE));
    let lamp = eyerays_tests::model::matt(Vec3::ONE);
    eyerays_tests::model::add_wall(&mut scene, lamp, Vec3::new(0.0, 0.0, 5.0), 1.0);
    let transport = Transport { integrator: Integrator::Path, ..Transport::default() };
    let packed = pack(&scene, &scene.cameras[0], Settings { transport, ..settings(&scene, (1, 1), SAMPLES) });
    let got = on_cpu(&packed).0.pixels[0][0];
    assert!((got - RADIANCE).abs() <= f32::EPSILON * RADIANCE, "{got}");
    let plain = (0..SAMPLES).fold(0f32, |sum, _| sum + RADIANCE) / SAMPLES as f32;
    assert!((plain - RADIANCE).abs() > 5e-4 * RADIANCE, "this test could not fail: {plain}");
}

/// The emitters are listed by number, wherever the hierarchy puts them.
#[test]
fn every_quality_of_the_hierarchy() {
    for name in SAMPLED {
        let scene = shipped(name);
        let of = |quality: Bvh| {
            on_cpu(&pack_in(&scene, &scene.cameras[0], settings(&scene, (40, 30), 2), quality.quality())).0
        };
        assert_same_bits(&of(Bvh::Fast), &of(Bvh::High), name);
    }
}

/// Other lights of a scene that is loaded, all of them black: positions and powers, which lights are chosen by.
#[test]
fn lights_change_without_another_scene() {
    let mut scene = shipped("lights");
    scene.settings.transport.integrator = Integrator::Path;
    let settings = settings(&scene, (24, 18), 4);
    let dark = |light: &Light| {
        let mut light = light.clone();
        let (Light::Point { colour, .. } | Light::Directional { colour, .. } | Light::Spot { colour, .. }) = &mut light;
        *colour = Vec3::ZERO;
        light
    };
    let black = Scene { lights: scene.lights.iter().map(dark).collect(), ..scene.clone() };
    let packed = pack(&black, &black.cameras[0], settings);
    let mut renderer = cpu::Renderer::new(&packed, Traversal::default(), 2).unwrap();
    for (light, factor) in scene.lights.iter_mut().zip([0.0, 3.0, 0.5].into_iter().cycle()) {
        match light {
            Light::Point { colour, .. } | Light::Spot { colour, .. } | Light::Directional { colour, .. } => {
                *colour *= factor;
            }
        }
    }
    renderer.set_lights(&scene.lights).unwrap();
    let picture = renderer.render::<f32>(&packed.view, &|_| (), &()).unwrap().0;
    let fresh = pack(&scene, &scene.cameras[0], settings);
    assert_same_bits(&picture, &on_cpu(&fresh).0, "CPU");
    let Some(gpu) = quick_gpu() else { return };
    let mut renderer = Renderer::new(&gpu, &packed, true, Traversal::default()).unwrap();
    renderer.set_lights(&scene.lights).unwrap();
    let film = renderer.render(&packed.view, &|_| ()).unwrap().film;
    assert_same_bits(&film.develop().unwrap(), &picture, "GPU");
}

/// Catchers, holes, what rays do not meet, clipping planes and two eyes, by paths and by Whitted's integrator.
#[test]
fn what_pictures_show_of_objects() {
    let Some(gpu) = quick_gpu() else { return };
    for (name, mattes) in
        [("cornell_path", [Matte::Catcher, Matte::Holdout]), ("glass", [Matte::Shown, Matte::Holdout])]
    {
        let mut scene = shipped(name);
        for (number, object) in scene.objects.iter_mut().enumerate() {
            let reflection = number % 3 != 1;
            let shadow = number % 4 != 2;
            let matte = mattes.get(number).copied().unwrap_or_default();
            object.visibility = Visibility { shadow, reflection, matte, ..Visibility::default() };
        }
        let camera = &mut scene.cameras[0];
        let distance = (camera.target - camera.eye).length();
        let stereo =
            Stereo { layout: StereoLayout::SideBySide, distance: 0.05 * distance, convergence: Some(distance) };
        (camera.clip, camera.stereo) = ([0.4 * distance, 1.4 * distance], Some(stereo));
        let settings = Settings { size: (38, 29), samples: 2, spp: 0, ..scene.settings };
        let posed = pack(&scene, &scene.cameras[0], settings);
        assert_same(&gpu, &posed, Traversal::default(), name);
        let alpha = on_cpu(&posed).0.alpha.expect("holes are not opaque");
        assert!(alpha.iter().any(|&alpha| alpha < 1.0), "{name}");
    }
}

/// Lenses, projections, shifts, pixel filters and clear backgrounds, by each integrator.
#[test]
fn what_cameras_have_beside_pinholes() {
    let Some(gpu) = quick_gpu() else { return };
    let lens = Lens { blades: 5, roundness: 0.4, rotation: 11.0, ratio: 1.5, ..Lens::round(0.2) };
    let (fisheye, fov) = (Mapping::Equisolid, 170.0);
    let cases: [(&str, Option<Projection>, Option<Lens>); 6] = [
        ("glass", None, Some(lens)),
        ("cornell", Some(Projection::Fisheye { fov, mapping: Mapping::Equidistant }), None),
        ("cornell_path", None, Some(lens)),
        ("bleeding", Some(Projection::Fisheye { fov, mapping: fisheye }), None),
        ("soft_shadows", Some(Projection::Orthographic { height: 3.0 }), Some(Lens { blades: 0, ..lens })),
        ("occlusion", Some(Projection::Equirectangular), None),
    ];
    for (number, (name, projection, lens)) in cases.into_iter().enumerate() {
        let mut scene = shipped(name);
        let camera = &mut scene.cameras[0];
        (camera.projection, camera.lens) = (projection.unwrap_or(camera.projection), lens);
        camera.shift = if camera.projection.is_flat() { [0.1, -0.2] } else { [0.0; 2] };
        let filter = [PixelFilter::Gaussian, PixelFilter::Box, PixelFilter::Tent][number % 3];
        let (pixel_filter, transparent) = (Some(filter), number % 2 == 0);
        let settings = Settings { size: (37, 29), samples: 2, spp: 0, pixel_filter, transparent, ..scene.settings };
        let posed = pack(&scene, &scene.cameras[0], settings);
        assert_same(&gpu, &posed, Traversal::default(), name);
        assert_eq!(on_cpu(&posed).0.alpha.is_some(), transparent, "{name}");
    }
}
