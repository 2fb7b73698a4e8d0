//! Layers that films keep: parts of the light, which add up to the picture, whatever renders it and however it is parted.

use eyerays::film::Film;
use eyerays::layers::{self, Aovs, Layer, Shown, Values};
use eyerays::noise::Target;
use eyerays::picture::Picture;
use eyerays::render::{Backend, Choice, DeviceWish, Rendering, Session};
use eyerays::scene::{
    Background, Camera, Integrator, Material, Physical, PixelFilter, Projection, Sampler, Scene, Settings, Sphere,
    Transport, Wall,
};
use eyerays::view::{Region, View};
use eyerays_tests::model::{add_box, add_wall, empty, lamp, matt, mirror};
use eyerays_tests::{Posed, assert_same_bits, pack, quick_gpu, shipped};
use glam::Vec3;

const SIZE: (u32, u32) = (40, 30);

/// All that a film may keep.
static KEPT: [Layer; 12] = [
    Layer::Albedo,
    Layer::Normal,
    Layer::Direct,
    Layer::Emission,
    Layer::Environment,
    Layer::DiffuseDirect,
    Layer::DiffuseIndirect,
    Layer::GlossyDirect,
    Layer::GlossyIndirect,
    Layer::TransmissionDirect,
    Layer::TransmissionIndirect,
    Layer::LightGroups,
];

/// What every light that reaches the camera is in one of.
fn parts() -> &'static [Layer] {
    &KEPT[3..11]
}

fn paths(spp: u32) -> Settings {
    Settings {
        size: SIZE,
        spp,
        bounces: 4,
        sampler: Sampler::Sobol,
        pixel_filter: Some(PixelFilter::Box),
        transport: Transport { integrator: Integrator::Path, ..Transport::default() },
        ..Settings::default()
    }
}

fn plastic(base: Vec3) -> Material {
    let physical = Physical { base, metallic: 0.0, roughness: 0.3, ..Physical::default() };
    Material { physical: Some(physical), ..matt(base) }
}

/// A floor, a mirror, a pane, a ball of plastic and one of metal, by a lamp of a group, a light of another, a small one without and a sky.
fn studio() -> Scene {
    let mut scene = empty();
    add_box(&mut scene, plastic(Vec3::new(0.6, 0.3, 0.1)), Vec3::new(-5.0, -1.0, -5.0), Vec3::new(5.0, 0.0, 5.0));
    add_wall(&mut scene, mirror(Vec3::splat(0.8)), Vec3::new(0.0, 2.0, -3.0), 4.0);
    let pane = Physical { transmission: Vec3::splat(1.0), wall: Wall::Pane, roughness: 0.2, ..Physical::default() };
    // A ball would keep away what comes through it.
    let glass = Material { physical: Some(pane), ..Material::default() };
    add_wall(&mut scene, glass, Vec3::new(0.2, 0.8, 1.6), 0.4);
    let shining =
        Material { emission: Vec3::new(8.0, 7.0, 6.0), group: "key".to_owned(), two_sided: true, ..matt(Vec3::ZERO) };
    let small = Material { emission: Vec3::splat(20.0), ..matt(Vec3::ZERO) };
    let metal = Physical { base: Vec3::new(0.9, 0.7, 0.4), metallic: 1.0, roughness: 0.4, ..Physical::default() };
    let made = [
        (Vec3::new(-1.0, 0.6, 0.0), 0.6, plastic(Vec3::new(0.1, 0.4, 0.2))),
        (Vec3::new(0.9, 0.5, 0.4), 0.5, Material { physical: Some(metal), ..Material::default() }),
        (Vec3::new(0.0, 3.5, 1.0), 0.7, shining),
        (Vec3::new(-1.8, 0.4, 0.9), 0.1, small),
    ];
    for (center, radius, made) in made {
        let material = scene.materials.len() as u32;
        scene.materials.push(made);
        scene.spheres.push(Sphere { center, radius, material });
    }
    scene.lights = vec![lamp(Vec3::new(3.0, 2.0, 3.0)).in_group("fill")];
    scene.background = Background::Colour(Vec3::new(0.2, 0.3, 0.5));
    scene.background_group = "sky".to_owned();
    scene.cameras = vec![Camera::new(
        "front",
        Vec3::new(0.0, 1.6, 5.0),
        Vec3::new(0.0, 0.7, 0.0),
        Projection::Perspective { fov: 50.0 },
    )];
    scene
}

