//! Caustics by photons: against closed forms, against what chance finds, and with the same bits on all ways.

use eyerays::cpu;

use eyerays::film::Film;
use eyerays::gpu::Renderer;
use eyerays::method::Traversal;
use eyerays::picture::Picture;
use eyerays::scene::{
    Background, Camera, Environment, Integrator, Light, Material, Physical, PixelFilter, Projection, Sampler, Scene,
    Settings, Sphere, Texels, Texture, Transport,
};
use eyerays_bvh::Quality;
use eyerays_tests::model::{add_quad, add_wall, black, empty, glass, matt, mirror};
use eyerays_tests::{
    Posed, assert_same_bits, assert_same_on_all_ways, mean, on_cpu, pack, pack_in, quick_gpu, shipped,
};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Paths, and photons for each pixel, of a seed.
fn paths(size: (u32, u32), spp: u32, caustics: f32, seed: u32) -> Settings {
    Settings {
        size,
        spp,
        bounces: 8,
        caustics,
        sampler: Sampler::Random,
        transport: Transport { integrator: Integrator::Path, seed, ..Transport::default() },
        ..Settings::default()
    }
}

/// The same of light that is mirrored or refracted once and then seen, with many photons.
fn once(size: (u32, u32), spp: u32, seed: u32) -> Settings {
    Settings { bounces: 1, pixel_filter: Some(PixelFilter::Box), ..paths(size, spp, 16.0, seed) }
}

fn shining(radiance: f32) -> Material {
    Material { emission: Vec3::splat(radiance), ..black() }
}

fn point(position: Vec3, power: f32) -> Light {
    Light::Point { position, colour: Vec3::splat(power), group: String::new(), illuminant: None }
}

/// A floor at height 0, seen from above by parallel rays: a square of this edge around a place. The scene knows the camera.
fn from_above(scene: &mut Scene, place: Vec3, edge: f32) -> Camera {
    let eye = place + Vec3::Y * 0.2;
    let camera =
        Camera { up: Vec3::NEG_Z, ..Camera::new("above", eye, place, Projection::Orthographic { height: edge }) };
    scene.cameras = vec![camera.clone()];
    camera
}

