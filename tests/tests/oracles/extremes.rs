//! Shading where renderers break: finite, as physics has it, and the same bits on the GPU.

use eyerays::gpu::{AdapterRequest, Renderer};
use eyerays::method::Traversal;
use eyerays::scene::{Background, Light, Material, Projection, Scene, Settings};
use eyerays::scene_io;
use eyerays_shader::material::{fresnel, refract};
use eyerays_shader::real::{Real, Scalar, V3};
use eyerays_tests::model::{add_quad, add_wall, black, empty, glass, lamp, matt};
use eyerays_tests::numbers::picture;
use eyerays_tests::{Posed, assert_same_bits, count, gpu, on_cpu, pack};
use glam::Vec3;

/// On the CPU without a value that is not finite, and on a GPU the same bits.
fn pictures(packed: &Posed, what: &str) -> Vec<Vec3> {
    let (picture, rays) = on_cpu(packed);
    assert_eq!(rays.non_finite, 0, "{what}");
    assert!(picture.pixels.iter().flatten().all(|channel| channel.is_finite()), "{what}");
    if let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) {
        let mut renderer = Renderer::new(&gpu, packed, true, Traversal::default()).unwrap();
        let rendering = renderer.render(&packed.view, &|_| ()).unwrap();
        assert_same_bits(&rendering.film.develop().unwrap(), &picture, what);
    }
    picture.pixels.iter().map(|&pixel| Vec3::from(pixel)).collect()
}

fn next(x: f32, ulps: i32) -> f32 {
    f32::from_bits(x.to_bits().wrapping_add_signed(ulps))
}

/// Around the critical angle, a unit at a time: total reflection begins once and for all, what passes is a unit
/// vector along the surface, and shares stay shares.
#[test]
fn the_critical_angle_a_unit_at_a_time() {
    let up = V3::<f32>::splat(Vec3::Y);
    for ior in [next(1.0, 1), 1.0003, 1.333, 1.5, 2.4, 4.0] {
        let critical = (1.0 - 1.0 / (f64::from(ior) * f64::from(ior))).sqrt() as f32;
        let mut seen = [0; 2];
        for ulps in -1000..=1000 {
            let cosine = next(critical, ulps);
            let sine = (1.0 - f64::from(cosine) * f64::from(cosine)).sqrt() as f32;
            let at = refract(V3::new(sine, -cosine, 0.0), up, ior);
            let share = fresnel(&at, ior);
            assert!((0.0..=1.0).contains(&share), "{ior}, {ulps}: {share}");
            let (unit, length) = at.direction.normalised();
            assert!(at.total || (length - 1.0).abs() < 1e-3 && unit.y <= 0.0, "{ior}, {ulps}: {unit:?}");
            assert!(at.total || at.direction.y.abs() < 0.05, "{ior}, {ulps}: grazing");
            // Seen from above and below by more than rounding.
            let exact = 1.0 - f64::from(ior).powi(2) * (1.0 - f64::from(cosine).powi(2));
            let bound = 8.0 * f64::from(ior).powi(2) / (1u64 << 24) as f64;
            assert!(exact.abs() < bound || at.total == (exact < 0.0), "{ior}, {ulps}: {exact:e}");
            seen[usize::from(at.total)] += 1;
        }
        // So near 1 the whole range is less than a roundoff of the sine's square.
        assert!(ior < 1.1 || seen[0] > 0 && seen[1] > 0, "{ior}: {seen:?}");
    }
}

