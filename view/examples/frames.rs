//! How many pictures a second a window has on a device while its camera moves: the window's own code without a window, each picture in a
//! texture that a window would draw.
//!
//! `cargo run --release -p eyerays-view --example frames -- SCENE.toml 1920x1080 [SECONDS]`

use std::cell::Cell;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use eyerays::gpu::{Gpu, wgpu};
use eyerays::render::{Choice, DeviceWish};
use eyerays_view::{AsTheyAre, Device, Doing, News, Studio, Wish, motion};
use glam::DVec2;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((scene, size, seconds)) = parsed(&arguments) else {
        eprintln!("error: name a scene and a size, for example scenes/whitted.toml 1920x1080, and seconds if not 5");
        return ExitCode::from(2);
    };
    match measured(scene, size, seconds) {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(fault) => {
            eprintln!("error: {fault}");
            ExitCode::from(2)
        }
    }
}

fn parsed(arguments: &[String]) -> Option<(PathBuf, (u32, u32), f64)> {
    let (width, height) = arguments.get(1)?.split_once('x')?;
    let seconds = arguments.get(2).map_or(Some(5.0), |seconds| seconds.parse().ok())?;
    Some((PathBuf::from(&arguments[0]), (width.parse().ok()?, height.parse().ok()?), seconds))
}

fn measured(scene: PathBuf, size: (u32, u32), seconds: f64) -> Result<String, String> {
    let gpu = opened()?;
    let name = gpu.report.name.clone();
    let device = Device::of(&Choice { device: DeviceWish::Gpu, ..Choice::default() });
    let mut studio = Studio::new(Box::new(AsTheyAre::default()), Some(gpu), None);
    let mut wish = Wish { most: 1, ..Wish::new(scene, device, size) };
    let told = first(&mut studio, &wish)?;
    let mut camera = studio.news().facts.as_ref().expect("a picture is of a scene").camera.clone();
    wish.is_moving = true;
    let (mut start, mut frames, mut full) = (Instant::now(), 0u32, 0u32);
    let (mut is_warm, mut before) = (false, 0.0);
    loop {
        motion::orbit(&mut camera, DVec2::new(1e-3, 0.0));
        wish.camera = Some(camera.clone());
        let picture = loop {
            if let Some(picture) = studio.step(&wish, &|_| ()).picture {
                break picture;
            }
            if let Some(fault) = &studio.news().fault {
                return Err(fault.clone());
            }
        };
        frames += 1;
        full += u32::from(picture.size == size);
        // Clocks rise, and pictures come to their size.
        if !is_warm && start.elapsed() > Duration::from_secs(1) {
            (is_warm, before, start, frames, full) = (true, resident(), Instant::now(), 0, 0);
        }
        if is_warm && start.elapsed().as_secs_f64() >= seconds {
            break;
        }
    }
    let rate = f64::from(frames) / start.elapsed().as_secs_f64();
    let (width, height) = size;
    Ok(format!(
        "{name}: {rate:.0} pictures a second of {width}x{height}, {full} of {frames} of that size; {told}; memory {:.2} times that of the first second",
        resident() / before
    ))
}

/// When the first pictures of a wish are there, counted from when its scene is read and packed.
fn first(studio: &mut Studio, wish: &Wish) -> Result<String, String> {
    let (start, packed) = (Instant::now(), Cell::new(None));
    let mut seen = None;
    loop {
        let tell = |news: &News| {
            if matches!(news.doing, Doing::Opening(_)) {
                packed.set(packed.get().or(Some(Instant::now())));
            }
        };
        let step = studio.step(wish, &tell);
        if let Some(fault) = &studio.news().fault {
            return Err(fault.clone());
        }
        let Some(picture) = step.picture else { continue };
        let packed = packed.get().ok_or("nothing was opened")?;
        let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
        let first: f64 = *seen.get_or_insert_with(|| milliseconds(packed.elapsed()));
        if picture.samples > 0 {
            let (packing, samples) = (milliseconds(packed - start), milliseconds(packed.elapsed()));
            return Ok(format!(
                "read and packed in {packing:.0} ms, then a picture after {first:.0} ms, samples after {samples:.0} ms"
            ));
        }
    }
}

/// What of the process is in memory; 0 where nobody tells.
fn resident() -> f64 {
    let told = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    told.split_whitespace().nth(1).and_then(|pages| pages.parse().ok()).unwrap_or(0.0)
}

/// A GPU as a window opens it.
fn opened() -> Result<Gpu, String> {
    let best = Gpu::open(&eyerays::gpu::AdapterRequest { software: true, exact: true, ..Default::default() });
    let best = best.map_err(|error| error.to_string())?;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let adapter = adapters.into_iter().find(|adapter| adapter.get_info().name == best.report.name);
    let adapter = adapter.ok_or("the GPU is gone")?;
    let device = pollster::block_on(adapter.request_device(&Gpu::descriptor(&adapter)));
    let (device, queue) = device.map_err(|error| error.to_string())?;
    Gpu::from_wgpu(&adapter, device, queue).map_err(|error| error.to_string())
}
