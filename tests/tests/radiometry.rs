//! Sampled light against closed forms. Each answer is given with its standard error, from how much the pixels differ, which see
//! the same and draw their samples at random; it is below 1e-3, and the answer is within four of them.

use std::f32::consts::PI;

use eyerays::picture::Picture;
use eyerays::scene::{
    Background, Camera, Direct, Disk, Integrator, Light, Material, Projection, Sampler, Scene, Settings, Sphere,
    Transport,
};
use eyerays_tests::model::{add_quad, black, empty, matt};
use eyerays_tests::{by, mean, on_cpu, pack};
use glam::Vec3;

const WAYS: [Direct; 4] = [Direct::Power, Direct::Balance, Direct::Light, Direct::Surface];

fn lamp(radiance: f32) -> Material {
    Material { emission: Vec3::splat(radiance), ..black() }
}

/// Path tracing by random samples, light reflected once.
fn once() -> Settings {
    Settings {
        size: (32, 32),
        spp: 256,
        sampler: Sampler::Random,
        bounces: 0,
        transport: Transport { integrator: Integrator::Path, ..Transport::default() },
        ..Settings::default()
    }
}

/// A camera that sees almost nothing but one point.
fn at(eye: Vec3, target: Vec3) -> Camera {
    let projection = Projection::Perspective { fov: 0.01 };
    Camera { up: Vec3::new(0.1, 0.2, 1.0), ..Camera::new("spot", eye, target, projection) }
}

fn render(scene: &Scene, camera: &Camera, settings: Settings) -> Picture {
    let (picture, rays) = on_cpu(&pack(scene, camera, settings));
    assert_eq!(rays.non_finite, 0);
    picture
}

fn assert_is(what: &str, (got, error): (f64, f64), want: f64) {
    println!("{what}: {got:.6} of {want:.6}, standard error {error:.1e}");
    assert!(error < 1e-3, "{what}: standard error {error}");
    // Rounding alone is below a millionth.
    assert!((got - want).abs() < 4.0 * error + 1e-6, "{what}: {got} of {want}, standard error {error}");
}

/// A white floor around the origin that faces up.
fn on_white_floor() -> Scene {
    let mut scene = empty();
    let corner = |x: f32, z: f32| Vec3::new(3.0 * x, 0.0, 3.0 * z);
    add_quad(&mut scene, matt(Vec3::ONE), [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)]);
    scene
}

/// A unit square of radiance 1 at height 1 that faces down, whose least corner is given.
fn add_square(scene: &mut Scene, x: f32, z: f32) {
    let corner = |i: f32, j: f32| Vec3::new(x + i, 1.0, z + j);
    add_quad(scene, lamp(1.0), [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]);
}

/// A white floor's radiance is the irradiance over pi.
fn assert_floor(what: &str, scene: &Scene, irradiance: f64) {
    let camera = at(Vec3::new(2.0, 0.4, 0.3), Vec3::ZERO);
    for direct in WAYS {
        let picture = render(scene, &camera, by(direct, once()));
        assert_is(&format!("{what}, {direct:?}"), mean(&picture), irradiance / f64::from(PI));
    }
}

#[test]
fn below_a_square() {
    for (what, x, irradiance) in [("below its centre", -0.5, 0.752_275), ("below its corner", 0.0, 0.435_210)] {
        let mut scene = on_white_floor();
        add_square(&mut scene, x, x);
        assert_floor(what, &scene, irradiance);
    }
}

#[test]
fn on_the_axis_of_a_disk() {
    let mut scene = on_white_floor();
    scene.materials.push(lamp(1.0));
    scene.disks.push(Disk { center: Vec3::Y * 2.0, normal: -Vec3::Y, radius: 1.0, material: 1 });
    assert_floor("below a disk", &scene, f64::from(PI) / 5.0);
}

#[test]
fn beside_a_sphere() {
    let mut scene = on_white_floor();
    scene.materials.push(lamp(1.0));
    let center = Vec3::new(-0.8, 0.6, 0.0) * 2.0;
    scene.spheres.push(Sphere { center, radius: 0.5, material: 1 });
    assert_floor("beside a sphere", &scene, 0.117_810);
}

