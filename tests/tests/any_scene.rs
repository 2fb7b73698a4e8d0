//! Any scene that is accepted is drawn: whatever its materials, pictures and vertices have and lack, no kernel reads beyond what was
//! packed, and all light is finite.

use std::sync::Arc;

use eyerays::choice::Named;
use eyerays::device_scene::Feature;
use eyerays::gpu::{Gpu, Renderer};
use eyerays::method::Traversal;
use eyerays::scene::{
    Absorption, Alpha, Coat, Conductor, DiffuseTransmission, Direct, Environment, Filter, FinishMaps, Grid, Hair,
    Integrator, Map, Maps, Material, Medium, Physical, Placement, Sampler, Scene, Settings, Sheen, Temperature, Texels,
    Texture, ThinFilm, Transport, Volume, Wall, Wrap,
};
use eyerays::spectrum::{Fluorescent, Glass, Illuminant, Metal};
use eyerays_tests::random::Random;
use eyerays_tests::{assert_same_bits, on_cpu, pack, quick_gpu, shipped};
use glam::{DVec3, Vec2, Vec3, Vec4};

const SCENES: u64 = 1500;

/// One of a few.
fn one<T: Copy>(random: &mut Random, of: &[T]) -> T {
    of[random.index(of.len())]
}

fn chance(random: &mut Random, share: f64) -> bool {
    random.unit() < share
}

fn colour(random: &mut Random) -> Vec3 {
    let channel = |random: &mut Random| one(random, &[0.0, 0.0, 0.3, 1.0]);
    Vec3::new(channel(random), channel(random), channel(random))
}

/// Small ones, with texels of every kind.
fn pictures() -> Vec<Arc<Texture>> {
    let picture = |name: &str, width, height, texels| Arc::new(Texture { name: name.into(), width, height, texels });
    let noise = (0..3 * 5u32).map(|i| i.wrapping_mul(2_654_435_761).to_le_bytes()).collect();
    vec![
        picture("black", 1, 1, Texels::Bytes(vec![[0; 4]])),
        picture("noise", 3, 5, Texels::Bytes(noise)),
        picture(
            "spark",
            64,
            64,
            Texels::Bytes((0..64 * 64).map(|i| if i == 9 { [1, 9, 0, 7] } else { [0; 4] }).collect()),
        ),
        picture("dark", 2, 1, Texels::Floats(vec![[0.0; 4]; 2])),
        picture(
            "bright",
            1,
            4,
            Texels::Floats(vec![[0.0, 1e3, 1e-20, 1.0], [1e3, 1e3, 1e3, 0.3], [1e-30; 4], [0.5; 4]]),
        ),
    ]
}

fn map(random: &mut Random, pictures: &[Arc<Texture>]) -> Option<Map> {
    let wrap = one(random, &[Wrap::Repeat, Wrap::Mirror, Wrap::Clamp]);
    let scale = one(random, &[0.0, 1.0, -3.0, 1e6]);
    let placement = Placement {
        set: random.bits() % 2,
        wrap: [wrap; 2],
        nearest: chance(random, 0.5),
        ..Placement::default().transformed(Vec2::splat(scale), 30.0, Vec2::new(0.5, -9.0))
    };
    chance(random, 0.3).then(|| Map { texture: pictures[random.index(pictures.len())].clone(), placement })
}

fn maps(random: &mut Random, pictures: &[Arc<Texture>]) -> Maps {
    Maps {
        base: map(random, pictures),
        metallic_roughness: map(random, pictures),
        normal: map(random, pictures),
        normal_scale: one(random, &[0.0, 1.0, -1e3]),
        emission: map(random, pictures),
        transmission: map(random, pictures),
        specular_weight: map(random, pictures),
        specular_tint: map(random, pictures),
        anisotropy: map(random, pictures),
        opacity: map(random, pictures),
        finish: if chance(random, 0.5) { finish_maps(random, pictures) } else { FinishMaps::default() },
    }
}

