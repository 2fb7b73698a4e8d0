//! Light of single wavelengths (`--spectral`): against red, green and blue, closed forms, and with the same bits on all ways.

use std::f64::consts::PI;
use std::sync::Arc;

use eyerays::picture::Picture;
use eyerays::scene::{
    Background, Camera, Environment, Integrator, Light, Material, Medium, Physical, PixelFilter, Projection, Sampler,
    Scene, Settings, Sphere, Texels, Texture, ThinFilm, Transport, Volume,
};
use eyerays::spectrum::{self, Fluorescent, Glass, Illuminant, Metal};
use eyerays_tests::model::{add_quad, add_wall, black, empty, glass, lamp, matt, sun};
use eyerays_tests::prism::Prism;
use eyerays_tests::{assert_same_on_all_ways, on_cpu, pack};
use glam::{DVec3, Vec3};

/// As many samples as there are sets of wavelengths, of which Sobol's points draw each once.
const ALL: u32 = 512;

fn paths(size: u32, spp: u32, bounces: u32) -> Settings {
    Settings {
        size: (size, size),
        spp,
        bounces,
        sampler: Sampler::Sobol,
        spectral: true,
        pixel_filter: Some(PixelFilter::Box),
        transport: Transport { integrator: Integrator::Path, roulette: 1 << 20, ..Transport::default() },
        ..Settings::default()
    }
}

fn ahead() -> Camera {
    Camera::new("c", Vec3::ZERO, Vec3::NEG_Z, Projection::Perspective { fov: 40.0 })
}

fn render(scene: &Scene, camera: &Camera, settings: Settings) -> Picture {
    let (picture, rays) = on_cpu(&pack(scene, camera, settings));
    assert_eq!(rays.non_finite, 0);
    picture
}

/// The mean of the pixels.
fn mean(picture: &Picture) -> DVec3 {
    picture.pixels.iter().map(|&pixel| Vec3::from(pixel).as_dvec3()).sum::<DVec3>() / picture.pixels.len() as f64
}

/// A wall in the light of a lamp, which is all that the camera sees.
fn wall(material: Material, light: Light) -> Scene {
    let mut scene = empty();
    add_wall(&mut scene, material, Vec3::NEG_Z * 3.0, 10.0);
    scene.lights.push(light);
    scene
}

/// White light stays white, and of white light any colour is scattered as red, green and blue have it: each pixel, with all wavelengths.
#[test]
fn a_colour_in_white_light_is_what_it_is_in_red_green_and_blue() {
    for colour in [Vec3::ONE, Vec3::splat(0.18), Vec3::new(0.9, 0.1, 0.02), Vec3::new(0.0, 0.4, 1.0)] {
        let scene = wall(matt(colour), sun(Vec3::NEG_Z));
        let spectral = render(&scene, &ahead(), paths(8, ALL, 1));
        let plain = render(&scene, &ahead(), Settings { spectral: false, ..paths(8, ALL, 1) });
        for (own, want) in spectral.pixels.iter().zip(&plain.pixels) {
            let want = Vec3::from(*want);
            let far = (Vec3::from(*own) - want).abs().max_element() / want.max_element();
            assert!(far < 1e-4, "{colour}: {own:?} {want}");
        }
    }
}

/// White surroundings, white fog and glass beside white walls are white within 1e-3.
#[test]
fn white_stays_white_however_often_it_is_scattered() {
    let mut scene = empty();
    scene.background = Background::Colour(Vec3::ONE);
    let clear = Physical { transmission: Vec3::ONE, roughness: 0.3, ..Physical::default() };
    let fog = Medium { scattering: Vec3::ONE, ..Medium::default() };
    scene.materials.extend([
        matt(Vec3::ONE),
        Material { physical: Some(Physical { specular_weight: 0.0, ..Physical::default() }), ..matt(Vec3::ONE) },
        Material { physical: Some(clear), ..glass(Vec3::ONE) },
        Material { volume: Some(Volume::open(fog)), ..matt(Vec3::ONE) },
    ]);
    for (number, x) in (0..4).zip([-1.5f32, -0.5, 0.5, 1.5]) {
        scene.spheres.push(Sphere { center: Vec3::new(x, 0.0, -5.0), radius: 0.45, material: number });
    }
    let picture = render(&scene, &ahead(), paths(16, 2 * ALL, 1000));
    let white = mean(&picture);
    // Rough glass loses a little between its facets, as in red, green and blue.
    let plain = mean(&render(&scene, &ahead(), Settings { spectral: false, ..paths(16, 2 * ALL, 1000) }));
    assert!((white / plain - 1.0).abs().max_element() < 1e-3, "{white} {plain}");
    let grey = white.element_sum() / 3.0;
    assert!((white / grey - 1.0).abs().max_element() < 1e-3, "{white}");
}

