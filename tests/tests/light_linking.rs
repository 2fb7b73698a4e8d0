//! Surfaces that some lamps alone light: pictures of them are made of layers of pictures without such.

use eyerays::layers::{self, Layer, Values};
use eyerays::picture::Picture;
use eyerays::render::{Backend, Choice, DeviceWish};
use eyerays::scene::{
    Background, Camera, Integrator, LightGroups, Material, PixelFilter, Projection, Sampler, Scene, Settings, Sphere,
    Transport,
};
use eyerays::view::View;
use eyerays_tests::model::{add_box, black, empty, lamp, matt, mirror};
use eyerays_tests::{assert_same_bits, on_cpu, pack, quick_gpu};
use glam::Vec3;

const SIZE: (u32, u32) = (40, 30);

fn paths(bounces: u32) -> Settings {
    Settings {
        size: SIZE,
        spp: 16,
        bounces,
        sampler: Sampler::Sobol,
        pixel_filter: Some(PixelFilter::Box),
        transport: Transport { integrator: Integrator::Path, ..Transport::default() },
        ..Settings::default()
    }
}

/// A floor, a ball and a mirror below a lamp of a group that shines, a light of another, and, if it has one, a sky of a third.
fn room(sky: f32) -> Scene {
    let mut scene = empty();
    add_box(&mut scene, matt(Vec3::splat(0.7)), Vec3::new(-5.0, -1.0, -5.0), Vec3::new(5.0, 0.0, 5.0));
    let key = Material { group: "key".to_owned(), emission: Vec3::splat(6.0), ..black() };
    let made = [
        (Vec3::new(-0.8, 0.7, 0.0), 0.7, matt(Vec3::new(0.8, 0.3, 0.2))),
        (Vec3::new(0.9, 0.6, 0.2), 0.6, mirror(Vec3::splat(0.9))),
        (Vec3::new(0.0, 3.0, 0.5), 0.5, key),
    ];
    for (center, radius, made) in made {
        let material = scene.materials.len() as u32;
        scene.materials.push(made);
        scene.spheres.push(Sphere { center, radius, material });
    }
    scene.lights = vec![lamp(Vec3::new(3.0, 2.5, 3.0)).in_group("fill")];
    scene.background = Background::Colour(Vec3::splat(sky));
    scene.background_group = "sky".to_owned();
    scene.cameras = vec![Camera::new(
        "front",
        Vec3::new(0.0, 1.6, 5.0),
        Vec3::new(0.0, 0.7, 0.0),
        Projection::Perspective { fov: 45.0 },
    )];
    scene
}

fn linked(mut scene: Scene, lit_by: &[&str], materials: &[usize]) -> Scene {
    for &number in materials {
        scene.materials[number].lit_by = Some(lit_by.iter().map(|&name| name.to_owned()).collect());
    }
    scene
}

fn picture(scene: &Scene, settings: Settings) -> Picture {
    on_cpu(&pack(scene, &scene.cameras[0], settings)).0
}

/// The light of a group where every lamp lights everything.
fn of_group(scene: &Scene, settings: Settings, name: &str) -> Picture {
    let posed = pack(scene, &scene.cameras[0], settings);
    let job = posed.packed.keeping(layers::asked(&[Layer::LightGroups])).unwrap();
    let view = View::new(&job, &scene.cameras[0]).unwrap();
    let backend = Backend::new(&Choice { device: DeviceWish::Cpu, ..Choice::default() }).unwrap();
    let film = backend.open(&job).unwrap().expose(&view, &|_| ()).unwrap().film.unwrap();
    let Some(Values::Parts(parts)) =
        layers::of_film(&film, (&layers::names(&job), &film.develop().unwrap()), Layer::LightGroups).unwrap()
    else {
        panic!("it was asked for")
    };
    let name = format!("group_{name}");
    parts.into_iter().find(|(group, _)| *group == name).expect("a group").1
}

