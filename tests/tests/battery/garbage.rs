//! Meshes of random bits are refused in one line, or drawn without a number that is none.

use std::fmt::Write as _;

use eyerays::job::Job;
use eyerays::scene::{Projection, Scene, Settings};
use eyerays::scene_io;
use eyerays::view::View;
use eyerays_bvh::Quality;
use eyerays_tests::Posed;
use eyerays_tests::count;
use eyerays_tests::machine::Machine;
use eyerays_tests::model::{add, empty, glass, lamp, matt, mirror, sun};
use eyerays_tests::random::Random;
use glam::Vec3;

/// Meshes in all, and those that a software GPU compiles its kernels for unless all are asked for.
const MESHES: u64 = 1000;
const FEW: usize = 8;

/// Any bits; bits that are finite numbers; or some of a wide range of sizes.
fn number(kind: u64, random: &mut Random) -> f32 {
    let any = f32::from_bits(random.bits());
    match kind % 4 {
        0 => any,
        1 if any.is_finite() => any,
        2 => random.magnitude(-8.0, 8.0),
        _ => random.magnitude(-2.0, 0.0),
    }
}

fn corner(kind: u64, random: &mut Random) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| number(kind, random)))
}

fn mesh(seed: u64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut random = Random::new(seed);
    let vertices = 3 + random.index(60);
    let corners = (0..vertices).map(|_| corner(seed, &mut random)).collect();
    let triangle = |random: &mut Random| std::array::from_fn(|_| random.index(vertices) as u32);
    (corners, (0..1 + random.index(80)).map(|_| triangle(&mut random)).collect())
}

/// Seen from one of its vertices towards another, in light from a third.
fn scene(seed: u64) -> Scene {
    let (corners, triangles) = mesh(seed);
    let mut scene = empty();
    let material = [matt(Vec3::ONE), mirror(Vec3::splat(0.9)), glass(Vec3::ONE)][seed as usize / 4 % 3].clone();
    add(&mut scene, material, &corners, &triangles);
    (scene.cameras[0].eye, scene.cameras[0].target, scene.cameras[0].projection) =
        (corners[0], corners[1], Projection::Perspective { fov: 70.0 });
    scene.lights = vec![lamp(corners[2]), sun(Vec3::new(0.3, -1.0, -0.2))];
    scene.ambient = Vec3::splat(0.1);
    scene.settings = Settings { size: (16, 12), bounces: 4, min_contribution: 0.01, ..scene.settings };
    scene
}

/// How many of the meshes were drawn, and the pixels that lost a contribution or are no number.
#[derive(Default)]
struct Drawn {
    meshes: usize,
    pixels: usize,
    bad: usize,
}

fn draw(machine: Machine, scenes: impl Iterator<Item = Scene>) -> Drawn {
    let mut drawn = Drawn::default();
    for scene in scenes {
        match Job::with_wide_nodes(&scene, scene.settings, Quality::Medium) {
            Ok(packed) => {
                let Ok(view) = View::new(&packed, &scene.cameras[0]) else { continue };
                let (picture, rays) = machine.render(&Posed { packed, view });
                drawn.meshes += 1;
                drawn.pixels += picture.pixels.len();
                let is_bad = |pixel: &&[f32; 3]| !pixel.iter().all(|channel| channel.is_finite());
                drawn.bad += picture.pixels.iter().filter(is_bad).count() + rays.non_finite as usize;
            }
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
    drawn
}

#[test]
fn meshes_of_random_bits() {
    for machine in Machine::all() {
        let few = if machine.is_software() { count::of(FEW, MESHES as usize) } else { MESHES as usize };
        let drawn = draw(machine, (0..few as u64).map(scene));
        let what = format!("garbage, no numbers in the picture of {} meshes of random bits of {few}", drawn.meshes);
        count::none(what, machine, drawn.bad, drawn.pixels);
        assert!(drawn.meshes * 2 > few, "{machine}: only {} of {few} are drawn", drawn.meshes);
    }
}

/// The same meshes as text, which is read, framed and lit as any mesh.
#[test]
fn files_of_random_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let load = |seed: u64| {
        let (corners, triangles) = mesh(seed);
        let mut text = String::new();
        corners.iter().for_each(|v| writeln!(text, "v {:e} {} {:e}", v.x, v.y, v.z).unwrap());
        let face = |[a, b, c]: [u32; 3]| format!("f {} {} {}\n", a + 1, b + 1, c + 1);
        triangles.into_iter().for_each(|triangle| text += &face(triangle));
        let path = folder.path().join(format!("{seed}.obj"));
        std::fs::write(&path, text).unwrap();
        match scene_io::load(&path) {
            Ok((mut scene, _)) => {
                scene.settings.size = (16, 12);
                Some(scene)
            }
            Err(error) => {
                let line = error.to_string();
                assert!(line.contains(".obj") && !line.contains('\n'), "{line}");
                None
            }
        }
    };
    let drawn = draw(Machine::CPU, (0..MESHES).filter_map(load));
    let what = format!("garbage, no numbers in the picture of {} files of {MESHES}", drawn.meshes);
    count::none(what, Machine::CPU, drawn.bad, drawn.pixels);
    assert!(drawn.meshes > 300);
}