/// A scene with films that keep layers, before its first camera.
fn keeping(scene: &Scene, settings: Settings, kept: &[Layer]) -> Posed {
    let posed = pack(scene, &scene.cameras[0], settings);
    let packed = posed.packed.keeping(layers::asked(kept)).unwrap();
    let view = View::new(&packed, &scene.cameras[0]).unwrap();
    Posed { packed, view }
}

fn session(posed: &Posed, device: DeviceWish) -> Session {
    let adapter = std::env::var("EYERAYS_ADAPTER").ok().filter(|_| device == DeviceWish::Gpu);
    Backend::new(&Choice { device, adapter, ..Choice::default() }).unwrap().open(&posed.packed).unwrap()
}

fn exposed(posed: &Posed, device: DeviceWish) -> Rendering {
    session(posed, device).expose(&posed.view, &|_| ()).unwrap()
}

fn film(rendering: &Rendering) -> &Film {
    rendering.film.as_ref().expect("it was exposed")
}

/// The light of a layer, each part of several.
fn light(posed: &Posed, film: &Film, layer: Layer) -> Vec<(String, Picture)> {
    match layers::of_film(film, (&layers::names(&posed.packed), &film.develop().unwrap()), layer).unwrap() {
        Some(Values::Light(picture) | Values::Colours(picture) | Values::Vectors(picture)) => {
            vec![(String::new(), picture)]
        }
        Some(Values::Parts(parts)) => parts,
        other => panic!("{layer}: {other:?}"),
    }
}

fn sum(pictures: impl Iterator<Item = Picture>) -> Vec<[f64; 3]> {
    let mut all = vec![[0.0; 3]; (SIZE.0 * SIZE.1) as usize];
    for picture in pictures {
        for (all, pixel) in all.iter_mut().zip(&picture.pixels) {
            *all = [0, 1, 2].map(|i| all[i] + f64::from(pixel[i]));
        }
    }
    all
}

/// Equal but for rounding: a sample adds up some ten numbers of single precision, in another order.
fn assert_adds_up(parts: &[[f64; 3]], picture: &Picture, what: &str) {
    for (at, (sum, pixel)) in parts.iter().zip(&picture.pixels).enumerate() {
        for i in 0..3 {
            let (sum, all) = (sum[i], f64::from(pixel[i]));
            assert!((sum - all).abs() <= 1e-5 * all.max(1e-3), "{what}, pixel {at}: {sum} of {all}");
        }
    }
}

#[test]
fn parts_of_the_surface_and_groups_of_lamps_add_up_to_the_picture() {
    let scene = studio();
    let posed = keeping(&scene, paths(32), &KEPT);
    let rendering = exposed(&posed, DeviceWish::Cpu);
    let of = |layer| light(&posed, film(&rendering), layer);
    let parts_of_surface = parts().iter().copied().flat_map(of).map(|(_, picture)| picture);
    assert_adds_up(&sum(parts_of_surface), &rendering.picture, "parts of the surface");
    let groups = of(Layer::LightGroups);
    let names: Vec<&str> = groups.iter().map(|(name, _)| &name[..]).collect();
    assert_eq!(names, ["group_rest", "group_fill", "group_key", "group_sky"]);
    assert_adds_up(&sum(groups.into_iter().map(|(_, picture)| picture)), &rendering.picture, "groups of lamps");
    let halves = [Layer::Direct, Layer::Indirect].into_iter().flat_map(of).map(|(_, picture)| picture);
    assert_adds_up(&sum(halves), &rendering.picture, "direct and indirect light");
    for &layer in parts() {
        let some = of(layer)[0].1.pixels.iter().filter(|pixel| pixel[1] > 0.0).count();
        assert!(some > 2, "{layer} has {some} pixels");
    }
}

