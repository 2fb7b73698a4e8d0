//! Surfaces that pictures of heights move.

use std::collections::HashMap;

use glam::Vec3;

use super::Folder;
use crate::scene::Mesh;

/// A PNG of 16 bits a texel, grey.
fn png((width, height): (u32, u32), value: impl Fn(u32, u32) -> u16) -> Vec<u8> {
    let picture = image::ImageBuffer::from_fn(width, height, |x, y| image::Luma([value(x, y)]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::DynamicImage::ImageLuma16(picture).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn load(table: &str, picture: &[u8]) -> Mesh {
    let text = format!("[[mesh]]\n{table}\n");
    let folder = Folder::new(&[("scene.toml", text.as_bytes()), ("h.png", picture)]);
    let (scene, warnings) = folder.load("scene.toml").unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    scene.mesh
}

const FLOOR: &str = "shape = \"quad\"\ncorners = [[0, 0, 1], [1, 0, 1], [1, 0, 0], [0, 0, 0]]\nsubdivide = 5";

/// A ramp from left to right: between the middles of its first and its last texel the surface is a plane, in steps of 16 bits.
#[test]
fn a_ramp_makes_a_plane_of_a_floor() {
    let ramp = png((64, 4), |x, _| (1000 * x) as u16);
    let mesh = load(&format!("{FLOOR}\ndisplace = {{ file = \"h.png\", height = 6.5535, middle = 0.5 }}"), &ramp);
    let mut count = 0;
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        let texels = position.x * 64.0 - 0.5;
        if (1.5..61.5).contains(&texels) {
            let wanted = 0.1 * texels - 0.5 * 6.5535;
            assert!((position.y - wanted).abs() < 1e-5, "{position}: {wanted}");
            if (4.0..59.0).contains(&texels) {
                assert!(normal.abs_diff_eq(Vec3::new(-6.4, 1.0, 0.0).normalize(), 1e-4), "{normal}");
            }
            count += 1;
        }
    }
    assert!(count > 500, "{count}");
}

#[test]
fn a_box_whose_sides_have_coordinates_of_their_own_stays_closed() {
    let noise = png((16, 16), |x, y| ((x * 7919 + y * 104_729).wrapping_mul(2_654_435_761) >> 16) as u16);
    let table = "shape = \"box\"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nsubdivide = 4\ncrease = 30";
    let mesh = load(&format!("{table}\ndisplace = {{ file = \"h.png\", height = 0.1 }}"), &noise);
    let mut edges = HashMap::new();
    let place = |vertex: u32| mesh.positions[vertex as usize].to_array().map(f32::to_bits);
    for [a, b, c] in mesh.triangles.iter().map(|triangle| triangle.map(place)) {
        [(a, b), (b, c), (c, a)].into_iter().for_each(|edge| *edges.entry(edge).or_insert(0) += 1);
    }
    assert!(edges.iter().all(|(&(a, b), &count)| count == 1 && edges.get(&(b, a)) == Some(&1)));
    let largest = mesh.positions.iter().map(|at| at.abs().max_element()).fold(0.0, f32::max);
    assert!((1.05..1.1001).contains(&largest), "{largest}");
}

#[test]
fn what_can_not_be_moved_is_told() {
    let refused = |table: &str, wants: &[&str]| {
        let flat = png((1, 1), |_, _| 0);
        let scene = format!("[[mesh]]\n{table}\n");
        let triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let folder =
            Folder::new(&[("scene.toml", scene.as_bytes()), ("h.png", &flat), ("a.obj", triangle), ("x.png", b"no")]);
        let error = folder.refuse("scene.toml").to_string();
        for want in wants {
            assert!(error.contains(want), "{table}: {error}");
        }
    };
    let displace = |file: &str| format!("displace = {{ file = \"{file}\", height = 1 }}");
    refused(&format!("shape = \"sphere\"\n{}", displace("h.png")), &["scene.toml:3", "tessellate"]);
    refused(&format!("file = \"a.obj\"\n{}", displace("h.png")), &["scene.toml:3", "no texture coordinates"]);
    refused(&format!("{FLOOR}\n{}", displace("none.png")), &["scene.toml:5", "none.png"]);
    refused(&format!("{FLOOR}\n{}", displace("x.png")), &["scene.toml:5", "x.png"]);
    refused(&format!("{FLOOR}\ndisplace = \"h.png\""), &["scene.toml:5", "how far"]);
    refused(&format!("{FLOOR}\ndisplace = {{ file = \"h.png\" }}"), &["scene.toml", "height"]);
}