/// Three panes of glass side by side before a striped wall.
fn panes(iors: [f32; 3]) -> Scene {
    let mut scene = empty();
    for (i, stripe) in (-8i8..8).enumerate() {
        let colour = if i % 2 == 0 { Vec3::new(0.9, 0.5, 0.1) } else { Vec3::new(0.1, 0.3, 0.7) };
        let (left, right) = (f32::from(stripe) / 2.0, f32::from(stripe + 1) / 2.0);
        let at = |x: f32, y: f32| Vec3::new(x, y, -6.0);
        add_quad(&mut scene, matt(colour), [at(left, -4.0), at(right, -4.0), at(right, 4.0), at(left, 4.0)]);
    }
    for (ior, x) in iors.into_iter().zip([-1.0, 0.0, 1.0]) {
        for z in [-3.0, -3.5] {
            add_wall(&mut scene, Material { ior, ..glass(Vec3::ONE) }, Vec3::new(x, 0.0, z), 0.45);
        }
    }
    scene.ambient = Vec3::ONE;
    scene.cameras[0].projection = Projection::Perspective { fov: 50.0 };
    scene.settings = Settings { size: (61, 47), bounces: 6, min_contribution: 0.0, ..Settings::default() };
    scene
}

/// Glass that does not bend light is not there; nor is glass that bends it by a unit.
#[test]
fn an_index_of_one_is_no_glass() {
    let mut bare = panes([1.0; 3]);
    bare.materials.iter_mut().filter(|m| m.transmission != Vec3::ZERO).for_each(|m| *m = black());
    bare.mesh.triangles.truncate(2 * 16);
    bare.mesh.materials.truncate(2 * 16);
    let pixels = |scene: &Scene, what| pictures(&pack(scene, &scene.cameras[0], scene.settings), what);
    let (without, with) = (pixels(&bare, "no glass"), pixels(&panes([1.0, next(1.0, 1), next(1.0, 2)]), "ior 1"));
    let differing = without.iter().zip(&with).filter(|(a, b)| (**a - **b).abs().max_element() > 1e-4).count();
    // A ray at the border of two stripes may end on either.
    assert!(differing * 100 <= with.len(), "{differing} of {}", with.len());
    let bent = pixels(&panes([1.5, 2.4, 4.0]), "glass");
    let reflected = without.iter().zip(&bent).filter(|(a, b)| (**a - **b).abs().max_element() > 1e-2).count();
    assert!(reflected * 10 > bent.len(), "real glass is seen");
}

#[test]
fn an_index_that_is_none_is_refused_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("glass.toml");
    for (ior, fits) in
        [("1.0", true), ("1.0000001", true), ("0.0", false), ("0.9999999", false), ("nan", false), ("inf", false)]
    {
        let text = format!(
            "[[material]]\nname = \"glass\"\ntransmission = [1.0, 1.0, 1.0]\nior = {ior}\n\n[[mesh]]\nshape = \"sphere\"\nmaterial = \"glass\"\n"
        );
        std::fs::write(&path, text).unwrap();
        match scene_io::load(&path) {
            Ok(_) => assert!(fits, "{ior}"),
            Err(error) => {
                let line = error.to_string();
                assert!(!fits && line.contains("glass.toml:4") && line.contains("ior"), "{ior}: {line}");
            }
        }
    }
}

/// A wall with a lamp before it, which shines on it head on where the camera looks.
fn highlight(shininess: f32) -> Scene {
    let mut scene = empty();
    add_wall(&mut scene, Material { specular: Vec3::ONE, shininess, ..black() }, Vec3::new(0.0, 0.0, -2.0), 2.0);
    scene.lights = vec![lamp(Vec3::new(0.0, 0.0, -1.0))];
    scene.cameras[0].projection = Projection::Perspective { fov: 60.0 };
    scene.settings = Settings { size: (33, 33), ..Settings::default() };
    scene
}

#[test]
fn highlights_from_dull_to_a_point() {
    let lit = [0.0, 1.0, 1e4, 1e9].map(|shininess| {
        let scene = highlight(shininess);
        let picture = pictures(&pack(&scene, &scene.cameras[0], scene.settings), "a highlight");
        assert!(picture.iter().all(|p| p.min_element() >= 0.0 && p.max_element() <= 1.0));
        assert!(picture[33 * 16 + 16].x > 0.99, "head on all is mirrored: {}", picture[33 * 16 + 16]);
        picture
    });
    assert!(lit[0].iter().all(|p| *p == Vec3::ONE), "to the power of zero all is one");
    for pair in lit.windows(2) {
        assert!(pair[0].iter().zip(&pair[1]).all(|(dull, sharp)| sharp.x <= dull.x), "a greater power is never more");
    }
    let bright = |picture: &Vec<Vec3>| picture.iter().filter(|p| p.x > 0.0).count();
    assert!(2 * bright(&lit[1]) > lit[1].len() && bright(&lit[3]) <= 9, "{} of 1e9", bright(&lit[3]));
}

