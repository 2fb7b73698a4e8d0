//! Participating media against closed forms and published tables, with standard errors from pixels that see the same.

mod temperatures;

use std::sync::Arc;

use eyerays::picture::Picture;
use eyerays::scene::{
    Background, Camera, Direct, Grid, Integrator, Light, Material, Medium, Physical, Projection, Sampler, Scene,
    Settings, Sphere, Transport, Volume,
};
use eyerays_tests::model::{add_box, add_wall, black, empty, glass, matt};
use eyerays_tests::{assert_same_bits, assert_same_on_all_ways, by, mean, on_cpu, pack};
use glam::{DVec3, Vec3};

const WAYS: [Direct; 4] = [Direct::Power, Direct::Balance, Direct::Light, Direct::Surface];

/// Paths by random samples.
fn paths(spp: u32, bounces: u32) -> Settings {
    Settings {
        size: (32, 32),
        spp,
        bounces,
        sampler: Sampler::Random,
        transport: Transport { integrator: Integrator::Path, ..Transport::default() },
        ..Settings::default()
    }
}

fn medium(scattering: f32, absorption: f32, anisotropy: f32) -> Medium {
    let [scattering, absorption] = [scattering, absorption].map(Vec3::splat);
    Medium { scattering, absorption, anisotropy, ..Medium::default() }
}

/// What has no surface, but is filled with a medium.
fn open(medium: Medium) -> Material {
    Material { volume: Some(Volume::open(medium)), ..black() }
}

fn shining(radiance: f32) -> Material {
    Material { emission: Vec3::splat(radiance), two_sided: true, ..black() }
}

/// A camera that sees almost nothing but one point.
fn at(eye: Vec3, target: Vec3) -> Camera {
    let projection = Projection::Perspective { fov: 0.001 };
    Camera { up: Vec3::new(0.1, 1.0, 0.2), ..Camera::new("spot", eye, target, projection) }
}

fn render(scene: &Scene, camera: &Camera, settings: Settings) -> Picture {
    let (picture, rays) = on_cpu(&pack(scene, camera, settings));
    assert_eq!(rays.non_finite, 0);
    picture
}

fn assert_is(what: &str, (got, error): (f64, f64), want: f64) {
    println!("{what}: {got:.6} of {want:.6}, standard error {error:.1e}");
    assert!(error < 2e-3, "{what}: standard error {error}");
    assert!((got - want).abs() < 4.0 * error + 2e-6, "{what}: {got} of {want}, standard error {error}");
}

/// So wide that what leaves at its sides does not count.
const WIDE: f32 = 300.0;

/// A slab of a medium below z = 0, with a wall that shines above or below it.
fn slab(medium: Medium, thickness: f32, lamp: f32) -> Scene {
    let mut scene = empty();
    let corner = Vec3::new(WIDE, WIDE, 0.0);
    add_box(&mut scene, open(medium), -corner - Vec3::Z * thickness, corner);
    add_wall(&mut scene, shining(1.0), Vec3::Z * lamp, 2.0 * WIDE);
    scene
}

/// By reciprocity, what a camera sees of a slab below a white sky is what the slab reflects of a beam along the camera's ray. The table
/// is van de Hulst's (Multiple Light Scattering, 1980), of albedo 0.9, a mean cosine of 0.75 and an optical depth of 2.
#[test]
fn a_slab_reflects_and_transmits_what_van_de_hulst_found() {
    let of = medium(0.9, 0.1, 0.75);
    for (what, lamp, want) in [("reflected", 2.0, 0.097_39), ("transmitted", -3.0, 0.660_96)] {
        let scene = slab(of, 2.0, lamp);
        let camera = at(Vec3::Z, Vec3::ZERO);
        for direct in [Direct::Power, Direct::Surface] {
            let picture = render(&scene, &camera, by(direct, paths(400, 500)));
            assert_is(&format!("{what}, {direct:?}"), mean(&picture), want);
        }
    }
}

