//! Estimates of the same light by different ways: their means agree on each of 64 blocks of the picture, by the standard errors
//! that seeds tell.

use std::collections::BTreeSet;
use std::sync::Arc;

use eyerays::picture::Picture;
use eyerays::scene::{
    Alpha, Direct, Environment, Integrator, Light, Map, Physical, PixelFilter, Placement, Sampler, Scene, Settings,
    Texels, Texture, Transport,
};
use eyerays_tests::{by, on_cpu, pack, shipped};
use glam::{Vec2, Vec3};

/// Blocks along an edge of the picture.
const BLOCKS: usize = 8;
const SEEDS: u32 = 24;

/// Brightness of each block by each seed.
fn blocks(picture: &Picture) -> Vec<f64> {
    let edge = picture.width as usize / BLOCKS;
    let mut sums = vec![0.0; BLOCKS * BLOCKS];
    for (index, pixel) in picture.pixels.iter().enumerate() {
        let (x, y) = (index % picture.width as usize, index / picture.width as usize);
        sums[y / edge * BLOCKS + x / edge] += pixel.iter().map(|&channel| f64::from(channel)).sum::<f64>();
    }
    sums
}

/// The mean of each block, and the square of its standard error.
fn estimate(scene: &Scene, settings: Settings) -> Vec<(f64, f64)> {
    let all: Vec<Vec<f64>> = (0..SEEDS)
        .map(|seed| {
            let transport = Transport { seed, ..settings.transport };
            let (picture, rays) = on_cpu(&pack(scene, &scene.cameras[0], Settings { transport, ..settings }));
            assert_eq!(rays.non_finite, 0);
            blocks(&picture)
        })
        .collect();
    let count = f64::from(SEEDS);
    (0..BLOCKS * BLOCKS)
        .map(|block| {
            let mean = all.iter().map(|blocks| blocks[block]).sum::<f64>() / count;
            let square = all.iter().map(|blocks| (blocks[block] - mean).powi(2)).sum::<f64>() / (count - 1.0);
            (mean, square / count)
        })
        .collect()
}

fn assert_alike(what: &str, a: &[(f64, f64)], b: &[(f64, f64)]) {
    let z = |(a, b): (&(f64, f64), &(f64, f64))| {
        let error = (a.1 + b.1).sqrt();
        // A block may be black, or as bright in all samples.
        if (a.0 - b.0).abs() <= 1e-5 * a.0.abs() { 0.0 } else { (a.0 - b.0) / error }
    };
    let all: Vec<f64> = a.iter().zip(b).map(z).collect();
    let worst = all.iter().fold(0.0f64, |worst, z| worst.max(z.abs()));
    let mean = all.iter().sum::<f64>() / (all.len() as f64).sqrt();
    println!("{what}: greatest |z| {worst:.2} of {} blocks, {mean:.2} of their sum", all.len());
    assert!(worst < 4.0 && mean.abs() < 4.0, "{what}: {worst:.2}, {mean:.2}");
}

fn settings(scene: &Scene) -> Settings {
    // Filters that reach further let few samples of a lamp's edge decide about a block.
    let pixel_filter = Some(PixelFilter::Box);
    Settings { size: (64, 64), spp: 32, sampler: Sampler::Random, pixel_filter, ..scene.settings }
}

/// Samples of lights, of surfaces, and both weighted in either way; with chance ending paths, and without.
fn assert_scene(scene: &Scene) {
    let settings = Settings { bounces: 3, ..settings(scene) };
    let power = estimate(scene, by(Direct::Power, settings));
    for direct in [Direct::Balance, Direct::Light, Direct::Surface] {
        assert_alike(&format!("power and {direct:?}"), &power, &estimate(scene, by(direct, settings)));
    }
    for roulette in [0, Settings::MOST_BOUNCES] {
        let transport = Transport { roulette, ..settings.transport };
        let other = estimate(scene, Settings { transport, ..settings });
        assert_alike(&format!("roulette after {roulette}"), &power, &other);
    }
}

#[test]
fn a_box_with_a_lamp_and_a_glass_ball() {
    assert_scene(&shipped("cornell_path"));
}

#[test]
fn lamps_of_every_shape() {
    assert_scene(&shipped("soft_shadows"));
}