fn floor(scene: &mut Scene, half: f32) {
    let corner = |x: f32, z: f32| Vec3::new(x * half, 0.0, z * half);
    let corners = [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
    add_quad(scene, matt(Vec3::splat(0.8)), corners);
}

/// The mean of a function of places in a square on the floor.
fn over_square(place: Vec3, edge: f64, of: impl Fn(DVec3) -> f64) -> f64 {
    const STEPS: i32 = 64;
    let along = |i: i32| ((f64::from(i) + 0.5) / f64::from(STEPS) - 0.5) * edge;
    let all = (0..STEPS).flat_map(|x| (0..STEPS).map(move |z| (x, z)));
    let sum: f64 = all.map(|(x, z)| of(place.as_dvec3() + DVec3::new(along(x), 0.0, along(z)))).sum();
    sum / f64::from(STEPS * STEPS)
}

/// The picture's mean is this, but for chance: photons are shared by pixels, so that seeds tell it.
fn assert_mean(what: &str, scene: &Scene, camera: &Camera, want: f64) {
    const SEEDS: u32 = 6;
    let each = |seed| {
        let (picture, rays) = on_cpu(&pack(scene, camera, once((24, 24), 150, seed)));
        assert_eq!(rays.non_finite, 0);
        mean(&picture).0
    };
    let all: Vec<f64> = (0..SEEDS).map(each).collect();
    let count = f64::from(SEEDS);
    let got = all.iter().sum::<f64>() / count;
    let error = (all.iter().map(|one| (one - got).powi(2)).sum::<f64>() / (count - 1.0) / count).sqrt();
    println!("{what}: {got:.5}, standard error {error:.1e}, want {want:.5}");
    assert!(error < 0.01 * want && (got - want).abs() < 4.0 * error + 2e-3 * want, "{what}: {got}, not {want}");
}

/// Of a point lamp no chance finds the image in a mirror: a wall at x = -1 throws its light onto the floor as if another lamp stood behind it, as far away.
#[test]
fn a_mirror_throws_the_light_of_a_point_lamp_as_its_image_would() {
    let mut scene = empty();
    floor(&mut scene, 4.0);
    let corner = |y: f32, z: f32| Vec3::new(-1.0, y, z);
    let corners = [corner(0.0, 1.5), corner(0.0, -1.5), corner(2.0, -1.5), corner(2.0, 1.5)];
    add_quad(&mut scene, mirror(Vec3::splat(0.9)), corners);
    let lamp = Vec3::new(0.4, 1.5, 0.2);
    scene.lights.push(point(lamp, 3.0));
    let (place, edge) = (Vec3::new(0.3, 0.0, 0.1), 0.5);
    let camera = from_above(&mut scene, place, edge);
    let of = |lamp: Vec3, at: DVec3| {
        let away = lamp.as_dvec3() - at;
        3.0 * away.y / away.length().powi(3)
    };
    let both = |at| of(lamp, at) + 0.9 * of(Vec3::new(-2.4, 1.5, 0.2), at);
    let want = 0.8 / PI * over_square(place, edge.into(), both);
    assert_mean("mirror", &scene, &camera, want);
}

/// Light of a point lamp through the flat surface of water, by Snell's law and Fresnel's equations: what goes through a ring of the surface comes to a
/// ring of the floor.
#[test]
fn light_through_a_flat_surface_of_water_is_what_snell_and_fresnel_say() {
    let mut scene = empty();
    floor(&mut scene, 4.0);
    let (depth, height, ior) = (0.75, 2.25, 1.5f64);
    let corner = |x: f32, z: f32| Vec3::new(x * 1.2, depth as f32, z * 1.2);
    let water = Material { ior: ior as f32, ..glass(Vec3::ONE) };
    add_quad(&mut scene, water, [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)]);
    scene.lights.push(point(Vec3::new(0.0, (depth + height) as f32, 0.0), 2.0));
    // The radius at which light comes to the floor, and what share passes the surface.
    let through = |angle: f64| {
        let inner = (angle.sin() / ior).asin();
        let (out, own) = (angle.cos(), inner.cos());
        let across = (out - ior * own) / (out + ior * own);
        let along = (ior * out - own) / (ior * out + own);
        (height * angle.tan() + depth * inner.tan(), 1.0 - (across * across + along * along) / 2.0)
    };
    let irradiance = |at: DVec3| {
        let wanted = at.x.hypot(at.z).max(1e-6);
        let (mut low, mut high) = (0.0, 1.2);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if through(middle).0 < wanted { low = middle } else { high = middle }
        }
        let step = 1e-5;
        let slope = (through(low + step).0 - through(low).0) / step;
        2.0 * through(low).1 * low.sin() / (wanted * slope)
    };
    let edge = 0.5;
    let camera = from_above(&mut scene, Vec3::ZERO, edge);
    let want = 0.8 / PI * over_square(Vec3::ZERO, edge.into(), irradiance);
    assert_mean("water", &scene, &camera, want);
}

/// Scenes in which chance finds caustics often enough: large lamps.
fn found_by_chance() -> Vec<(&'static str, Scene, Camera)> {
    let above = |height: f32| {
        let eye = Vec3::new(0.0, height, height);
        Camera::new("c", eye, Vec3::new(0.0, 0.2, 0.0), Projection::Perspective { fov: 40.0 })
    };
    let mut ball = empty();
    floor(&mut ball, 3.0);
    ball.materials.push(Material { ior: 1.5, ..glass(Vec3::new(0.9, 1.0, 0.8)) });
    ball.spheres.push(Sphere { center: Vec3::new(0.0, 0.8, 0.0), radius: 0.5, material: 1 });
    add_quad(&mut ball, shining(9.0), lamp());
    let mut silver = empty();
    floor(&mut silver, 3.0);
    silver.materials.push(Material {
        physical: Some(Physical {
            metallic: 1.0,
            roughness: 0.0,
            base: Vec3::new(0.9, 0.8, 0.7),
            ..Physical::default()
        }),
        ..matt(Vec3::splat(0.5))
    });
    silver.spheres.push(Sphere { center: Vec3::new(0.4, 0.5, 0.0), radius: 0.5, material: 1 });
    // Lacquered, so that it is lit and lights others, too.
    silver.materials.push(Material {
        physical: Some(Physical { roughness: 0.0, base: Vec3::new(0.2, 0.5, 0.8), ..Physical::default() }),
        ..matt(Vec3::splat(0.5))
    });
    silver.spheres.push(Sphere { center: Vec3::new(-0.7, 0.4, 0.2), radius: 0.4, material: 2 });
    silver.spheres.push(Sphere { center: Vec3::new(0.0, 3.0, -0.5), radius: 0.6, material: 3 });
    silver.materials.push(shining(12.0));
    silver.background = Background::Colour(Vec3::splat(0.2));
    vec![("ball", ball, above(3.0)), ("silver", silver, above(2.6))]
}