/// 1 - sqrt(1 - w) H(cosine) with Chandrasekhar's function of isotropic scattering (Radiative Transfer, 1960).
#[test]
fn a_half_space_reflects_what_chandrasekhar_found() {
    let upright = Vec3::Z;
    let aslant = Vec3::new(0.75f32.sqrt(), 0.0, 0.5);
    for (albedo, from, want) in [
        (0.9, upright, 0.414_947),
        (0.5, upright, 0.115_226),
        (0.99, upright, 0.752_721),
        (0.9, aslant, 0.507_939),
        (0.5, aslant, 0.160_144),
        (0.99, aslant, 0.815_140),
    ] {
        let scene = slab(medium(albedo, 1.0 - albedo, 0.0), 80.0, 2.0);
        let picture = render(&scene, &at(from, Vec3::ZERO), paths(64, 4000));
        assert_is(&format!("albedo {albedo} from {from}"), mean(&picture), want);
    }
}

/// What a white floor below a lamp shows, with and without something on the lamp's way that the camera does not see through.
#[test]
fn shadow_rays_are_dimmed_by_what_they_go_through() {
    let lit = |within: &dyn Fn(&mut Scene)| {
        let mut scene = empty();
        add_box(&mut scene, matt(Vec3::ONE), Vec3::new(-9.0, -1.0, -9.0), Vec3::new(9.0, 0.0, 9.0));
        scene.lights.push(Light::Point {
            position: Vec3::new(0.0, 8.0, 0.0),
            colour: Vec3::ONE,
            group: String::new(),
            illuminant: None,
        });
        within(&mut scene);
        let picture = render(&scene, &at(Vec3::new(5.0, 0.5, 0.0), Vec3::ZERO), paths(1, 0));
        picture.pixels[0].map(f64::from)
    };
    let bare = lit(&|_| ());
    let around = |scene: &mut Scene, of: Material, bottom: f32, top: f32| {
        add_box(scene, of, Vec3::new(-2.0, bottom, -2.0), Vec3::new(2.0, top, 2.0));
    };
    let red = Medium { absorption: Vec3::new(0.0, 0.5, 2.0), ..Medium::default() };
    let hidden = |medium, priority| {
        let mut material = open(medium);
        material.volume.as_mut().unwrap().priority = priority;
        material
    };
    let ratio = |with: [f64; 3], channel: usize| with[channel] / bare[channel];
    // Rays start off the surfaces that they go on through, by a millionth of the scene.
    let near = |what: &str, got: f64, want: f64| {
        let error = (got / want - 1.0).abs();
        assert!(error < 1e-5 * (1.0 - want.ln()), "{what}: {got} is not {want}");
    };

    let through = lit(&|scene| around(scene, open(red), 2.0, 5.0));
    for (channel, sigma) in [0.0, 0.5, 2.0].into_iter().enumerate() {
        near("one box", ratio(through, channel), (-3.0f64 * sigma).exp());
    }
    let both = lit(&|scene| {
        around(scene, open(medium(0.1, 0.1, 0.5)), 2.0, 5.0);
        around(scene, open(red), 5.5, 6.5);
    });
    near("two boxes", ratio(both, 1), (-3.0f64 * 0.2 - 0.5).exp());
    // Nested, and overlapping: what has the higher priority is there.
    let nested = lit(&|scene| {
        around(scene, open(medium(0.1, 0.0, 0.0)), 1.0, 7.0);
        around(scene, open(red), 2.0, 3.0);
    });
    near("nested", ratio(nested, 1), (-5.0f64 * 0.1 - 0.5).exp());
    for (priority, want) in [(0, -3.0 * 0.1 - 0.5), (3, -0.1 - 3.0 * 0.5)] {
        let overlapping = lit(&|scene| {
            around(scene, hidden(medium(0.1, 0.0, 0.0), 1), 1.0, 4.0);
            around(scene, hidden(red, priority), 2.0, 5.0);
        });
        near(&format!("overlapping, priority {priority}"), ratio(overlapping, 1), f64::exp(want));
    }
    let ball = lit(&|scene| {
        scene.materials.push(open(red));
        let material = scene.materials.len() as u32 - 1;
        scene.spheres.push(Sphere { center: Vec3::Y * 4.0, radius: 1.5, material });
    });
    near("a ball", ratio(ball, 1), (-1.5f64).exp());
}

