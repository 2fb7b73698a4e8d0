//! Lamps and lights that move while the shutter is open, against the mean of what they are at many moments.

use eyerays::gpu;
use eyerays::method::Method;
use eyerays::picture::Picture;
use eyerays::scene::{
    Camera, Direct, Falloff, Integrator, Light, Material, Object, PixelFilter, Primitives, Projection, Sampler, Scene,
    Settings, Transport, Visibility,
};
use eyerays_tests::model::{add, add_quad, add_wall, empty, matt};
use eyerays_tests::{assert_same_bits, by, on_cpu, pack, quick_gpu};
use glam::{DMat3, DVec3, Vec3};

const SIZE: (u32, u32) = (12, 9);

fn settings(integrator: Integrator, spp: u32, seed: u32) -> Settings {
    Settings {
        size: SIZE,
        spp,
        bounces: 1,
        sampler: Sampler::Sobol,
        pixel_filter: Some(PixelFilter::Box),
        transport: Transport { integrator, seed, ..Transport::default() },
        ..Settings::default()
    }
}

/// What emits so much light to all sides of its front.
fn shining(radiance: f32) -> Material {
    Material { emission: Vec3::splat(radiance), ..matt(Vec3::ZERO) }
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Moving {
    /// A lamp of two triangles goes aside.
    Goes,
    /// Five lamps turn together.
    Turns,
    /// A lamp grows to four times its area.
    Grows,
    /// Lights without extent go and turn.
    Lights,
}

/// A floor below lamps, seen from above, at a time of the shutter.
fn scene(moving: Moving, time: f32) -> Scene {
    let mut scene = empty();
    add_wall(&mut scene, matt(Vec3::splat(0.8)), Vec3::new(0.0, 0.0, -1.0), 3.0);
    add_wall(&mut scene, matt(Vec3::splat(0.8)), Vec3::new(0.0, 0.0, 9.0), 0.1);
    let ground = scene.mesh.triangles.len();
    let object = |primitives| {
        let (bounds, visibility) = ([Vec3::ZERO; 2], Visibility::default());
        Object { name: "thing".into(), primitives, bounds, visibility }
    };
    let mut objects = vec![object(Primitives::Triangles(0..ground))];
    let down = |x: f32, y: f32, half: f32| {
        let corner = |a: f32, b: f32| Vec3::new(x + a * half, y + b * half, 0.5);
        [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]
    };
    match moving {
        Moving::Goes => add_quad(&mut scene, shining(4.0), down(-1.5 + 3.0 * time, 0.2, 0.4)),
        Moving::Grows => add_quad(&mut scene, shining(4.0), down(0.5, 0.0, 0.3 + 0.3 * time)),
        Moving::Turns => {
            let turn = DMat3::from_axis_angle(DVec3::new(0.2, 0.1, 1.0).normalize(), f64::from(time) * 1.2);
            for number in 0..5 {
                let corners = down(-1.6 + 0.8 * number as f32, 0.3 * number as f32, 0.2);
                let turned = corners.map(|corner| (turn * corner.as_dvec3()).as_vec3());
                add(&mut scene, shining(2.0 + number as f32), &turned, &[[0, 1, 2], [0, 2, 3]]);
            }
        }
        Moving::Lights => {
            let (colour, group) = (Vec3::ONE, String::new());
            let place = Vec3::new(-1.0 + 2.0 * time, 0.5, 0.5);
            let target = Vec3::new(1.5 * time, -0.5, -1.0);
            scene.lights = vec![
                Light::Point { position: place, colour, group: group.clone(), illuminant: None },
                Light::Directional {
                    direction: Vec3::new(time - 0.5, 0.3, -1.0),
                    colour,
                    group: group.clone(),
                    illuminant: None,
                },
                Light::Spot {
                    position: place + Vec3::Y,
                    target,
                    colour: colour * 4.0,
                    outer: 40.0,
                    inner: 20.0,
                    falloff: Falloff::Gltf,
                    group,
                    illuminant: None,
                },
            ];
        }
    }
    if scene.mesh.triangles.len() > ground {
        objects.push(object(Primitives::Triangles(ground..scene.mesh.triangles.len())));
    }
    scene.objects = objects;
    let projection = Projection::Orthographic { height: 4.0 };
    scene.cameras = vec![Camera { up: Vec3::Y, ..Camera::new("above", Vec3::Z * 5.0, Vec3::ZERO, projection) }];
    scene
}

fn blurred(moving: Moving, steps: usize) -> Scene {
    let later: Vec<Scene> = (1..=steps).map(|step| scene(moving, step as f32 / steps as f32)).collect();
    let moved = scene(moving, 0.0).over(&later, 1.0).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(moved.left, [""; 0]);
    moved.scene
}

fn picture(scene: &Scene, settings: Settings) -> Picture {
    on_cpu(&pack(scene, &scene.cameras[0], settings)).0
}

/// The light of nine blocks of the picture.
fn blocks(picture: &Picture) -> Vec<f64> {
    let mut sums = vec![0.0; 9];
    for (i, pixel) in picture.pixels.iter().enumerate() {
        let (x, y) = (i as u32 % SIZE.0, i as u32 / SIZE.0);
        sums[(y * 3 / SIZE.1 * 3 + x * 3 / SIZE.0) as usize] += f64::from(pixel[0]);
    }
    sums
}

/// Means of blocks over pictures, and their standard errors.
fn means(pictures: &[Picture]) -> Vec<(f64, f64)> {
    let all: Vec<Vec<f64>> = pictures.iter().map(blocks).collect();
    let count = all.len() as f64;
    let of = |block: usize| {
        let values = all.iter().map(|blocks| blocks[block]);
        let mean = values.clone().sum::<f64>() / count;
        let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (mean, (variance / count).sqrt())
    };
    (0..9).map(of).collect()
}

/// Whatever finds the lamps, and whichever is chosen of them.
#[test]
fn blurred_light_is_the_mean_of_that_of_all_moments() {
    const MOMENTS: u32 = 64;
    for moving in [Moving::Goes, Moving::Turns, Moving::Grows, Moving::Lights] {
        // One still picture a moment, in the middle of its part of the time.
        let still = |moment: u32| {
            let time = (moment as f32 + 0.5) / MOMENTS as f32;
            picture(&scene(moving, time), settings(Integrator::Path, 128, moment))
        };
        let moments: Vec<Vec<f64>> = (0..MOMENTS).map(|moment| blocks(&still(moment))).collect();
        let want: Vec<f64> =
            (0..9).map(|block| moments.iter().map(|of| of[block]).sum::<f64>() / f64::from(MOMENTS)).collect();
        let blurred = blurred(moving, 16);
        let lights: &[Direct] = if moving == Moving::Lights {
            &[Direct::Power]
        } else {
            &[Direct::Power, Direct::Balance, Direct::Light, Direct::Surface]
        };
        for &direct in lights {
            let spp = if direct == Direct::Surface { 1536 } else { 384 };
            let of = |seed| picture(&blurred, by(direct, settings(Integrator::Path, spp, seed)));
            let got = means(&(0..12).map(of).collect::<Vec<_>>());
            for (block, (&want, &(mean, error))) in want.iter().zip(&got).enumerate() {
                // Still pictures have noise, too, and steps of a sixteenth of a turn are straight.
                let off = 4.0 * error + 8e-3 * want;
                assert!(
                    (mean - want).abs() <= off,
                    "{moving:?}, {direct}, block {block}: {mean} +- {error}, not {want}"
                );
            }
        }
    }
}

/// Lights without extent have no noise.
#[test]
fn whitted_lights_move_too() {
    let whitted = |scene: &Scene, spp: u32| picture(scene, settings(Integrator::Whitted, spp, 0));
    let got = blocks(&whitted(&blurred(Moving::Lights, 16), 1024));
    let moments: Vec<Vec<f64>> =
        (0..64u32).map(|moment| blocks(&whitted(&scene(Moving::Lights, (moment as f32 + 0.5) / 64.0), 64))).collect();
    for block in 0..9 {
        let want = moments.iter().map(|of| of[block]).sum::<f64>() / 64.0;
        assert!((got[block] - want).abs() < 4e-3 * want, "block {block}: {} instead of {want}", got[block]);
    }
}

#[test]
fn a_gpu_has_the_same_bits() {
    let Some(gpu) = quick_gpu() else { return };
    for moving in [Moving::Goes, Moving::Turns, Moving::Grows, Moving::Lights] {
        let scene = blurred(moving, 3);
        let mut integrators = vec![Integrator::Path, Integrator::Distributed];
        integrators.extend((moving == Moving::Lights).then_some(Integrator::Whitted));
        for integrator in integrators {
            let posed = pack(&scene, &scene.cameras[0], settings(integrator, 4, 1));
            let want = on_cpu(&posed).0;
            let mut renderer = gpu::Renderer::new(&gpu, &posed.packed, true, Method::IfIf).unwrap();
            let got = renderer.render(&posed.view, &|_| ()).unwrap().film.develop().unwrap();
            assert_same_bits(&want, &got, &format!("{moving:?}, {integrator}"));
        }
    }
}