/// On the wall itself, at a vertex, at the camera's eye, and on the surface's own plane.
#[test]
fn lights_on_surfaces() {
    for place in [Vec3::new(0.0, 0.0, -2.0), Vec3::new(-2.0, -2.0, -2.0), Vec3::ZERO, Vec3::new(3.0, 0.5, -2.0)] {
        let mut scene = highlight(50.0);
        let wall = Material { diffuse: Vec3::splat(0.5), ..scene.materials[0].clone() };
        scene.materials[0] = wall;
        scene.lights = vec![
            lamp(place),
            Light::Point { position: place, colour: Vec3::splat(1e-30), group: String::new(), illuminant: None },
        ];
        let picture = pictures(&pack(&scene, &scene.cameras[0], scene.settings), &format!("a lamp at {place}"));
        let on_plane = place.z == -2.0;
        // Light along a surface gives it none: the cosine is zero but for rounding of the place.
        assert!(!on_plane || picture.iter().filter(|p| p.x > 1e-2).count() <= 1, "{place}: {picture:?}");
        assert!(on_plane || picture.iter().all(|p| p.x > 0.1));
    }
}

/// A closed box of mirrors that glow a little: each bounce adds the same, exactly, and none is lost through a corner.
fn mirror_box(bounces: u32) -> Scene {
    let mut scene = empty();
    let glow = Vec3::splat(1.0 / 16_384.0);
    let (least, greatest) = (Vec3::new(-1.1, -0.9, -1.3), Vec3::new(0.8, 1.2, 1.0));
    let mirror = Material { ambient: Some(glow), reflection: Vec3::ONE, ..black() };
    eyerays_tests::model::add_box(&mut scene, mirror, least, greatest);
    scene.ambient = Vec3::ONE;
    scene.background = Background::Colour(Vec3::splat(1e6));
    scene.cameras[0].projection = Projection::Perspective { fov: 90.0 };
    scene.settings = Settings { size: (8, 4), bounces, min_contribution: 0.0, ..Settings::default() };
    scene
}

#[test]
fn none_and_ten_thousand_bounces_in_a_box_of_mirrors() {
    for bounces in [0, 1, 10_000] {
        let scene = mirror_box(bounces);
        let packed = pack(&scene, &scene.cameras[0], scene.settings);
        let glow = (bounces + 1) as f32 / 16_384.0;
        let expected = |p: &V3<f32>| [p.x, p.y, p.z] == [glow; 3];
        assert!(picture::<f32>(&packed).iter().all(expected), "{bounces} bounces");
    }
    let on_gpu = mirror_box(if count::full() { 10_000 } else { 200 });
    pictures(&pack(&on_gpu, &on_gpu.cameras[0], on_gpu.settings), "a box of mirrors");
}

/// Exact precision takes powers for which single precision has no exponent but 1.
#[test]
fn powers_at_the_ends() {
    for exponent in [0.0, f32::MIN_POSITIVE, 1.0, 1e4, 1e9, f32::MAX] {
        for x in [0.0, f32::MIN_POSITIVE, 0.5, next(1.0, -1), 1.0] {
            let (exact, truth) = (Scalar::pow(x, exponent), f64::from(x).powf(f64::from(exponent)));
            assert!((0.0..=1.0).contains(&exact), "{x}^{exponent}: {exact}");
            // What is below 2^-100 may be zero, base and result alike.
            let faint = truth < 8e-31 || x < 8e-31;
            assert!(faint || (f64::from(exact) - truth).abs() <= 4e-5 * truth, "{x}^{exponent}: {exact} {truth}");
        }
    }
    assert_eq!(Real::sqrt(-0f32).to_bits(), (-0f32).to_bits());
}
