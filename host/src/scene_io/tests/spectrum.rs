//! What scene files say of glasses, metals, temperatures of lamps and light of single wavelengths, and what is kept of it.

use glam::Vec3;

use super::{Folder, assert_refused};
use crate::scene::{Light, Material, Scene};
use crate::scene_io::describe;
use crate::spectrum::{Glass, Illuminant, Metal};

const MESH: &[u8] = b"mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn folder(text: &str) -> Folder {
    let text = format!("[[mesh]]\nfile = \"a.obj\"\n{text}");
    Folder::new(&[("a.toml", text.as_bytes()), ("a.obj", MESH), ("a.mtl", b"newmtl m\n")])
}

fn scene(text: &str) -> Scene {
    let (scene, warnings) = folder(text).load("a.toml").unwrap_or_else(|error| panic!("{text}: {error}"));
    assert!(warnings.is_empty(), "{text}: {warnings:?}");
    scene
}

fn material(keys: &str) -> Material {
    scene(&format!("[[material]]\nname = \"m\"\n{keys}")).materials.remove(0)
}

#[test]
fn a_glass_is_clear_and_has_its_own_index() {
    let of = material("glass = \"bk7\"");
    let physical = of.physical.unwrap();
    assert_eq!((physical.glass, physical.transmission, physical.roughness), (Some(Glass::Bk7), Vec3::ONE, 0.0));
    assert!((of.ior - 1.5168).abs() < 1e-4 && physical.ior == of.ior);
    // Of light of three channels it is as its Abbe number says.
    assert!((physical.dispersion() - 0.5168 / (2.0 * 64.17)).abs() < 1e-5);
    let frosted = material("glass = \"water\"\nroughness = 0.5\ntransmission = [0.5, 0.6, 0.7]").physical.unwrap();
    assert_eq!((frosted.roughness, frosted.transmission), (0.5, Vec3::new(0.5, 0.6, 0.7)));
}

#[test]
fn a_metal_is_a_conductor_of_its_colour() {
    let conductor = material("metal = \"gold\"").physical.unwrap().conductor.unwrap();
    assert_eq!((conductor.metal, conductor), (Some(Metal::Gold), Metal::Gold.conductor()));
}

#[test]
fn light_of_a_temperature_has_its_colour_unless_another_is_said() {
    let bulb = Illuminant::BlackBody(2700.0);
    let warm = bulb.colour();
    for (keys, want) in [("", warm), ("emission = 20", warm * 20.0), ("emission = [1, 2, 3]", Vec3::new(1.0, 2.0, 3.0))]
    {
        let of = material(&format!("temperature = 2700\n{keys}"));
        assert_eq!((of.illuminant, of.emission), (Some(bulb), want), "{keys}");
    }
    let lit = |keys: &str| {
        let text = format!("[[light]]\nkind = \"spot\"\nposition = [0, 1, 0]\ntarget = [0, 0, 0]\nangle = 20\n{keys}");
        scene(&text).lights.remove(0)
    };
    let Light::Spot { colour, illuminant, .. } = lit("temperature = 2700\nintensity = 3") else { panic!("a spot") };
    assert_eq!((colour, illuminant), (warm * 3.0, Some(bulb)));
    let Light::Spot { colour, .. } = lit("temperature = 2700\ncolor = [0, 1, 0]") else { panic!("a spot") };
    assert_eq!(colour, Vec3::Y);
}

#[test]
fn what_is_described_says_all_of_it_again() {
    let text = "[render]\nintegrator = \"path\"\nspectral = true\n[[material]]\nname = \"m\"\ntemperature = 2700\nemission = 3\n\
        [[light]]\nkind = \"point\"\nposition = [0, 1, 0]\nilluminant = \"f11\"\n";
    for keys in ["", "glass = \"sf11\"", "metal = \"copper\""] {
        let text = text.replace("name = \"m\"\n", &format!("name = \"m\"\n{keys}\n"));
        let first = scene(&text);
        assert!(first.settings.spectral);
        let told = describe(&first, "a.obj");
        let again = Folder::new(&[("a.toml", told.as_bytes()), ("a.obj", MESH), ("a.mtl", b"newmtl m\n")]);
        let (second, warnings) = again.load("a.toml").unwrap_or_else(|error| panic!("{error}\n{told}"));
        assert!(warnings.is_empty(), "{warnings:?}\n{told}");
        assert_eq!((&second.materials, &second.lights), (&first.materials, &first.lights), "{told}");
        assert_eq!(second.settings, first.settings, "{told}");
    }
}

#[test]
fn what_makes_no_sense_is_refused_in_a_line_with_its_key() {
    for (keys, line, why) in [
        ("glass = \"jade\"", 5, "jade"),
        ("glass = \"bk7\"\nior = 1.5", 5, "a glass has an index of its own; remove glass, or ior and abbe"),
        ("glass = \"bk7\"\nabbe = 50", 5, "a glass has an index of its own; remove glass, or ior and abbe"),
        ("metal = \"brass\"", 5, "brass"),
        ("metal = \"gold\"\nconductor = { eta = [1, 1, 1], k = [1, 1, 1] }", 6, "remove metal or conductor"),
        ("illuminant = \"f99\"", 5, "f99"),
        ("temperature = 2700\nilluminant = \"f2\"", 5, "remove temperature or illuminant"),
        ("temperature = 400", 5, "\"temperature\" must be between 500 and 100000, not 400"),
        ("temperature = nan", 5, "\"temperature\" must be between 500 and 100000, not nan"),
        ("temperature = 2700\nemission = -1", 6, "\"emission\" must be a finite number of at least 0, not -1"),
        ("emission = 5", 5, "\"emission\" must be three numbers"),
    ] {
        let refused = folder(&format!("[[material]]\nname = \"m\"\n{keys}")).refuse("a.toml");
        assert_refused(&refused, "a.toml", Some(line), why);
    }
}