/// The light of a lamp of a temperature is Planck's.
#[test]
fn lamps_have_the_colours_of_their_temperatures() {
    for kelvins in [2700.0f32, 5000.0, 10_000.0] {
        let colour = Illuminant::BlackBody(kelvins).colour();
        let Light::Point { position, .. } = lamp(Vec3::Z) else { panic!("a point light") };
        let warm =
            Light::Point { position, colour, group: String::new(), illuminant: Some(Illuminant::BlackBody(kelvins)) };
        let want = spectrum::black_body(kelvins.into()) / spectrum::luminance(spectrum::black_body(kelvins.into()));
        let white = mean(&render(&wall(matt(Vec3::ONE), lamp(Vec3::Z)), &ahead(), paths(8, ALL, 1)));
        let found = mean(&render(&wall(matt(Vec3::ONE), warm), &ahead(), paths(8, ALL, 1))) / white;
        assert!(found.distance(want) < 1e-3, "{kelvins} K: {found} {want}");
        let glowing =
            Material { emission: colour, illuminant: Some(Illuminant::BlackBody(kelvins)), two_sided: true, ..black() };
        let mut scene = empty();
        add_wall(&mut scene, glowing, Vec3::NEG_Z * 3.0, 10.0);
        let seen = mean(&render(&scene, &ahead(), paths(8, ALL, 1)));
        assert!(seen.distance(want) < 1e-3, "{kelvins} K: {seen} {want}");
    }
}

/// Light of fluorescent lamps, too; and what is behind a coloured wall of both is more than the product of three numbers.
#[test]
fn fluorescent_lamps_light_as_their_spectra_say() {
    let lit = |colour: Vec3, illuminant: Illuminant| {
        let Light::Point { position, group, .. } = lamp(Vec3::Z) else { panic!("a point light") };
        let illuminated = Light::Point { position, colour: illuminant.colour(), group, illuminant: Some(illuminant) };
        mean(&render(&wall(matt(colour), illuminated), &ahead(), paths(8, ALL, 1)))
    };
    let white = mean(&render(&wall(matt(Vec3::ONE), lamp(Vec3::Z)), &ahead(), paths(8, ALL, 1)));
    for lamp in [Fluorescent::Cool, Fluorescent::Broad, Fluorescent::Narrow] {
        let illuminant = Illuminant::Fluorescent(lamp);
        let found = lit(Vec3::ONE, illuminant) / white;
        assert!(found.distance(illuminant.light()) < 1e-3, "{lamp:?}: {found}");
        let (orange, own) = (Vec3::new(0.9, 0.3, 0.05), illuminant.over_colour());
        let spectrum = |wavelength: f64| own(wavelength) * spectrum::of_colour(illuminant.colour(), wavelength);
        let want = spectrum::rgb(&|wavelength| spectrum(wavelength) * spectrum::of_colour(orange, wavelength));
        let found = lit(orange, illuminant) / white;
        assert!(found.distance(want) < 1e-3, "{lamp:?}: {found} {want}");
        assert!(found.distance(orange.as_dvec3() * illuminant.light()) > 5e-3, "{lamp:?}: {found}");
    }
}

/// Metals reflect what was measured at each wavelength, a film what Airy's sum says.
#[test]
fn measured_metals_and_films_reflect_their_spectra() {
    let seen = |physical: Physical| {
        let mut scene = empty();
        scene.background = Background::Colour(Vec3::ONE);
        scene.materials.push(Material { physical: Some(physical), ..black() });
        add_wall(&mut scene, Material { physical: Some(physical), ..black() }, Vec3::NEG_Z * 3.0, 10.0);
        let camera = Camera::new("c", Vec3::ZERO, Vec3::NEG_Z, Projection::Perspective { fov: 0.01 });
        mean(&render(&scene, &camera, paths(4, ALL, 2)))
    };
    let smooth = Physical { roughness: 0.0, ..Physical::default() };
    for metal in [Metal::Gold, Metal::Copper, Metal::Silver] {
        let found = seen(Physical { conductor: Some(metal.conductor()), ..smooth });
        let want = spectrum::rgb(&|wavelength| metal.reflectance(wavelength));
        assert!(found.distance(want) < 2e-4, "{metal:?}: {found} {want}");
    }
    // A film of 1.33 on metal that reflects three tenths: so thick that red, green and blue tell no more of it.
    for thickness in [150.0f64, 400.0, 2500.0] {
        let film = ThinFilm { weight: 1.0, ior: 1.33, thickness: [thickness as f32; 2] };
        let found = seen(Physical { base: Vec3::splat(0.3), metallic: 1.0, film: Some(film), ..smooth });
        let upper = (1.0f64 - 1.33) / (1.0 + 1.33);
        let below = (1.0 + 0.3f64.sqrt()) / (1.0 - 0.3f64.sqrt());
        let lower = (1.33 - below) / (1.33 + below);
        let want = spectrum::rgb(&|wavelength| {
            let phase = (4.0 * PI * 1.33 * thickness / wavelength).cos();
            let (squares, both) = (upper * upper + lower * lower, upper * lower);
            (squares + 2.0 * both * phase) / (1.0 + both * both + 2.0 * both * phase)
        });
        assert!(found.distance(want) < 3e-3, "{thickness} nm: {found} {want}");
    }
}

