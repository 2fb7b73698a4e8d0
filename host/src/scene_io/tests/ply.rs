//! Meshes in the Polygon File Format: the same in all three encodings, and refused in a line.

use std::path::Path;

use glam::{Vec2, Vec3, Vec4};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::{Folder, assert_refused, budget, said};
use crate::scene_io::ply;

/// A pyramid of a square and four triangles, with a vertex that nothing uses.
const PLACES: [[f32; 3]; 6] =
    [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 0.0, 2.0], [0.0, 0.0, 2.0], [9.0, 9.0, 9.0], [1.0, 1.5, 1.0]];
const FACES: [&[i32]; 5] = [&[0, 1, 2, 3], &[0, 5, 1], &[1, 5, 2], &[2, 5, 3], &[3, 5, 0]];

fn header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nelement vertex 6\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar quality\nelement face 5\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

fn as_text() -> Vec<u8> {
    let vertex = |[x, y, z]: &[f32; 3]| format!("{x} {y} {z} 7\n");
    let face = |corners: &&[i32]| {
        let corners: Vec<String> = corners.iter().map(i32::to_string).collect();
        format!("{} {}\n", corners.len(), corners.join(" "))
    };
    let lines: Vec<String> = PLACES.iter().map(vertex).chain(FACES.iter().map(face)).collect();
    (header("ascii") + &lines.concat()).into_bytes()
}

fn as_numbers(format: &str, number: fn(f32) -> [u8; 4], corner: fn(i32) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = header(format).into_bytes();
    for place in PLACES {
        bytes.extend(place.map(number).as_flattened());
        bytes.push(7);
    }
    for face in FACES {
        bytes.push(face.len() as u8);
        face.iter().for_each(|&number| bytes.extend(corner(number)));
    }
    bytes
}

fn little() -> Vec<u8> {
    as_numbers("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes)
}

fn read(bytes: &[u8]) -> ply::Ply {
    ply::parse(Path::new("a.ply"), bytes, budget(1 << 20)).unwrap()
}

#[test]
fn all_encodings_hold_the_same_mesh_of_the_vertices_in_use() {
    let mesh = read(&as_text()).mesh;
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| mesh.positions[vertex as usize]);
    let place = |number: usize| Vec3::from(PLACES[number]);
    assert_eq!(mesh.positions.len(), 5);
    assert_eq!(corners(&mesh.triangles[0]), [0, 1, 2].map(place));
    assert_eq!(corners(&mesh.triangles[1]), [0, 2, 3].map(place));
    assert_eq!(corners(&mesh.triangles[5]), [3, 5, 0].map(place));
    assert!(mesh.normals.is_empty() && mesh.materials == [0; 6]);
    assert_eq!(read(&little()).mesh, mesh);
    assert_eq!(read(&as_numbers("binary_big_endian", f32::to_be_bytes, i32::to_be_bytes)).mesh, mesh);
}

#[test]
fn strips_turn_and_end_and_normals_have_unit_length() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n\
                property float nx\nproperty float ny\nproperty float nz\nelement tristrips 1\n\
                property list int int vertex_indices\nelement edge 1\nproperty int vertex1\nend_header\n\
                0 0 0 0 0 2\n1 0 0 0 0 2\n0 1 0 0 0 2\n1 1 0 0 0 2\n8 0 1 2 3 -1 3 2 1\n0\n";
    let ply = read(text.as_bytes());
    assert_eq!(ply.mesh.triangles, [[0, 1, 2], [2, 1, 3], [3, 2, 1]]);
    assert_eq!(ply.mesh.normals, [Vec3::Z; 4]);
    assert_eq!(said(&ply.warnings), ["a.ply: the element \"edge\" is ignored: only polygons are read"]);
}

/// A triangle whose vertices have more properties than places.
fn with(properties: &str, vertices: [&str; 3]) -> ply::Ply {
    let vertex = |rest: &str| format!("0 1 2 {rest}\n");
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{properties}\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n{}3 0 1 2\n",
        vertices.map(vertex).concat()
    );
    read(text.as_bytes())
}

#[test]
fn coordinates_run_down_by_any_of_their_names() {
    for [u, v] in [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]] {
        let mesh = with(&format!("property float {u}\nproperty float {v}\n"), ["0 0", "0.5 1", "2 -1"]).mesh;
        let wanted = [[0.0, 1.0], [0.5, 0.0], [2.0, 2.0]].map(Vec2::from);
        assert_eq!(mesh.coordinates, [wanted.to_vec(), Vec::new()]);
    }
    assert_eq!(with("property float u\n", ["0", "1", "2"]).mesh.coordinates[0], []);
}

