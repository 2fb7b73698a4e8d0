//! Shapes, transforms and framing.

use std::collections::HashMap;

use glam::Vec3;

use super::{Folder, TRIANGLE};
use crate::scene::{Background, Mesh, Scene, Settings, Sphere, default_camera, normal};
use crate::scene_io::shape;
use crate::scene_io::transform::Transform;

fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [Vec3; 3] {
    triangle.map(|vertex| mesh.positions[vertex as usize])
}

fn sphere(center: Vec3, radius: f32, steps: u32) -> Mesh {
    shape::spheres(&[Sphere { center, radius, material: 0 }], steps)
}

/// A scene of nothing else.
fn of_mesh(mesh: Mesh) -> Scene {
    Scene {
        mesh,
        spheres: Vec::new(),
        disks: Vec::new(),
        shared: Vec::new(),
        instances: Vec::new(),
        objects: Vec::new(),
        animations: Vec::new(),
        files: Vec::new(),
        materials: Vec::new(),
        lights: Vec::new(),
        cameras: Vec::new(),
        background: Background::Colour(Vec3::ZERO),
        background_group: String::new(),
        ambient: Vec3::ZERO,
        settings: Settings::default(),
        motion: None,
        hierarchy: None,
        fog: None,
        environment: None,
    }
}

/// Every edge once each way: no crack, and all triangles turn the same way.
fn assert_closed(mesh: &Mesh) {
    let mut edges = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            *edges.entry(edge).or_insert(0) += 1;
        }
    }
    for (&(a, b), &count) in &edges {
        assert_eq!((count, edges.get(&(b, a))), (1, Some(&1)), "edge {a} {b}");
    }
}

fn assert_outward(mesh: &Mesh, center: Vec3) {
    for &triangle in &mesh.triangles {
        let [a, b, c] = corners(mesh, triangle);
        let outward = (a + b + c) / 3.0 - center;
        assert!((b - a).cross(c - a).dot(outward) > 0.0, "{triangle:?}");
    }
}

#[test]
fn a_sphere_is_closed_outward_and_round() {
    let center = Vec3::new(1.0, -2.0, 3.0);
    for subdivisions in [0, 1, 4] {
        let ball = sphere(center, 2.0, subdivisions);
        assert_eq!(ball.triangles.len(), 20 << (2 * subdivisions));
        assert_closed(&ball);
        assert_outward(&ball, center);
        for (position, normal) in ball.positions.iter().zip(&ball.normals) {
            assert!((normal.length() - 1.0).abs() < 1e-6);
            assert!((center + 2.0 * normal).distance(*position) < 1e-5);
        }
    }
}

#[test]
fn a_box_is_closed_and_outward() {
    let cuboid = shape::cuboid(Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 3.0, 4.0));
    assert_closed(&cuboid);
    assert_outward(&cuboid, Vec3::new(0.0, 1.5, 3.0));
}

#[test]
fn a_box_for_textures_has_the_triangles_of_another_and_pictures_upright() {
    let (least, greatest) = (Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 3.0, 4.0));
    let [shared, covered] = [shape::cuboid(least, greatest), shape::covered_cuboid(least, greatest)];
    let places = |mesh: &Mesh| mesh.triangles.iter().map(|&triangle| corners(mesh, triangle)).collect::<Vec<_>>();
    assert_eq!(places(&covered), places(&shared));
    for (triangle, places) in covered.triangles.iter().zip(places(&covered)) {
        let [a, b, c] = triangle.map(|vertex| covered.coordinates[0][vertex as usize]);
        let outward = (places[1] - places[0]).cross(places[2] - places[0]);
        // Rows are counted downward, so that what is not mirrored turns the other way.
        assert!((b - a).perp_dot(c - a) < 0.0, "a picture is mirrored");
        if outward.y == 0.0 {
            let tops = [a, b, c].map(|coordinate| coordinate.y == 0.0);
            assert_eq!(tops, places.map(|place| place.y == greatest.y), "a picture is not upright");
        }
    }
}