fn physical(random: &mut Random) -> Physical {
    let gold = Conductor { eta: Vec3::new(0.143, 0.375, 1.442), k: Vec3::new(3.983, 0.0, 100.0), metal: None };
    Physical {
        base: colour(random),
        metallic: one(random, &[0.0, 0.5, 1.0]),
        roughness: one(random, &[0.0, 0.03, 0.4, 1.0]),
        anisotropy: one(random, &[0.0, 0.0, 1.0]),
        anisotropy_rotation: 77.0,
        specular_weight: one(random, &[0.0, 1.0]),
        specular_tint: 4.0 * colour(random),
        transmission: colour(random),
        ior: one(random, &[1.0, 1.001, 1.5, 4.0]),
        wall: one(random, Wall::VARIANTS),
        absorption: chance(random, 0.5).then(|| Absorption { colour: colour(random), distance: 1e-3 }),
        conductor: one(random, &[None, None, None, Some(gold), Some(Metal::Copper.conductor())]),
        coat: chance(random, 0.3)
            .then(|| Coat { weight: one(random, &[0.0, 0.5, 1.0]), roughness: one(random, &[0.0, 0.03, 0.5, 1.0]) }),
        sheen: chance(random, 0.3).then(|| Sheen { colour: colour(random), roughness: one(random, &[0.0, 0.3, 1.0]) }),
        diffuse_transmission: chance(random, 0.3)
            .then(|| DiffuseTransmission { weight: one(random, &[0.0, 0.5, 1.0]), colour: colour(random) }),
        film: chance(random, 0.3).then(|| ThinFilm {
            weight: one(random, &[0.0, 0.5, 1.0]),
            ior: one(random, &[1.0, 1.3, 4.0]),
            thickness: [one(random, &[0.0, 300.0]), one(random, &[0.0, 500.0, 1e5])],
        }),
        abbe: one(random, &[None, Some(1.0), Some(30.0)]),
        glass: one(random, &[None, None, Some(Glass::Sf11), Some(Glass::Diamond)]),
        hair: chance(random, 0.2).then(|| Hair {
            roughness: one(random, &[0.0, 0.3, 1.0]),
            radial_roughness: one(random, &[0.0, 0.3, 1.0]),
            tilt: one(random, &[-10.0, 0.0, 2.0]),
        }),
    }
}

fn finish_maps(random: &mut Random, pictures: &[Arc<Texture>]) -> FinishMaps {
    FinishMaps {
        coat: map(random, pictures),
        coat_roughness: map(random, pictures),
        coat_normal: map(random, pictures),
        coat_normal_scale: one(random, &[1.0, 3.0]),
        sheen_colour: map(random, pictures),
        sheen_roughness: map(random, pictures),
        diffuse_transmission: map(random, pictures),
        diffuse_transmission_colour: map(random, pictures),
        film: map(random, pictures),
        film_thickness: map(random, pictures),
    }
}

fn medium(random: &mut Random) -> Medium {
    let absorption = one(random, &[0.0, 1.0, 1e12]) * colour(random);
    let sends = |c: f32| if c > 0.0 { 3.0 } else { 0.0 };
    Medium {
        scattering: one(random, &[0.0, 1e-6, 2.0, 1e12]) * colour(random),
        absorption,
        anisotropy: one(random, &[-0.999, -0.4, 0.0, 0.8, 0.999]),
        emission: if chance(random, 0.3) { absorption.map(sends) } else { Vec3::ZERO },
    }
}

/// Of any kind, as dense everywhere or as a grid says.
fn volume(random: &mut Random, may_be_open: bool) -> Volume {
    let numbers: Vec<f32> = (0..9 * 9 * 10).map(|_| one(random, &[0.0, 0.0, 0.3, 1e-30, 40.0])).collect();
    let grid = Grid::dense("grid", [9, 9, 10], &numbers, [DVec3::splat(-1.5), DVec3::new(1.0, 0.5, 1.5)]);
    Volume {
        medium: medium(random),
        interface: !may_be_open || chance(random, 0.4),
        priority: one(random, &[0, 0, 7]),
        density: chance(random, 0.4).then(|| Arc::new(grid.clone())),
        temperature: chance(random, 0.3)
            .then(|| Temperature { grid: Arc::new(grid), kelvins: one(random, &[0.001, 1.0, 50.0, 1e6]) }),
    }
}

fn change(random: &mut Random, material: &mut Material, pictures: &[Arc<Texture>]) {
    material.physical = chance(random, 0.7).then(|| physical(random));
    material.maps = maps(random, pictures);
    material.emission = one(random, &[0.0, 0.0, 1e-6, 1e3]) * colour(random);
    material.volume = chance(random, 0.3).then(|| volume(random, material.emission == Vec3::ZERO));
    material.two_sided = chance(random, 0.5);
    material.alpha = one(random, &[Alpha::Opaque, Alpha::Mask(0.0), Alpha::Mask(0.5), Alpha::Mask(1.0), Alpha::Blend]);
    material.opacity = one(random, &[0.0, 0.5, 1.0]);
}

fn any_scene(random: &mut Random) -> Scene {
    let mut scene = shipped(one(random, &["lights", "bleeding", "soft_shadows", "glass", "cornell_path"]));
    let pictures = pictures();
    scene.materials.iter_mut().for_each(|material| change(random, material, &pictures));
    let mesh = &mut scene.mesh;
    let count = mesh.positions.len();
    for set in 0..2 {
        let coordinate = |random: &mut Random| Vec2::new(random.magnitude(-3.0, 3.0), one(random, &[0.0, 0.5, 1e9]));
        let has = chance(random, 0.5);
        mesh.coordinates[set] = if has { (0..count).map(|_| coordinate(random)).collect() } else { Vec::new() };
    }
    if chance(random, 0.4) {
        mesh.colours = (0..count).map(|_| colour(random).extend(one(random, &[0.0, 0.5, 1.0]))).collect();
    }
    if chance(random, 0.4) {
        let tangent = |random: &mut Random| one(random, &[Vec4::ZERO, Vec4::X, Vec4::new(0.6, 0.0, 0.8, -1.0)]);
        mesh.tangents = (0..count).map(|_| tangent(random)).collect();
    }
    if chance(random, 0.3) {
        mesh.normals = Vec::new();
    }
    if chance(random, 0.4) {
        scene.lights.clear();
    }
    let far = pictures[random.index(pictures.len())].clone();
    let visible = chance(random, 0.5);
    scene.environment =
        chance(random, 0.5).then_some(Environment { texture: far, rotation: 33.0, scale: 2.0, visible });
    scene.settings = any_settings(random, &scene);
    for light in &mut scene.lights {
        let spectra = [Illuminant::BlackBody(500.0), Illuminant::Fluorescent(Fluorescent::Narrow)].map(Some);
        *light = light.clone().of_spectrum(one(random, &[None, spectra[0], spectra[1]]));
    }
    scene.fog = chance(random, 0.2).then(|| medium(random));
    if !matches!(scene.settings.transport.integrator, Integrator::Path | Integrator::Ao) {
        // Nothing else goes through media.
        scene.fog = None;
        scene.materials.iter_mut().for_each(|material| material.volume = None);
    }
    scene
}