#[test]
fn colours_are_srgb_in_bytes_and_linear_in_floats() {
    let colours = |kind: &str, more: &str| {
        ["red", "green", "blue"].map(|name| format!("property {kind} {name}\n")).concat() + more
    };
    let bytes = with(&colours("uchar", "property uchar alpha\n"), ["255 0 0 255", "128 128 128 51", "0 0 255 0"]);
    let grey = 0.215_860_5;
    let wanted = [[1.0, 0.0, 0.0, 1.0], [grey, grey, grey, 0.2], [0.0, 0.0, 1.0, 0.0]].map(Vec4::from);
    assert_eq!((bytes.mesh.colours, bytes.warnings.len()), (wanted.to_vec(), 0));
    let floats = with(&colours("float", ""), ["0.25 0.5 1", "-1 2 0", "1 1 1"]).mesh;
    let wanted = [[0.25, 0.5, 1.0, 1.0], [0.0, 1.0, 0.0, 1.0], [1.0; 4]].map(Vec4::from);
    assert_eq!(floats.colours, wanted);
    let foreign = with(&colours("int", ""), ["255 0 0", "0 0 0", "0 0 0"]);
    assert_eq!(foreign.mesh.colours, []);
    assert!(foreign.warnings[0].message.contains("colours are ignored: make them uchar"), "{:?}", foreign.warnings);
}

#[test]
fn beneath_colours_a_mesh_is_white() {
    let text = String::from_utf8(as_text()).unwrap();
    let vertex = "property uchar quality\n";
    let more = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let text = text.replace(vertex, more).replace(" 7\n", " 7 8 9\n");
    let folder = Folder::new(&[("a.ply", text.as_bytes())]);
    let (scene, warnings) = folder.load("a.ply").unwrap();
    assert_eq!((scene.materials[0].diffuse, scene.mesh.colours.len(), warnings.len()), (Vec3::ONE, 5, 0));
}

#[test]
fn it_is_a_scene_and_a_mesh_of_a_scene() {
    let toml = b"[[mesh]]\nfile = \"a.ply\"\nmaterial = \"red\"\n[[material]]\nname = \"red\"\ndiffuse = [1, 0, 0]\n";
    let folder = Folder::new(&[("a.ply", &little()), ("scene.toml", toml)]);
    let (bare, _) = folder.load("a.ply").unwrap();
    assert_eq!((bare.mesh.triangles.len(), bare.cameras.len(), bare.lights.len()), (6, 1, 2));
    let (scene, _) = folder.load("scene.toml").unwrap();
    assert_eq!((scene.mesh.triangles.len(), scene.materials[0].diffuse), (6, Vec3::X));
    assert_eq!(scene.files, [folder.path("a.ply")]);
}

