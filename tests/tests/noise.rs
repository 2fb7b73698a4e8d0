//! Pictures that end by their noise: the same on GPU and CPU, and no other in the mean than those of a fixed number of samples.

use std::sync::atomic::AtomicBool;

use eyerays::image::ToneMap;
use eyerays::method::{Method, Order, Traversal};
use eyerays::noise::Target;
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish, Rendering};
use eyerays::scene::{Integrator, PixelFilter, Sampler, Scene, Settings, Transport};
use eyerays::watch::Watch;
use eyerays_tests::{Posed, assert_same_bits, pack, pack_in, quick_gpu, shipped};

fn settings(scene: &Scene, size: (u32, u32), spp: u32) -> Settings {
    // Of so few pixels other filters make most of them edges.
    Settings { size, spp, sampler: Sampler::Sobol, pixel_filter: Some(PixelFilter::Box), ..scene.settings }
}

fn rendered(posed: &Posed, target: &Target, device: DeviceWish, traversal: Traversal) -> Rendering {
    let adapter = std::env::var("EYERAYS_ADAPTER").ok().filter(|_| device == DeviceWish::Gpu);
    let backend = Backend::new(&Choice { device, adapter, traversal, ..Choice::default() }).unwrap();
    let stop = AtomicBool::new(false);
    let watch = Watch { limit: None, stop: &stop, grown: &|_| () };
    backend.open(&posed.packed).unwrap().render_until(&posed.view, target, None, &watch).unwrap()
}

/// In every order of pixels, of which each has other grids of cells, with paths that branch and paths that do not.
#[test]
fn gpu_and_cpu_decide_alike() {
    if quick_gpu().is_none() {
        return;
    }
    let target = Target::new(0.06, 0.0, ToneMap::None).unwrap();
    let mut differ = 0;
    let linear = Traversal { order: Order::Linear, ..Method::IfIf.into() };
    let morton = Traversal { order: Order::Morton, ..Method::IfIf.into() };
    for (name, integrator, traversal) in [
        ("cornell_path", Integrator::Path, Traversal::default()),
        ("cornell_path", Integrator::Path, linear),
        ("occlusion", Integrator::Ao, morton),
        ("glass", Integrator::Distributed, Traversal::default()),
    ] {
        let scene = shipped(name);
        let transport = Transport { integrator, ..scene.settings.transport };
        let posed = pack(&scene, &scene.cameras[0], Settings { transport, ..settings(&scene, (45, 37), 120) });
        let [gpu, cpu] = [DeviceWish::Gpu, DeviceWish::Cpu].map(|device| rendered(&posed, &target, device, traversal));
        let [own, want] = [&gpu, &cpu].map(|rendering| rendering.film.as_ref().unwrap());
        assert_eq!((own.samples(), gpu.rays), (want.samples(), cpu.rays), "{name}");
        assert_eq!((own.errors(), own.cells_left()), (want.errors(), 0), "{name}");
        assert_same_bits(&gpu.picture, &cpu.picture, name);
        let counts = own.samples();
        differ += usize::from(counts.iter().max() > counts.iter().min());
    }
    assert!(differ > 0, "cells that all have one number of samples show little");
}

/// The mean of pictures of 64 seeds.
fn mean(scene: &Scene, render: impl Fn(&Posed) -> Rendering) -> (Vec<f64>, Vec<u32>) {
    let (mut sum, mut samples) = (vec![0.0; 32 * 16], Vec::new());
    for seed in 0..64 {
        let transport = Transport { seed, ..scene.settings.transport };
        let posed = pack_in(
            scene,
            &scene.cameras[0],
            Settings { transport, bounces: 2, ..settings(scene, (32, 16), 256) },
            Bvh::Fast.quality(),
        );
        let rendering = render(&posed);
        for (sum, pixel) in sum.iter_mut().zip(&rendering.picture.pixels) {
            *sum += pixel.iter().map(|&channel| f64::from(channel)).sum::<f64>() / 3.0 / 64.0;
        }
        samples.extend(rendering.film.unwrap().samples());
    }
    (sum, samples)
}

/// Cells stop because of the samples that they show: where those are too dark by chance and alike, too soon. Cell by cell, whose means
/// of 64 pictures err by chance by less than a fiftieth of the noise.
#[test]
fn stopping_by_noise_changes_no_mean_by_more_than_a_tenth_of_it() {
    const NOISE: f64 = 0.05;
    let target = Target::new(NOISE, 0.0, ToneMap::None).unwrap();
    let scene = shipped("cornell_path");
    let until = |posed: &Posed| rendered(posed, &target, DeviceWish::Cpu, Traversal::default());
    let fixed = |posed: &Posed| {
        let backend = Backend::new(&Choice { device: DeviceWish::Cpu, ..Choice::default() }).unwrap();
        let view = posed.view.part(posed.view.region(), 0..96).unwrap();
        backend.open(&posed.packed).unwrap().expose(&view, &|_| ()).unwrap()
    };
    let ((own, samples), (want, _)) = (mean(&scene, until), mean(&scene, fixed));
    let stopped = samples.iter().filter(|&&count| count < 256).count();
    assert!(stopped > samples.len() / 2 && samples.iter().any(|&count| count > 64), "{stopped} of {}", samples.len());
    for cell in 0..2 {
        let pixels = (0..256).map(|i| i / 16 * 32 + cell * 16 + i % 16);
        let share = |i: usize| (own[i] - want[i]) / want[i].max(Target::FLOOR);
        let bias = pixels.map(share).sum::<f64>() / 256.0;
        assert!(bias.abs() < NOISE / 10.0, "cell {cell}: {bias}");
    }
}
