//! Wavefront meshes and their materials.

use std::path::Path;

use glam::Vec3;

use super::{Folder, TRIANGLE, assert_refused, budget};
use crate::scene::map::Images;
use crate::scene::{Mesh, Scene, mtl, obj};

fn mesh(text: &str) -> Mesh {
    obj::parse(Path::new("a.obj"), text.as_bytes(), budget(1 << 20)).unwrap().mesh
}

fn with_material(mtl: &str) -> (Scene, Vec<String>) {
    let obj = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let folder = Folder::new(&[("a.obj", obj), ("a.mtl", mtl.as_bytes())]);
    folder.load("a.obj").unwrap()
}

const REFUSED: &[(&str, usize, &str)] = &[
    ("v 1 2\n", 1, "three numbers"),
    ("v 1 2 x\n", 1, "no number"),
    ("v 1,0 2,0 3,0\n", 1, "no number"),
    ("v 1 2 nan\n", 1, "no finite number"),
    ("v 1 2 inf\n", 1, "no finite number"),
    ("# 1\n\nv 1 2 1e39\n", 3, "no finite number"),
    ("v 1 2 # 3\n", 1, "three numbers"),
    ("vt\n", 1, "two numbers"),
    ("vt 0 nan\n", 1, "no finite number"),
    ("vt x 0\n", 1, "no number"),
    ("vn 1 2\n", 1, "three numbers"),
    ("vn 1 2 x\n", 1, "no number"),
    ("v 0 0 0\nf 1 1 2\n", 2, "vertex 2 does not exist, 1 precede"),
    ("v 0 0 0\nf 1 1 0\n", 2, "count from 1"),
    ("v 0 0 0\nf 1 1 -2\n", 2, "vertex -2 does not exist"),
    ("v 0 0 0\nf 1 1 -9223372036854775808\n", 2, "does not exist"),
    ("v 0 0 0\nf 1 1 9223372036854775807\n", 2, "does not exist"),
    ("v 0 0 0\nf 1 1 9223372036854775808\n", 2, "no whole number"),
    ("v 0 0 0\nvt 0 0\nf 1/2 1/1 1/1\n", 3, "texture vertex 2 does not exist"),
    ("v 0 0 0\nvn 0 0 1\nf 1//2 1//1 1//1\n", 3, "normal 2 does not exist"),
    ("v 0 0 0\nf 1//0 1 1\n", 2, "normal 0 does not exist"),
    ("v 0 0 0\nvn 0 0 1\nf 1//0 1//1 1//1\n", 3, "normal 0"),
    ("v 0 0 0\nf 1/1/1/1 1 1\n", 2, ""),
    ("v 0 0 0\nvn 0 0 1\nf //1 1 1\n", 3, "none of v, v/vt"),
    ("v 0 0 0\nf 1 1\n", 2, "at least 3 corners"),
    ("v 0 0 0\nf 1 1 \\\n1.5\n", 2, "no whole number"),
    ("mtllib\n", 1, "names no file"),
    ("mtllib /etc/hostname\n", 1, "outside"),
    ("mtllib ../a.mtl\n", 1, "outside"),
    ("mtllib sub\\..\\..\\a.mtl\n", 1, "outside"),
    ("mtllib C:\\a.mtl\n", 1, "outside"),
];

#[test]
fn what_makes_no_sense_is_refused_where_it_stands() {
    for (text, line, why) in REFUSED {
        let folder = Folder::new(&[("a.obj", text.as_bytes())]);
        assert_refused(&folder.refuse("a.obj"), "a.obj", Some(*line), why);
    }
}

#[test]
fn what_is_no_mesh_is_refused() {
    let folder = Folder::new(&[
        ("empty.obj", b""),
        ("points.obj", b"v 0 0 0\n"),
        ("line.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n"),
        ("mesh.stl", b"ply\n"),
        ("empty.toml", b""),
    ]);
    std::fs::create_dir(folder.path("folder.obj")).unwrap();
    for (name, why) in [
        ("empty.obj", "empty"),
        ("points.obj", "no face"),
        ("line.obj", "no face"),
        ("mesh.stl", "unknown kind"),
        ("empty.toml", "empty"),
        ("folder.obj", "folder"),
        ("missing.obj", "no such file"),
    ] {
        assert_refused(&folder.refuse(name), name, None, why);
    }
}

