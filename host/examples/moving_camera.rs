//! A camera that moves over a scene which is uploaded once: `moving_camera SCENE.toml [FRAMES] [WIDTH] [HEIGHT]`.

use std::error::Error;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use eyerays::gpu::{AdapterRequest, Gpu, Renderer};
use eyerays::job::Job;
use eyerays::method::Traversal;
use eyerays::quality::Bvh;
use eyerays::scene::Camera;
use eyerays::scene_io;
use eyerays::view::View;
use glam::Vec3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let shipped = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell.toml"));
    let file = arguments.next().map_or(shipped, PathBuf::from);
    let frames: u32 = arguments.next().map_or(Ok(10), |frames| frames.parse())?;
    let width: u32 = arguments.next().map_or(Ok(256), |width| width.parse())?;
    let height: u32 = arguments.next().map_or(Ok(width), |height| height.parse())?;

    let (scene, warnings) = scene_io::load(&file)?;
    warnings.iter().for_each(|warning| println!("{warning}"));
    let packed = Job::new(&scene, scene.settings, Bvh::Medium.quality())?;
    let Ok(gpu) = Gpu::open(&AdapterRequest { software: true, exact: true, ..AdapterRequest::default() }) else {
        println!("there is no GPU that renders exactly");
        return Ok(());
    };
    let mut renderer = Renderer::new(&gpu, &packed, true, Traversal::default())?;

    let view = |frame| View::of(&packed, &turned(&scene.cameras[0], frame as f32 / frames as f32), (width, height), 1);
    // A first frame takes memory; the others only send what a view says.
    renderer.render(&view(0)?, &|_| ())?;
    let start = Instant::now();
    for frame in 0..frames {
        renderer.start(&view(frame)?)?;
        renderer.add(0..1, &|_| ())?;
    }
    let last = renderer.film()?.develop()?;
    println!("{frames} frames of {width}x{height} in {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
    println!("checksum of the last: {}", last.hash());

    // Once more, asking the device after every frame what it took.
    let mut device = Duration::ZERO;
    for frame in 0..frames {
        device += renderer.render(&view(frame)?, &|_| ())?.device_time.unwrap_or_default();
    }
    println!("on the device {:.1} ms", device.as_secs_f64() * 1e3);
    Ok(())
}

/// A camera that looks to one side, to the other and back while `turn` goes from 0 to 1.
fn turned(camera: &Camera, turn: f32) -> Camera {
    let ahead = camera.target - camera.eye;
    let aside: Vec3 = ahead.cross(camera.up).normalize() * ahead.length();
    // From -1 to 1 and back.
    let share = 1.0 - 4.0 * (turn - 0.5).abs();
    Camera { target: camera.target + aside * 0.1 * share, ..camera.clone() }
}
