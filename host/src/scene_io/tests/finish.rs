//! What scene files say of coats, sheen, diffuse transmission, films and Abbe numbers, and what is kept of it.

use std::io::Cursor;

use glam::Vec3;
use image::{ImageFormat, RgbImage};

use super::{Folder, assert_refused};
use crate::scene::{
    Coat, DiffuseTransmission, FinishMaps, Hair, Material, Physical, Pigment, Scene, Sheen, Texels, Texture, ThinFilm,
};
use crate::scene_io::{describe, fingerprint, write};

const MESH: &[u8] = b"mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// All keys, none of which has its default.
const ALL: &str = "base_color = [0.5, 0.25, 0.125]\ntransmission = [0.5, 0.5, 0.5]\n\
    coat = { weight = 0.5, roughness = 0.25 }\nsheen = { color = [0.1, 0.2, 0.3], roughness = 0.4 }\n\
    diffuse_transmission = { weight = 0.75, color = [0.4, 0.5, 0.6] }\n\
    film = { weight = 0.3, ior = 1.7, thickness = 250 }\nabbe = 55\n";

/// All keys of hair.
const HAIR: &str =
    "base_color = [0.5, 0.25, 0.125]\nhair = { roughness = 0.2, radial_roughness = 0.4, tilt = -3 }\nior = 1.6\n";

fn folder(keys: &str) -> Folder {
    let mut picture = Cursor::new(Vec::new());
    RgbImage::new(2, 2).write_to(&mut picture, ImageFormat::Png).unwrap();
    let text = format!("[[mesh]]\nfile = \"a.obj\"\n[[material]]\nname = \"m\"\n{keys}");
    Folder::new(&[
        ("a.toml", text.as_bytes()),
        ("a.obj", MESH),
        ("a.mtl", b"newmtl m\nPc 1\nPcr 0.5\n"),
        ("a.png", picture.get_ref()),
    ])
}

fn scene(keys: &str) -> Scene {
    let (scene, warnings) = folder(keys).load("a.toml").unwrap_or_else(|error| panic!("{keys}: {error}"));
    assert!(warnings.is_empty(), "{keys}: {warnings:?}");
    scene
}

fn material(keys: &str) -> Material {
    scene(keys).materials.remove(0)
}

fn physical(keys: &str) -> Physical {
    material(keys).physical.unwrap_or_else(|| panic!("{keys}: not physical"))
}

fn warnings(keys: &str) -> Vec<String> {
    folder(keys).load("a.toml").unwrap_or_else(|error| panic!("{keys}: {error}")).1
}

#[test]
fn what_a_file_says_of_a_finish_is_what_the_material_has() {
    let physical = physical(ALL);
    assert_eq!(physical.coat, Some(Coat { weight: 0.5, roughness: 0.25 }));
    assert_eq!(physical.sheen, Some(Sheen { colour: Vec3::new(0.1, 0.2, 0.3), roughness: 0.4 }));
    let through = DiffuseTransmission { weight: 0.75, colour: Vec3::new(0.4, 0.5, 0.6) };
    assert_eq!(physical.diffuse_transmission, Some(through));
    assert_eq!(physical.film, Some(ThinFilm { weight: 0.3, ior: 1.7, thickness: [250.0; 2] }));
    assert_eq!(physical.abbe, Some(55.0));
}

#[test]
fn hair_has_the_color_of_its_base_or_of_its_pigment() {
    let told = physical(HAIR);
    assert_eq!(told.hair, Some(Hair { roughness: 0.2, radial_roughness: 0.4, tilt: -3.0 }));
    assert_eq!((told.base, told.ior), (Vec3::new(0.5, 0.25, 0.125), 1.6));
    let plain = physical("hair = {}\ndiffuse = [0.5, 0.4, 0.3]\n");
    assert_eq!((plain.hair, plain.ior), (Some(Hair::default()), Hair::IOR));
    assert_eq!(plain.base, Vec3::new(0.5, 0.4, 0.3));
    let brown = physical("hair = { melanin = 1.3 }\n");
    assert_eq!(brown.base, Hair::default().colour(Pigment::Melanin(1.3, 0.0)));
    let dyed = physical("hair = { absorption = [0.1, 0.2, 0.4] }\ndiffuse = [1, 1, 1]\n");
    assert_eq!(dyed.base, Hair::default().colour(Pigment::Absorption(Vec3::new(0.1, 0.2, 0.4))));
}