/// The mean over a receiver that is seen from afar, over how much of the picture it takes.
#[test]
fn between_parallel_squares() {
    let receiver = |material: Material| {
        let mut scene = empty();
        let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        add_quad(&mut scene, material, [corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0), corner(0.0, 0.0)]);
        scene
    };
    let middle = Vec3::new(0.5, 0.0, 0.5);
    let away = Vec3::new(0.9, 0.42, 0.1).normalize() * 2000.0;
    let camera =
        Camera { projection: Projection::Perspective { fov: 0.045 }, up: Vec3::Y, ..at(middle + away, middle) };
    let mut lit = receiver(matt(Vec3::ONE));
    add_square(&mut lit, 0.0, 0.0);
    // The lamp is seen from behind, where it is black.
    let mut bright = receiver(lamp(1.0));
    let Some(square) = lit.mesh.positions.get(4..8) else { panic!("the lamp's corners") };
    add_quad(&mut bright, black(), [square[0], square[1], square[2], square[3]]);
    let settings = Settings { size: (128, 128), spp: 64, ..once() };
    let (whole, _) = mean(&render(&bright, &camera, settings));
    for direct in WAYS {
        let parts: Vec<f64> = (0..16)
            .map(|seed| {
                let seeded = Transport { seed, direct, ..settings.transport };
                mean(&render(&lit, &camera, Settings { spp: 16, transport: seeded, ..settings })).0 / whole
            })
            .collect();
        let got = parts.iter().sum::<f64>() / 16.0;
        let square = parts.iter().map(|part| (part - got).powi(2)).sum::<f64>() / 15.0;
        assert_is(&format!("between squares, {direct:?}"), (got, (square / 16.0).sqrt()), 0.199_825);
    }
}

/// A camera inside a unit sphere.
fn inside() -> Camera {
    Camera::new("inside", Vec3::new(0.1, -0.2, 0.5), Vec3::NEG_X, Projection::Perspective { fov: 80.0 })
}

fn in_sphere(material: Material) -> Scene {
    let mut scene = empty();
    scene.materials.push(material);
    scene.spheres.push(Sphere { center: Vec3::ZERO, radius: 1.0, material: 0 });
    scene
}

/// With a point light in its centre.
fn lit_sphere() -> Scene {
    let mut scene = in_sphere(matt(Vec3::splat(0.5)));
    scene.lights.push(Light::Point {
        position: Vec3::ZERO,
        colour: Vec3::splat(PI),
        group: String::new(),
        illuminant: None,
    });
    scene
}

/// Every wall point gets the same from the light, and from all walls, whatever the samples.
#[test]
fn a_point_light_in_a_sphere() {
    let scene = lit_sphere();
    for k in 1..=5 {
        let transport = Transport { roulette: Settings::MOST_BOUNCES, ..once().transport };
        let picture = render(&scene, &inside(), Settings { spp: 4, bounces: k - 1, transport, ..once() });
        let want = 1.0 - 0.5f32.powi(k as i32);
        let all = picture.pixels.iter().map(|pixel| pixel[1]);
        let (least, most) = (all.clone().fold(f32::MAX, f32::min), all.fold(0.0, f32::max));
        println!("{k}: {least} to {most} of {want}");
        assert!((least - want).abs() < 1e-5 && (most - want).abs() < 1e-5, "{k}: {least} to {most} of {want}");
        assert!(most - least < 1e-6, "{k}: {least} to {most}");
    }
}

/// As far away as it is, and no further: neither what lies right behind it nor what it lies on shadows it.
#[test]
fn a_point_light_that_lies_on_a_ceiling() {
    let mut scene = on_white_floor();
    let corner = |x: f32, z: f32| Vec3::new(5.0 * x, 2.0, 5.0 * z);
    let ceiling = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    add_quad(&mut scene, black(), ceiling);
    scene.lights.push(Light::Point {
        position: Vec3::new(0.7, 2.0, -0.4),
        colour: Vec3::splat(10.0),
        group: String::new(),
        illuminant: None,
    });
    // Another kind of light beside it, which sends none.
    scene.lights.push(Light::Directional {
        direction: Vec3::NEG_Y,
        colour: Vec3::ZERO,
        group: String::new(),
        illuminant: None,
    });
    let square = 0.7 * 0.7 + 2.0 * 2.0 + 0.4 * 0.4;
    let want = 10.0 / square * (2.0 / f64::sqrt(square)) / f64::from(PI);
    let (got, _) = mean(&render(&scene, &at(Vec3::new(2.0, 0.4, 0.3), Vec3::ZERO), once()));
    assert!((got - want).abs() < 1e-4 * want, "{got} of {want}");
}

fn assert_everywhere(what: &str, picture: &Picture, want: f32) {
    let far = picture.pixels.as_flattened().iter().map(|got| (got - want).abs()).fold(0.0, f32::max);
    assert!(far < 1e-5, "{what}: {far} off {want}");
}

/// In a glowing sphere each bounce halves the light: what was scattered more than once is at most the clamp, each by itself.
#[test]
fn a_clamp() {
    let scene = in_sphere(Material { emission: Vec3::splat(0.5), two_sided: true, ..matt(Vec3::splat(0.5)) });
    for clamp in [0.05f32, 0.1, 0.125, 0.25, 7.0] {
        let transport =
            Transport { clamp, roulette: Settings::MOST_BOUNCES, direct: Direct::Surface, ..once().transport };
        let picture = render(&scene, &inside(), Settings { spp: 4, bounces: 4, transport, ..once() });
        let scattered = (2..=5).map(|n| (0.5 * 0.5f32.powi(n)).min(clamp));
        let want = 0.5 + 0.25 + scattered.sum::<f32>();
        assert_everywhere(&format!("clamp {clamp}"), &picture, want);
    }
    // Light that is asked for is scattered once more when it arrives.
    let scene = lit_sphere();
    for clamp in [0.1f32, 0.2, 0.25] {
        let transport = Transport { clamp, roulette: Settings::MOST_BOUNCES, ..once().transport };
        let picture = render(&scene, &inside(), Settings { spp: 4, bounces: 3, transport, ..once() });
        let want = 0.5 + (2..=4).map(|n| 0.5f32.powi(n).min(clamp)).sum::<f32>();
        assert_everywhere(&format!("clamp {clamp}, asked for"), &picture, want);
    }
}

