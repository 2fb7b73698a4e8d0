//! What lies on surfaces and what else their bases do, by pictures: against closed forms, and with the same bits on all ways.

use eyerays::scene::{
    Background, Camera, Coat, DiffuseTransmission, Integrator, Material, Physical, Projection, Sampler, Scene,
    Settings, Sheen, Sphere, ThinFilm, Transport, Wall,
};
use eyerays_tests::model::{add_quad, add_wall, black, empty, glass, matt};
use eyerays_tests::prism::Prism;
use eyerays_tests::{assert_same_on_all_ways, mean, on_cpu, pack};
use glam::{DVec3, Vec3};

fn paths(size: u32, spp: u32, bounces: u32) -> Settings {
    Settings {
        size: (size, size),
        spp,
        bounces,
        sampler: Sampler::Random,
        transport: Transport { integrator: Integrator::Path, ..Transport::default() },
        ..Settings::default()
    }
}

fn shining(radiance: f32) -> Material {
    Material { emission: Vec3::splat(radiance), ..black() }
}

fn of(physical: Physical) -> Material {
    Material { physical: Some(physical), ..matt(physical.base) }
}

const LACQUER: Coat = Coat { weight: 1.0, roughness: 0.0 };
const VELVET: Sheen = Sheen { colour: Vec3::ONE, roughness: 0.4 };
const LEAF: DiffuseTransmission = DiffuseTransmission { weight: 0.4, colour: Vec3::ONE };
const BUBBLE: ThinFilm = ThinFilm { weight: 1.0, ior: 1.33, thickness: [100.0, 400.0] };

/// White surfaces that send on all light, whatever lies on them.
fn white() -> Vec<(&'static str, Physical)> {
    let plain = Physical { specular_weight: 0.0, ..Physical::default() };
    let flint = Physical { transmission: Vec3::ONE, roughness: 0.0, ior: 1.7, abbe: Some(20.0), ..Physical::default() };
    let coat = |roughness| Some(Coat { roughness, ..LACQUER });
    vec![
        ("lacquer", Physical { coat: Some(LACQUER), ..plain }),
        ("rough lacquer", Physical { coat: coat(0.5), ..plain }),
        ("lacquer on a mirror", Physical { metallic: 1.0, roughness: 0.0, coat: coat(0.4), ..plain }),
        ("velvet", Physical { sheen: Some(VELVET), ..plain }),
        ("lacquer on velvet", Physical { coat: coat(0.3), sheen: Some(VELVET), ..plain }),
        ("leaf", Physical { diffuse_transmission: Some(LEAF), wall: Wall::Interface, ..plain }),
        ("flint", flint),
    ]
}

#[test]
fn white_finishes_are_not_seen_in_a_white_furnace() {
    for (what, physical) in white() {
        let mut scene = empty();
        scene.background = Background::Colour(Vec3::ONE);
        scene.materials.push(of(physical));
        scene.spheres.push(Sphere { center: Vec3::NEG_Z * 3.0, radius: 1.0, material: 0 });
        let camera = Camera::new("c", Vec3::ZERO, Vec3::new(0.2, 0.1, -3.0), Projection::Perspective { fov: 40.0 });
        let (picture, rays) = on_cpu(&pack(&scene, &camera, paths(16, 1600, 400)));
        let (got, error) = mean(&picture);
        println!("{what}: {got:.5}, standard error {error:.1e}");
        assert_eq!(rays.non_finite, 0);
        assert!(error < 2e-3 && (got - 1.0).abs() < 4.0 * error + 2e-3, "{what}: {got}, standard error {error}");
    }
}

/// A prism of 60 degrees sends red, green and blue light each where its index does: to a lamp that only this channel finds.
#[test]
fn a_prism_sends_each_channel_where_its_index_does() {
    let prism = Prism { apex: 60f64.to_radians(), symmetric: 1.6 };
    let abbe = 15.0;
    let spread = 0.6 / (2.0 * abbe);
    for (channel, index) in [1.6 - spread, 1.6, 1.6 + spread].into_iter().enumerate() {
        let mut scene = empty();
        let flint = Physical {
            transmission: Vec3::ONE,
            roughness: 0.0,
            ior: 1.6,
            abbe: Some(abbe as f32),
            ..Physical::default()
        };
        prism.add(&mut scene, Material { physical: Some(flint), ior: 1.6, ..glass(Vec3::ONE) });
        let way = prism.through(index);
        let (place, side) = (40.0 * way, 0.3 * way.cross(DVec3::Z));
        let up = 0.3 * DVec3::Z;
        let corners = [place - side - up, place + side - up, place + side + up, place - side + up];
        add_quad(&mut scene, Material { two_sided: true, ..shining(1.0) }, corners.map(|c| c.as_vec3()));
        let eye = (-30.0 * prism.incident()).as_vec3();
        let camera =
            Camera { up: Vec3::Z, ..Camera::new("c", eye, Vec3::ZERO, Projection::Perspective { fov: 0.001 }) };
        let (picture, _) = on_cpu(&pack(&scene, &camera, paths(8, 4000, 8)));
        let [r, g, b] = [0, 1, 2].map(|c| picture.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / 64.0);
        let seen = [r, g, b];
        for (other, seen) in seen.into_iter().enumerate() {
            let want = if other == channel { 0.8..1.0 } else { 0.0..0.02 };
            assert!(want.contains(&seen), "of channel {other} the lamp of {channel} has {seen}: {r} {g} {b}");
        }
    }
}

/// Crown glass BK7 in the light of helium's d line: by a prism of 60 degrees the least deviation is 38.647 degrees.
#[test]
fn bk7_deviates_least_by_the_angle_that_is_known() {
    let (apex, index) = (60f64.to_radians(), 1.5168f64);
    let least = (1..6000)
        .map(|step| {
            let inner = f64::from(step) * 1e-4;
            let (first, second) = ((index * inner.sin()).asin(), (index * (apex - inner).sin()).asin());
            first + second - apex
        })
        .filter(|deviation| deviation.is_finite())
        .fold(f64::MAX, f64::min);
    assert!((least.to_degrees() - 38.647).abs() < 0.01, "{}", least.to_degrees());
}

/// Of all of it, by surfaces that a lamp and a sky light.
fn all_of_it() -> Scene {
    let mut scene = empty();
    scene.background = Background::Colour(Vec3::new(0.3, 0.4, 0.5));
    for (number, (_, physical)) in white().into_iter().enumerate() {
        scene.materials.push(of(Physical { base: Vec3::new(0.8, 0.5, 0.3), film: Some(BUBBLE), ..physical }));
        let (x, y) = ((number % 3) as f32 - 1.0, (number / 3) as f32 - 1.0);
        let center = Vec3::new(1.1 * x, 1.1 * y, -5.0);
        scene.spheres.push(Sphere { center, radius: 0.5, material: number as u32 });
    }
    add_wall(&mut scene, of(Physical { coat: Some(LACQUER), ..Physical::default() }), Vec3::NEG_Z * 7.0, 4.0);
    add_wall(&mut scene, Material { two_sided: true, ..shining(4.0) }, Vec3::new(0.0, 6.0, -4.0), 1.0);
    scene
}

#[test]
fn every_method_and_device_gives_the_same_bits() {
    let scene = all_of_it();
    let camera = Camera::new("c", Vec3::ZERO, Vec3::NEG_Z, Projection::Perspective { fov: 50.0 });
    assert_same_on_all_ways(&pack(&scene, &camera, paths(24, 4, 12)));
}