/// The oracle of each is a picture of its own: no bit of it is another, and none of the picture beside.
#[test]
fn layers_are_the_pictures_of_what_they_hold() {
    for scene in [studio(), shipped("room"), shipped("frosted")] {
        let settings = Settings { sampler: Sampler::Sobol, ..paths(8) };
        let lit = [Layer::Albedo, Layer::Normal, Layer::Direct];
        let posed = keeping(&scene, settings, &lit);
        let kept = exposed(&posed, DeviceWish::Cpu);
        let plain = pack(&scene, &scene.cameras[0], settings);
        let mut session = session(&plain, DeviceWish::Cpu);
        let without = session.expose(&plain.view, &|_| ()).unwrap();
        assert_same_bits(&kept.picture, &without.picture, "the picture");
        assert_eq!(kept.rays, without.rays);
        let rendered = layers::render(&mut session, Shown::of(&scene), &without, &lit).unwrap();
        for (layer, values) in rendered {
            let (Values::Light(picture) | Values::Colours(picture) | Values::Vectors(picture)) = values else {
                panic!("{layer} is no picture")
            };
            assert_same_bits(&light(&posed, film(&kept), layer)[0].1, &picture, &layer.to_string());
        }
    }
}

/// Means and variances of blocks of pixels of independent pictures tell whether two estimators have one mean.
fn z(samples: &[Vec<f64>; 2]) -> f64 {
    let [a, b] = samples.each_ref().map(|of| {
        let count = of.len() as f64;
        let mean = of.iter().sum::<f64>() / count;
        let variance = of.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (count - 1.0) / count;
        (mean, variance)
    });
    if a.1 + b.1 == 0.0 { if a.0 == b.0 { 0.0 } else { f64::INFINITY } } else { (a.0 - b.0) / (a.1 + b.1).sqrt() }
}

/// The mean of the green light of the lower half, by seeds.
fn by_seeds(scene: &Scene, layer: Option<Layer>) -> Vec<f64> {
    let mean = |seed| {
        let mut settings = paths(16);
        settings.transport.seed = seed;
        let posed = keeping(scene, settings, layer.as_slice());
        let rendering = exposed(&posed, DeviceWish::Cpu);
        let picture = match layer {
            Some(layer) => light(&posed, film(&rendering), layer).swap_remove(0).1,
            None => rendering.picture,
        };
        let half = &picture.pixels[picture.pixels.len() / 2..];
        half.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / half.len() as f64
    };
    (0..24).map(mean).collect()
}

/// A coat mirrors the same light over whatever base: so the glossy light of plastic is all light of black plastic, but for what lamps and
/// the sky show themselves; and the rest goes with the base's colour.
#[test]
fn the_glossy_light_of_plastic_is_all_light_of_black_plastic() {
    let floor = |base: Vec3| {
        let mut scene = empty();
        add_box(&mut scene, plastic(base), Vec3::new(-5.0, -1.0, -5.0), Vec3::new(5.0, 0.0, 5.0));
        let material = scene.materials.len() as u32;
        scene.materials.push(Material { emission: Vec3::splat(4.0), ..matt(Vec3::ZERO) });
        scene.spheres.push(Sphere { center: Vec3::new(0.0, 1.2, -1.0), radius: 0.8, material });
        scene.cameras = studio().cameras;
        scene
    };
    let (full, half, black) = (floor(Vec3::splat(0.8)), floor(Vec3::splat(0.4)), floor(Vec3::ZERO));
    let own = z(&[by_seeds(&full, Some(Layer::GlossyDirect)), by_seeds(&black, Some(Layer::GlossyDirect))]);
    assert!(own.abs() < 4.0, "{own}");
    let none = by_seeds(&black, Some(Layer::DiffuseDirect));
    assert!(none.iter().all(|&mean| mean == 0.0), "{none:?}");
    // Of light that came straight from the lamp all is of the base or of the coat.
    let twice: Vec<f64> = by_seeds(&half, Some(Layer::DiffuseDirect)).iter().map(|mean| 2.0 * mean).collect();
    let base = z(&[by_seeds(&full, Some(Layer::DiffuseDirect)), twice]);
    assert!(base.abs() < 4.0, "{base}");
}