/// Absorbed and sent on a way of length 2 before a wall of radiance 3, in fog and inside of a box, by camera rays and further ones.
#[test]
fn what_is_seen_through_fog_is_as_dim_and_as_bright_as_the_closed_form_says() {
    let of = Medium { emission: Vec3::splat(0.7), ..medium(0.0, 0.4, 0.0) };
    let left = (-0.8f64).exp();
    let want = 3.0 * left + 0.7 * (1.0 - left);
    let mut foggy = empty();
    add_wall(&mut foggy, shining(3.0), Vec3::NEG_Z * 2.0, 1.0);
    let mut boxed = foggy.clone();
    foggy.fog = Some(of);
    add_box(&mut boxed, open(of), Vec3::splat(-9.0), Vec3::splat(9.0));
    // A box that is entered on the way: only its part of it counts.
    let mut entered = empty();
    add_wall(&mut entered, shining(3.0), Vec3::NEG_Z * 2.0, 1.0);
    add_box(&mut entered, open(of), Vec3::new(-9.0, -9.0, -1.5), Vec3::new(9.0, 9.0, -0.5));
    let half = (-0.4f64).exp();
    for (what, scene, want) in [
        ("fog", &foggy, want),
        ("from inside", &boxed, want),
        ("a box on the way", &entered, 3.0 * half + 0.7 * (1.0 - half)),
    ] {
        assert_is(what, mean(&render(scene, &at(Vec3::ZERO, Vec3::NEG_Z), paths(1600, 3))), want);
    }
}

/// Far from the scene, too, a camera is in the fog.
#[test]
fn fog_begins_at_the_camera_however_far_it_is_from_the_scene() {
    for distance in [3.0f32, 50.0, 2000.0] {
        let mut scene = empty();
        add_wall(&mut scene, shining(1.0), Vec3::ZERO, 1.0);
        scene.fog = Some(medium(0.0, 1.0 / distance, 0.0));
        let picture = render(&scene, &at(Vec3::Z * distance, Vec3::ZERO), paths(900, 1));
        assert_is(&format!("from {distance}"), mean(&picture), (-1.0f64).exp());
    }
}

/// White light from everywhere, and nothing is absorbed: nothing is seen, whatever scatters.
#[test]
fn what_absorbs_nothing_is_not_seen_in_a_white_furnace() {
    let scatters = |anisotropy| medium(3.0, 0.0, anisotropy);
    for (what, material) in [
        ("open", open(scatters(0.0))),
        ("forward", open(scatters(0.8))),
        ("back", open(scatters(-0.5))),
        (
            "glass",
            Material { volume: Some(Volume { interface: true, ..Volume::open(scatters(0.3)) }), ..glass(Vec3::ONE) },
        ),
    ] {
        let mut scene = empty();
        scene.background = Background::Colour(Vec3::ONE);
        scene.materials.push(material);
        scene.spheres.push(Sphere { center: Vec3::NEG_Z * 3.0, radius: 1.0, material: 0 });
        let picture = render(&scene, &at(Vec3::ZERO, Vec3::new(0.2, 0.1, -3.0)), paths(400, 4000));
        assert_is(what, mean(&picture), 1.0);
    }
}

/// Water over glass, whose boxes overlap: what has the higher priority is there, and light is bent and reflected as the indices on both
/// sides of each surface say, of which there are three. What none of them absorbs gets through by 1 / (1 + sum R / (1 - R)).
#[test]
fn bodies_within_bodies_reflect_by_the_indices_on_both_sides() {
    let filled = |ior: f32, priority: u8| Material {
        ior,
        volume: Some(Volume { interface: true, priority, ..Volume::open(Medium::default()) }),
        ..glass(Vec3::ONE)
    };
    let physical = |ior: f32, priority: u8| Material {
        physical: Some(Physical { transmission: Vec3::ONE, roughness: 0.0, ior, ..Physical::default() }),
        ..filled(ior, priority)
    };
    let share = |a: f64, b: f64| {
        let reflected = ((a - b) / (a + b)).powi(2);
        reflected / (1.0 - reflected)
    };
    let want = 1.0 / (1.0 + share(1.0, 1.33) + share(1.33, 1.5) + share(1.5, 1.0));
    for (what, of) in [("by the thesis' model", &filled as &dyn Fn(f32, u8) -> Material), ("by microfacets", &physical)]
    {
        for (water, glass) in [(0, 1), (5, 9)] {
            let mut scene = empty();
            let corner = Vec3::new(WIDE, WIDE, 0.0);
            add_box(&mut scene, of(1.33, water), -corner - Vec3::Z * 2.0, corner);
            add_box(&mut scene, of(1.5, glass), -corner - Vec3::Z * 3.0, corner - Vec3::Z);
            add_wall(&mut scene, shining(1.0), Vec3::NEG_Z * 5.0, 2.0 * WIDE);
            let picture = render(&scene, &at(Vec3::Z, Vec3::ZERO), paths(400, 200));
            assert_is(what, mean(&picture), want);
        }
    }
}