fn lamp() -> [Vec3; 4] {
    let corner = |x: f32, z: f32| Vec3::new(x * 0.7 + 0.4, 3.0, z * 0.7);
    [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]
}

/// Means of blocks of 4x4 pixels.
fn blocks(picture: &Picture) -> Vec<f64> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let at = |x: usize, y: usize| f64::from(picture.pixels[y * width + x].iter().sum::<f32>()) / 3.0;
    let block = |bx: usize, by: usize| (0..16).map(|i| at(4 * bx + i % 4, 4 * by + i / 4)).sum::<f64>() / 16.0;
    (0..height / 4).flat_map(|by| (0..width / 4).map(move |bx| (bx, by))).map(|(bx, by)| block(bx, by)).collect()
}

/// Mean and standard error of each block over seeds.
fn over_seeds(scene: &Scene, camera: &Camera, spp: u32, caustics: f32) -> Vec<(f64, f64)> {
    const SEEDS: u32 = 8;
    let all: Vec<Vec<f64>> = (0..SEEDS)
        .map(|seed| blocks(&on_cpu(&pack(scene, camera, paths((32, 24), spp, caustics, seed + 1))).0))
        .collect();
    let count = f64::from(SEEDS);
    (0..all[0].len())
        .map(|block| {
            let mean = all.iter().map(|seed| seed[block]).sum::<f64>() / count;
            let square = all.iter().map(|seed| (seed[block] - mean).powi(2)).sum::<f64>() / (count - 1.0);
            (mean, (square / count).sqrt())
        })
        .collect()
}

/// What photons tell, chance does not count again, and nothing is left out: in the mean of a picture, and of its blocks but for the blur of a
/// radius that is a fraction of a pixel.
fn assert_alike(name: &str, scene: &Scene, camera: &Camera) {
    let chance = over_seeds(scene, camera, 2000, 0.0);
    let photons = over_seeds(scene, camera, 500, 2.0);
    let sum = |all: &[(f64, f64)]| {
        let count = all.len() as f64;
        let mean = all.iter().map(|(mean, _)| mean).sum::<f64>() / count;
        (mean, all.iter().map(|(_, error)| error * error).sum::<f64>().sqrt() / count)
    };
    let (a, b) = (sum(&chance), sum(&photons));
    let z = |(a, b): (&(f64, f64), &(f64, f64))| (a.0 - b.0) / (a.1 * a.1 + b.1 * b.1 + (0.004 * a.0).powi(2)).sqrt();
    let all: Vec<f64> = chance.iter().zip(&photons).map(z).collect();
    let worst = all.iter().fold(0f64, |worst, z| worst.max(z.abs()));
    let root = (all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64).sqrt();
    println!("{name}: chance {:.5}, photons {:.5}, z root mean square {root:.2}, most {worst:.2}", a.0, b.0);
    let room = 4.0 * (a.1 * a.1 + b.1 * b.1).sqrt() + 2e-3 * a.0;
    assert!((b.0 - a.0).abs() < room, "{name}: {a:?} by chance, {b:?} by photons");
    assert!(root < 1.5 && worst < 5.0, "{name}: z {root}, at most {worst}");
}

