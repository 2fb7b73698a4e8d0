//! Curves of a scene file and of files of strands: the same from everywhere, and refused or left out in a line.

use std::path::Path;

use glam::{Vec3, Vec4};
use proptest::prelude::*;

use super::{Folder, assert_refused, budget, said, warning};
use crate::error::Result;
use crate::scene::curves::{Basis, ControlPoint, Curves, Strand, Strands};
use crate::scene::{Mesh, Scene};
use crate::scene_io::curves::{self, Listed};
use crate::scene_io::load::{Loading, load_within, parse};

/// Two strands of which every number has few binary digits.
const STRANDS: [&[[f32; 4]]; 2] = [
    &[[0.0, 0.0, 0.0, 0.25], [0.0, 1.0, 0.0, 0.125], [0.5, 2.0, 0.0, 0.0625]],
    &[[2.0, 0.0, 1.0, 0.25], [2.0, 1.5, -1.0, 0.25]],
];

fn as_list() -> String {
    format!("strands = {STRANDS:?}")
}

fn as_text() -> String {
    let strand = |points: &&[[f32; 4]]| {
        let line = |[x, y, z, radius]: &[f32; 4]| format!("{x} {y} {z} {radius}\n");
        points.iter().map(line).collect::<String>()
    };
    STRANDS.iter().map(strand).collect::<Vec<_>>().join("\n")
}

/// What a `.hair` file says beside its points.
#[derive(Default)]
struct Hair {
    flags: u32,
    default_segments: u32,
    thickness: f32,
    transparency: f32,
    colour: [f32; 3],
}

impl Hair {
    /// The bytes of a file with the arrays that its flags name; strands are as long as they are, and without an array of that as it says.
    fn bytes(&self, strands: &[&[[f32; 4]]]) -> Vec<u8> {
        let points: Vec<[f32; 4]> = strands.concat();
        let mut bytes = b"HAIR".to_vec();
        let counts = [strands.len() as u32, points.len() as u32, self.flags, self.default_segments];
        bytes.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
        let defaults = [[self.thickness, self.transparency].as_slice(), &self.colour].concat();
        bytes.extend(defaults.iter().flat_map(|number| number.to_le_bytes()));
        bytes.resize(128, b' ');
        let has = |bit: u32| self.flags & bit != 0;
        if has(1) {
            bytes.extend(strands.iter().flat_map(|strand| (strand.len() as u16 - 1).to_le_bytes()));
        }
        let mut floats = |own: bool, of: &dyn Fn(&[f32; 4]) -> Vec<f32>| {
            if own {
                bytes.extend(points.iter().flat_map(of).flat_map(f32::to_le_bytes));
            }
        };
        floats(has(2), &|point| point[..3].to_vec());
        floats(has(4), &|point| vec![2.0 * point[3]]);
        floats(has(8), &|point| vec![point[3]]);
        floats(has(16), &|point| vec![1.0, point[3], 0.0]);
        bytes
    }
}

fn as_hair() -> Vec<u8> {
    Hair { flags: 7, colour: [1.0; 3], ..Hair::default() }.bytes(&STRANDS)
}

fn read(name: &str, bytes: &[u8]) -> Result<Listed> {
    curves::parse(Path::new(name), bytes, None, budget(1 << 24))
}

fn folder(mesh: &str) -> Folder {
    let text = format!("[[mesh]]\n{mesh}\n");
    Folder::new(&[("scene.toml", text.as_bytes()), ("a.txt", as_text().as_bytes()), ("a.hair", &as_hair())])
}