#[test]
fn what_a_table_leaves_out_has_its_default() {
    assert_eq!(physical("coat = {}\n").coat, Some(Coat { weight: 1.0, roughness: 0.0 }));
    assert_eq!(physical("sheen = {}\n").sheen, Some(Sheen { colour: Vec3::ONE, roughness: 0.3 }));
    assert_eq!(physical("film = {}\n").film, Some(ThinFilm { weight: 1.0, ior: 1.3, thickness: [400.0; 2] }));
    let through = |keys: &str| physical(keys).diffuse_transmission.unwrap();
    let green = through("base_color = [0, 1, 0]\ndiffuse_transmission = {}\n");
    assert_eq!(green, DiffuseTransmission { weight: 1.0, colour: Vec3::Y });
    assert_eq!(through("diffuse = [1, 0, 0]\ndiffuse_transmission = { weight = 0.5 }\n").colour, Vec3::X);
    let plain = physical("roughness = 0.5\ncoat = { weight = 0 }\n");
    assert_eq!((plain.sheen, plain.diffuse_transmission, plain.film, plain.abbe), (None, None, None, None));
}

/// The material file's coat has the roughness 0.5.
#[test]
fn a_table_takes_the_place_of_the_whole_table_of_the_model() {
    assert_eq!(physical("").coat, Some(Coat { weight: 1.0, roughness: 0.5 }));
    assert_eq!(physical("sheen = {}\n").coat, Some(Coat { weight: 1.0, roughness: 0.5 }));
    assert_eq!(physical("coat = { weight = 0.25 }\n").coat, Some(Coat { weight: 0.25, roughness: 0.0 }));
}

#[test]
fn pictures_of_a_finish_are_taken_as_they_are_unless_a_number_is_given() {
    let of = |keys: &str| physical(&keys.replace("PICTURE", "_texture = \"a.png\"\n"));
    assert_eq!(of("coatPICTURE").coat, Some(Coat { weight: 1.0, roughness: 0.5 }));
    assert_eq!(of("coat = {}\ncoat_roughnessPICTURE").coat, Some(Coat { weight: 1.0, roughness: 1.0 }));
    let half = of("coat = { weight = 0.5, roughness = 0.25 }\ncoatPICTUREcoat_roughnessPICTURE");
    assert_eq!(half.coat, Some(Coat { weight: 0.5, roughness: 0.25 }));
    assert_eq!(of("sheen_colorPICTURE").sheen, Some(Sheen { colour: Vec3::ONE, roughness: 0.3 }));
    assert_eq!(of("sheen_roughnessPICTURE").sheen, Some(Sheen { colour: Vec3::ONE, roughness: 1.0 }));
    let of_base = of("base_color = [1, 0, 0]\ndiffuse_transmissionPICTURE").diffuse_transmission;
    assert_eq!(of_base, Some(DiffuseTransmission { weight: 1.0, colour: Vec3::X }));
    let coloured = of("base_color = [1, 0, 0]\ndiffuse_transmission_colorPICTURE").diffuse_transmission;
    assert_eq!(coloured, Some(DiffuseTransmission { weight: 1.0, colour: Vec3::ONE }));
    assert_eq!(of("filmPICTURE").film, Some(ThinFilm { weight: 1.0, ior: 1.3, thickness: [400.0; 2] }));
    assert_eq!(of("film_thicknessPICTURE").film.unwrap().thickness, [100.0, 400.0]);
    let thick = of("film = { thickness = [300, 20] }\nfilm_thicknessPICTURE").film.unwrap();
    assert_eq!(thick.thickness, [300.0, 20.0]);
}