/// By all strategies alike: a lamp with extent, seen by what a ball and the fog around it scatter.
#[test]
fn every_strategy_finds_as_much_light() {
    let mut scene = empty();
    scene.fog = Some(Medium { scattering: Vec3::new(0.1, 0.2, 0.3), ..medium(0.0, 0.05, 0.6) });
    scene.materials.push(open(medium(2.0, 0.2, -0.3)));
    scene.spheres.push(Sphere { center: Vec3::NEG_Z * 3.0, radius: 1.0, material: 0 });
    add_wall(&mut scene, shining(6.0), Vec3::new(0.0, 0.5, -6.0), 1.0);
    let camera = at(Vec3::ZERO, Vec3::new(0.3, 0.0, -3.0));
    let all = WAYS.map(|direct| mean(&render(&scene, &camera, by(direct, paths(900, 40)))));
    let least = all.iter().map(|(_, error)| *error).fold(f64::MAX, f64::min);
    let (want, _) = *all.iter().find(|(_, error)| *error == least).unwrap();
    for (direct, (got, error)) in WAYS.iter().zip(all) {
        println!("{direct:?}: {got:.5}, {error:.1e}");
        assert!((got - want).abs() < 4.0 * (error * error + least * least).sqrt(), "{direct:?}: {got} of {want}");
    }
}

/// As much everywhere as a homogeneous medium has, and nothing at all.
#[test]
fn a_grid_of_one_number_is_a_homogeneous_medium_and_one_of_zeros_nothing() {
    let scene = |of: Medium, density: Option<Arc<Grid>>| {
        let mut scene = empty();
        scene.background = Background::Colour(Vec3::splat(0.2));
        add_wall(&mut scene, shining(3.0), Vec3::new(0.0, 2.0, -4.0), 1.5);
        let volume = Volume { density, ..Volume::open(of) };
        add_box(&mut scene, Material { volume: Some(volume), ..black() }, Vec3::splat(-1.0), Vec3::splat(1.0));
        scene
    };
    let even = |number: f32| {
        let numbers = vec![number; 20 * 5 * 9];
        Some(Arc::new(Grid::dense("even", [20, 5, 9], &numbers, [DVec3::splat(-1.2), DVec3::splat(1.2)])))
    };
    let camera = at(Vec3::Z * 5.0, Vec3::new(0.3, 0.1, 0.0));
    let (thin, thick) = (medium(0.4, 0.1, 0.3), medium(1.6, 0.4, 0.3));
    let seen = |scene: &Scene| render(scene, &camera, paths(400, 30));
    let (want, error) = mean(&seen(&scene(thick, None)));
    let (got, other) = mean(&seen(&scene(thin, even(4.0))));
    println!("{got:.5} and {want:.5}, {other:.1e} and {error:.1e}");
    assert!((got - want).abs() < 4.0 * (error * error + other * other).sqrt(), "{got} is not {want}");
    let nothing = seen(&scene(thick, even(0.0)));
    assert_same_bits(&nothing, &seen(&scene(Medium::default(), None)), "a grid of zeros");
}