#[test]
fn what_makes_no_sense_is_refused_in_a_line() {
    let spoiled = |from: &str, to: &str| String::from_utf8(as_text()).unwrap().replace(from, to).into_bytes();
    let covered = String::from_utf8(spoiled("uchar quality", "float s\nproperty float t")).unwrap();
    let mut nowhere = little();
    let height = header("binary_little_endian").len() + 5 * 13 + 4;
    nowhere[height..height + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    for (bytes, why) in [
        (b"ply\n".to_vec(), "ends within its header; write it again"),
        (b"solid thing\n".to_vec(), "is no PLY file: its first line is not \"ply\""),
        (spoiled("property float y", "propperty float y"), "have no numbers x, y and z"),
        (spoiled("property float y", "property float x"), "a second property \"x\"; remove one"),
        (spoiled("element face 5", "element vertex 5"), "a second element \"vertex\"; remove one"),
        (spoiled("format ascii 1.0\n", ""), "its header has no line \"format ascii 1.0\""),
        (
            spoiled(
                "element face",
                &((0..70).map(|i| format!("element e{i} 0\n")).collect::<String>() + "element face"),
            ),
            "there are more than 64 elements; remove some",
        ),
        (spoiled("made by hand", &"x".repeat(1 << 20)), "its header has more than 1048576 bytes"),
        (nowhere, "vertex 5, counted from 0, is at [1.0, NaN, 1.0]"),
        (spoiled("1 1.5 1 7", "1 1.5 x 7"), "is not the x y z quality of a vertex; correct the line"),
        (spoiled("element vertex 6", "element vertex 1000000000"), "take about"),
        (spoiled("element face 5", "element face 0").split_at(230).0.to_vec(), "ends within vertex 4 of 6"),
        (spoiled("element face 5", "element tristrips 1000000000"), "1000000000 triangles with 6 vertices"),
        (spoiled("float z", "float w"), "have no numbers x, y and z"),
        (spoiled("float z", "list uchar float z"), "have no numbers x, y and z"),
        (spoiled("list uchar int vertex", "list uchar float vertex"), "have no list vertex_indices of whole numbers"),
        (spoiled("list uchar int vertex", "int vertex"), "have no list vertex_indices of whole numbers"),
        (covered.replace(" 7\n", " 0 1e39\n").into_bytes(), "vertex 0, counted from 0, has the texture coordinates"),
        (spoiled("vertex_indices", "corners"), "have no list vertex_indices"),
        (spoiled("float x", "int8 x"), ""),
        (little()[..little().len() - 3].to_vec(), "ends within face 4 of 5, counted from 0"),
    ] {
        match ply::parse(Path::new("a.ply"), &bytes[..], budget(1 << 20)) {
            Ok(ply) => assert!(why.is_empty(), "{ply:?}"),
            Err(error) => {
                assert!(!error.to_string().contains('\n'), "{error}");
                assert!(error.message().contains(why), "{error}, wanted: {why}");
            }
        }
    }
    let none = [header("ascii").replace("face 5", "face 0").into_bytes(), b"0 0 0 1\n".repeat(6)].concat();
    let error = ply::parse(Path::new("a.ply"), &none[..], budget(1 << 20)).unwrap_err();
    assert_refused(&error, "a.ply", None, "a point cloud: 6 vertices and no faces; make a mesh of it");
    let bad = String::from_utf8(as_text()).unwrap().replace(" 5", " 9").replace("4 0 1 2 3", "2 0 1");
    let error =
        ply::parse(Path::new("a.ply"), bad.replace("element face 9", "element face 5").as_bytes(), budget(1 << 20));
    assert_refused(
        &error.unwrap_err(),
        "a.ply",
        None,
        "face 0 has 2 corners, and a face has at least 3, and no face is left",
    );
}

#[test]
fn faces_that_make_no_sense_are_left_out_with_one_warning() {
    for (face, why) in [
        ("4 0 1 2 9", "face 0 names vertex 9, but 6 precede it, counted from 0; correct it: left out"),
        ("4 0 1 2 -3", "face 0 names vertex -3"),
        ("2 0 1", "face 0 has 2 corners, and a face has at least 3: left out"),
    ] {
        let ply = read(String::from_utf8(as_text()).unwrap().replace("4 0 1 2 3", face).as_bytes());
        assert_eq!((ply.mesh.triangles.len(), ply.warnings.len()), (4, 1));
        assert!(ply.warnings[0].to_string().starts_with(&format!("a.ply: {why}")), "{:?}", ply.warnings);
    }
    let more = String::from_utf8(as_text()).unwrap().replace("4 0 1 2 3", "0").replace("3 0 5 1", "1 0");
    assert!(
        read(more.as_bytes()).warnings[0]
            .message
            .ends_with("face 0 has 0 corners, and a face has at least 3 and 1 more: left out")
    );
}

#[test]
fn vertices_may_follow_their_faces_and_lines_may_hold_several() {
    let text = String::from_utf8(as_text()).unwrap();
    let mesh = read(text.as_bytes()).mesh;
    let (head, body) = text.split_once("end_header\n").unwrap();
    let (head, face) = head.split_at(head.find("element face").unwrap());
    let (top, vertex) = head.split_at(head.find("element vertex").unwrap());
    let (vertices, faces) = body.split_at(body.find("4 0 1").unwrap());
    let turned = format!("{top}{face}{vertex}end_header\n{faces}{vertices}");
    assert_eq!(read(turned.as_bytes()).mesh, mesh);
    let wrapped = format!("{head}{face}end_header\n{}\n{faces}", vertices.replace("7\n0 0 2", "7 0 0 2").trim_end());
    let wrapped = wrapped.replace("0 0 0 7\n", "0 0 0\n7\n").replace("2 0 0 7\n2 0", "2 0 0 7 2 0");
    assert_ne!(wrapped, text);
    assert_eq!(read(wrapped.as_bytes()).mesh, mesh);
}

#[test]
fn a_line_of_a_header_without_a_keyword_is_ignored_with_a_warning() {
    let text = String::from_utf8(as_text()).unwrap().replace("comment made", "made");
    let ply = read(text.as_bytes());
    assert_eq!(ply.mesh, read(&as_text()).mesh);
    assert_eq!(
        said(&ply.warnings),
        ["a.ply: line 3 of its header, \"made by hand\", is ignored: it begins with no keyword"]
    );
}

#[test]
fn faces_have_colours_where_vertices_have_none() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n\
                property uchar blue\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n";
    let mesh = read(text.as_bytes()).mesh;
    let colours = |triangle: usize| mesh.triangles[triangle].map(|corner| mesh.colours[corner as usize]);
    assert_eq!(colours(0), [Vec4::new(1.0, 0.0, 0.0, 1.0); 3]);
    assert_eq!(colours(1), [Vec4::new(0.0, 0.0, 1.0, 1.0); 3]);
    assert_eq!(
        mesh.triangles[1].map(|corner| mesh.positions[corner as usize]),
        [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]
    );
}

