//! Surfaces of which meshes are the cages.

use glam::Vec3;

use super::Folder;
use crate::scene::Mesh;

/// An open thing of eight faces with three and four corners: one hangs at an edge, three meet in a point.
const CAGE: &[u8] = include_bytes!("cage.obj");
/// What Blender 5.0 (whose surfaces are OpenSubdiv's) makes of it: two levels, at their limit, corners of the boundary kept; without
/// creases, and with one at each edge of more than 70 degrees.
const SMOOTH: &str = include_str!("smooth.txt");
const CREASED: &str = include_str!("creased.txt");

fn load(table: &str, files: &[(&str, &[u8])]) -> Mesh {
    let text = format!("[[mesh]]\n{table}\n");
    let folder = Folder::new(&[&[("scene.toml", text.as_bytes())], files].concat());
    let (scene, warnings) = folder.load("scene.toml").unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    scene.mesh
}

fn places(text: &str) -> Vec<Vec3> {
    let place = |line: &str| {
        let numbers: Vec<f32> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        Vec3::from_slice(&numbers)
    };
    text.lines().map(place).collect()
}

/// Each once, though vertices have several normals.
fn distinct(mesh: &Mesh) -> Vec<Vec3> {
    let mut bits: Vec<[u32; 3]> = mesh.positions.iter().map(|at| at.to_array().map(f32::to_bits)).collect();
    bits.sort_unstable();
    bits.dedup();
    bits.into_iter().map(|bits| Vec3::from(bits.map(f32::from_bits))).collect()
}

#[test]
fn a_surface_is_that_of_blender() {
    for (table, wanted) in [("subdivide = 2", SMOOTH), ("subdivide = 2\ncrease = 70", CREASED)] {
        let (mesh, wanted) = (load(&format!("file = \"cage.obj\"\n{table}"), &[("cage.obj", CAGE)]), places(wanted));
        let found = distinct(&mesh);
        assert_eq!((mesh.triangles.len(), found.len()), (2 * 116, wanted.len()), "{table}");
        for place in wanted {
            let nearest = found.iter().map(|at| at.distance(place)).fold(f32::INFINITY, f32::min);
            assert!(nearest < 2e-5, "{table}: {place} is {nearest} away");
        }
    }
}

#[test]
fn a_ply_of_quads_and_a_box_are_cages_too() {
    let mut ply = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n".to_owned();
    for i in 0..8 {
        ply += &format!("{} {} {}\n", 2 * (i & 1) - 1, (i & 2) - 1, (i >> 1 & 2) - 1);
    }
    ply += "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";
    let of_ply = load("file = \"a.ply\"\nsubdivide = 3", &[("a.ply", ply.as_bytes())]);
    let of_box = load("shape = \"box\"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nsubdivide = 3", &[]);
    assert_eq!(of_ply.triangles.len(), 2 * 24 * 16);
    // Sums are of other orders.
    let sorted = |mesh: &Mesh| {
        let mut all: Vec<[i32; 3]> =
            distinct(mesh).iter().map(|at| at.to_array().map(|c| (c * 1e4).round() as i32)).collect();
        all.sort_unstable();
        all
    };
    assert_eq!(sorted(&of_ply), sorted(&of_box));
    assert_eq!(
        load("shape = \"box\"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nsubdivide = 3\nsmooth = false", &[]).normals,
        []
    );
}

#[test]
fn what_can_not_be_divided_is_told() {
    let refused = |table: &str, wants: &[&str]| {
        let folder = Folder::new(&[("scene.toml", format!("[[mesh]]\n{table}\n").as_bytes()), ("cage.obj", CAGE)]);
        let error = folder.refuse("scene.toml").to_string();
        for want in wants {
            assert!(error.contains(want), "{table}: {error}");
        }
    };
    refused("shape = \"sphere\"\nsubdivide = 1", &["scene.toml:3", "round already"]);
    refused("file = \"cage.obj\"\ncrease = 30", &["scene.toml:3", "add \"subdivide\""]);
    refused("file = \"cage.obj\"\nsubdivide = 9", &["scene.toml:3", "subdivide"]);
    refused("file = \"cage.obj\"\nsubdivide = 0", &["scene.toml:3", "subdivide"]);
    refused("file = \"cage.obj\"\nsubdivide = 2\ncrease = 181", &["scene.toml:4", "between 0 and 180"]);
}

/// A box of edges of 2 whose nearest ones are 4 from an eye that sees 100 rows of 90 degrees: a pixel is 0.08 wide there.
fn seen(subdivide: &str, place: &str) -> usize {
    let camera =
        "[[camera]]\nname = \"c\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nfov = 90\n[render]\nsize = [160, 100]\n";
    let shape = "shape = \"box\"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\n";
    load(&format!("{shape}subdivide = {subdivide}\n{place}\n{camera}"), &[]).triangles.len()
}

/// Levels of a box come to 6 * 2 * 4^levels triangles.
#[test]
fn a_surface_is_as_fine_as_pixels_ask_for() {
    // Its edges are at most 2 / (0.02 * sqrt(17)) = 24.25 pixels long.
    for (length, levels) in [(30.0, 1), (12.2, 1), (12.0, 2), (3.1, 3), (3.0, 4), (0.01, 6)] {
        let found = seen(&format!("{{ pixels = {length:?} }}"), "");
        assert_eq!(found, 12 << (2 * levels), "{length}");
    }
    assert_eq!(seen("{ pixels = 0.01, most = 3 }", ""), 12 << 6);
    // Far away it needs less, and smaller, too.
    assert_eq!(seen("{ pixels = 3.0 }", "translate = [0, 0, -100]"), 12 << 2);
    assert_eq!(seen("{ pixels = 3.0 }", "scale = 0.1"), 12 << 2);
}

#[test]
fn pixels_that_make_no_sense_are_refused() {
    let refused = |subdivide: &str, camera: &str| {
        let text = format!(
            "[[mesh]]\nshape = \"box\"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nsubdivide = {subdivide}\n{camera}"
        );
        Folder::new(&[("a.toml", text.as_bytes())]).refuse("a.toml").to_string()
    };
    let camera = "[[camera]]\nname = \"c\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n";
    for (subdivide, camera, why) in [
        ("{ pixels = 0 }", camera, "\"pixels\" must be a finite number greater than 0, not 0"),
        ("{ pixels = nan }", camera, "\"pixels\" must be a finite number greater than 0"),
        ("{ pixels = 1, most = 9 }", camera, "\"most\" must be between 1 and 8, not 9"),
        ("{ most = 3 }", camera, "[subdivide] needs \"pixels\"; add it"),
        ("{ pixels = 1, edge = 2 }", camera, "unknown key \"edge\""),
        ("{ pixels = 1 }", "", "add a [[camera]]"),
    ] {
        let found = refused(subdivide, camera);
        assert!(found.contains(why), "{subdivide}: {found}");
    }
}
