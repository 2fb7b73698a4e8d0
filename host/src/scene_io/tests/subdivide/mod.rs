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
