//! Triangles that move from frame to frame, on a GPU that fits its hierarchy to them: `waves [TRIANGLES] [FRAMES] [WIDTH] [HEIGHT]`.

use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

use eyerays::gpu::{AdapterRequest, Gpu, Renderer};
use eyerays::job::Job;
use eyerays::method::Traversal;
use eyerays::quality::Bvh;
use eyerays::scene::{Mesh, Scene};
use eyerays::scene_io::{self, Loading};
use eyerays::view::View;
use glam::Vec3;
use rayon::prelude::*;

/// All but the water, which takes the place of the box: that is as large as all that the water may reach.
const SCENE: &str = r#"
[render]
samples = 1
[background]
horizon = [0.6, 0.7, 0.9]
zenith = [0.1, 0.2, 0.6]
[[camera]]
name = "shore"
eye = [0.0, 0.7, 2.2]
target = [0.0, 0.0, 0.0]
[[light]]
kind = "directional"
direction = [-0.5, -1.0, -0.7]
[[mesh]]
shape = "box"
min = [-2.0, -2.0, -2.0]
max = [2.0, 2.0, 2.0]
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u32>());
    let mut next = |default| arguments.next().unwrap_or(Ok(default));
    let (triangles, frames, width, height) = (next(20_000)?, next(20)?, next(320)?, next(180)?);
    let edge = (triangles / 2).isqrt().max(1);

    let (around, _) = scene_io::read_as(SCENE.as_bytes(), Path::new("waves"), Loading::default())?;
    let scene = Scene { mesh: water(edge, &around.mesh), objects: Vec::new(), ..around };
    // What is split can't be moved.
    let job = Job::new(&scene, scene.settings, Bvh::Fast.quality())?;
    let Ok(gpu) = Gpu::open(&AdapterRequest { software: true, exact: true, ..AdapterRequest::default() }) else {
        println!("there is no GPU that renders exactly");
        return Ok(());
    };
    let mut renderer = Renderer::new(&gpu, &job, true, Traversal::default())?;
    let view = View::of(&job, &scene.cameras[0], (width, height), 1)?;
    let count = scene.mesh.triangles.len();

    // A first frame takes memory.
    renderer.deform(&scene, &scene.mesh.positions, &[])?;
    renderer.render(&view, &|_| ())?;
    let (start, mut computing) = (Instant::now(), Duration::ZERO);
    let mut positions = scene.mesh.positions.clone();
    for frame in 1..=frames {
        let since = Instant::now();
        move_water(edge, frame as f32 / 60.0, &mut positions);
        computing += since.elapsed();
        renderer.deform(&scene, &positions, &[])?;
        renderer.start(&view)?;
        renderer.add(0..1, &|_| ())?;
        // As whoever shows it: the picture is here before the next is begun.
        renderer.film()?;
    }
    let time = start.elapsed();
    let rate = f64::from(frames) / time.as_secs_f64();
    println!("{frames} frames of {count} triangles and {width}x{height} pixels: {rate:.1} a second");
    println!("of {:.2} ms a frame, {:.2} move the vertices", mean(time, frames), mean(computing, frames));
    let repeated = |renderer: &mut Renderer, what: &str, work: &dyn Fn(&mut Renderer) -> eyerays::error::Result<()>| {
        work(renderer)?;
        renderer.wait()?;
        let start = Instant::now();
        (0..frames).try_for_each(|_| work(renderer))?;
        renderer.wait()?;
        println!("{what} alone: {:.2} ms", mean(start.elapsed(), frames));
        eyerays::error::Result::Ok(())
    };
    let picture = |renderer: &mut Renderer| {
        renderer.start(&view)?;
        renderer.add(0..1, &|_| ())
    };
    repeated(&mut renderer, "a picture", &picture)?;
    repeated(&mut renderer, "uploading and fitting", &|renderer| renderer.deform(&scene, &positions, &[]))?;
    repeated(&mut renderer, "building on the device", &Renderer::rebuild)?;
    repeated(&mut renderer, "a picture by what was built there", &picture)?;
    let last = renderer.film()?.develop()?;
    println!("checksum of the last: {}", last.hash());
    Ok(())
}

fn mean(time: Duration, frames: u32) -> f64 {
    time.as_secs_f64() * 1e3 / f64::from(frames.max(1))
}

/// A sheet of squares of two triangles, and two corners of the box around all, which are seen by nobody.
fn water(edge: u32, around: &Mesh) -> Mesh {
    let side = edge + 1;
    let mut positions = vec![Vec3::ZERO; (side * side) as usize];
    move_water(edge, 0.0, &mut positions);
    let squares = (0..edge).flat_map(|row| (0..edge).map(move |column| row * side + column));
    let mut triangles: Vec<[u32; 3]> =
        squares.flat_map(|a| [[a, a + side, a + side + 1], [a, a + side + 1, a + 1]]).collect();
    for corner in [around.positions[0], *around.positions.last().expect("a box has corners")] {
        let first = positions.len() as u32;
        positions.extend([corner, corner * 0.999, corner * 0.998]);
        triangles.push([first, first + 1, first + 2]);
    }
    Mesh { materials: vec![0; triangles.len()], positions, triangles, ..Mesh::default() }
}

/// Where it is after some seconds.
#[expect(clippy::disallowed_methods, reason = "water may differ by a bit from machine to machine")]
fn move_water(edge: u32, seconds: f32, positions: &mut [Vec3]) {
    let side = edge as usize + 1;
    positions[..side * side].par_chunks_mut(side).enumerate().for_each(|(row, places)| {
        let z = 4.0 * row as f32 / edge as f32 - 2.0;
        for (column, place) in places.iter_mut().enumerate() {
            let x = 4.0 * column as f32 / edge as f32 - 2.0;
            let swell = 0.08 * (3.0 * x + 2.0 * seconds).sin() + 0.05 * (7.0 * z - 3.0 * x + 4.0 * seconds).sin();
            *place = Vec3::new(x, swell, z);
        }
    });
}