#[test]
fn a_groups_light_is_the_picture_of_its_lamps_alone() {
    let all = studio();
    let dark = |name: &str| {
        let mut scene = studio();
        for material in scene.materials.iter_mut().filter(|material| material.group != name) {
            material.emission = Vec3::ZERO;
        }
        scene.lights.retain(|light| light.group() == name);
        if scene.background_group != name {
            scene.background = Background::Colour(Vec3::ZERO);
        }
        scene
    };
    let mut numbers = Vec::new();
    for (number, name) in ["", "fill", "key", "sky"].into_iter().enumerate() {
        let mean = |seed| {
            let mut settings = paths(16);
            settings.transport.seed = seed;
            let posed = keeping(&all, settings, &[Layer::LightGroups]);
            let rendering = exposed(&posed, DeviceWish::Cpu);
            let picture = light(&posed, film(&rendering), Layer::LightGroups).swap_remove(number).1;
            picture.pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>()
        };
        let of_alone = |seed: u32| {
            let mut settings = paths(16);
            settings.transport.seed = 1000 + seed;
            let scene = dark(name);
            let picture = exposed(&pack(&scene, &scene.cameras[0], settings), DeviceWish::Cpu).picture;
            picture.pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>()
        };
        numbers.push(z(&[(0..24).map(mean).collect(), (0..24).map(of_alone).collect()]));
    }
    assert!(numbers.iter().all(|z| z.abs() < 4.0), "{numbers:?}");
}

#[test]
fn surfaces_of_one_part_have_light_of_that_part_alone() {
    let plain = |material: Material| {
        let mut scene = empty();
        add_wall(&mut scene, material, Vec3::new(0.0, 0.0, -1.0), 9.0);
        scene.background = Background::Colour(Vec3::ONE);
        scene
    };
    let pane = Physical { transmission: Vec3::ONE, wall: Wall::Pane, roughness: 0.0, ..Physical::default() };
    let glass = Material { physical: Some(pane), ..Material::default() };
    for (material, layers) in [
        (matt(Vec3::splat(0.5)), &[Layer::DiffuseDirect][..]),
        (mirror(Vec3::splat(0.5)), &[Layer::GlossyDirect]),
        (glass, &[Layer::GlossyDirect, Layer::TransmissionDirect]),
    ] {
        let scene = plain(material);
        let posed = keeping(&scene, paths(16), &KEPT[..11]);
        let rendering = exposed(&posed, DeviceWish::Cpu);
        for &layer in parts() {
            let has = light(&posed, film(&rendering), layer)[0].1.pixels.iter().any(|pixel| *pixel != [0.0; 3]);
            assert_eq!(has, layers.contains(&layer), "{layer} of {layers:?}");
        }
    }
}

fn assert_same_layers(posed: &Posed, a: &Film, b: &Film, what: &str) {
    for layer in KEPT {
        for ((name, own), (_, other)) in light(posed, a, layer).iter().zip(&light(posed, b, layer)) {
            assert_same_bits(own, other, &format!("{what}: {layer} {name}"));
        }
    }
}

