//! Wavefront meshes.

use std::path::Path;

use glam::Vec3;

use super::{Folder, TRIANGLE, assert_refused, budget, said, warning};
use crate::scene::Mesh;
use crate::scene_io::obj;

fn mesh(text: &str) -> Mesh {
    obj::parse(Path::new("a.obj"), text.as_bytes(), budget(1 << 20)).unwrap().mesh
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
    ("v 0 0 0\nf 1/1/1/1 1 1\n", 2, ""),
    ("v 0 0 0\nvn 0 0 1\nf //1 1 1\n", 3, "none of v, v/vt"),
    ("v 0 0 0\nf 1 1\n", 2, "at least 3 corners"),
    ("v 0 0 0\nf 1 1 \\\n1.5\n", 2, "no whole number"),
];

#[test]
fn what_makes_no_sense_is_told_where_it_stands_if_no_face_is_left() {
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
    let error = crate::scene_io::load(Path::new("/dev/zero")).unwrap_err();
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
fn a_link_out_of_the_folder_is_not_followed() {
    let outside = Folder::new(&[("a.mtl", b"newmtl m\n")]);
    let folder = Folder::new(&[("a.obj", &[b"mtllib a.mtl\n", TRIANGLE].concat())]);
    std::os::unix::fs::symlink(outside.path("a.mtl"), folder.path("a.mtl")).unwrap();
    let (scene, warnings) = folder.load("a.obj").unwrap();
    assert_eq!(scene.files, [] as [std::path::PathBuf; 0]);
    assert!(warnings[0].contains("a.obj:1: material file \"a.mtl\" not found"), "{warnings:?}");
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
    assert_eq!(parse(1500).unwrap().mesh.triangles.len(), 4);
    let why = "4 triangles with 3 vertices take about 0 MB of memory, and the test leaves 0 MB; use fewer";
    assert_refused(&parse(1400).unwrap_err(), "a.obj", Some(5), why);
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
fn normals_and_texture_vertices_of_which_there_are_none_are_left_out_with_one_warning() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/2/-1 3/3/3\n";
    let obj = obj::parse(Path::new("a.obj"), text.as_bytes(), budget(1 << 20)).unwrap();
    assert_eq!(obj.mesh.triangles.len(), 1);
    assert!(obj.mesh.normals.is_empty());
    assert_eq!(
        said(&obj.warnings),
        ["a.obj:4: texture vertex 1 and 5 more ignored: none of this number precedes the face"]
    );
}

#[test]
fn a_statement_of_a_mesh_that_makes_no_sense_is_left_out_with_one_warning() {
    for (bad, why) in [
        ("f 1 2", "a.obj:5: f (a face has at least 3 corners, not 2; remove it) left out"),
        ("f 0 1 2\nf 1 2 9", "a.obj:5: f (vertex 0 does not exist; indices count from 1) and 1 more left out"),
        ("f 1/x 2 3", "a.obj:5: f (texture vertex \"x\" is no whole number; correct the face) left out"),
        ("vt nan 0", "a.obj:5: vt (vt holds nan"),
        ("vn 0 x 0\nvn 1", "a.obj:5: vn (vn holds \"x\", which is no number; correct it) and 1 more left out"),
        ("v 1 x 0\nv 5 5 5", "a.obj:5: v (v holds \"x\""),
    ] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n{bad}\nf 1 2 3\nf 2 3 -1\n");
        let obj = obj::parse(Path::new("a.obj"), text.as_bytes(), budget(1 << 20)).unwrap();
        assert_eq!(obj.mesh.triangles.len(), 2, "{bad}");
        let last = obj.mesh.triangles[1].map(|corner| obj.mesh.positions[corner as usize]);
        assert_eq!(last[2], if bad.starts_with("v ") { Vec3::splat(5.0) } else { Vec3::new(1.0, 1.0, 0.0) });
        assert!(warning(&said(&obj.warnings)).starts_with(why), "{:?}, wanted: {why}", obj.warnings);
    }
}

#[test]
fn a_face_of_a_vertex_that_makes_no_sense_is_left_out() {
    let text = "v 0 0 0\nv 1 0 nan\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 1 3 4\nf 1 2 3 4\n";
    let obj = obj::parse(Path::new("a.obj"), text.as_bytes(), budget(1 << 20)).unwrap();
    assert_eq!(obj.mesh.positions, [Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)]);
    assert_eq!(obj.warnings.len(), 2, "{:?}", obj.warnings);
    assert_eq!(said(&obj.warnings)[1], "a.obj:5: face and 1 more left out: a vertex of it makes no sense");
}

