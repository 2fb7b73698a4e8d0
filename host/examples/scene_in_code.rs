//! A scene that code makes, not a file: a square on a floor, rendered on the CPU and, where there is one, on the GPU.

use eyerays::compare::compare;
use eyerays::error::{Error, Result};
use eyerays::job::Job;
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish, Rendering};
use eyerays::scene::{Background, Camera, Light, Material, Mesh, Projection, Scene, Settings};
use eyerays::view::View;
use glam::{Vec3, vec3};

fn main() -> Result<()> {
    let scene = scene();
    let packed = Job::new(&scene, scene.settings, Bvh::Medium.quality())?;
    let view = View::new(&packed, &scene.cameras[0])?;
    let cpu = render(&packed, &view, DeviceWish::Cpu)?;
    println!("{}: {} rays", cpu.device, cpu.rays.total());

    // Three floats of linear light a pixel, row by row from the top left.
    let values: &[f32] = cpu.picture.pixels.as_flattened();
    let mean = values.iter().sum::<f32>() / values.len() as f32;
    println!("{} values, {mean:.4} on average", values.len());

    match render(&packed, &view, DeviceWish::Gpu) {
        Ok(gpu) => {
            let comparison = compare(&cpu.picture, &gpu.picture)?;
            println!("{}: {} pixels differ from the CPU's", gpu.device, comparison.differing_pixels);
        }
        // Without a GPU, or with one that can't be exact, there is nothing to compare with.
        Err(Error::NoGpu) => println!("there is no GPU here"),
        Err(Error::Inexact { device, .. }) => println!("{device} can't be exact"),
        Err(other) => return Err(other),
    }
    Ok(())
}

fn render(packed: &Job, view: &View, device: DeviceWish) -> Result<Rendering> {
    let choice = Choice { device, ..Choice::default() };
    Backend::new(&choice)?.render(packed, view, 1, &|_| ())
}

/// A mirror that stands on a red floor.
fn scene() -> Scene {
    let plain = Material {
        name: "floor".to_owned(),
        ambient: Some(Vec3::splat(0.1)),
        diffuse: vec3(0.8, 0.2, 0.2),
        ..Material::default()
    };
    let mirror = Material { name: "mirror".to_owned(), reflection: Vec3::splat(0.7), ..plain.clone() };
    let floor = [(-2.0, 0.0, 2.0), (2.0, 0.0, 2.0), (2.0, 0.0, -2.0), (-2.0, 0.0, -2.0)];
    let stands = [(-1.0, 0.0, -1.0), (1.0, 0.0, -1.0), (1.0, 1.5, -1.0), (-1.0, 1.5, -1.0)];
    let mesh = Mesh {
        positions: [floor, stands].concat().into_iter().map(Vec3::from).collect(),
        // None at all: every triangle is flat.
        normals: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
        materials: vec![0, 0, 1, 1],
        ..Mesh::default()
    };
    Scene {
        materials: vec![plain.clone(), mirror],
        lights: vec![Light::Point {
            position: vec3(1.5, 3.0, 2.0),
            colour: Vec3::ONE,
            group: String::new(),
            illuminant: None,
        }],
        cameras: vec![Camera::new(
            "front",
            vec3(0.5, 1.5, 4.0),
            vec3(0.0, 0.5, 0.0),
            Projection::Perspective { fov: 50.0 },
        )],
        background: Background::Colour(vec3(0.2, 0.3, 0.5)),
        ambient: Vec3::ONE,
        settings: Settings { size: (320, 240), samples: 2, ..Settings::default() },
        ..Scene::of_mesh(mesh, plain)
    }
}