/// Surroundings of which a ring is bright whose angle from straight up is near this one.
fn ring(degrees: f64) -> Environment {
    const ROWS: u32 = 1800;
    let row = (degrees * f64::from(ROWS) / 180.0) as u32;
    let texels = (0..ROWS).flat_map(|y| [if y == row { [1.0f32; 4] } else { [0.0, 0.0, 0.0, 1.0] }; 2]).collect();
    let texture = Texture { name: "ring".into(), width: 2, height: ROWS, texels: Texels::Floats(texels) };
    Environment { texture: Arc::new(texture), rotation: 0.0, scale: 1.0, visible: true }
}

/// How much light of a ring a drop sends back at an angle from where it came: by a camera in the place of the sun, and a ring in the
/// place of the eye.
fn bow(drop: &Material, degrees: f64, settings: Settings) -> DVec3 {
    let mut scene = empty();
    scene.environment = Some(ring(degrees));
    scene.materials.push(drop.clone());
    scene.spheres.push(Sphere { center: Vec3::ZERO, radius: 1.0, material: 0 });
    let sun = Camera::new("sun", Vec3::Y * 5.0, Vec3::ZERO, Projection::Orthographic { height: 2.0 });
    scene.cameras = vec![Camera { up: Vec3::Z, ..sun }];
    mean(&render(&scene, &scene.cameras[0], settings))
}

/// Descartes' angle of the rainbow: the least deviation of light that is mirrored once within a drop.
fn descartes(index: f64) -> f64 {
    let sine = ((4.0 - index * index) / 3.0).sqrt();
    (4.0 * (sine / index).asin() - 2.0 * sine.asin()).to_degrees()
}

/// The angle in tenths of a degree where a bow is brightest.
fn brightest(angles: std::ops::Range<u32>, light: impl Fn(f64) -> f64) -> f64 {
    let angle = |tenth: u32| f64::from(tenth) / 10.0 + 0.05;
    let best = angles.map(|tenth| (light(angle(tenth)), tenth)).max_by(|a, b| a.0.total_cmp(&b.0));
    angle(best.expect("there are angles").1)
}

/// Water of 1.333 has its rainbow at 42.08 degrees, beyond which it is dark.
#[test]
fn the_rainbow_is_where_descartes_has_it() {
    assert!((descartes(1.333) - 42.08).abs() < 0.005);
    let water = Physical { transmission: Vec3::ONE, roughness: 0.0, ior: 1.333, ..Physical::default() };
    let water = Material { physical: Some(water), ior: 1.333, ..glass(Vec3::ONE) };
    let settings = Settings { spectral: false, ..paths(96, 64, 3) };
    let light = |degrees: f64| bow(&water, degrees, settings).y;
    let found = brightest(415..428, light);
    assert!((found - 42.08).abs() <= 0.1, "{found}");
    assert!(light(42.35) < 0.2 * light(42.05), "Alexander's band is dark");
}

/// The bow of water as it is has red outside of green and blue, each where its wavelengths are.
#[test]
fn red_is_outside_of_blue_in_a_rainbow() {
    let water = Physical { glass: Some(Glass::Water), transmission: Vec3::ONE, roughness: 0.0, ..Physical::default() };
    let ior = Glass::Water.ior();
    let water = Material { physical: Some(Physical { ior, ..water }), ior, ..glass(Vec3::ONE) };
    let lights: Vec<DVec3> =
        (400..430).map(|tenth| bow(&water, f64::from(tenth) / 10.0 + 0.05, paths(64, ALL / 8, 3))).collect();
    for (channel, wavelength) in [(0, 610.0), (1, 540.0), (2, 455.0)] {
        let found = brightest(400..430, |degrees| lights[(degrees * 10.0) as usize - 400][channel]);
        let want = descartes(Glass::Water.index(wavelength));
        assert!((found - want).abs() < 0.3, "channel {channel}: {found} {want}");
    }
}

