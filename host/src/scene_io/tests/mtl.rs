//! Materials of Wavefront meshes.

use glam::Vec3;

use super::{Folder, TRIANGLE, warning};
use crate::scene::{Integrator, Material, Scene};
use crate::scene_io::load::Loading;

fn with_material(mtl: &str) -> (Scene, Vec<String>) {
    let obj = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let folder = Folder::new(&[("a.obj", obj), ("a.mtl", mtl.as_bytes())]);
    folder.load("a.obj").unwrap()
}

#[test]
fn missing_materials_are_grey_and_warned_of_once() {
    let text = b"mtllib b.mtl\nv 0 0 0\nusemtl x\nf 1 1 1\nusemtl y\nf 1 1 1\n";
    let folder = Folder::new(&[("a.obj", text), ("c.obj", &text[13..]), ("d.obj", TRIANGLE)]);
    let (scene, warnings) = folder.load("a.obj").unwrap();
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(scene.materials[0].name, "default");
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("a.obj:1: material file \"b.mtl\" not found"), "{warnings:?}");
    let (_, warnings) = folder.load("c.obj").unwrap();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("c.obj:2: material \"x\" and 1 more"), "{warnings:?}");
    assert!(folder.load("d.obj").unwrap().1.is_empty());
}

#[test]
fn material_files_are_found_with_blanks_and_as_a_list() {
    let obj = b"mtllib a b.mtl\nmtllib c.mtl d.mtl\nv 0 0 0\nusemtl a b\nf 1 1 1\nusemtl d#1\nf 1 1 1\n";
    let folder = Folder::new(&[
        ("x.obj", obj),
        ("a b.mtl", b"newmtl a b\nKd 1 0 0\n"),
        ("c.mtl", b"newmtl c\n"),
        ("d.mtl", b"newmtl d#1\nKd 0 1 0\n"),
    ]);
    let (scene, warnings) = folder.load("x.obj").unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(scene.materials[0].diffuse, Vec3::X);
    assert_eq!(scene.materials[1].diffuse, Vec3::Y);
}

#[test]
fn names_in_latin1_and_empty_names_find_their_materials_with_a_warning_each() {
    let obj = b"mtllib a.mtl\no \xd8\nv 0 0 0\nusemtl Terraind\xe6k\nf 1 1 1\nusemtl \nf 1 1 1\nusemtl\nf 1 1 1\n";
    let mtl = b"newmtl Terraind\xe6k\nKd 1 0 0\nnewmtl \nKd 0 1 0\n# \xe6\n";
    let folder = Folder::new(&[("a.obj", obj), ("a.mtl", mtl)]);
    let (scene, warnings) = folder.load("a.obj").unwrap();
    let colours: Vec<_> = scene.mesh.materials.iter().map(|&at| scene.materials[at as usize].diffuse).collect();
    assert_eq!(colours, [Vec3::X, Vec3::Y, Vec3::Y]);
    assert_eq!(scene.materials[0].name, "Terraind\u{e6}k");
    let wanted = [
        "a.mtl:1: line not UTF-8 text: read as Latin-1",
        "a.mtl:3: newmtl without a name",
        "a.obj:2: line and 1 more not UTF-8 text: read as Latin-1",
        "a.obj:6: usemtl and 1 more without a name",
    ];
    assert_eq!(warnings.len(), wanted.len(), "{warnings:?}");
    for (warning, want) in warnings.iter().zip(wanted) {
        assert!(warning.contains(want), "{warning}, wanted: {want}");
    }
}

#[test]
fn a_line_of_a_material_that_makes_no_sense_is_left_out_with_a_warning() {
    for (text, line, why) in [
        ("Kd 1 0 0\nnewmtl m\n", 1, "before newmtl"),
        ("newmtl m\nKd 1 0\n", 2, "three numbers, not 2"),
        ("newmtl m\nKd\n", 2, "three numbers, not 0"),
        ("newmtl m\nKd xyz 1 0 0\n", 2, "no number"),
        ("newmtl m\nKs 1 0 nan\n", 2, "no finite number"),
        ("newmtl m\nTf spectral a.rfl\n", 2, "no number"),
        ("newmtl m\nNs\n", 2, "one number"),
        ("newmtl m\nNi inf\n", 2, "no finite number"),
        ("newmtl m\nd 1 2\n", 2, "one number"),
        ("newmtl m\nTr x\n", 2, "no number"),
        ("newmtl m\nillum 11\n", 2, "0 to 10"),
        ("newmtl m\nmap_Kd -s 1 1 1 ../a.png\n", 2, "not found"),
        ("newmtl m\nnorm -bm a.png\n", 2, "-bm holds \"a.png\", which is no number"),
        ("newmtl m\nmap_Kd -o 1 inf a.png\n", 2, "-o holds inf"),
        ("newmtl m\nmap_Kd -s 1 3e38 -o 0 3e38 a.png\n", 2, "lead out of single precision"),
        ("newmtl m\nKe 1 x\n", 2, "no number"),
    ] {
        let (scene, warnings) = with_material(text);
        assert_eq!(scene.materials[0], Material { name: "m".into(), ..Material::default() });
        let warning = warning(&warnings);
        assert!(warning.contains(&format!("a.mtl:{line}: ")) && warning.contains(why), "{warning}, wanted: {why}");
    }
    let (_, warnings) = with_material("newmtl m\nKd xyz 1 0 0\nKs spectral a.rfl\nKe 1\n");
    assert!(warnings[0].contains("a.mtl:2: Kd (Kd holds \"xyz\", which is no number; correct it) and 1 more left out"));
}

