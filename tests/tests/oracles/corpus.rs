//! The scenes of triangles and the rays that all oracles are asked about, with fixed seeds.

use eyerays::job::Job;
use eyerays::scene::Scene;
use eyerays::scene_io;
use eyerays::stream::StreamRay;
use eyerays_command::generate::{Files, Kind, Recipe};
use eyerays_shader::camera::{self, CameraRay};
use eyerays_shader::data::{Launch, Order};
use eyerays_shader::ray::Ray;
use eyerays_tests::model::{add, empty, matt};
use eyerays_tests::{Posed, SHIPPED, pack, settings};
use fastrand::Rng;
use glam::Vec3;

/// A scene, and rays that start in it.
pub struct Case {
    pub name: String,
    pub packed: Posed,
    pub rays: Vec<StreamRay>,
}

impl Case {
    fn new(name: &str, scene: &Scene, count: usize) -> Self {
        let packed = pack(scene, &scene.cameras[0], settings(scene, (32, 24), 1));
        let mut rays = primary(&packed);
        rays.extend(aimed(&packed, count, &mut Rng::with_seed(7)));
        Case { name: name.to_owned(), packed, rays }
    }

    /// Every triangle once, by its number in the scene.
    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        let mut all: Vec<_> = self.packed.primitives().iter().map(|t| (t.number(), t.vertices())).collect();
        all.sort_by_key(|t| t.0);
        all.dedup_by_key(|t| t.0);
        all.into_iter().map(|t| t.1).collect()
    }
}

/// Shipped scenes of triangles alone, a generated one, and triangles of every shape and size; each with its camera's rays
/// and `count` others.
pub fn cases(count: usize) -> Vec<Case> {
    let mut cases: Vec<Case> = SHIPPED.iter().map(|name| Case::new(name, &tessellated(name), count)).collect();
    cases.push(Case::new("hall", &hall(), count));
    cases.push(Case::new("soup", &soup(&mut Rng::with_seed(11)), count));
    cases
}

/// A shipped scene whose spheres are meshes.
fn tessellated(name: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for file in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes")).expect("the scenes") {
        let file = file.expect("an entry");
        // Textures are no text.
        let bytes = match String::from_utf8(std::fs::read(file.path()).expect("a file")) {
            Ok(text) => text.replace("shape = \"sphere\"", "shape = \"sphere\"\ntessellate = 4").into_bytes(),
            Err(other) => other.into_bytes(),
        };
        std::fs::write(folder.path().join(file.file_name()), bytes).expect("a copy");
    }
    scene_io::load(&folder.path().join(name).with_extension("toml")).unwrap().0
}

fn hall() -> Scene {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mesh = folder.path().join("hall.obj");
    let files = Files::beside(&mesh).unwrap();
    Recipe { kind: Kind::Hall, triangles: 6000, seed: 3 }.write(&files).unwrap();
    scene_io::load(&mesh.with_extension("toml")).unwrap().0
}

/// Triangles from 1 down to 2^-16 of the scene, many of them slivers, some in planes along the axes, some that share
/// vertices with others.
fn soup(rng: &mut Rng) -> Scene {
    let mut scene = empty();
    let mut corners: Vec<Vec3> = Vec::new();
    for i in 0..1500 {
        let place = point(rng);
        let size = (-16.0 * rng.f32()).exp2();
        let thin = if i % 3 == 0 { (-20.0 * rng.f32()).exp2() } else { 1.0 };
        let along = point(rng) * size;
        let mut triangle = [place, place + along, place + along * rng.f32() + point(rng) * size * thin];
        if i % 5 == 0 {
            let axis = rng.usize(0..3);
            triangle.iter_mut().for_each(|p| p[axis] = place[axis]);
        }
        if i % 4 == 0 && i > 0 {
            triangle[0] = corners[corners.len() - 2];
            triangle[1] = corners[corners.len() - 1];
        }
        corners.extend(triangle.map(|p| p.clamp(Vec3::NEG_ONE, Vec3::ONE)));
    }
    let triangles: Vec<[u32; 3]> = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    add(&mut scene, matt(Vec3::ONE), &corners, &triangles);
    scene
}

fn point(rng: &mut Rng) -> Vec3 {
    Vec3::new(rng.f32(), rng.f32(), rng.f32()) * 2.0 - 1.0
}

/// The camera's.
fn primary(posed: &Posed) -> Vec<StreamRay> {
    let frame = posed.view.launch(posed, posed.view.region(), 0, 1, Order::default());
    let pixels =
        (0..frame.slots).map(|slot| camera::pixel(&frame, Order::default(), slot)).filter(|pixel| pixel.inside);
    let ray = |pixel| {
        let CameraRay { origin, direction, .. } = camera::plain_ray::<f32>(&frame, Launch::default(), pixel);
        let vector = |v: eyerays_shader::real::V3<f32>| Vec3::new(v.x, v.y, v.z);
        StreamRay {
            origin: vector(Ray::from_afar(origin, direction).origin),
            direction: vector(direction),
            limit: f32::MAX,
            source_primitive: StreamRay::NOWHERE,
        }
    };
    pixels.map(ray).collect()
}

/// At vertices, at edges, into triangles, along axes, along a triangle's plane, and anywhere.
fn aimed(packed: &Job, count: usize, rng: &mut Rng) -> Vec<StreamRay> {
    let triangles: Vec<[Vec3; 3]> = packed.primitives().iter().map(|t| t.vertices()).collect();
    let ray = |i: usize| {
        let [a, b, c] = triangles[rng.usize(0..triangles.len())];
        let mut origin = point(rng) * 0.99;
        let (s, t) = (rng.f32(), rng.f32());
        let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
        let target = match i % 6 {
            0 => [a, b, c][rng.usize(0..3)],
            1 => a + (b - a) * s,
            2 | 3 => a + (b - a) * s + (c - a) * t,
            4 => {
                origin = a + (b - a) * 3.0 * (s - 0.5) + (c - a) * 3.0 * (t - 0.5);
                a + (c - a) * s
            }
            _ => point(rng),
        };
        let mut direction = target - origin;
        if i.is_multiple_of(7) {
            direction[rng.usize(0..3)] = 0.0;
        }
        if direction == Vec3::ZERO {
            direction = Vec3::X;
        }
        let source_primitive = StreamRay::NOWHERE;
        StreamRay {
            origin,
            direction: if i.is_multiple_of(2) { direction.normalize() } else { direction },
            limit: f32::MAX,
            source_primitive,
        }
    };
    (0..count).map(ray).collect()
}
