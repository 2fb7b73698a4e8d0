//! What scene files say of media, what a described scene says of them again, and what binary scenes keep.

use glam::Vec3;

use super::{Folder, assert_refused};
use crate::scene::{Medium, Scene, Temperature, Volume};
use crate::scene_io::{describe, fingerprint, write};

/// A grid volume of Mitsuba of two cells along x.
fn vol(numbers: [f32; 2]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    [1, 2, 1, 1, 1].iter().for_each(|number: &i32| bytes.extend(number.to_le_bytes()));
    [0f32, 0.0, 0.0, 2.0, 1.0, 1.0].iter().chain(&numbers).for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes
}

const BALL: &str = "[[mesh]]\nshape = \"sphere\"\nmaterial = \"m\"\n";

fn folder(text: &str) -> Folder {
    Folder::new(&[
        ("scene.toml", text.as_bytes()),
        ("g.vol", &vol([0.5, 3.0])),
        ("bad.vol", &vol([0.5, -1.0])),
        ("fire.vol", &vol([900.0, 1800.0])),
        ("ash.vol", &vol([0.0, 0.0])),
        ("no.nvdb", b"hello"),
    ])
}

fn load(text: &str) -> Scene {
    let (scene, warnings) = folder(text).load("scene.toml").unwrap_or_else(|error| panic!("{error}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

fn of_material(volume: &str) -> Volume {
    let scene = load(&format!("[[material]]\nname = \"m\"\ntransmission = [1, 1, 1]\nvolume = {{ {volume} }}\n{BALL}"));
    scene.materials.into_iter().find_map(|material| material.volume).expect("a volume")
}

#[test]
fn a_volume_is_as_it_is_told_and_nothing_where_nothing_is() {
    let all =
        "scattering = [1, 2, 3], absorption = 0.5, anisotropy = -0.3, emission = 4, interface = false, priority = 9";
    let medium = Medium {
        scattering: Vec3::new(1.0, 2.0, 3.0),
        absorption: Vec3::splat(0.5),
        anisotropy: -0.3,
        emission: Vec3::splat(4.0),
    };
    assert_eq!(of_material(all), Volume { priority: 9, ..Volume::open(medium) });
    let default = Volume { interface: true, ..Volume::open(Medium::default()) };
    assert_eq!(of_material(""), default);
    let scene = load("[fog]\nscattering = 0.1\n[[mesh]]\nshape = \"sphere\"\n");
    assert_eq!(scene.fog, Some(Medium { scattering: Vec3::splat(0.1), ..Medium::default() }));
}

#[test]
fn a_volume_that_nobody_sees_is_a_warning() {
    let hidden = format!("[[material]]\nname = \"m\"\nvolume = {{ scattering = 1 }}\n{BALL}");
    let (_, warnings) = folder(&hidden).load("scene.toml").unwrap();
    assert!(warnings.len() == 1 && warnings[0].contains("behind an opaque surface"), "{warnings:?}");
}

/// White scatters all, black nothing, and in between less is scattered than is seen of what is scattered again and again.
#[test]
fn a_colour_is_that_of_a_thick_body() {
    let of = of_material("color = [0, 0.5, 1], distance = 0.25").medium;
    let albedo = of.scattering / (of.scattering + of.absorption);
    assert!((of.scattering + of.absorption).abs_diff_eq(Vec3::splat(4.0), 1e-5), "{of:?}");
    assert!(albedo.x < 0.01 && (0.85..0.95).contains(&albedo.y) && albedo.z > 0.999, "{albedo}");
}

#[test]
fn what_no_medium_may_be_is_refused_where_it_stands() {
    let refuse = |table: &str, why: &str| {
        let text = format!("[[material]]\nname = \"m\"\nvolume = {{ {table} }}\n{BALL}");
        assert_refused(&folder(&text).refuse("scene.toml"), "scene.toml", Some(3), why);
    };
    refuse("scattering = -1", "must be a finite number of at least 0");
    refuse("anisotropy = 1", "must be between -0.999 and 0.999");
    refuse("emission = [0, 1, 0]", "what sends green light must absorb green light");
    refuse("color = [1, 1, 1]", "distance");
    refuse("color = [1, 1, 1], distance = 1, scattering = 2", "scattering is told by color and distance");
    refuse("priority = 256", "priority");
    refuse("thickness = 1", "thickness");
    refuse("density = \"gone.nvdb\"", "there is no such file");
    refuse("density = \"no.nvdb\"", "neither NanoVDB");
    refuse("density = \"bad.vol\"", "the grid has the number -1");
    refuse("density = { file = \"g.vol\", bounds = [[0, 0, 0], [1, 0, 1]] }", "must be greater than the first");
    refuse("density = { file = \"g.vol\", size = 3 }", "size");
    refuse("density = { file = \"g.vol\", kelvins = 3 }", "kelvins");
    refuse("temperature = \"fire.vol\"", "what sends red light must absorb red light: give it absorption");
    refuse("temperature = \"fire.vol\", absorption = [1, 1, 0]", "must absorb blue light");
    refuse("temperature = \"bad.vol\", absorption = 1", "bad.vol: the grid has the number -1; temperatures are finite");
    refuse("temperature = { file = \"fire.vol\", kelvins = 0 }, absorption = 1", "must be between 0.001 and 1000000");
    refuse("temperature = { file = \"fire.vol\", kelvins = nan }, absorption = 1", "must be between 0.001 and 1000000");
    let hot = "temperature = { file = \"fire.vol\", kelvins = 1e6 }, absorption = 1";
    refuse(hot, "fire.vol: its hottest place has 1.8e9 kelvins; lower kelvins, to at most 1e9 there");
    let shines = format!("[[material]]\nname = \"m\"\nemission = [1, 1, 1]\nvolume = {{ interface = false }}\n{BALL}");
    let scene = load(&shines);
    assert!(scene.check().unwrap_err().to_string().contains("shines without a surface"));
}

/// What is hot glows unless it is told otherwise.
#[test]
fn a_temperature_is_a_grid_and_its_kelvins() {
    let told = of_material("temperature = \"fire.vol\", absorption = 1");
    let temperature = told.temperature.expect("a temperature");
    assert_eq!((told.medium.emission, temperature.kelvins), (Vec3::ONE, 1.0));
    assert_eq!((temperature.grid.number([0, 0, 0]), temperature.grid.number([1, 0, 0])), (900.0, 1800.0));
    assert_eq!(told.density, None);
    let told =
        "temperature = { file = \"g.vol\", kelvins = 1000, bounds = [[-1, -1, -1], [1, 1, 1]] }, density = \"g.vol\"";
    let told = of_material(&format!("{told}, absorption = 1, emission = [4, 5, 6]"));
    let temperature = told.temperature.expect("a temperature");
    assert_eq!((told.medium.emission, temperature.kelvins), (Vec3::new(4.0, 5.0, 6.0), 1000.0));
    assert_eq!(temperature.grid.bounds()[0], glam::DVec3::splat(-1.0));
    assert_eq!(told.density.expect("a density").bounds()[0], glam::DVec3::ZERO);
}

#[test]
fn a_temperature_of_which_nobody_sees_anything_is_a_warning() {
    let warned = |volume: &str, why: &str| {
        let text =
            format!("[[material]]\nname = \"m\"\nvolume = {{ {volume}, absorption = 1, interface = false }}\n{BALL}");
        let (_, warnings) = folder(&text).load("scene.toml").unwrap();
        assert!(warnings.len() == 1 && warnings[0].contains(why), "{warnings:?}");
    };
    warned("temperature = \"ash.vol\"", "below 500 kelvins everywhere");
    warned("temperature = \"g.vol\"", "raise its kelvins, or name another grid");
    warned("temperature = \"fire.vol\", emission = 0", "an emission of 0; remove one of them");
}

#[test]
fn a_described_scene_says_its_media_again() {
    let text = "[fog]\nscattering = [0.1, 0.2, 0.3]\nanisotropy = 0.5\n[[material]]\nname = \"m\"\n\
        volume = { absorption = 2, emission = [0, 1, 2], interface = false, priority = 3 }\n";
    let scene = load(&format!("{text}{BALL}"));
    let told = describe(&scene, "ball.obj");
    let obj = b"mtllib ball.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let again = Folder::new(&[("scene.toml", told.as_bytes()), ("ball.obj", obj), ("ball.mtl", b"newmtl m\n")]);
    let (again, _) = again.load("scene.toml").unwrap_or_else(|error| panic!("{error}\n{told}"));
    assert_eq!(again.fog, scene.fog, "{told}");
    let volume = |scene: &Scene| scene.materials.iter().find(|material| material.name == "m").unwrap().volume.clone();
    assert_eq!(volume(&again), volume(&scene), "{told}");
}

/// Two grids that differ in a number are two scenes; the same grid comes back from a binary file.
#[test]
fn binary_scenes_keep_grids() {
    let told = "density = { file = \"g.vol\", bounds = [[-1, -1, -1], [1, 1, 1]] }, scattering = 2, interface = false";
    let scene = load(&format!("[[material]]\nname = \"m\"\nvolume = {{ {told} }}\n{BALL}"));
    let mut bytes = Vec::new();
    write(&scene, None, &mut bytes).unwrap();
    let folder = Folder::new(&[("scene.eyerays", &bytes)]);
    let (again, _) = folder.load("scene.eyerays").unwrap();
    assert_eq!(again.materials, scene.materials);
    assert_eq!(fingerprint(&again).unwrap(), fingerprint(&scene).unwrap());
    let mut other = scene.clone();
    let volume = other.materials[0].volume.as_mut().unwrap();
    let grid = std::sync::Arc::make_mut(volume.density.as_mut().unwrap());
    grid.background = 1.0;
    assert_ne!(fingerprint(&other).unwrap(), fingerprint(&scene).unwrap());
}

/// One grid of both is kept once, and one of another unit is another scene.
#[test]
fn binary_scenes_keep_temperatures() {
    let told = "temperature = { file = \"g.vol\", kelvins = 1000 }, absorption = 2, interface = false";
    let mut scene = load(&format!("[[material]]\nname = \"m\"\nvolume = {{ {told} }}\n{BALL}"));
    let kept = |scene: &Scene| {
        let mut bytes = Vec::new();
        write(scene, None, &mut bytes).unwrap();
        let (again, _) = Folder::new(&[("scene.eyerays", &bytes)]).load("scene.eyerays").unwrap();
        assert_eq!(again.materials, scene.materials);
        assert_eq!(fingerprint(&again).unwrap(), fingerprint(scene).unwrap());
        bytes.len()
    };
    let one = kept(&scene);
    let volume = scene.materials[0].volume.as_mut().unwrap();
    volume.density = volume.temperature.as_ref().map(|temperature| temperature.grid.clone());
    let both = kept(&scene);
    assert!(both < one + 200, "{both} bytes after {one}");
    let mut other = scene.clone();
    other.materials[0].volume.as_mut().unwrap().temperature.as_mut().unwrap().kelvins = 1001.0;
    assert_ne!(fingerprint(&other).unwrap(), fingerprint(&scene).unwrap());
}

/// What code makes is refused as what files hold is.
#[test]
fn temperatures_of_code_are_checked() {
    let scene = load(&format!(
        "[[material]]\nname = \"m\"\nvolume = {{ temperature = \"fire.vol\", absorption = 2, interface = false }}\n{BALL}"
    ));
    let refused = |spoil: &dyn Fn(&mut Temperature)| {
        let mut scene = scene.clone();
        spoil(scene.materials[0].volume.as_mut().unwrap().temperature.as_mut().unwrap());
        scene.check().unwrap_err().message()
    };
    let kelvins = refused(&|temperature| temperature.kelvins = f32::NAN);
    assert!(kelvins.contains("material \"m\" has the kelvins of temperature NaN; it must be"), "{kelvins}");
    let hot = refused(&|temperature| temperature.kelvins = 1e6);
    assert!(hot.contains("material \"m\", \"fire.vol\": its hottest place has 1.8e9 kelvins"), "{hot}");
    let odd = refused(&|temperature| std::sync::Arc::make_mut(&mut temperature.grid).background = -3.0);
    assert!(odd.contains("the grid has the number -3; temperatures are finite"), "{odd}");
}