/// Through bounces, by lamps that are sampled and by those that paths find.
#[test]
fn a_scene_that_one_group_lights_is_the_layer_of_that_group() {
    let (scene, settings) = (room(0.0), paths(3));
    for (group, other) in [("key", "fill"), ("fill", "key")] {
        // What the camera itself sees of lamps is no matter of who lights what.
        let mut dark = linked(scene.clone(), &[group], &[0, 1, 2]);
        let mut all = scene.clone();
        for scene in [&mut dark, &mut all] {
            scene.materials[3].visibility.camera = false;
        }
        let want = of_group(&all, settings, group);
        assert!(want.pixels.iter().filter(|pixel| pixel[1] > 0.0).count() > 300);
        assert_same_bits(&picture(&dark, settings), &want, group);
        assert!(!picture(&linked(dark, &[other], &[0]), settings).bits_equal(&want));
    }
}

/// Pixels of the ball have the light of the groups that light it, and all others that of all: but for edges, where samples are of both.
#[test]
fn each_surface_has_the_light_of_the_groups_that_it_is_lit_by() {
    let (scene, settings) = (room(0.4), paths(0));
    let (all, own) = (picture(&scene, settings), picture(&linked(scene.clone(), &["sky"], &[1]), settings));
    let sky = of_group(&scene, settings, "sky");
    let (mut of_ball, mut of_others) = (0, 0);
    for ((own, all), sky) in own.pixels.iter().zip(&all.pixels).zip(&sky.pixels) {
        of_ball += usize::from(own == sky && own != all);
        of_others += usize::from(own == all);
    }
    let pixels = (SIZE.0 * SIZE.1) as usize;
    assert!(of_ball > 60 && of_ball + of_others > pixels * 9 / 10, "{of_ball} and {of_others} of {pixels}");
}

#[test]
fn gpu_and_cpu_link_alike() {
    if quick_gpu().is_none() {
        return;
    }
    let scene = linked(linked(room(0.3), &["sky", LightGroups::REST], &[1]), &["fill"], &[2]);
    let adapter = std::env::var("EYERAYS_ADAPTER").ok();
    let posed = pack(&scene, &scene.cameras[0], paths(3));
    let backend = Backend::new(&Choice { device: DeviceWish::Gpu, adapter, ..Choice::default() }).unwrap();
    let gpu = backend.render(&posed.packed, &posed.view, 1, &|_| ()).unwrap();
    assert_same_bits(&gpu.picture, &on_cpu(&posed).0, "linked");
}

#[test]
fn a_group_that_no_lamp_is_in_lights_nothing_and_is_refused() {
    let error = linked(room(0.1), &["kye"], &[0]).check().unwrap_err().to_string();
    assert!(error.contains("\"kye\", which no lamp is in; there are fill, key, sky, rest"), "{error}");
    let mut many = linked(room(0.1), &["sky"], &[0]);
    many.lights.extend((0..15).map(|number| lamp(Vec3::Y).in_group(&format!("lamp {number}"))));
    let error = many.check().unwrap_err().to_string();
    assert!(error.contains("18 groups of lamps; where materials have lit_by there are at most 14"), "{error}");
    many.lights.extend((0..300).map(|number| lamp(Vec3::Y).in_group(&format!("more {number}"))));
    let error = many.check().unwrap_err().to_string();
    assert!(error.contains("more than 255 groups"), "{error}");
    let scene = linked(room(0.0), &["fill"], &[0]);
    let settings = Settings { transport: Transport::default(), ..paths(1) };
    let mut plain = scene.clone();
    plain.materials[3].emission = Vec3::ZERO;
    plain.background_group.clear();
    plain.materials[0].lit_by = Some(vec!["fill".to_owned()]);
    let error =
        eyerays::job::Job::new(&plain, settings, eyerays::quality::Bvh::Fast.quality()).err().unwrap().to_string();
    assert!(error.contains("set the integrator to \"path\""), "{error}");
}