#[test]
fn a_quad_faces_the_side_that_its_corners_turn_around() {
    let quad = shape::quad([Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    for &triangle in &quad.triangles {
        let [a, b, c] = corners(&quad, triangle);
        assert_eq!((b - a).cross(c - a), Vec3::Z);
    }
}

#[test]
fn a_transform_scales_then_turns_then_moves() {
    let mut mesh = shape::quad([Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE]);
    let scale = Vec3::new(2.0, 3.0, 4.0);
    Transform::new(scale, Vec3::new(90.0, 0.0, 0.0), Vec3::new(10.0, 0.0, 0.0)).apply(&mut mesh);
    // About x, y turns to z and z to -y.
    assert_eq!(
        mesh.positions,
        [Vec3::new(12.0, 0.0, 0.0), Vec3::new(10.0, 0.0, 3.0), Vec3::new(10.0, -4.0, 0.0), Vec3::new(12.0, -4.0, 3.0),]
    );
    let mut turned = shape::quad([Vec3::X, Vec3::Y, Vec3::Z, Vec3::ZERO]);
    Transform::new(Vec3::ONE, Vec3::new(90.0, 90.0, 90.0), Vec3::ZERO).apply(&mut turned);
    // x to -z by y; y to z by x, to x by y, to y by z; z to -y by x, to x by z.
    assert_eq!(turned.positions[..3], [Vec3::NEG_Z, Vec3::Y, Vec3::X]);
}

#[test]
fn a_mirror_keeps_the_outside_out_and_a_stretch_keeps_normals_upright() {
    for scale in [Vec3::new(-1.0, 1.0, 1.0), Vec3::splat(-2.0), Vec3::new(1.0, 2.0, 0.5)] {
        let mut ball = sphere(Vec3::ZERO, 1.0, 4);
        Transform::new(scale, Vec3::new(10.0, 20.0, 30.0), Vec3::ONE).apply(&mut ball);
        assert_closed(&ball);
        assert_outward(&ball, Vec3::ONE);
        for &triangle in &ball.triangles {
            let [a, b, c] = corners(&ball, triangle);
            let face = (b - a).cross(c - a).normalize();
            for vertex in triangle {
                let normal = ball.normals[vertex as usize];
                assert!((normal.length() - 1.0).abs() < 1e-6);
                // The faces are small, so that their normals are near their vertices'.
                assert!(normal.dot(face) > 0.9, "{scale} {normal} {face}");
            }
        }
    }
}

#[test]
fn smoothing_joins_vertices_at_one_place_and_leaves_given_normals() {
    let mut mesh = shape::cuboid(-Vec3::ONE, Vec3::ONE);
    mesh.positions = mesh.triangles.iter().flat_map(|&t| corners(&mesh, t)).collect();
    mesh.triangles = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    mesh.normals = vec![Vec3::ZERO; 36];
    mesh.normals[0] = Vec3::NEG_X;
    normal::smooth(&mut mesh);
    assert_eq!(mesh.normals[0], Vec3::NEG_X);
    let mut seen: HashMap<[u32; 3], Vec3> = HashMap::new();
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals).skip(1) {
        assert!((normal.length() - 1.0).abs() < 1e-6);
        assert!(normal.dot(*position) > 1.0);
        let same = *seen.entry(position.to_array().map(f32::to_bits)).or_insert(*normal);
        assert_eq!(same, *normal);
    }
    assert_eq!(seen.len(), 8);
}

#[test]
fn smooth_decides_over_a_file_s_normals() {
    let load = |smooth: &str| -> Scene {
        let scene = format!("[[mesh]]\nfile = \"a.obj\"\n{smooth}\n");
        let folder = Folder::new(&[("scene.toml", scene.as_bytes()), ("a.obj", TRIANGLE)]);
        folder.load("scene.toml").unwrap().0
    };
    assert!(load("").mesh.normals.is_empty());
    assert_eq!(load("smooth = true").mesh.normals, [Vec3::Z; 3]);
    let flat = b"[[mesh]]\nshape = \"sphere\"\nsmooth = false\n";
    let (scene, _) = Folder::new(&[("a.toml", flat)]).load("a.toml").unwrap();
    assert!(scene.mesh.normals.is_empty());
}

#[test]
fn the_framing_camera_sees_every_vertex() {
    for (at, radius, aspect) in [(0.0, 1.0, 1.0), (1e3, 0.5, 2.0), (-5.0, 1e6, 0.4), (0.0, 1e-6, 1.0)] {
        let ball = sphere(Vec3::splat(at), radius, 3);
        let camera = default_camera(&of_mesh(ball.clone()), aspect).unwrap();
        let forward = (camera.target - camera.eye).normalize();
        let right = forward.cross(camera.up).normalize();
        let up = right.cross(forward);
        let high = (camera.projection.fov().unwrap() / 2.0).to_radians().tan();
        let mut widest = 0f32;
        for &position in &ball.positions {
            let view = position - camera.eye;
            let depth = view.dot(forward);
            assert!(depth > 0.0);
            let x = (view.dot(right) / depth / high / aspect as f32).abs();
            let y = (view.dot(up) / depth / high).abs();
            assert!(x <= 1.0 && y <= 1.0, "{position} at {x}, {y}");
            widest = widest.max(x).max(y);
        }
        assert!(widest > 0.85, "the mesh fills only {widest} of the image");
    }
}

#[test]
fn a_mesh_of_one_place_is_framed() {
    let dot = Mesh { positions: vec![Vec3::splat(7.0)], ..Mesh::default() };
    let camera = default_camera(&of_mesh(dot), 1.0).unwrap();
    assert_ne!(camera.eye, camera.target);
}