/// Makes the lamp of a scene three times as wide, so that chance finds it soon, and returns its material.
fn widen_lamp(scene: &mut Scene) -> usize {
    let lamp = scene.materials.iter().position(|material| material.emission != Vec3::ZERO).expect("there is a lamp");
    let mesh = &mut scene.mesh;
    let of_lamp = mesh.triangles.iter().zip(&mesh.materials).filter(|(_, material)| **material as usize == lamp);
    let corners: BTreeSet<u32> = of_lamp.flat_map(|(corners, _)| *corners).collect();
    let middle = corners.iter().map(|&corner| mesh.positions[corner as usize]).sum::<Vec3>() / corners.len() as f32;
    for corner in corners {
        let place = &mut mesh.positions[corner as usize];
        *place = middle + (*place - middle) * 3.0;
    }
    lamp
}

/// Everything opaque to a share, or behind a mask: what surfaces find and what lamps send is as much less.
#[test]
fn lamps_that_are_not_opaque_everywhere() {
    let dots = |i: usize| if i.is_multiple_of(3) { [255; 4] } else { [255, 255, 255, 40] };
    let texels = Texels::Bytes((0..8 * 8).map(dots).collect());
    let texture = Arc::new(Texture { name: "dots".into(), width: 8, height: 8, texels });
    for (alpha, is_covered) in
        [(Alpha::Blend, false), (Alpha::Blend, true), (Alpha::Mask(0.3), true), (Alpha::Mask(0.9), false)]
    {
        let mut scene = shipped("cornell_path");
        let places = &scene.mesh.positions;
        scene.mesh.coordinates[0] = places.iter().map(|place| Vec2::new(place.x, place.z) * 3.0).collect();
        let lamp = widen_lamp(&mut scene);
        let lamp = &mut scene.materials[lamp];
        (lamp.alpha, lamp.opacity) = (alpha, 0.6);
        lamp.maps.opacity = is_covered.then(|| Map { texture: texture.clone(), placement: Placement::default() });
        let settings = Settings { bounces: 1, ..settings(&scene) };
        let power = estimate(&scene, by(Direct::Power, settings));
        for direct in [Direct::Light, Direct::Surface] {
            let what = format!("{alpha:?}, {is_covered}, power and {direct:?}");
            assert_alike(&what, &power, &estimate(&scene, by(direct, settings)));
        }
    }
}

/// On an eighth of its picture, beside which there is another light: rays find what samples of lamps find, by any filter.
#[test]
fn lamps_with_pictures() {
    let texel = |i: usize| if i % 64 < 8 && i / 64 < 8 { [255, 200, 90, 255] } else { [0, 0, 160, 255] };
    let texels = Texels::Bytes((0..64 * 64).map(texel).collect());
    let texture = Arc::new(Texture { name: "atlas".into(), width: 64, height: 64, texels });
    let mut scene = shipped("cornell_path");
    scene.mesh.coordinates[0] =
        scene.mesh.positions.iter().map(|place| Vec2::new(place.x, place.z).fract().abs()).collect();
    let lamp = widen_lamp(&mut scene);
    let placement = Placement::default().transformed(Vec2::splat(0.125), 0.0, Vec2::ZERO);
    scene.materials[lamp].maps.emission = Some(Map { texture, placement });
    let settings = Settings { bounces: 1, ..settings(&scene) };
    let power = estimate(&scene, by(Direct::Power, settings));
    for direct in [Direct::Light, Direct::Surface] {
        assert_alike(&format!("power and {direct:?}"), &power, &estimate(&scene, by(direct, settings)));
    }
}

#[test]
fn colours_that_walls_throw() {
    assert_scene(&shipped("bleeding"));
}

#[test]
fn lights_without_extent_beside_a_lamp() {
    let mut scene = shipped("lights");
    // Not the stage: what stands on it gets light from however near, which is rare and bright where lights alone are sampled, so
    // that so few pictures tell its error badly.
    let lamp = scene.materials.iter_mut().find(|material| material.name == "piece");
    lamp.expect("there are pieces").emission = Vec3::splat(0.5);
    scene.settings.transport.integrator = Integrator::Path;
    assert_scene(&scene);
}

