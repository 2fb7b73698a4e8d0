//! What the whole-program tests share: the shipped scenes, the GPU at hand, and pictures side by side.

pub mod bare;
pub mod brute_force;
pub mod count;
pub mod covered;
pub mod driver;
pub mod machine;
pub mod model;
pub mod numbers;
pub mod prism;
pub mod random;
pub mod surface;

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use eyerays::compare::compare;
use eyerays::cpu;
use eyerays::gpu::{AdapterRequest, Gpu, Renderer, wgpu};
use eyerays::job::Job;
use eyerays::method::{Layout, Method, Order, Scheduling, Traversal};
use eyerays::picture::Picture;
use eyerays::rays::Rays;
use eyerays::scene::{Camera, Direct, Scene, Settings, Transport};
use eyerays::scene_io;
use eyerays::view::View;
use eyerays_bvh::Quality;
use eyerays_shader::data::Tuning;

/// The scenes that the project ships for Whitted's model.
pub const SHIPPED: [&str; 4] = ["cornell", "whitted", "glass", "lights"];

/// Those whose light is sampled.
pub const SAMPLED: [&str; 4] = ["cornell_path", "soft_shadows", "bleeding", "occlusion"];

/// A shipped scene by its name.
///
/// # Panics
/// If it does not load.
pub fn shipped(name: &str) -> Scene {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let (scene, _) = scene_io::load(&folder.join(name).with_extension("toml")).unwrap_or_else(|e| panic!("{e}"));
    scene
}

/// The scene's own settings at another size and number of samples.
pub fn settings(scene: &Scene, size: (u32, u32), samples: u32) -> Settings {
    Settings { size, samples, spp: 0, ..scene.settings }
}

/// The same settings, but for the way to find lights with extent.
pub fn by(direct: Direct, settings: Settings) -> Settings {
    Settings { transport: Transport { direct, ..settings.transport }, ..settings }
}

/// A scene packed at medium quality.
///
/// # Panics
/// If no device could hold it.
pub fn pack(scene: &Scene, camera: &Camera, settings: Settings) -> Posed {
    pack_in(scene, camera, settings, Quality::Medium)
}

/// The same at some quality.
///
/// # Panics
/// As [`pack`].
pub fn pack_in(scene: &Scene, camera: &Camera, settings: Settings, quality: Quality) -> Posed {
    let packed = Job::with_wide_nodes(scene, settings, quality).unwrap_or_else(|e| panic!("{e}"));
    let view = View::new(&packed, camera).unwrap_or_else(|e| panic!("{e}"));
    Posed { packed, view }
}

/// A scene before a camera.
pub struct Posed {
    /// The scene.
    pub packed: Job,
    /// The camera's view.
    pub view: View,
}

impl std::ops::Deref for Posed {
    type Target = Job;

    fn deref(&self) -> &Job {
        &self.packed
    }
}

/// The GPU that tests run on, a software one such as lavapipe too: `EYERAYS_ADAPTER` names one, else it is
/// the best. Without any, a test has nothing to do and says so, unless `EYERAYS_REQUIRE_GPU` is `1`.
///
/// A process opens one for each precision and route, and never closes it: lavapipe has crashed once while threads opened and closed
/// devices beside each other.
///
/// # Panics
/// If there is none and there must be.
pub fn gpu(want: &AdapterRequest) -> Option<Gpu> {
    static OPEN: Mutex<Vec<([bool; 2], Gpu)>> = Mutex::new(Vec::new());
    let kind = [want.exact, want.naga];
    let want = AdapterRequest { software: true, adapter: std::env::var("EYERAYS_ADAPTER").ok(), ..want.clone() };
    let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, gpu)) = open.iter().find(|(other, _)| *other == kind) {
        return Some(gpu.clone());
    }
    match Gpu::open(&want) {
        Ok(gpu) => {
            open.push((kind, gpu.clone()));
            Some(gpu)
        }
        Err(error) => {
            let required = std::env::var("EYERAYS_REQUIRE_GPU").is_ok_and(|value| value == "1");
            assert!(!required, "EYERAYS_REQUIRE_GPU=1, but {error}");
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// The adapter that a GPU was opened of, to open a device as a window does.
///
/// # Panics
/// If it is there no more.
pub fn adapter(of: &Gpu) -> wgpu::Adapter {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
    let own = adapters.into_iter().find(|adapter| adapter.get_info().name == of.report.name);
    own.expect("it was there to be opened")
}

/// One that has exact precision, and whose compiler is quick: lavapipe's optimizer needs minutes for the kernels of paths unless
/// `GALLIVM_PERF=nopt` turns it off.
pub fn quick_gpu() -> Option<Gpu> {
    gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }).filter(|gpu| {
        let is_slow = gpu.report.is_software() && std::env::var_os("GALLIVM_PERF").is_none_or(|value| value != "nopt");
        if is_slow {
            eprintln!("skipped: {} compiles such kernels for minutes without GALLIVM_PERF=nopt", gpu.report.name);
        }
        !is_slow
    })
}