#[test]
fn corners_without_the_normal_that_they_name_are_flat() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//0 2//0 3//0\nf 1//1 2//2 3//-9\n";
    let obj = obj::parse(Path::new("a.obj"), text.as_bytes(), budget(1 << 20)).unwrap();
    let normals = |triangle: usize| obj.mesh.triangles[triangle].map(|corner| obj.mesh.normals[corner as usize]);
    assert_eq!(normals(0), [Vec3::ZERO; 3]);
    assert_eq!(normals(1), [Vec3::Z, Vec3::ZERO, Vec3::ZERO]);
    assert_eq!(said(&obj.warnings), ["a.obj:5: normal 0 and 4 more ignored: none of this number precedes the face"]);
}

/// Two triangles that share an edge, folded by a right angle.
const FOLD: &str = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\n";

#[test]
fn smoothing_groups_without_normals_are_smooth_each_by_itself() {
    let normals = |statements: &str| {
        let mesh = mesh(&format!("{FOLD}{statements}"));
        mesh.triangles.iter().map(|t| t.map(|corner| mesh.normals.get(corner as usize).copied())).collect::<Vec<_>>()
    };
    let flat = [None; 3];
    assert_eq!(normals("f 1 3 2\nf 1 2 4\n"), [flat, flat]);
    assert_eq!(normals("s off\nf 1 3 2\ns 0\nf 1 2 4\n"), [flat, flat]);
    let (z, x) = (Some(Vec3::Z), Some(Vec3::X));
    let both = Some(Vec3::new(0.5f32.sqrt(), 0.0, 0.5f32.sqrt()));
    let is_near = |a: Option<Vec3>, b: Option<Vec3>| a.unwrap().distance(b.unwrap()) < 1e-6;
    let same = |found: Vec<[Option<Vec3>; 3]>, wanted: [[Option<Vec3>; 3]; 2]| {
        found.as_flattened().iter().zip(wanted.as_flattened()).all(|(&a, &b)| is_near(a, b))
    };
    assert!(same(normals("s 1\nf 1 3 2\nf 1 2 4\n"), [[both, z, both], [both, both, x]]));
    assert!(same(normals("s 1\nf 1 3 2\ns 2\nf 1 2 4\n"), [[z; 3], [x; 3]]));
    let zero = Some(Vec3::ZERO);
    assert!(same(normals("f 1 3 2\ns 3\nf 1 2 4\n"), [[zero; 3], [x; 3]]));
    assert!(same(normals("vn 0 1 0\ns 1\nf 1//1 3//1 2//1\nf 1 2 4\n"), [[Some(Vec3::Y); 3], [both, both, x]]));
}

#[test]
fn colours_of_vertices_are_srgb_and_white_is_beneath_them() {
    let obj = b"v 0 0 0 1 0 0\nv 1 0 0 0 0.5 0\nv 0 1 0\nv 1 1 0 2\nf 1 2 3\nf 2 3 4\n";
    let folder = Folder::new(&[("a.obj", obj)]);
    let (scene, warnings) = folder.load("a.obj").unwrap();
    assert_eq!((warnings.len(), scene.materials[0].diffuse), (0, Vec3::ONE));
    let half = scene.mesh.colours[1].y;
    // ((0.5 + 0.055) / 1.055) ^ 2.4
    assert!((half - 0.214_041).abs() < 1e-6, "{half}");
    let wanted = [[1.0, 0.0, 0.0, 1.0], [0.0, half, 0.0, 1.0], [1.0; 4], [1.0; 4]].map(glam::Vec4::from);
    assert_eq!(scene.mesh.colours, wanted);
    assert!(mesh("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n").colours.is_empty(), "one more number is a weight");
}

#[test]
fn a_mesh_far_from_the_origin_is_framed_as_it_is_there() {
    let corners = [[-10.0, -10.0, -10.0], [10.0, -10.0, 10.0], [-10.0, 10.0, 10.0], [10.0, 10.0, -10.0f64]];
    let distance = |[x, y, z]: [f64; 3]| {
        let places = corners.map(|[a, b, c]| format!("v {} {} {}\n", x + a, y + b, z + c));
        let folder = Folder::new(&[("a.obj", (places.concat() + "f 1 2 3\nf 2 3 4\n").as_bytes())]);
        let camera = folder.load("a.obj").unwrap().0.cameras.remove(0);
        camera.eye.as_dvec3().distance(camera.target.as_dvec3())
    };
    let (near, far) = (distance([0.0; 3]), distance([500_000.0, 5_400_000.0, 200.0]));
    // A coordinate there is a multiple of a half.
    assert!((near - far).abs() < 1.0, "{near} {far}");
}

#[test]
fn a_compressed_file_is_told_to_be_unpacked() {
    let folder = Folder::new(&[("a.obj.gz", b"\x1f\x8b")]);
    assert_refused(&folder.refuse("a.obj.gz"), "a.obj.gz", None, "it is compressed; unpack it");
}