/// A scene below a picture of 16 x 8 texels, one of which is bright; a ball and the floor are of rough materials.
fn below(column: usize, row: usize) -> Scene {
    let mut texels = vec![[0.02, 0.03, 0.05, 1.0]; 16 * 8];
    texels[row * 16 + column] = [40.0, 35.0, 30.0, 1.0];
    let texture = Texture { name: "sky".into(), width: 16, height: 8, texels: Texels::Floats(texels) };
    let mut scene = shipped("lights");
    scene.lights.clear();
    scene.environment = Some(Environment { texture: texture.into(), rotation: 25.0, scale: 0.5, visible: true });
    let rough = Physical { base: Vec3::new(0.8, 0.5, 0.3), roughness: 0.4, ..Physical::default() };
    let metal = Physical { metallic: 1.0, roughness: 0.3, anisotropy: 0.5, ..rough };
    for (material, physical) in scene.materials.iter_mut().zip([rough, metal].into_iter().cycle()) {
        material.physical = Some(physical);
    }
    scene.settings.transport.integrator = Integrator::Path;
    scene
}

/// Also where the bright texel touches a pole: its directions are few, and its neighbours all around.
#[test]
fn light_of_an_environment_from_any_side() {
    for (column, row) in [(9, 3), (3, 0), (12, 7)] {
        let scene = below(column, row);
        let settings = Settings { bounces: 2, ..settings(&scene) };
        let power = estimate(&scene, by(Direct::Power, settings));
        for direct in [Direct::Light, Direct::Surface] {
            let what = format!("texel ({column}, {row}), power and {direct:?}");
            assert_alike(&what, &power, &estimate(&scene, by(direct, settings)));
        }
    }
}

/// By another integrator.
fn with(integrator: Integrator, settings: Settings) -> Settings {
    Settings { transport: Transport { integrator, ..settings.transport }, ..settings }
}

/// Where nothing reflects, shines or lets pass, both draw the light of lamps that arrives at once, and no other.
#[test]
fn distributed_rays_and_paths_without_bounces() {
    for name in ["cornell_path", "soft_shadows", "bleeding"] {
        let mut scene = shipped(name);
        scene.ambient = Vec3::ZERO;
        for material in &mut scene.materials {
            (material.reflection, material.specular) = (Vec3::ZERO, Vec3::ZERO);
            material.transmission = Vec3::ZERO;
        }
        let settings = Settings { bounces: 0, spp: 64, ..settings(&scene) };
        let of = |integrator| estimate(&scene, with(integrator, settings));
        assert_alike(name, &of(Integrator::Distributed), &of(Integrator::Path));
    }
}

/// A directional light has one place to be sampled at: then a distributed tree is Whitted's, of mirrors, glass, highlights and
/// ambient light, but for pi of the light.
#[test]
fn distributed_trees_are_whitteds() {
    // By a least contribution a mirrored or a refracted ray goes on alone.
    for (name, min_contribution) in [("whitted", 0.0), ("glass", 0.0), ("whitted", 0.07)] {
        let mut scene = shipped(name);
        let settings = Settings {
            size: (96, 64),
            samples: 1,
            bounces: 8,
            min_contribution,
            sampler: Sampler::Regular,
            ..scene.settings
        };
        // Nothing is seen from within glass, nor the inside of its surface: Whitted's model does not compress light there.
        for material in scene.materials.iter_mut().filter(|material| material.transmission != Vec3::ZERO) {
            (material.ambient, material.diffuse, material.specular) = (Some(Vec3::ZERO), Vec3::ZERO, Vec3::ZERO);
        }
        for camera in [0, 1] {
            let mut picture = |integrator, light: f32| {
                let direction = Vec3::new(-0.4, -1.0, 0.3);
                scene.lights = vec![Light::Directional {
                    direction,
                    colour: Vec3::splat(0.5 * light),
                    group: String::new(),
                    illuminant: None,
                }];
                on_cpu(&pack(&scene, &scene.cameras[camera], with(integrator, settings))).0
            };
            let (tree, want) =
                (picture(Integrator::Distributed, std::f32::consts::PI), picture(Integrator::Whitted, 1.0));
            let off = |(got, want): (&[f32; 3], &[f32; 3])| got.iter().zip(want).any(|(a, b)| (a - b).abs() > 2e-5);
            let others = tree.pixels.iter().zip(&want.pixels).filter(|&pair| off(pair)).count();
            println!(
                "{name}, camera {camera}, least {min_contribution}: {others} of {} pixels differ",
                want.pixels.len()
            );
            // Balls that mirror each other magnify the rounding of a ray's start; within glass, where light is compressed, the
            // least contribution ends other rays.
            let share = if min_contribution == 0.0 { 500 } else { 100 };
            assert!(others <= want.pixels.len() / share, "{name}, camera {camera}: {others}");
        }
    }
}