#[test]
fn gpu_and_cpu_keep_the_same_bits() {
    if quick_gpu().is_none() {
        return;
    }
    let mut many = shipped("lights");
    for (number, light) in many.lights.iter_mut().enumerate() {
        *light = light.clone().in_group(["a", "b", ""][number % 3]);
    }
    let mut around = shipped("dusk");
    around.background_group = "around".to_owned();
    for (name, mut scene) in [("studio", studio()), ("lights", many), ("dusk", around)] {
        scene.settings.transport.integrator = Integrator::Path;
        let settings = Settings { size: SIZE, spp: 5, sampler: Sampler::Sobol, ..scene.settings };
        let posed = keeping(&scene, settings, &KEPT);
        let [gpu, cpu] = [DeviceWish::Gpu, DeviceWish::Cpu].map(|device| exposed(&posed, device));
        assert_same_bits(&gpu.picture, &cpu.picture, name);
        assert_same_layers(&posed, film(&gpu), film(&cpu), name);
    }
}

#[test]
fn parts_have_the_layers_of_the_whole_in_files_too() {
    let scene = studio();
    let posed = keeping(&scene, paths(9), &KEPT);
    let whole = exposed(&posed, DeviceWish::Cpu);
    let mut session = session(&posed, DeviceWish::Cpu);
    let mut merged: Option<Film> = None;
    for (x, width) in [(0, 13), (13, 27)] {
        for samples in [4..9, 0..4] {
            let part = posed.view.part(Region { x, y: 0, width, height: SIZE.1 }, samples).unwrap();
            let film = session.expose(&part, &|_| ()).unwrap().film.unwrap();
            let mut bytes = Vec::new();
            film.write(&mut bytes).unwrap();
            let film = Film::read(&mut &bytes[..]).unwrap();
            match &mut merged {
                Some(merged) => merged.merge(film).unwrap(),
                None => merged = Some(film),
            }
        }
    }
    assert_same_layers(&posed, &merged.unwrap(), film(&whole), "parts");
    let other = keeping(&scene, paths(9), &KEPT[..3]);
    let mut fewer = exposed(&other, DeviceWish::Cpu).film.unwrap();
    assert!(fewer.merge(whole.film.unwrap()).is_err());
}

#[test]
fn films_that_end_by_their_noise_keep_layers() {
    let scene = studio();
    let posed = keeping(&scene, paths(256), &KEPT);
    let stop = std::sync::atomic::AtomicBool::new(false);
    let watch = eyerays::watch::Watch { limit: None, stop: &stop, grown: &|_| () };
    let target = Target::new(0.06, 0.0, eyerays::image::ToneMap::None).unwrap();
    let mut session = session(&posed, DeviceWish::Cpu);
    let rendering = session.render_until(&posed.view, &target, None, &watch).unwrap();
    let samples = film(&rendering).samples();
    assert!(samples.iter().min() < samples.iter().max(), "cells of one number of samples show little");
    let groups = light(&posed, film(&rendering), Layer::LightGroups);
    assert_adds_up(&sum(groups.into_iter().map(|(_, picture)| picture)), &rendering.picture, "groups of lamps");
}

#[test]
fn layers_of_light_are_refused_where_no_paths_are_traced_or_no_lamp_is_in_a_group() {
    let scene = shipped("cornell");
    let posed = pack(&scene, &scene.cameras[0], Settings { size: SIZE, ..scene.settings });
    let error = posed.packed.keeping(Aovs(Aovs::EMISSION)).err().expect("refused").to_string();
    assert!(error.contains("--integrator path"), "{error}");
    let scene = shipped("cornell_path");
    let posed = pack(&scene, &scene.cameras[0], Settings { size: SIZE, ..scene.settings });
    let error = posed.packed.keeping(Aovs(Aovs::GROUPS)).err().expect("refused").to_string();
    assert!(error.contains("group = \"name\""), "{error}");
}