#[test]
fn colours_of_sixteen_bits_are_srgb() {
    let colours = "property ushort red\nproperty ushort green\nproperty ushort blue\n";
    let mesh = with(colours, ["65535 0 0", "32896 32896 32896", "0 0 65535"]).mesh;
    let grey = mesh.colours[1].x;
    assert!((grey - 0.215_860_5).abs() < 1e-6, "{grey}");
    assert_eq!((mesh.colours[0], mesh.colours[2]), (Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 0.0, 1.0, 1.0)));
}

/// Any number of records without properties takes no byte, and so no time.
#[test]
fn an_element_of_nothing_is_passed_over() {
    let nothing = |format| header(format).replace("element face", "element nothing 1000000000000000\nelement face");
    let numbers = little().split_off(header("binary_little_endian").len());
    let ply = read(&[nothing("binary_little_endian").into_bytes(), numbers].concat());
    assert_eq!(ply.mesh, read(&little()).mesh);
    let text = as_text().split_off(header("ascii").len());
    let text = [nothing("ascii").into_bytes(), text].concat();
    let error = ply::parse(Path::new("a.ply"), &text[..], budget(1 << 20)).unwrap_err();
    assert_refused(&error, "a.ply", None, "ends within nothing 5 of 1000000000000000");
}

#[test]
fn a_fault_of_text_is_on_its_line_and_one_of_numbers_on_none() {
    let line = |bytes: &[u8]| {
        let error = ply::parse(Path::new("a.ply"), bytes, budget(1 << 20)).unwrap_err();
        error.place().and_then(|(_, line)| line)
    };
    let text = String::from_utf8(as_text()).unwrap();
    assert_eq!(line(text.replace("1 1.5 1 7", "1 1.5 1").as_bytes()), Some(11 + 6));
    assert_eq!(line(text.replace("3 3 5 0", "3 3 5").as_bytes()), Some(11 + 6 + 5));
    assert_eq!(line(text.replace("float y", "flat y").as_bytes()), Some(6));
    assert_eq!(line(&little()[..little().len() - 3]), None);
}

#[test]
fn comments_need_not_be_utf8() {
    let mut latin = as_text();
    let at = latin.windows(4).position(|bytes| bytes == b"hand").unwrap();
    latin[at] = 0xE9;
    assert_eq!(read(&latin).mesh, read(&as_text()).mesh);
}

/// As many corners as a line of text holds, and more than can be cut in a minute.
#[test]
fn a_face_of_very_many_corners_is_refused() {
    let count = 200_000u32;
    let corners: Vec<u32> = (0..count).map(|i| i.wrapping_mul(2_654_435_761) % count).collect();
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\nproperty list uint uint vertex_indices\nend_header\n"
    )
    .into_bytes();
    let at = |i: u32| [i % 449, i / 449, 0].map(|x| (x as f32).to_le_bytes());
    (0..count).for_each(|i| bytes.extend(at(i).as_flattened()));
    bytes.extend([count].iter().chain(&corners).flat_map(|number| number.to_le_bytes()));
    let error = ply::parse(Path::new("a.ply"), &bytes[..], budget(1 << 30)).unwrap_err();
    assert_refused(&error, "a.ply", None, "its faces have too many corners to be cut into triangles");
}

#[test]
fn a_line_without_an_end_is_refused_before_all_of_it_is_read() {
    let text = [header("ascii").into_bytes(), b"1 ".repeat(8 << 20)].concat();
    let error = ply::parse(Path::new("a.ply"), &text[..], budget(1 << 30)).unwrap_err();
    assert!(error.message().contains("a line has more than 4194304 bytes"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn a_mutated_file_is_refused_in_a_line_or_whole(
        is_text in any::<bool>(), changes in prop::collection::vec((any::<u16>(), any::<u8>()), 1..6), cut in any::<u16>(),
    ) {
        let mut bytes = if is_text { as_text() } else { little() };
        let length = bytes.len();
        changes.iter().for_each(|&(at, byte)| bytes[usize::from(at) % length] = byte);
        bytes.truncate(length - usize::from(cut) % (2 * length) % length);
        match ply::parse(Path::new("a.ply"), &bytes[..], budget(1 << 20)) {
            Ok(ply) => {
                let count = ply.mesh.positions.len();
                prop_assert!(ply.mesh.triangles.as_flattened().iter().all(|&vertex| (vertex as usize) < count));
                prop_assert!(ply.mesh.positions.iter().all(|position| position.is_finite()));
            }
            Err(error) => prop_assert!(!error.to_string().contains('\n'), "{}", error),
        }
    }
}