#[test]
fn each_key_of_a_picture_covers_what_it_is_named_after() {
    type Of = fn(&FinishMaps) -> bool;
    let all: [(&str, Of); 9] = [
        ("coat", |maps| maps.coat.is_some()),
        ("coat_roughness", |maps| maps.coat_roughness.is_some()),
        ("coat_normal", |maps| maps.coat_normal.is_some()),
        ("sheen_color", |maps| maps.sheen_colour.is_some()),
        ("sheen_roughness", |maps| maps.sheen_roughness.is_some()),
        ("diffuse_transmission", |maps| maps.diffuse_transmission.is_some()),
        ("diffuse_transmission_color", |maps| maps.diffuse_transmission_colour.is_some()),
        ("film", |maps| maps.film.is_some()),
        ("film_thickness", |maps| maps.film_thickness.is_some()),
    ];
    for (key, is_there) in all {
        let material = material(&format!("{key}_texture = \"a.png\"\n"));
        let maps = &material.maps.finish;
        assert!(is_there(maps) && maps.all().count() == 1 && material.physical.is_some(), "{key}: {maps:?}");
    }
    let bumpy = material("coat_normal_texture = { file = \"a.png\", strength = 0.5, scale = 2 }\n").maps.finish;
    assert_eq!(bumpy.coat_normal_scale, 0.5);
    assert_eq!(bumpy.coat_normal.unwrap().placement.transform[0], [2.0, 0.0, 0.0]);
}

/// A leaf has its picture on both sides.
#[test]
fn light_that_is_scattered_through_has_the_picture_of_the_base_unless_it_has_its_own_colour() {
    let of = |keys: &str| material(&format!("base_texture = \"a.png\"\n{keys}")).maps;
    let leaf = of("diffuse_transmission = { weight = 0.5 }\n");
    assert!(leaf.base.is_some() && leaf.finish.diffuse_transmission_colour == leaf.base);
    let green = of("diffuse_transmission = { weight = 0.5, color = [0, 1, 0] }\n");
    assert_eq!(green.finish.diffuse_transmission_colour, None);
    assert_eq!(of("coat = {}\n").finish, FinishMaps::default());
}

#[test]
fn a_described_scene_says_its_finish_again() {
    let told = [HAIR, ALL, "film = { ior = 1.5, thickness = [20, 300] }\nfilm_thickness_texture = \"a.png\"\n"];
    for keys in told.into_iter().chain(["conductor = { eta = [1, 1, 1], k = [4, 3, 2] }\ncoat = {}\nsheen = {}\n"]) {
        let first = scene(keys);
        let mut text = describe(&first, "a.obj");
        let again = folder("");
        if keys.contains("film_thickness_texture") {
            text = text.replace("film = ", "film_thickness_texture = \"a.png\"\nfilm = ");
        }
        std::fs::write(again.path("a.toml"), &text).unwrap();
        let (second, warnings) = again.load("a.toml").unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert!(warnings.is_empty(), "{warnings:?}\n{text}");
        assert_eq!(second.materials[0].physical, first.materials[0].physical, "{text}");
    }
    let without = describe(&scene("coat = {}\nroughness = 0.5\n"), "a.obj");
    for key in ["sheen", "diffuse_transmission", "film", "abbe"] {
        assert!(!without.contains(key), "{without}");
    }
}

/// A number in the TOML that is out of range, of another kind, or of no key is refused where it stands.
#[test]
fn a_finish_that_makes_no_sense_is_refused_in_a_line_with_its_key() {
    for (keys, why) in [
        ("coat = { weight = 1.5 }", "\"weight\" must be between 0 and 1, not 1.5"),
        ("coat = { roughness = -1 }", "\"roughness\" must be between 0 and 1, not -1"),
        ("coat = { rougness = 1 }", "unknown key \"rougness\" in [coat]; did you mean \"roughness\"?"),
        ("coat = 1", "\"coat\" must be a table"),
        ("sheen = { color = [2, 0, 0] }", "\"color\" must be between 0 and 1, not 2"),
        ("sheen = { color = 0.5 }", "\"color\" must be three numbers"),
        ("sheen = { roughness = nan }", "\"roughness\" must be between 0 and 1, not nan"),
        ("diffuse_transmission = { weight = 2 }", "\"weight\" must be between 0 and 1, not 2"),
        ("diffuse_transmission = { color = [0, 0, 1e9] }", "\"color\" must be between 0 and 1"),
        ("film = { ior = 0.5 }", "\"ior\" must be between 1 and 4, not 0.5"),
        ("film = { thickness = 100001 }", "\"thickness\" must be between 0 and 100000 nanometres, not 100001"),
        ("film = { thickness = inf }", "\"thickness\" must be between 0 and 100000 nanometres, not inf"),
        ("film = { thickness = [1, 2, 3] }", "\"thickness\" must be two numbers, not 3 of them"),
        ("film = { thickness = \"400\" }", "\"thickness\" must be a decimal number, not a string"),
        ("hair = { roughness = 2 }", "\"roughness\" must be between 0 and 1, not 2"),
        ("hair = { radial_roughness = -1 }", "\"radial_roughness\" must be between 0 and 1, not -1"),
        ("hair = { tilt = 11 }", "\"tilt\" must be between -10 and 10 degrees, not 11"),
        ("hair = { melanin = -1 }", "\"melanin\" must be between 0 and 100, not -1"),
        ("hair = { absorption = [1, 2] }", "\"absorption\" must be three numbers"),
        ("hair = { absorption = [1, 2, 3], melanin = 1 }", "remove absorption or melanin"),
        ("hair = { melanin = 1 }\nbase_color = [1, 1, 1]", "base_color says the color of hair; remove it or melanin"),
        ("hair = { roughnes = 1 }", "unknown key \"roughnes\" in [hair]; did you mean \"roughness\"?"),
        ("abbe = 0.5", "\"abbe\" must be between 1 and 1000, not 0.5"),
        ("abbe = 1e9", "\"abbe\" must be between 1 and 1000, not 1e9"),
        ("coat_texture = \"no.png\"", "no.png"),
        ("coat_texture = { file = \"a.png\", strength = 2 }", "unknown key \"strength\""),
    ] {
        assert_refused(&folder(keys).refuse("a.toml"), "a.toml", Some(5), why);
    }
}