#[test]
fn photons_tell_what_chance_finds() {
    for (name, scene, camera) in found_by_chance() {
        assert_alike(name, &scene, &camera);
    }
}

/// The floor below a ball of glass, by as many samples: of chance photons leave a small part of the noise.
#[test]
fn photons_leave_little_of_the_noise() {
    let mut scene = empty();
    floor(&mut scene, 3.0);
    scene.materials.push(Material { ior: 1.5, ..glass(Vec3::ONE) });
    scene.spheres.push(Sphere { center: Vec3::new(0.0, 0.8, 0.0), radius: 0.5, material: 1 });
    scene.spheres.push(Sphere { center: Vec3::new(0.3, 4.0, 0.0), radius: 0.2, material: 2 });
    scene.materials.push(shining(60.0));
    let camera = from_above(&mut scene, Vec3::ZERO, 0.8);
    let noise = |caustics| {
        let all = over_seeds(&scene, &camera, 64, caustics);
        all.iter().map(|(_, error)| error * error).sum::<f64>()
    };
    let (chance, photons) = (noise(0.0), noise(2.0));
    println!("chance {chance:.2e}, photons {photons:.2e}");
    assert!(photons < chance / 20.0, "{photons}, beside {chance} by chance");
}

/// Lamps of which most shine away from what casts: a hierarchy that asks what arrives at one place would leave some out.
#[test]
fn each_of_many_lamps_sends_photons() {
    let (scene, camera) = many_lamps();
    assert_alike("lamps", &scene, &camera);
}

/// Two mirrors far apart, and three lamps.
fn many_lamps() -> (Scene, Camera) {
    let mut scene = empty();
    floor(&mut scene, 4.0);
    scene.materials.push(mirror(Vec3::splat(0.9)));
    for x in [-2.0, 2.0] {
        scene.spheres.push(Sphere { center: Vec3::new(x, 0.4, 0.0), radius: 0.4, material: 1 });
    }
    // Two that stand back to back between the balls, and one above.
    let panel = |x: f32, z: f32| {
        let corner = |y: f32, side: f32| Vec3::new(x, y, side * z);
        [corner(0.3, 1.0), corner(0.3, -1.0), corner(1.2, -1.0), corner(1.2, 1.0)]
    };
    add_quad(&mut scene, shining(6.0), panel(0.1, 0.5));
    add_quad(&mut scene, shining(6.0), panel(-0.1, -0.5));
    add_quad(&mut scene, shining(2.0), lamp());
    let eye = Vec3::new(0.0, 3.5, 3.5);
    let camera = Camera::new("c", eye, Vec3::new(0.0, 0.2, 0.0), Projection::Perspective { fov: 55.0 });
    (scene, camera)
}

/// The sky's picture sends photons, too: a ball of glass in a sky with a small sun.
#[test]
fn a_picture_of_the_sky_sends_photons() {
    let mut scene = empty();
    floor(&mut scene, 3.0);
    scene.materials.push(Material { ior: 1.5, ..glass(Vec3::ONE) });
    scene.spheres.push(Sphere { center: Vec3::new(0.0, 0.8, 0.0), radius: 0.5, material: 1 });
    let (width, height) = (32, 16);
    let mut texels = vec![[0.2, 0.25, 0.3, 1.0]; width as usize * height as usize];
    for (x, y) in [(9, 3), (10, 3), (9, 4), (10, 4)] {
        texels[y * width as usize + x] = [40.0, 36.0, 30.0, 1.0];
    }
    let texture = Texture { name: "sky".into(), width, height, texels: Texels::Floats(texels) };
    scene.environment = Some(Environment { texture: texture.into(), rotation: 25.0, scale: 0.5, visible: true });
    let eye = Vec3::new(0.0, 3.0, 3.0);
    let camera = Camera::new("c", eye, Vec3::new(0.0, 0.2, 0.0), Projection::Perspective { fov: 40.0 });
    assert_alike("sky", &scene, &camera);
}

