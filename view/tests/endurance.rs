//! A studio that runs for long, and one whose device goes.
#![cfg(target_os = "linux")]

use std::path::Path;
use std::time::{Duration, Instant};

use eyerays::gpu::{AdapterRequest, Gpu, wgpu};
use eyerays::render::{Choice, DeviceWish};
use eyerays_view::{AsTheyAre, Device, Doing, Studio, Wish, motion};
use glam::DVec2;

const PATIENCE: Duration = Duration::from_secs(240);
const SIZE: (u32, u32) = (16, 12);

fn wish(device: DeviceWish) -> Wish {
    let device = Device::of(&Choice { device, threads: 2, ..Choice::default() });
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/whitted.toml");
    Wish { most: 1, ..Wish::new(scene, device, SIZE) }
}

fn studio(shared: Option<Gpu>) -> Studio {
    Studio::new(Box::new(AsTheyAre::default()), shared, None)
}

/// Steps until a picture of samples is there; none where the wish can't be had.
fn pictured(studio: &mut Studio, wish: &Wish) -> Option<u32> {
    let start = Instant::now();
    loop {
        let step = studio.step(wish, &|_| ());
        match step.picture {
            Some(picture) if picture.samples > 0 => return Some(picture.samples),
            None if !step.goes_on => return None,
            _ => assert!(start.elapsed() < PATIENCE, "{:?}", studio.news().doing),
        }
    }
}

/// A device as a window opens it, in software too, if there is one.
fn shared() -> Option<(Gpu, wgpu::Device)> {
    let required = std::env::var("EYERAYS_REQUIRE_GPU").is_ok_and(|value| value == "1");
    let best = match Gpu::open(&AdapterRequest { software: true, exact: true, ..Default::default() }) {
        Ok(best) => best.report.name.clone(),
        Err(error) => {
            assert!(!required, "EYERAYS_REQUIRE_GPU=1, but {error}");
            eprintln!("skipped: {error}");
            return None;
        }
    };
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let adapter = adapters.into_iter().find(|adapter| adapter.get_info().name == best).unwrap();
    let (device, queue) = pollster::block_on(adapter.request_device(&Gpu::descriptor(&adapter))).unwrap();
    Some((Gpu::from_wgpu(&adapter, device.clone(), queue).unwrap(), device))
}

/// What of the process is in memory, in bytes.
fn resident() -> u64 {
    let told = std::fs::read_to_string("/proc/self/statm").unwrap();
    4096 * told.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap()
}

/// Memory after some frames of a moving camera and after many.
fn grows(studio: &mut Studio, device: DeviceWish, [some, many]: [u32; 2]) -> f64 {
    let mut wish = wish(device);
    pictured(studio, &wish).unwrap();
    let mut camera = studio.news().facts.as_ref().unwrap().camera.clone();
    wish.is_moving = true;
    let mut before = 0;
    for frame in 0..many {
        motion::orbit(&mut camera, DVec2::new(1e-3, 0.0));
        wish.camera = Some(camera.clone());
        pictured(studio, &wish).unwrap();
        if frame == some {
            before = resident();
        }
    }
    resident() as f64 / before as f64
}

/// One test: what others hold in memory would count.
#[test]
fn ten_thousand_frames_take_no_more_memory_than_some_and_a_device_that_goes_leaves_the_cpu() {
    let growth = grows(&mut studio(None), DeviceWish::Cpu, [1000, 10_000]);
    assert!(growth < 1.05, "on a CPU {growth}");
    let Some((gpu, device)) = shared() else { return };
    let mut studio = studio(Some(gpu));
    let growth = grows(&mut studio, DeviceWish::Gpu, [500, 2000]);
    assert!(growth < 1.05, "on a GPU {growth}");
    device.destroy();
    let lost =
        Wish { source: eyerays_view::Source { version: 1, ..wish(DeviceWish::Gpu).source }, ..wish(DeviceWish::Gpu) };
    assert_eq!(pictured(&mut studio, &lost), None);
    let fault = studio.news().fault.clone().unwrap();
    assert!(!fault.contains('\n') && studio.news().doing == Doing::Nothing, "{fault}");
    let cpu = Wish { device: wish(DeviceWish::Cpu).device, ..lost };
    assert_eq!(pictured(&mut studio, &cpu), Some(1));
}