fn load(mesh: &str) -> Scene {
    let (scene, warnings) = folder(mesh).load("scene.toml").unwrap_or_else(|error| panic!("{mesh}: {error}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    scene.check().unwrap();
    scene
}

#[test]
fn the_scene_file_and_both_kinds_of_files_make_the_same_mesh() {
    for keys in ["", "basis = \"linear\"", "kind = \"ribbon\"\nup = [0, 0, 1]", "tolerance = 0.001\nsides = 5"] {
        let here = load(&format!("shape = \"curves\"\n{}\n{keys}", as_list()));
        assert!(!here.mesh.triangles.is_empty());
        for file in ["a.txt", "a.hair"] {
            assert!(load(&format!("file = \"{file}\"\n{keys}")).mesh == here.mesh, "{file} {keys}");
        }
        assert!(here.mesh.tangents.is_empty() && here.mesh.coordinates[0].is_empty());
        assert_eq!(here.objects[0].name, "curves");
    }
}

#[test]
fn a_radius_is_for_points_without_one_and_for_all_of_a_hair_file() {
    let reach = |keys: &str| load(keys).mesh.bounds()[0].x;
    let points = "shape = \"curves\"\nbasis = \"linear\"\nsides = 4\n";
    assert_eq!(reach(&format!("{points}strands = [[[0, 0, 0], [0, 1, 0]]]\nradius = 0.5")), -0.5);
    let tips = load(&format!("{points}strands = [[[0, 0, 0], [0, 1, 0, 0]]]\nradius = 0.5"));
    assert_eq!(tips.mesh.triangles.len(), 4 + 2);
    assert!((reach("file = \"a.hair\"\nsides = 4\nradius = 3") + 3.0).abs() < 0.2);
    assert!((reach("file = \"a.txt\"\nsides = 4\nradius = 3") + 0.25).abs() < 0.1);
}

#[test]
fn curves_move_stand_in_many_places_and_have_what_their_material_asks_for() {
    let line = "shape = \"curves\"\nbasis = \"linear\"\nstrands = [[[0, 0, 0, 0.5], [0, 4, 0, 0.5]]]\nmaterial = \"m\"";
    let scene = load(&format!(
        "{line}\nplace = [{{}}, {{ translate = [9, 0, 0] }}]\n[[material]]\nname = \"m\"\nanisotropy = 0.5"
    ));
    let alone = load(&format!("{line}\nscale = [1, 2, 1]\nsmooth = false\n[[material]]\nname = \"m\""));
    assert_eq!(scene.mesh.triangles.len(), 2 * alone.mesh.triangles.len());
    assert!(alone.mesh.normals.is_empty() && alone.mesh.tangents.is_empty());
    assert_eq!(alone.mesh.bounds()[1].y, 8.0);
    let along = |(normal, tangent): &(&Vec3, &Vec4)| normal.y == 0.0 && tangent.abs_diff_eq(Vec3::Y.extend(1.0), 1e-6);
    assert_eq!(scene.mesh.normals.iter().zip(&scene.mesh.tangents).filter(along).count(), 2 * 2 * 8);
    let mut picture = std::io::Cursor::new(Vec::new());
    image::DynamicImage::new_rgb8(2, 2).write_to(&mut picture, image::ImageFormat::Png).unwrap();
    let text = format!("[[mesh]]\n{line}\n[[material]]\nname = \"m\"\nbase_texture = \"p.png\"");
    let folder = Folder::new(&[("a.toml", text.as_bytes()), ("p.png", picture.get_ref())]);
    let (scene, _) = folder.load("a.toml").unwrap();
    let along = scene.mesh.positions.iter().zip(&scene.mesh.coordinates[0]);
    assert!(along.clone().count() > 0 && along.into_iter().all(|(place, own)| (own.x - place.y / 4.0).abs() < 1e-6));
}

#[test]
fn a_hair_file_has_defaults_and_colours() {
    let defaults = Hair { flags: 2, default_segments: 1, thickness: 0.5, transparency: 0.25, colour: [0.5, 1.0, 2.0] };
    let two: [&[[f32; 4]]; 2] = [&STRANDS[0][..2], STRANDS[1]];
    let listed = read("a.hair", &defaults.bytes(&two)).unwrap();
    let strands: Vec<Strand> = listed.strands.iter().collect();
    assert_eq!((strands.len(), listed.places), (2, vec![1, 2]));
    assert_eq!(strands[1].points[0], ControlPoint { position: Vec3::new(2.0, 0.0, 1.0), radius: 0.25 });
    assert_eq!(strands[1].colours, [Vec4::new(0.5, 1.0, 1.0, 0.75); 2]);
    let own = Hair { flags: 31, ..Hair::default() }.bytes(&STRANDS);
    let listed = read("a.hair", &own).unwrap();
    assert_eq!(listed.strands.iter().next().unwrap().colours[1], Vec4::new(1.0, 0.125, 0.0, 0.875));
    let folder = Folder::new(&[("a.toml", b"[[mesh]]\nfile = \"a.HAIR\"\n"), ("a.HAIR", &own)]);
    let (scene, warnings) = folder.load("a.toml").unwrap();
    assert_eq!((scene.materials[0].diffuse, warnings.len()), (Vec3::ONE, 0));
    assert!(scene.mesh.colours.len() == scene.mesh.positions.len());
    scene.check().unwrap();
}

#[test]
fn strands_that_make_no_sense_are_left_out_with_a_warning() {
    let text = "# roots\n0 0 0 1\n0 1 0 1\n\n5 5 5 1\n\n\n1 0 0 1\n1 one 0 1\n1 2 0 nan\n\n2 0 0 -1\n2 1 0 1\n\n0 0 0 1\n1 1 1 1 1\n";
    let scene = "[[mesh]]\nfile = \"a.txt\"\nbasis = \"linear\"\nsides = 4\n";
    let (scene, warnings) =
        Folder::new(&[("s.toml", scene.as_bytes()), ("a.txt", text.as_bytes())]).load("s.toml").unwrap();
    assert_eq!(scene.mesh.triangles.len(), 8 + 4);
    let [lines, counts] = &warnings[..] else { panic!("{warnings:?}") };
    let wanted = "a.txt:9: strand (a control point holds \"one\", which is no number; correct it) and 2 more left out";
    assert!(lines.ends_with(wanted), "{lines}");
    assert!(counts.contains("a.txt:5: strand (it has 1 points, and linear wants at least 2 points"), "{counts}");
    let odd: [&[[f32; 4]]; 4] =
        [STRANDS[0], &[[0.0, f32::NAN, 0.0, 1.0], [1.0; 4]], &[[1.0; 4], [2.0, 2.0, 2.0, -2.0]], STRANDS[1]];
    let hair = Hair { flags: 7, colour: [1.0; 3], ..Hair::default() }.bytes(&odd);
    let folder = Folder::new(&[("s.toml", b"[[mesh]]\nfile = \"a.hair\"\n"), ("a.hair", &hair)]);
    let (scene, warnings) = folder.load("s.toml").unwrap();
    assert!(scene.mesh == load("file = \"a.hair\"").mesh);
    let wanted = "a.hair: strand number 2 (it has at its point number 1 the position [0, NaN, 0]";
    assert!(warning(&warnings).contains(wanted) && warnings[0].contains("and 1 more left out"), "{warnings:?}");
}

#[test]
fn files_that_make_no_sense_are_refused_in_a_line() {
    let cut = |count: usize| as_hair()[..count].to_vec();
    let with = |at: usize, value: u32| {
        let mut bytes = as_hair();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    let hairs: [(Vec<u8>, &str); 8] = [
        (b"OBJ of another kind".to_vec(), "does not begin with \"HAIR\""),
        (cut(4), "is it whole?"),
        (cut(127), "is it whole?"),
        (cut(as_hair().len() - 1), "is it whole?"),
        (with(4, u32::MAX), "is it whole?"),
        (with(8, u32::MAX), "is it whole?"),
        (with(12, 2), "strands have 2 points by their segments, but it says 5"),
        (with(12, 0), "there is no strand in it"),
    ];
    for (bytes, wanted) in hairs {
        let scene = b"[[mesh]]\nfile = \"a.hair\"\n";
        assert_refused(&Folder::new(&[("s.toml", scene), ("a.hair", &bytes)]).refuse("s.toml"), "a.hair", None, wanted);
    }
    for (text, line, wanted) in [
        ("\n\n# nothing\n", None, "there is no strand in it; write a control point a line"),
        ("0 0 0 1\n0 0 one 1\n", Some(2), "no strand is left"),
        ("0 0 0\n0 0 1\n", Some(1), "the control point has no radius"),
        ("\n0 0 0 1\n", Some(2), "has 1 points, and catmull-rom wants at least 2 points"),
        ("7 7 7 1\n7 7 7 1\n", Some(1), "all of its points at one place"),
    ] {
        let scene = b"[[mesh]]\nfile = \"a.txt\"\n";
        let folder = Folder::new(&[("s.toml", scene), ("a.txt", text.as_bytes())]);
        assert_refused(&folder.refuse("s.toml"), "a.txt", line, wanted);
    }
    let empty = Folder::new(&[("s.toml", b"[[mesh]]\nfile = \"a.txt\"\n"), ("a.txt", b"")]);
    assert_refused(&empty.refuse("s.toml"), "s.toml", Some(2), "the file is empty");
}

#[test]
fn tables_that_make_no_sense_are_refused_by_their_lines() {
    for (keys, line, wanted) in [
        ("strands = []", 3, "there is no strand"),
        ("strands = [[[0, 0, 0, 1]]]", 3, "has 1 points, and catmull-rom wants at least 2"),
        ("strands = [\n[[0, 0, 0, 1], [0, 1, 0, 1]],\n[[0, 0, 0, 1]]]", 5, "has 1 points"),
        ("strands = [[[0, 0, 0, 1],\n[0, 1]]]", 4, "[x, y, z, radius], not 2 numbers"),
        ("strands = [[[0, 0, 0, 1],\n[0, 1, 0, -1]]]", 4, "at least 0"),
        ("strands = [[[0, 0, 0],\n[0, 1, 0]]]", 3, "no radius; add a fourth number"),
        ("strands = [[0, 0, 0]]", 3, "must be a list of strands"),
        ("radius = 1", 1, "curves needs \"strands\""),
        ("strand = [[[0, 0, 0, 1], [0, 1, 0, 1]]]", 3, "did you mean \"strands\""),
        ("basis = \"bspline\"", 3, "did you mean \"b-spline\""),
        ("kind = \"ribbon\"\nsides = 4", 4, "a ribbon has no sides"),
        ("up = [0, 1, 0]", 3, "a tube faces all sides"),
        ("kind = \"ribbon\"\nup = [0, 0, 0]", 4, "up is zero"),
        ("sides = 2", 3, "between 3 and 256"),
        ("tolerance = 0", 3, "greater than 0"),
        (
            "kind = \"ribbon\"\nstrands = [[[0, 0, 0, 1], [0, 1, 0, 1]]]\nnormals = [[[0, 0, 1]]]",
            4,
            "2 points and 1 normals",
        ),
        (
            "kind = \"ribbon\"\nstrands = [[[0, 0, 0, 1], [0, 1, 0, 1]]]\nnormals = [[], []]",
            5,
            "1 strands and normals of 2",
        ),
        ("file = \"a.txt\"\nbasis = \"linear\"", 2, "a file or a shape"),
    ] {
        let folder = folder(&format!("shape = \"curves\"\n{keys}"));
        assert_refused(&folder.refuse("scene.toml"), "scene.toml", Some(line), wanted);
    }
    let error = folder("file = \"a.hair\"\nstrands = []").refuse("scene.toml");
    assert_refused(&error, "scene.toml", Some(3), "unknown key \"strands\" in a file of curves");
}

#[test]
fn what_there_is_no_memory_for_is_refused_before_it_is_made() {
    let within = |text: &str, bytes: u64| {
        let folder = folder(text);
        let error = load_within(&folder.path("scene.toml"), budget(bytes), Loading::default()).map(drop).unwrap_err();
        error.to_string()
    };
    // A thousand times as many triangles as there is memory for.
    for keys in ["tolerance = 1e-6\nsides = 256", "tolerance = 1e-9\nkind = \"ribbon\""] {
        let error = within(&format!("shape = \"curves\"\n{}\n{keys}", as_list()), 1 << 20);
        assert!(error.contains("take about 1 MB of memory, and the test leaves 1 MB; use fewer strands"), "{error}");
    }
    assert!(within("file = \"a.hair\"", 100).contains("a.hair: its 5 control points take about 0 MB of memory"));
    assert!(within("file = \"a.txt\"", 100).contains("a.txt:2: its 2 control points take about 0 MB of memory"));
}

/// The strands of numbers of a text.
fn strands(all: &[Vec<[f32; 4]>]) -> Strands {
    let mut strands = Strands::default();
    for strand in all {
        let point = |&[x, y, z, radius]: &[f32; 4]| ControlPoint { position: Vec3::new(x, y, z), radius };
        let points: Vec<_> = strand.iter().map(point).collect();
        strands.push(Strand { points: &points, ups: &[], colours: &[] });
    }
    strands
}

/// What is drawn of it, if anything is.
fn drawn(listed: &Listed, basis: Basis) -> Option<Mesh> {
    let (strands, _) = listed.sound(Path::new("a"), basis).ok()?;
    let curves = Curves { basis, ..Curves::default() };
    let budget = budget(1 << 24);
    curves.count(&strands, |triangles, vertices| budget.check(triangles, vertices)).ok()?;
    Some(curves.mesh(&strands))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn a_text_of_strands_holds_the_numbers_that_were_written(
        all in prop::collection::vec(prop::collection::vec(prop::array::uniform4(0f32..1e30), 1..6), 1..6), ends in "\n|\r\n",
    ) {
        let line = |[x, y, z, radius]: &[f32; 4]| format!("{x} {y:e} -{z} {radius}{ends}");
        let text: Vec<String> = all.iter().map(|strand| strand.iter().map(line).collect()).collect();
        let listed = read("a.txt", text.join(&*ends).as_bytes()).unwrap();
        let all: Vec<Vec<[f32; 4]>> =
            all.iter().map(|strand| strand.iter().map(|&[x, y, z, radius]| [x, y, -z, radius]).collect()).collect();
        prop_assert_eq!(listed.strands, strands(&all));
        prop_assert!(listed.warning.is_none());
    }

    #[test]
    fn a_hair_file_that_is_cut_or_changed_is_refused_or_drawn(
        flags in 0u32..64, length in 0usize..400, changes in prop::collection::vec((0usize..400, any::<u8>()), 0..6), basis in 0usize..4,
    ) {
        let mut bytes = Hair { flags: flags | 2, default_segments: 1, thickness: 0.1, ..Hair::default() }.bytes(&STRANDS);
        for (at, byte) in changes {
            let count = bytes.len();
            bytes[at % count] = byte;
        }
        bytes.truncate(length.max(5));
        let basis = [Basis::Bezier, Basis::BSpline, Basis::CatmullRom, Basis::Linear][basis];
        match read("a.hair", &bytes) {
            Ok(listed) => {
                let Some(mesh) = drawn(&listed, basis) else { return Ok(()) };
                prop_assert!(mesh.normals.iter().all(|normal| normal.is_normalized()));
                prop_assert!(mesh.positions.iter().all(|place| !place.is_nan()));
            }
            Err(error) => prop_assert!(!error.to_string().contains('\n')),
        }
    }

    #[test]
    fn a_text_of_strands_is_refused_or_drawn(
        words in prop::collection::vec("-?[0-9]{1,3} |[0-9]\\.[0-9]e-?[0-9]{1,2} |\n|\n|\n\n|#|nan |1e39 |\u{e9} ", 0..80), basis in 0usize..4,
    ) {
        let basis = [Basis::Bezier, Basis::BSpline, Basis::CatmullRom, Basis::Linear][basis];
        match curves::parse(Path::new("a.txt"), words.concat().as_bytes(), Some(0.5), budget(1 << 24)) {
            Ok(listed) => {
                prop_assert!(said(listed.warning.as_slice()).iter().all(|warning| !warning.contains('\n')));
                let Some(mesh) = drawn(&listed, basis) else { return Ok(()) };
                prop_assert!(mesh.normals.iter().all(|normal| normal.is_normalized()));
                prop_assert!(mesh.positions.iter().all(|place| place.is_finite()));
            }
            Err(error) => prop_assert!(!error.to_string().contains('\n')),
        }
    }

    #[test]
    fn a_table_of_curves_with_changed_bytes_is_refused_in_one_line(changes in prop::collection::vec((0usize..400, any::<u8>()), 1..4)) {
        let mut text = format!("[[mesh]]\nshape = \"curves\"\nkind = \"ribbon\"\n{}\nup = [0, 1, 0]\n", as_list()).into_bytes();
        for (at, byte) in changes {
            let count = text.len();
            text[at % count] = byte;
        }
        if let Err(error) = parse(Path::new("/nowhere/a.toml"), &text, budget(1 << 24), Loading::default()) {
            prop_assert!(!error.to_string().contains('\n'));
        }
    }
}