/// What covers a lamp, however near to it, leaves no light.
#[test]
fn lids_before_lamps() {
    let lid = |height: f32, radius: f32| {
        let mut scene = on_white_floor();
        scene.materials.extend([black(), lamp(1.0)]);
        let material = scene.materials.len() as u32 - 2;
        let (center, normal) = (Vec3::new(0.0, height, 0.0), Vec3::NEG_Y);
        scene.disks.push(Disk { center, normal, radius, material });
        (scene, material + 1)
    };
    let (mut below_sphere, material) = lid(1.47, 2.0);
    below_sphere.spheres.push(Sphere { center: Vec3::new(0.0, 2.0, 0.0), radius: 0.5, material });
    let (mut below_disk, material) = lid(1.99, 1.5);
    below_disk.disks.push(Disk { center: Vec3::new(0.0, 2.0, 0.0), normal: Vec3::NEG_Y, radius: 1.0, material });
    for (what, scene) in [("sphere", below_sphere), ("disk", below_disk)] {
        for direct in WAYS {
            let picture = render(&scene, &at(Vec3::new(2.0, 0.4, 0.3), Vec3::ZERO), by(direct, once()));
            assert!(picture.pixels.as_flattened().iter().all(|&channel| channel == 0.0), "{what}, {direct:?}");
        }
    }
}

/// About interpolated normals light from below a surface seems to come from above. Such rays start above their triangles, which are in the
/// way: the floor reaches beyond the lamp.
#[test]
fn no_light_comes_from_below_a_smooth_surface() {
    let scene = |height: f32| {
        let mut scene = on_white_floor();
        scene.mesh.positions.iter_mut().for_each(|position| *position *= 4.0);
        scene.mesh.normals = vec![Vec3::new(0.9, 0.4, 0.0).normalize(); scene.mesh.positions.len()];
        scene.materials.push(Material { two_sided: true, ..lamp(1.0) });
        let center = Vec3::new(6.0, height, 0.0);
        scene.disks.push(Disk { center, normal: Vec3::NEG_X, radius: 0.5, material: 1 });
        scene.lights.push(Light::Point {
            position: center + Vec3::NEG_X,
            colour: Vec3::ONE,
            group: String::new(),
            illuminant: None,
        });
        scene
    };
    let camera = at(Vec3::new(2.0, 0.4, 0.3), Vec3::ZERO);
    for direct in WAYS {
        let brightness = |height| mean(&render(&scene(height), &camera, by(direct, once()))).0;
        assert!(brightness(1.0) > 0.0, "{direct:?}: nothing comes from above");
        assert_eq!(brightness(-1.0), 0.0, "{direct:?}");
    }
}

/// White, wherever one looks: as much is emitted as is lost.
#[test]
fn a_furnace() {
    let glowing = Material { emission: Vec3::splat(0.5), two_sided: true, ..matt(Vec3::splat(0.5)) };
    let scene = in_sphere(glowing);
    for direct in WAYS {
        // Without chance a path ends after a hundred bounces, where it no longer counts.
        let roulettes = if direct == Direct::Power { &[3, Settings::MOST_BOUNCES][..] } else { &[3] };
        for &roulette in roulettes {
            let transport = Transport { roulette, direct, ..once().transport };
            let spp = if roulette == 3 { 1024 } else { 64 };
            let settings = Settings { bounces: Settings::MOST_BOUNCES, spp, transport, ..once() };
            let (got, error) = mean(&render(&scene, &inside(), settings));
            println!("{direct:?}, roulette {roulette}: {got:.5}, standard error {error:.1e}");
            assert!((got - 1.0).abs() < 1e-3, "{direct:?}, roulette {roulette}: {got}");
        }
    }
}

/// The background is light that surfaces find.
#[test]
fn a_ball_in_white_surroundings() {
    let mut scene = in_sphere(matt(Vec3::new(0.3, 0.5, 0.9)));
    scene.background = Background::Colour(Vec3::ONE);
    let camera = Camera {
        eye: Vec3::Z * 3.0,
        projection: Projection::Perspective { fov: 25.0 },
        target: Vec3::ZERO,
        ..inside()
    };
    let picture = render(&scene, &camera, Settings { spp: 16, ..once() });
    assert!(picture.pixels.iter().flat_map(|p| [p[0] - 0.3, p[1] - 0.5, p[2] - 0.9]).all(|off| off.abs() < 1e-6));
}