#[test]
fn what_of_a_finish_does_nothing_is_said_with_what_to_do() {
    let silver = "conductor = { eta = [1, 1, 1], k = [4, 3, 2] }\n";
    let (leaf, glass) = ("diffuse_transmission = { weight = 0.5 }\n", "transmission = [1, 1, 1]\n");
    let (tinted, bow) = ("absorption = { color = [0.9, 0.5, 0.5], distance = 1 }\n", "abbe = 55\n");
    let uneven = "film = { thickness = [100, 400] }\n";
    let film = "film_thickness_texture = \"a.png\"\n";
    let rough = "metallic_roughness_texture = \"a.png\"\n";
    for (keys, why) in [
        (["hair = {}\n", silver, ""], "hair has a color instead of a complex index; remove conductor or hair"),
        (["hair = {}\n", "metallic = 1\n", ""], "hair is no metal; remove metallic or hair"),
        (["hair = {}\n", glass, ""], "hair lets light pass by itself; remove transmission or hair"),
        (["hair = {}\n", leaf, ""], "hair lets light pass by itself; remove diffuse_transmission or hair"),
        (["hair = {}\n", "sheen = {}\n", ""], "hair is a fibre as a whole; remove sheen or hair"),
        (["hair = {}\n", "film = {}\n", ""], "hair is a fibre as a whole; remove film or hair"),
        (["hair = {}\n", "anisotropy = 1\n", ""], "hair has a direction of its own; remove anisotropy or hair"),
        ([silver, leaf, ""], "no light passes a conductor; remove conductor or diffuse_transmission"),
        ([silver, "film = {}\n", ""], "a conductor has no film; remove film"),
        ([silver, "sheen = {}\n", "coat = {}\n"], ""),
        ([leaf, "metallic = 1\n", ""], "no light passes metal; lower metallic"),
        ([leaf, "metallic = 1\n", rough], ""),
        ([leaf, "metallic = 0.5\n", ""], ""),
        ([leaf, glass, ""], "transmission leaves no light to diffuse_transmission"),
        ([leaf, "transmission = [1, 1, 0.5]\n", ""], ""),
        ([leaf, glass, "transmission_texture = \"a.png\"\nthin = false\n"], ""),
        ([leaf, tinted, ""], ""),
        ([leaf, tinted, "thin = true\n"], "absorption is of light that passes inside"),
        ([bow, "", ""], "abbe is of light that a body bends"),
        ([bow, leaf, ""], "abbe is of light that a body bends"),
        ([bow, glass, "thin = true\n"], "abbe is of light that a body bends"),
        ([bow, glass, ""], ""),
        ([uneven, "", ""], "without film_thickness_texture a film has the second of its thicknesses"),
        ([uneven, film, ""], ""),
        (["film = { thickness = 400 }\n", film, ""], "give the film both, thickness = [100, 400]"),
        (["film = {}\n", "metallic = 1\n", ""], ""),
        ([leaf, "volume = { scattering = 1 }\n", ""], ""),
        ([leaf, "volume = { scattering = 1 }\n", "thin = true\n"], "its volume is behind an opaque surface"),
    ] {
        let said = warnings(&keys.concat());
        assert_eq!(said.len(), usize::from(!why.is_empty()), "{keys:?}: {said:?}");
        assert!(said.iter().all(|said| said.contains("material \"m\": ") && said.contains(why)), "{said:?}");
    }
}