/// All kinds of lamps, mirrors, glass and what is rough, as small as a test can be.
fn all_of_it() -> (Scene, Camera) {
    let (_, mut scene, camera) = found_by_chance().remove(1);
    scene.lights.push(point(Vec3::new(1.5, 2.0, 0.5), 1.0));
    scene.lights.push(Light::Directional {
        direction: Vec3::new(0.3, -1.0, -0.2),
        colour: Vec3::new(0.4, 0.3, 0.2),
        group: String::new(),
        illuminant: None,
    });
    add_wall(&mut scene, mirror(Vec3::splat(0.7)), Vec3::new(0.0, 1.0, -1.5), 0.8);
    (scene, camera)
}

#[test]
fn every_method_and_device_gives_the_same_bits() {
    let (scene, camera) = all_of_it();
    assert_same_on_all_ways(&pack(&scene, &camera, Settings { sampler: Sampler::Sobol, ..paths((24, 20), 5, 1.5, 3) }));
}

/// Several balls around casters, of which lanes draw different ones.
#[test]
fn many_casters_and_lamps_have_the_same_bits() {
    let (scene, camera) = many_lamps();
    assert_same_on_all_ways(&pack(&scene, &camera, Settings { sampler: Sampler::Sobol, ..paths((24, 20), 3, 2.0, 1) }));
}

/// Samples and regions in any parts, one after the other, are those of all at once, on a CPU and on a GPU.
#[test]
fn parts_are_the_whole() {
    let (scene, camera) = all_of_it();
    let posed: Posed = pack(&scene, &camera, Settings { sampler: Sampler::Sobol, ..paths((40, 33), 6, 1.0, 0) });
    let (whole, rays) = on_cpu(&posed);
    let renderer = cpu::Renderer::new(&posed, Traversal::default(), 2).unwrap();
    let mut film: Film = renderer.start(&posed.view);
    for (samples, region) in [(0..2, 0), (2..6, 0), (0..5, 1), (5..6, 1)] {
        let pieces: Vec<_> = posed.view.region().pieces(40, 17).collect();
        let part = eyerays::film::Part { region: pieces[region], samples };
        renderer.add::<f32>(&posed.view, &mut film, part, &|_| (), &()).unwrap();
    }
    assert_same_bits(&film.develop().unwrap(), &whole, "parts");
    assert_eq!(film.rays(), rays);
    let Some(gpu) = quick_gpu() else { return };
    let mut renderer = Renderer::new(&gpu, &posed, true, Traversal::default()).unwrap();
    renderer.start(&posed.view).unwrap();
    for samples in [0..1, 1..4, 4..6] {
        renderer.add(samples, &|_| ()).unwrap();
    }
    let film = renderer.film().unwrap();
    assert_same_bits(&film.develop().unwrap(), &whole, "GPU in parts");
    assert_eq!(film.rays(), rays);
}

/// Few rays are followed through a hierarchy that is soon built and many through a better one, and a film of few is continued.
#[test]
fn a_better_hierarchy_changes_nothing() {
    let scene = shipped("caustics");
    let of = |quality| {
        let settings = Settings { size: (48, 32), spp: 2, ..scene.settings };
        let posed = pack_in(&scene, &scene.cameras[0], settings, quality);
        assert!(posed.packed.has_photons());
        on_cpu(&posed)
    };
    let (want, rays) = of(Quality::Fast);
    for quality in [Quality::Medium, Quality::High, Quality::Linear] {
        let (picture, counted) = of(quality);
        assert_same_bits(&want, &picture, &format!("{quality:?}"));
        assert_eq!(rays, counted, "{quality:?}");
    }
}

/// Where nothing casts a caustic, pictures have the bits and the kernels that they have without.
#[test]
fn without_casters_there_are_no_photons() {
    let mut scene = empty();
    floor(&mut scene, 3.0);
    add_quad(&mut scene, shining(5.0), lamp());
    let camera = from_above(&mut scene, Vec3::ZERO, 1.0);
    let of = |caustics| pack(&scene, &camera, paths((16, 16), 4, caustics, 0));
    assert!(!of(1.0).packed.has_photons());
    assert_same_bits(&on_cpu(&of(1.0)).0, &on_cpu(&of(0.0)).0, "no casters");
}
