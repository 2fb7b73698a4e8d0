//! What a key or a picture does, alone and beside others; what does nothing is said.

use std::io::Cursor;

use glam::Vec3;
use image::{ImageFormat, RgbImage};

use super::Folder;
use crate::scene::{Integrator, Scene, Wall};

/// A triangle of the material `m`, with a picture beside it.
fn load(text: &str) -> (Scene, Vec<String>) {
    let mut picture = Cursor::new(Vec::new());
    RgbImage::new(2, 2).write_to(&mut picture, ImageFormat::Png).unwrap();
    let mesh = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let text = format!("{text}\n[[mesh]]\nfile = \"a.obj\"\nmaterial = \"m\"\n");
    let files: [(&str, &[u8]); 3] = [("a.toml", text.as_bytes()), ("a.obj", mesh), ("a.png", picture.get_ref())];
    Folder::new(&files).load("a.toml").unwrap()
}

fn material(keys: &str) -> (Scene, Vec<String>) {
    load(&format!("[[material]]\nname = \"m\"\n{keys}"))
}

#[test]
fn a_picture_whose_factor_is_not_given_is_taken_as_it_is() {
    let of = |key: &str| material(&format!("{key}_texture = \"a.png\"\n")).0.materials.remove(0);
    assert_eq!(of("emission").emission, Vec3::ONE);
    let physical = |key| of(key).physical.unwrap();
    assert_eq!(physical("transmission").transmission, Vec3::ONE);
    assert_eq!((physical("metallic_roughness").metallic, physical("metallic_roughness").roughness), (1.0, 1.0));
    assert_eq!(physical("anisotropy").anisotropy, 1.0);
    assert_eq!(
        (physical("specular_weight").specular_weight, physical("specular_tint").specular_tint),
        (1.0, Vec3::ONE)
    );
    for key in ["base", "normal", "opacity"] {
        assert_eq!(of(key).physical, None, "{key} covers any material");
    }
    let (scene, _) = material("metallic_roughness_texture = \"a.png\"\nmetallic = 0.5\n");
    assert_eq!(scene.materials[0].physical.unwrap().metallic, 0.5);
}

#[test]
fn a_thin_wall_is_a_pane_or_one_interface() {
    let wall = |keys: &str| material(keys).0.materials[0].physical.unwrap().wall;
    assert_eq!(wall("thin = true\n"), Wall::Pane);
    assert_eq!((wall("thin = \"interface\"\n"), wall("thin = \"pane\"\n")), (Wall::Interface, Wall::Pane));
    assert_eq!((wall("thin = false\n"), wall("roughness = 1\n")), (Wall::Body, Wall::Body));
    let (scene, _) = material("thin = \"interface\"\ntransmission = [1, 1, 1]\n");
    assert!(crate::scene_io::describe(&scene, "a.obj").contains("thin = \"interface\""));
}

#[test]
fn keys_that_do_nothing_beside_others_are_warned_of() {
    let silver = "conductor = { eta = [0.1, 0.1, 0.1], k = [4, 3, 2] }\n";
    let tinted = "absorption = { color = [0.9, 0.5, 0.5], distance = 1 }\n";
    let glass = "transmission = [1, 1, 1]\n";
    for (keys, why) in [
        ([silver, glass, ""], "no light passes a conductor; remove conductor or transmission"),
        ([tinted, "", ""], "absorption is of light that passes inside"),
        ([tinted, glass, "thin = true\n"], "absorption is of light that passes inside"),
        ([tinted, glass, ""], ""),
        ([silver, "", ""], ""),
    ] {
        let (_, warnings) = material(&keys.concat());
        assert_eq!(warnings.len(), usize::from(!why.is_empty()), "{keys:?}: {warnings:?}");
        assert!(
            warnings.iter().all(|said| said.contains("a.toml: material \"m\": ") && said.contains(why)),
            "{warnings:?}"
        );
    }
}

#[test]
fn integrators_tell_what_light_they_leave_out() {
    let ignored = |integrator: Integrator, text: &str| integrator.ignored(&load(text).0).unwrap_or_default();
    let studio = "[background]\nenvironment = \"studio\"\n[[material]]\nname = \"m\"\n";
    assert!(ignored(Integrator::Whitted, studio).starts_with("the environment lights nothing"));
    assert_eq!(ignored(Integrator::Path, studio), "");
    let lit = format!("{studio}[[light]]\nkind = \"point\"\nposition = [0, 0, 9]\n");
    assert_eq!(ignored(Integrator::Whitted, &lit), "");
    let thesis = "[[material]]\nname = \"m\"\nspecular = [1, 1, 1]\n";
    assert!(ignored(Integrator::Path, thesis).starts_with("Phong's highlights are not drawn"));
    let physical = "[[material]]\nname = \"m\"\nroughness = 0.5\n";
    assert_eq!(ignored(Integrator::Path, physical), "");
}