#[test]
fn a_finish_of_code_that_is_out_of_range_is_refused_with_its_key() {
    let keys = format!("{ALL}coat_normal_texture = \"a.png\"\n");
    let whole = scene(&keys);
    assert_eq!(whole.check(), Ok(()));
    type Spoil = fn(&mut Physical);
    let spoils: [(Spoil, &str); 11] = [
        (|p| p.coat.as_mut().unwrap().weight = 1.5, "coat weight 1.5"),
        (|p| p.coat.as_mut().unwrap().roughness = f32::NAN, "coat roughness NaN"),
        (|p| p.sheen.as_mut().unwrap().colour.y = -1.0, "sheen color -1"),
        (|p| p.sheen.as_mut().unwrap().roughness = 2.0, "sheen roughness 2"),
        (|p| p.diffuse_transmission.as_mut().unwrap().weight = -0.5, "diffuse_transmission weight -0.5"),
        (|p| p.diffuse_transmission.as_mut().unwrap().colour.z = 1.5, "diffuse_transmission color 1.5"),
        (|p| p.film.as_mut().unwrap().weight = f32::INFINITY, "film weight inf"),
        (|p| p.film.as_mut().unwrap().ior = 0.0, "film ior 0"),
        (|p| p.film.as_mut().unwrap().thickness[0] = -1.0, "film thickness -1"),
        (|p| p.film.as_mut().unwrap().thickness[1] = 100_001.0, "film thickness 100001"),
        (|p| p.abbe = Some(0.5), "abbe 0.5"),
    ];
    for (spoil, why) in spoils {
        let mut scene = whole.clone();
        spoil(scene.materials[0].physical.as_mut().unwrap());
        let fault = scene.check().expect_err(why).message();
        assert!(fault.starts_with(&format!("the material \"m\" has the {why}; it must be ")), "{fault}");
    }
    let mut scene = whole;
    scene.materials[0].maps.finish.coat_normal_scale = f32::NAN;
    assert!(scene.check().expect_err("accepted").message().contains("strength of the coat's normals NaN"));
}

/// Films of different finishes must not be merged: the fingerprint tells them apart.
#[test]
fn binary_scenes_keep_a_finish_and_fingerprints_tell_it_apart() {
    let whole = scene(&format!("{ALL}coat_normal_texture = {{ file = \"a.png\", strength = 0.5 }}\n"));
    let mut bytes = Vec::new();
    write(&whole, None, &mut bytes).unwrap();
    let (again, _) = Folder::new(&[("a.eyerays", &bytes)]).load("a.eyerays").unwrap();
    assert_eq!(again.materials[0].physical, whole.materials[0].physical);
    assert_eq!(again.materials[0].maps.finish.coat_normal_scale, 0.5);
    let print = fingerprint(&whole).unwrap();
    assert_eq!(fingerprint(&again).unwrap(), print);
    let changes: [fn(&mut Material); 8] = [
        |m| m.physical.as_mut().unwrap().coat.as_mut().unwrap().roughness = 0.75,
        |m| m.physical.as_mut().unwrap().sheen = None,
        |m| m.physical.as_mut().unwrap().diffuse_transmission.as_mut().unwrap().colour.x = 1.0,
        |m| m.physical.as_mut().unwrap().film.as_mut().unwrap().thickness[0] = 0.0,
        |m| m.physical.as_mut().unwrap().abbe = Some(20.0),
        |m| m.maps.finish.coat_normal_scale = 1.0,
        |m| m.maps.finish.film = m.maps.finish.coat_normal.take(),
        |m| {
            let map = m.maps.finish.coat_normal.as_mut().unwrap();
            let texels = Texels::Bytes(vec![[9; 4]; 4]);
            map.texture = Texture { texels, ..(*map.texture).clone() }.into();
        },
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let mut other = whole.clone();
        change(&mut other.materials[0]);
        assert_ne!(fingerprint(&other).unwrap(), print, "change {number}");
    }
}