/// A ramp along the way, whose integral is known.
#[test]
fn shadow_rays_are_dimmed_by_the_integral_of_a_grid() {
    let lit = |density: Option<Arc<Grid>>| {
        let mut scene = empty();
        add_box(&mut scene, matt(Vec3::ONE), Vec3::new(-9.0, -1.0, -9.0), Vec3::new(9.0, 0.0, 9.0));
        scene.lights.push(Light::Point {
            position: Vec3::new(0.0, 8.0, 0.0),
            colour: Vec3::ONE,
            group: String::new(),
            illuminant: None,
        });
        let of = if density.is_some() { medium(0.3, 0.2, 0.0) } else { Medium::default() };
        let volume = Volume { density, ..Volume::open(of) };
        let material = Material { volume: Some(volume), ..black() };
        add_box(&mut scene, material, Vec3::new(-2.0, 1.0, -2.0), Vec3::new(2.0, 5.0, 2.0));
        mean(&render(&scene, &at(Vec3::new(5.0, 0.5, 0.0), Vec3::ZERO), paths(100, 0)))
    };
    // From 0 to 1 along y.
    let numbers: Vec<f32> = (0..4 * 40 * 3).map(|i| (i / 4 % 40) as f32 / 40.0 + 0.0125).collect();
    let grid = Grid::dense("ramp", [4, 40, 3], &numbers, [DVec3::new(-3.0, 1.0, -3.0), DVec3::new(3.0, 5.0, 3.0)]);
    let ((bare, _), (got, error)) = (lit(None), lit(Some(Arc::new(grid))));
    let want = bare * (-0.5f64 * 4.0 * 0.5).exp();
    println!("{got:.6} of {want:.6}, {error:.1e}");
    assert!((got - want).abs() < 4.0 * error && error < 0.01 * want, "{got} is not {want}");
}

/// A box of nothing without a surface is not there, to the bit of what is behind it, but for rays that its faces part.
#[test]
fn what_is_filled_with_nothing_is_not_there() {
    let mut scene = empty();
    add_wall(&mut scene, matt(Vec3::splat(0.6)), Vec3::NEG_Z * 4.0, 3.0);
    scene.background = Background::Colour(Vec3::splat(0.3));
    scene.lights.push(Light::Point { position: Vec3::ZERO, colour: Vec3::ONE, group: String::new(), illuminant: None });
    let camera = Camera::new("c", Vec3::ZERO, Vec3::NEG_Z, Projection::Perspective { fov: 40.0 });
    let bare = render(&scene, &camera, paths(16, 3));
    // Nothing, and rays that go on through 120 faces of it.
    for i in 0..30 {
        let z = -1.0 - 0.05 * i as f32;
        add_box(&mut scene, open(Medium::default()), Vec3::new(-0.4, -0.4, z), Vec3::new(0.4, 0.4, z + 0.02));
    }
    let with = render(&scene, &camera, paths(16, 3));
    let differ = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 1e-4 * a[c]);
    let odd = bare.pixels.iter().zip(&with.pixels).filter(|&pair| differ(pair)).count();
    assert_eq!(odd, 0, "of {}", bare.pixels.len());
}

/// Media that are alike share a number: what a picture shows does not hang on how often they are described.
#[test]
fn equal_media_of_several_materials_are_one() {
    let scene = |count: usize| {
        let mut scene = empty();
        scene.background = Background::Colour(Vec3::ONE);
        for i in 0..300 {
            let of = open(medium(1.0 + (i % count) as f32, 0.5, 0.2));
            let min = Vec3::new(-1.0, -1.0, -3.0 - 4.0 * i as f32);
            add_box(&mut scene, of, min, min + Vec3::new(2.0, 2.0, 1.0));
        }
        scene
    };
    let camera = at(Vec3::ZERO, Vec3::NEG_Z);
    render(&scene(200), &camera, paths(1, 2));
    let refused = eyerays::job::Job::new(&scene(300), paths(1, 2), eyerays::quality::Bvh::Fast.quality());
    let message = refused.err().expect("accepted").to_string();
    assert!(message.contains("more than 255 media"), "{message}");
}

/// With surfaces that are there and others, overlapping.
#[test]
fn every_method_gives_the_same_bits() {
    let mut scene = empty();
    scene.fog = Some(medium(0.05, 0.01, 0.4));
    add_box(&mut scene, open(medium(1.0, 0.2, 0.5)), Vec3::new(-2.0, -1.0, -6.0), Vec3::new(0.5, 1.0, -4.0));
    let volume = Some(Volume { interface: true, priority: 2, ..Volume::open(medium(0.3, 1.0, 0.0)) });
    scene.materials.push(Material { volume, ..glass(Vec3::ONE) });
    scene.spheres.push(Sphere { center: Vec3::new(0.5, 0.2, -5.0), radius: 0.9, material: 1 });
    add_wall(&mut scene, shining(4.0), Vec3::new(0.0, 0.0, -9.0), 2.0);
    let camera = Camera::new("c", Vec3::ZERO, Vec3::NEG_Z, Projection::Perspective { fov: 50.0 });
    assert_same_on_all_ways(&pack(&scene, &camera, paths(4, 20)));
}