#[test]
fn a_material_may_be_named_before_its_file_is() {
    let obj = b"usemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nmtllib a.mtl\nusemtl n\nf 1 2 3\n";
    let folder = Folder::new(&[("a.obj", obj), ("a.mtl", b"newmtl m\nKd 1 0 0\nnewmtl n\nKd 0 1 0\n")]);
    let (scene, warnings) = folder.load("a.obj").unwrap();
    let colours: Vec<_> = scene.mesh.materials.iter().map(|&at| scene.materials[at as usize].diffuse).collect();
    assert_eq!((colours, warnings.len()), (vec![Vec3::X, Vec3::Y], 0));
}

#[test]
fn ambient_light_answers_to_the_diffuse_colour_whatever_ka_says() {
    let with = |ka: &str| with_material(&format!("newmtl m\n{ka}Kd 0.05 0 0\n")).0.materials[0].clone();
    assert_eq!(with("Ka 1 1 1\n"), with(""));
    assert_eq!(with("Ka 1 1 1\n").ambient(), Vec3::new(0.05, 0.0, 0.0));
}

#[test]
fn what_tr_alone_would_hide_is_opaque_with_a_warning() {
    let (scene, warnings) = with_material("newmtl m\nKd 1 0 0\nTr 1\n");
    assert_eq!((scene.materials[0].transmission, scene.materials[0].diffuse), (Vec3::ZERO, Vec3::X));
    assert!(warning(&warnings).contains("a.mtl:3: Tr 1 without d taken for opaque"), "{warnings:?}");
    let (scene, warnings) = with_material("newmtl m\nKd 1 1 1\nTr 1\nd 0.25\n");
    assert_eq!((scene.materials[0].transmission, warnings.len()), (Vec3::splat(0.75), 0));
}

#[test]
fn what_emits_shines_where_paths_are_asked_for() {
    let obj = [b"mtllib a.mtl\nusemtl m\n", TRIANGLE].concat();
    let toml = b"[render]\nintegrator = \"path\"\n[[mesh]]\nfile = \"a.obj\"\n";
    let folder = Folder::new(&[("a.obj", &obj), ("a.mtl", b"newmtl m\nKe 4 2 1\n"), ("a.toml", toml)]);
    let load = |name, integrator| {
        let loading = Loading { integrator, ..Loading::default() };
        let (scene, warnings) = crate::scene_io::load_as(&folder.path(name), loading).unwrap();
        (scene.materials[0].emission, warnings.len())
    };
    let light = Vec3::new(4.0, 2.0, 1.0);
    assert_eq!(load("a.obj", None), (Vec3::ZERO, 1));
    assert_eq!(load("a.obj", Some(Integrator::Whitted)), (Vec3::ZERO, 1));
    assert_eq!(load("a.obj", Some(Integrator::Path)), (light, 0));
    assert_eq!(load("a.toml", None), (light, 0));
    assert_eq!(load("a.toml", Some(Integrator::Whitted)), (Vec3::ZERO, 1));
}

#[test]
fn unused_pictures_and_clamped_numbers_are_warned_of_once_a_file() {
    let (scene, warnings) = with_material("newmtl m\nKd 2 -1 0.5\nKs 0.5\nNi 0\nmap_Ns a.png\nmap_Ks b c.png\n");
    assert_eq!(scene.materials[0].diffuse, Vec3::new(1.0, 0.0, 0.5));
    assert_eq!(scene.materials[0].specular, Vec3::splat(0.5));
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].contains("a.mtl:5: map_Ns and 1 more ignored"), "{warnings:?}");
    assert!(warnings[1].contains("a.mtl:2: Kd and 1 more out of range"), "{warnings:?}");
}

#[test]
fn materials_map_to_the_illumination_model() {
    let material = |text: &str| with_material(&format!("newmtl m\n{text}")).0.materials[0].clone();
    let matt = material("Kd 0.5 0 0\nKs 1 1 1\nillum 1\n");
    assert_eq!(matt.ambient(), matt.diffuse);
    assert_eq!((matt.specular, matt.transmission), (Vec3::ZERO, Vec3::ZERO));
    let mirror = material("Ka 0 0 1\nKd 0.5 0 0\nKs 0.9 0.8 0.7\nNs 90\nillum 3\n");
    assert_eq!(mirror.reflection, Vec3::new(0.9, 0.8, 0.7));
    assert_eq!((mirror.ambient(), mirror.shininess), (Vec3::X * 0.5, 90.0));
    let stained = material("Kd 0.5 0.125 0\nKs 0.6 0.6 0.6\nNi 1.5\nd 0.25\nillum 7\n");
    assert_eq!(stained.transmission, Vec3::new(0.75, 0.1875, 0.0));
    assert_eq!(stained.diffuse, Vec3::new(0.125, 0.03125, 0.0));
    assert_eq!((stained.ior, stained.reflection), (1.5, Vec3::ZERO));
    let clear = material("Kd 0 0 0\nillum 7\n");
    assert_eq!((clear.transmission, clear.ior), (Vec3::ONE, 1.5));
    let filtered = material("Kd 1 1 1\nTf 0 1 0\nTr 0.5\n");
    assert_eq!((filtered.transmission, filtered.ior), (Vec3::Y * 0.5, 1.0));
    // Some exporters write this of everything.
    let opaque = material("Kd 1 1 1\nillum 4\nd 1\nTf 1 1 1\nNi 1\n");
    assert_eq!((opaque.transmission, opaque.diffuse), (Vec3::ZERO, Vec3::ONE));
    assert_eq!(material("illum 4\nNi 1.3\n").ior, 1.3);
}