/// A prism of flint sends each wavelength where its index does: to a lamp that only those near it find, which has their colour.
#[test]
fn a_prism_sends_each_wavelength_where_its_index_does() {
    let flint = Glass::Sf11;
    let prism = Prism { apex: 60f64.to_radians(), symmetric: 1.78 };
    for wavelength in [460.0, 545.0, 610.0] {
        let mut scene = empty();
        let physical = Physical {
            glass: Some(flint),
            transmission: Vec3::ONE,
            roughness: 0.0,
            ior: flint.ior(),
            ..Physical::default()
        };
        prism.add(&mut scene, Material { physical: Some(physical), ior: flint.ior(), ..glass(Vec3::ONE) });
        // Those 10 nm to either side.
        let ways = [wavelength - 10.0, wavelength + 10.0].map(|end| prism.through(flint.index(end)));
        let up = 0.3 * DVec3::Z;
        let [a, b] = ways.map(|way| 40.0 * way);
        let shining = Material { emission: Vec3::ONE, two_sided: true, ..black() };
        add_quad(&mut scene, shining, [a - up, b - up, b + up, a + up].map(|corner| corner.as_vec3()));
        let eye = (-30.0 * prism.incident()).as_vec3();
        let camera =
            Camera { up: Vec3::Z, ..Camera::new("c", eye, Vec3::ZERO, Projection::Perspective { fov: 0.001 }) };
        let found = mean(&render(&scene, &camera, paths(8, 16 * ALL, 4)));
        let near = |of: f64| if (of - wavelength).abs() < 10.0 { 1.0 } else { 0.0 };
        let want = spectrum::rgb(&near);
        let share = found.element_sum() / want.element_sum();
        assert!((0.6..1.0).contains(&share), "{wavelength}: {found} {want}");
        assert!(found.distance(want * share) < 0.08 * want.length(), "{wavelength}: {found} {want}");
    }
}

/// Of lamps, glass, metal, films, fog and colours.
fn all_of_it() -> Scene {
    let mut scene = empty();
    scene.background = Background::Gradient { horizon: Vec3::new(0.3, 0.4, 0.5), zenith: Vec3::new(0.1, 0.2, 0.6) };
    let film = ThinFilm { weight: 1.0, ior: 1.33, thickness: [300.0, 300.0] };
    let flint = Physical {
        glass: Some(Glass::Sf11),
        ior: Glass::Sf11.ior(),
        transmission: Vec3::ONE,
        roughness: 0.1,
        ..Physical::default()
    };
    let physicals = [
        Physical { base: Vec3::new(0.8, 0.5, 0.3), film: Some(film), ..Physical::default() },
        Physical { conductor: Some(Metal::Gold.conductor()), roughness: 0.3, ..Physical::default() },
        flint,
        Physical { glass: None, abbe: Some(20.0), ior: 1.6, ..flint },
    ];
    for (number, physical) in physicals.into_iter().enumerate() {
        scene.materials.push(Material { physical: Some(physical), ior: physical.ior, ..matt(physical.base) });
        let center = Vec3::new(1.1 * (number as f32 - 1.5), 0.0, -5.0);
        scene.spheres.push(Sphere { center, radius: 0.5, material: number as u32 });
    }
    add_wall(&mut scene, matt(Vec3::new(0.7, 0.2, 0.4)), Vec3::NEG_Z * 7.0, 4.0);
    let warm = Material {
        emission: Vec3::splat(4.0),
        illuminant: Some(Illuminant::BlackBody(2700.0)),
        two_sided: true,
        ..black()
    };
    add_wall(&mut scene, warm, Vec3::new(0.0, 6.0, -4.0), 1.0);
    scene.lights.push(lamp(Vec3::new(2.0, 3.0, 0.0)).of_spectrum(Some(Illuminant::BlackBody(9000.0))));
    scene.fog = Some(Medium { scattering: Vec3::new(0.01, 0.02, 0.03), ..Medium::default() });
    scene
}

#[test]
fn every_method_and_device_gives_the_same_bits() {
    let smoke = Medium { scattering: Vec3::new(1.0, 2.0, 0.5), absorption: Vec3::splat(0.1), ..Medium::default() };
    let mut smoky = all_of_it();
    smoky.materials.push(Material { volume: Some(Volume::open(smoke)), ..matt(Vec3::ONE) });
    smoky.spheres.push(Sphere {
        center: Vec3::new(0.0, 1.0, -4.5),
        radius: 0.6,
        material: smoky.materials.len() as u32 - 1,
    });
    for scene in [all_of_it(), smoky] {
        assert_same_on_all_ways(&pack(&scene, &ahead(), paths(24, 4, 12)));
    }
}

#[test]
fn pixels_of_one_sample_have_wavelengths_of_their_own() {
    let scene = wall(matt(Vec3::new(0.9, 0.5, 0.1)), lamp(Vec3::Z));
    let all = mean(&render(&scene, &ahead(), paths(8, ALL, 1)));
    // Of other pixels the wavelengths are others: 64 of them have the mean of all.
    let few = mean(&render(&scene, &ahead(), paths(64, 1, 1)));
    assert!((few - all).abs().max_element() < 0.1 * all.max_element(), "{few} {all}");
}
