//! Hair by pictures: against the closed form of a fibre of glass, and with the same bits on all ways.

use eyerays::scene::curves::{Basis, ControlPoint, Curves, Strand, Strands};
use eyerays::scene::{
    Background, Camera, Hair, Integrator, Material, Physical, PixelFilter, Projection, Sampler, Scene, Settings,
    Transport,
};
use eyerays_tests::model::{add_wall, black, empty, matt};
use eyerays_tests::{assert_same_on_all_ways, mean, on_cpu, pack};
use glam::Vec3;

fn paths(size: (u32, u32), spp: u32, bounces: u32) -> Settings {
    Settings {
        size,
        spp,
        bounces,
        sampler: Sampler::Random,
        // Others reach beyond the picture.
        pixel_filter: Some(PixelFilter::Box),
        transport: Transport { integrator: Integrator::Path, ..Transport::default() },
        ..Settings::default()
    }
}

fn hair(base: Vec3, hair: Hair) -> Material {
    let physical = Physical { base, hair: Some(hair), ior: Hair::IOR, ..Physical::default() };
    Material { physical: Some(physical), ..matt(base) }
}

/// A scene of strands of one material before a background.
fn strands(material: Material, ways: &[&[Vec3]], radius: f32, background: Vec3) -> Scene {
    let mut all = Strands::default();
    for way in ways {
        let points: Vec<ControlPoint> = way.iter().map(|&position| ControlPoint { position, radius }).collect();
        all.push(Strand { points: &points, ups: &[], colours: &[] });
    }
    let curves = Curves {
        basis: Basis::Linear,
        tolerance: Some(radius * 1e-3),
        sides: Some(96),
        has_tangents: true,
        ..Curves::default()
    };
    let mesh = curves.mesh(&all);
    Scene { mesh, materials: vec![material], background: Background::Colour(background), ..empty() }
}

/// What a smooth cylinder of glass sends in the mean over its width of light from everywhere, seen at right angles: by d'Eon's sum of what is reflected, let
/// through, and reflected inside.
fn of_cylinder(ior: f64, absorbed: f64) -> f64 {
    let steps = 20_000;
    let at = |step: i32| {
        let offset = (f64::from(step) + 0.5) / f64::from(steps);
        let (outer, inner) = ((1.0 - offset * offset).sqrt(), (1.0 - (offset / ior).powi(2)).sqrt());
        let across = (outer - ior * inner) / (outer + ior * inner);
        let along = (ior * outer - inner) / (ior * outer + inner);
        let reflected = (across * across + along * along) / 2.0;
        let left = (-2.0 * absorbed * inner).exp();
        reflected + (1.0 - reflected).powi(2) * left / (1.0 - reflected * left)
    };
    (0..steps).map(at).sum::<f64>() / f64::from(steps)
}

/// A strand over the whole width of the picture's light, seen from the side: its colour is that of glass that absorbs as much.
#[test]
fn a_strand_in_white_light_is_as_bright_as_a_cylinder_of_glass() {
    let own = Hair { roughness: 0.35, radial_roughness: 0.3, tilt: 2.0 };
    for absorbed in [0.1f64, 0.6] {
        let fit = 5.969 - 0.215 * 0.3 + 2.532 * 0.09 - 10.73 * 0.027 + 5.574 * 0.0081 + 0.245 * 0.00243;
        let base = Vec3::splat((-absorbed.sqrt() * fit).exp() as f32);
        let way: &[Vec3] = &[Vec3::new(0.0, -4.0, -3.0), Vec3::new(0.0, 4.0, -3.0)];
        let mut scene = strands(hair(base, own), &[way], 0.5, Vec3::ONE);
        // As wide as the strand.
        let camera = Camera::new("c", Vec3::ZERO, Vec3::NEG_Z, Projection::Orthographic { height: 0.999 });
        scene.cameras = vec![camera.clone()];
        let (picture, rays) = on_cpu(&pack(&scene, &camera, paths((24, 24), 1600, 3)));
        let ((got, error), want) = (mean(&picture), of_cylinder(f64::from(Hair::IOR), absorbed));
        println!("{absorbed}: {got:.5}, standard error {error:.1e}, cylinder {want:.5}");
        assert_eq!(rays.non_finite, 0);
        // The pixels of a column are alike, those of a row are not: their error is not that of chance.
        assert!((got - want).abs() < 3e-3, "{absorbed}: {got}, not {want}");
    }
}

/// Strands that cross each other and themselves.
fn tuft() -> Vec<Vec<Vec3>> {
    let way = |i: i32| {
        let turn = |step: i32| f64::from(i * 7 + step * 3) * 0.61;
        let at =
            |step| Vec3::new(turn(step).sin() as f32, step as f32 * 0.5 - 1.5, -4.0 + 0.5 * turn(step).cos() as f32);
        (0..7).map(at).collect()
    };
    (0..12).map(way).collect()
}

#[test]
fn white_hair_is_not_seen_in_a_white_furnace() {
    let tuft = tuft();
    let ways: Vec<&[Vec3]> = tuft.iter().map(Vec::as_slice).collect();
    for (roughness, radial_roughness) in [(0.1, 0.1), (0.3, 0.6)] {
        let own = hair(Vec3::ONE, Hair { roughness, radial_roughness, tilt: 3.0 });
        let scene = strands(own, &ways, 0.08, Vec3::ONE);
        let camera = Camera::new("c", Vec3::ZERO, Vec3::NEG_Z, Projection::Perspective { fov: 30.0 });
        let (picture, rays) = on_cpu(&pack(&scene, &camera, paths((16, 16), 400, 200)));
        let (got, error) = mean(&picture);
        println!("roughness {roughness}, {radial_roughness}: {got:.4}, standard error {error:.1e}");
        assert_eq!(rays.non_finite, 0);
        assert!((0.99..1.01).contains(&got), "roughness {roughness}, {radial_roughness}: {got}");
    }
}

#[test]
fn every_method_and_device_gives_the_same_bits() {
    let tuft = tuft();
    let ways: Vec<&[Vec3]> = tuft.iter().map(Vec::as_slice).collect();
    let own = hair(Vec3::new(0.5, 0.3, 0.15), Hair::default());
    let mut scene = strands(own, &ways, 0.05, Vec3::new(0.2, 0.25, 0.3));
    let lamp = Material { emission: Vec3::splat(8.0), two_sided: true, ..black() };
    add_wall(&mut scene, lamp, Vec3::new(1.0, 3.0, -7.0), 0.5);
    add_wall(&mut scene, matt(Vec3::splat(0.5)), Vec3::NEG_Z * 9.0, 6.0);
    let camera = Camera::new("c", Vec3::ZERO, Vec3::NEG_Z, Projection::Perspective { fov: 40.0 });
    assert_same_on_all_ways(&pack(&scene, &camera, paths((24, 24), 4, 10)));
}