#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_refused_without_waiting_for_it() {
    let error = crate::scene::load(Path::new("/dev/zero")).unwrap_err();
    assert_refused(&error, "zero", None, "no regular file");
    let folder = Folder::new(&[]);
    let pipe = folder.path("pipe.obj");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    assert_refused(&folder.refuse("pipe.obj"), "pipe.obj", None, "no regular file");
}

#[test]
fn a_file_beyond_the_limit_is_refused_by_its_size() {
    let folder = Folder::new(&[("big.obj", b"v")]);
    let file = std::fs::File::options().write(true).open(folder.path("big.obj"));
    file.unwrap().set_len((4 << 30) + 1).unwrap();
    assert_refused(&folder.refuse("big.obj"), "big.obj", None, "4294967297 bytes");
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_refused() {
    let outside = Folder::new(&[("a.mtl", b"newmtl m\n")]);
    let folder = Folder::new(&[("a.obj", b"mtllib a.mtl\n")]);
    std::os::unix::fs::symlink(outside.path("a.mtl"), folder.path("a.mtl")).unwrap();
    assert_refused(&folder.refuse("a.obj"), "a.obj", Some(1), "outside");
}

#[test]
fn large_finite_coordinates_are_accepted_and_framed() {
    let folder = Folder::new(&[("a.obj", b"v -1e38 0 0\nv 1e38 0 0\nv 0 1e38 1\nf 1 2 3\n")]);
    let (scene, _) = folder.load("a.obj").unwrap();
    assert_eq!(scene.mesh.positions[1].x, 1e38);
    assert!(scene.cameras[0].eye.is_finite());
    let folder = Folder::new(&[("a.obj", b"v -3e38 0 0\nv 3e38 0 0\nv 0 3e38 1\nf 1 2 3\n")]);
    assert_refused(&folder.refuse("a.obj"), "a.obj", None, "too large");
}

#[test]
fn triangles_and_vertices_beyond_the_memory_are_refused_where_they_stand() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3 1 2\n";
    let parse = |bytes| obj::parse(Path::new("a.obj"), &text[..], budget(bytes));
    assert_eq!(parse(2100).unwrap().mesh.triangles.len(), 4);
    let why = "4 triangles with 3 vertices take about 0 MB of memory, and the test leaves 0 MB; use fewer";
    assert_refused(&parse(2000).unwrap_err(), "a.obj", Some(5), why);
    assert_refused(&parse(100).unwrap_err(), "a.obj", Some(3), "0 triangles with 3 vertices");
}

#[test]
fn indices_relative_polygons_marks_and_colours_are_read() {
    let text = "\u{feff}v 0 0 0 1 0 0\r\nv 1 0 0\r\nv 1 1 0 0.5\r\nv 0 1 0 # four\r\nf -4 -3 -2 -1\r\n";
    let mesh = mesh(text);
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(mesh.normals.is_empty());
}

/// A letter U in a slanted plane, whose gap a fan would fill.
const U: &str = "v 0 0 0\nv 3 0 3\nv 3 3 3\nv 2 3 2\nv 2 1 2\nv 1 1 1\nv 1 3 1\nv 0 3 0\n";

#[test]
fn a_concave_face_leaves_its_gap_open() {
    let mesh = mesh(&format!("{U}f 1 2 3 4 5 6 7 8\n"));
    assert_eq!(mesh.triangles.len(), 6);
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| mesh.positions[vertex as usize]);
    let areas = mesh.triangles.iter().map(corners).map(|[a, b, c]| (b - a).cross(c - a).dot(Vec3::new(-1.0, 0.0, 1.0)));
    assert!(areas.clone().all(|area| area > 0.0));
    // Seen from the front the U covers 7 of 9 squares; a triangle has half of what its edges span.
    assert_eq!(areas.sum::<f32>() / 2.0, 2.0 * 7.0);
}