fn any_settings(random: &mut Random, scene: &Scene) -> Settings {
    let shines = scene.materials.iter().any(|material| material.emission != Vec3::ZERO);
    let mut integrators = vec![Integrator::Path, Integrator::Path, Integrator::Distributed, Integrator::Ao];
    if !shines {
        integrators.push(Integrator::Whitted);
    }
    let direct = one(random, &[Direct::Power, Direct::Balance, Direct::Light, Direct::Surface]);
    let transport = Transport { integrator: one(random, &integrators), direct, ..Transport::default() };
    Settings {
        size: (8, 6),
        samples: 1,
        spp: 1,
        sampler: Sampler::Random,
        bounces: 3,
        culling: chance(random, 0.2),
        compensation: chance(random, 0.8),
        spectral: transport.integrator == Integrator::Path && chance(random, 0.4),
        caustics: if transport.integrator == Integrator::Path { one(random, &[0.0, 0.0, 0.5, 3.0]) } else { 0.0 },
        filter: one(random, &[Filter::Nearest, Filter::Bilinear, Default::default()]),
        transport,
        ..Settings::default()
    }
}

#[test]
fn any_scene_that_is_accepted_is_drawn() {
    let mut drawn = 0;
    for seed in 0..SCENES {
        let mut random = Random::new(seed);
        let scene = any_scene(&mut random);
        if let Err(error) = scene.check() {
            panic!("seed {seed}: {error}");
        }
        let mut posed = pack(&scene, &scene.cameras[0], scene.settings);
        for feature in [None, Some(one(&mut random, &[Feature::Albedo, Feature::Normal, Feature::Place]))] {
            posed.packed = posed.packed.showing(feature);
            let (picture, rays) = on_cpu(&posed);
            assert_eq!(rays.non_finite, 0, "seed {seed}, {feature:?}");
            drawn += picture.pixels.iter().filter(|pixel| pixel.iter().any(|&channel| channel != 0.0)).count();
        }
    }
    assert!(drawn as u64 > 10 * SCENES, "most are not black, but {drawn} pixels are bright");
}

/// Of the first so many, `EYERAYS_SCENES` or five: each asks for kernels of its own, which take seconds to compile.
#[test]
fn any_scene_has_the_same_bits_on_a_gpu() {
    let Some(gpu) = quick_gpu() else { return };
    let count = std::env::var("EYERAYS_SCENES").ok().and_then(|count| count.parse().ok()).unwrap_or(5);
    for seed in 0..count {
        let scene = any_scene(&mut Random::new(seed));
        assert_same_on(&gpu, &scene, &format!("seed {seed}"));
        println!("{} scenes have the same bits", seed + 1);
    }
}

/// Light that pictures take away leaves kernels something to bind.
#[test]
fn black_surroundings_and_black_lamps_are_drawn_on_a_gpu() {
    let Some(gpu) = quick_gpu() else { return };
    let black = pictures()[0].clone();
    let mut scene = shipped("bleeding");
    scene.lights.clear();
    for material in &mut scene.materials {
        material.maps.emission = Some(Map { texture: black.clone(), placement: Placement::default() });
        material.emission = Vec3::ONE;
    }
    scene.settings = Settings { size: (8, 6), spp: 1, bounces: 1, ..scene.settings };
    assert_same_on(&gpu, &scene, "black lamps");
    scene.environment = Some(Environment { texture: black, rotation: 0.0, scale: 1.0, visible: true });
    assert_same_on(&gpu, &scene, "black lamps in black surroundings");
}

fn assert_same_on(gpu: &Gpu, scene: &Scene, what: &str) {
    let posed = pack(scene, &scene.cameras[0], scene.settings);
    let mut renderer = Renderer::new(gpu, &posed, true, Traversal::default()).unwrap_or_else(|e| panic!("{what}: {e}"));
    let rendering = renderer.render(&posed.view, &|_| ()).unwrap_or_else(|e| panic!("{what}: {e}"));
    assert_same_bits(&rendering.film.develop().unwrap(), &on_cpu(&posed).0, what);
}