/// Every method; the hybrids parting early, late, and as they do by default; single rays persistent too, and
/// each of the other switches once.
pub fn traversals() -> Vec<Traversal> {
    let mut all = Vec::new();
    for method in Method::ALL {
        all.push(Traversal::from(method));
        let limits: &[(u32, u32)] = match method {
            Method::SequentialStack | Method::InterleavedStack => &[(1, 0), (63, 0)],
            Method::SequentialCut | Method::InterleavedCut => &[(63, 0), (63, 100)],
            _ => &[],
        };
        let tuned = |&(stack, cut): &(u32, u32)| Traversal { tuning: Tuning::new(stack, cut), ..method.into() };
        all.extend(limits.iter().map(tuned));
        if method.is_resumable() {
            all.push(Traversal { scheduling: Scheduling::Persistent, ..method.into() });
        }
    }
    all.push(Traversal::default());
    for order in [Order::Linear, Order::Morton] {
        all.push(Traversal { order, ..Method::IfIf.into() });
    }
    for layout in [Layout::Indexed, Layout::Compact] {
        all.push(Traversal { layout, ..Method::IfIf.into() });
    }
    all
}

/// Renders on the CPU in exact precision by the default method, with a thread a core. Compiled here once: every test that
/// names the arithmetic itself compiles all kernels again.
///
/// # Panics
/// If there is no memory for the picture.
pub fn on_cpu(posed: &Posed) -> (Picture, Rays) {
    rendered::<f32>(posed)
}

/// The same in double precision, with a thread a core.
///
/// # Panics
/// As [`on_cpu`].
pub fn in_double_precision(posed: &Posed) -> (Picture, Rays) {
    rendered::<f64>(posed)
}

fn rendered<R: cpu::Number>(posed: &Posed) -> (Picture, Rays) {
    cpu::render::<R>(&posed.packed, &posed.view, Traversal::default(), 0, &|_| ()).unwrap_or_else(|e| panic!("{e}"))
}

/// Asserts that two pictures have the same bits.
///
/// # Panics
/// If they have not, with the differences.
pub fn assert_same_bits(a: &Picture, b: &Picture, what: &str) {
    let comparison = compare(a, b).unwrap_or_else(|e| panic!("{what}: {e}"));
    assert!(a.bits_equal(b) && comparison.bit_equal, "{what}:\n{comparison}");
}

/// Asserts that all methods of a CPU, and a GPU that compiles kernels of paths soon, give a scene the same bits, all of them finite.
///
/// # Panics
/// They do not.
pub fn assert_same_on_all_ways(posed: &Posed) {
    let (want, rays) = on_cpu(posed);
    assert_eq!(rays.non_finite, 0);
    for method in Method::ALL {
        let (got, _) = cpu::render::<f32>(posed, &posed.view, method, 2, &|_| ()).unwrap();
        assert_same_bits(&want, &got, &format!("{method:?}"));
    }
    if let Some(gpu) = quick_gpu() {
        let mut renderer = Renderer::new(&gpu, posed, true, Traversal::default()).unwrap();
        let got = renderer.render(&posed.view, &|_| ()).unwrap().film.develop().unwrap();
        assert_same_bits(&got, &want, "GPU");
    }
}

/// The mean of the green of all pixels, which see the same, and its standard error.
pub fn mean(picture: &Picture) -> (f64, f64) {
    let values: Vec<f64> = picture.pixels.iter().map(|pixel| f64::from(pixel[1])).collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (square / count).sqrt())
}

/// The largest difference of a channel of each pixel, row-major from the top left.
pub fn differences(a: &Picture, b: &Picture) -> Vec<f32> {
    let channel = |(a, b): (&f32, &f32)| (a - b).abs();
    let pixel = |(a, b): (&[f32; 3], &[f32; 3])| a.iter().zip(b).map(channel).fold(0.0, f32::max);
    a.pixels.iter().zip(&b.pixels).map(pixel).collect()
}