#[test]
fn faces_that_cross_themselves_are_left_out_with_one_warning() {
    let bow_ties = format!("{U}f 1 2 3\nf 1 3 2 8\n\nf 2 8 3 1\n");
    let folder =
        Folder::new(&[("a.obj", bow_ties.as_bytes()), ("b.obj", &bow_ties.replace("f 1 2 3\n", "").into_bytes())]);
    let (scene, warnings) = folder.load("a.obj").unwrap();
    assert_eq!(scene.mesh.triangles.len(), 1);
    let [warning] = &warnings[..] else {
        panic!("{warnings:?}");
    };
    assert!(warning.contains("a.obj:10: face and 1 more left out: the outline crosses itself"), "{warning}");
    assert_refused(&folder.refuse("b.obj"), "b.obj", Some(9), "crosses itself");
}

#[test]
fn normals_are_of_unit_length_and_flat_where_there_are_none() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 5\nvn 0 0 0\nvn nan 0 1\n\
        f 1//1 2//2 3//3\nf 3 2 1\nf 1//1 2 3//-3\n";
    let mesh = mesh(text);
    assert_eq!(mesh.normals.len(), mesh.positions.len());
    let at = |triangle: usize| mesh.triangles[triangle].map(|vertex| mesh.normals[vertex as usize]);
    assert_eq!(at(0), [Vec3::Z, Vec3::ZERO, Vec3::ZERO]);
    assert_eq!(at(1), [Vec3::ZERO; 3]);
    assert_eq!(at(2), [Vec3::Z, Vec3::ZERO, Vec3::Z]);
    let at = mesh.triangles[1].map(|vertex| mesh.positions[vertex as usize]);
    assert_eq!(at, [Vec3::Y, Vec3::X, Vec3::ZERO]);
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
fn normals_and_texture_vertices_of_which_there_are_none_are_left_out_with_one_warning() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/2/-1 3/3/3\n";
    let obj = obj::parse(Path::new("a.obj"), text.as_bytes(), budget(1 << 20)).unwrap();
    assert_eq!(obj.mesh.triangles.len(), 1);
    assert!(obj.mesh.normals.is_empty());
    assert_eq!(obj.warnings, ["a.obj:4: texture vertex 1 and 5 more ignored: none precede the face"]);
}

#[test]
fn materials_that_make_no_sense_are_refused() {
    for (text, line, why) in [
        ("Kd 1 0 0\n", 1, "before newmtl"),
        ("newmtl m\nKd 1 0\n", 2, "three numbers, not 2"),
        ("newmtl m\nKd\n", 2, "three numbers, not 0"),
        ("newmtl m\nKa 1 0 x\n", 2, "no number"),
        ("newmtl m\nKs 1 0 nan\n", 2, "no finite number"),
        ("newmtl m\nTf spectral a.rfl\n", 2, "no number"),
        ("newmtl m\nNs\n", 2, "one number"),
        ("newmtl m\nNi inf\n", 2, "no finite number"),
        ("newmtl m\nd 1 2\n", 2, "one number"),
        ("newmtl m\nTr x\n", 2, "no number"),
        ("newmtl m\nillum 11\n", 2, "0 to 10"),
        ("newmtl m\nillum\n", 2, "0 to 10"),
        ("newmtl m\nmap_Kd -s 1 1 1 ../a.png\n", 2, "outside"),
        ("newmtl m\nbump /a.png\n", 2, "outside"),
        ("map_Kd a.png\n", 1, "before newmtl"),
        ("newmtl m\nnorm -bm a.png\n", 2, "-bm holds \"a.png\", which is no number"),
        ("newmtl m\nmap_Kd -o 1 inf a.png\n", 2, "-o holds inf"),
        ("newmtl m\nmap_Kd -s 1 3e38 -o 0 3e38 a.png\n", 2, "lead out of single precision"),
        ("newmtl m\nKe 1 x\n", 2, "no number"),
    ] {
        let error = mtl::parse(Path::new("a.mtl"), text.as_bytes(), &mut Images::new(Path::new(""))).unwrap_err();
        assert_refused(&error, "a.mtl", Some(line), why);
    }
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
    assert_eq!(matt.ambient, matt.diffuse);
    assert_eq!((matt.specular, matt.transmission), (Vec3::ZERO, Vec3::ZERO));
    let mirror = material("Ka 0 0 1\nKd 0.5 0 0\nKs 0.9 0.8 0.7\nNs 90\nillum 3\n");
    assert_eq!(mirror.reflection, Vec3::new(0.9, 0.8, 0.7));
    assert_eq!((mirror.ambient, mirror.shininess), (Vec3::Z, 90.0));
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
