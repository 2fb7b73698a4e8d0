//! Fast precision by both routes to the driver: passthrough, and naga's, which machines without Vulkan take.

use eyerays::gpu::{AdapterRequest, Gpu, Renderer, Route};
use eyerays::method::{Method, Traversal};
use eyerays::scene::Settings;
use eyerays_passes::Kernels;
use eyerays_shader::data::{Launch, Specialisation};
use eyerays_tests::{Posed, SHIPPED, differences, gpu, on_cpu, pack, settings, shipped};

/// At least 99.9 % of the pixels lie within 1e-4 of exact. (Measured with lavapipe at this size, over every scene
/// and method: all do, and all but one of 19,200 within 1e-5.)
fn assert_near(gpu: &Gpu, packed: &Posed, traversal: Traversal, what: &str) {
    let (exact, _) = on_cpu(packed);
    let mut renderer = Renderer::new(gpu, packed, false, traversal).unwrap_or_else(|e| panic!("{what}: {e}"));
    let fast = renderer.render(&packed.view, &|_| ()).unwrap_or_else(|e| panic!("{what}: {e}"));
    assert_eq!(fast.film.rays().non_finite, 0, "{what}");
    let differences = differences(&exact, &fast.film.develop().unwrap());
    let far = differences.iter().filter(|&&difference| difference > 1e-4).count();
    assert!(1000 * far <= differences.len(), "{what}: {far} pixels of {} differ", differences.len());
}

fn assert_scenes_near(naga: bool) {
    let Some(gpu) = gpu(&AdapterRequest { naga, ..AdapterRequest::default() }) else { return };
    assert!(!naga || gpu.route == Route::Naga);
    for name in SHIPPED {
        let scene = shipped(name);
        let packed = pack(&scene, &scene.cameras[0], settings(&scene, (160, 120), 1));
        assert_near(&gpu, &packed, Traversal::default(), name);
    }
}

#[test]
fn passthrough() {
    assert_scenes_near(false);
}

#[test]
fn through_naga() {
    assert_scenes_near(true);
}

/// Primary rays alone, since every method compiles kernels of its own.
#[test]
fn methods_through_naga() {
    let Some(gpu) = gpu(&AdapterRequest { naga: true, ..AdapterRequest::default() }) else { return };
    let mut scene = shipped("whitted");
    scene.lights.clear();
    let packed = pack(&scene, &scene.cameras[0], Settings { bounces: 0, ..settings(&scene, (160, 120), 1) });
    for method in Method::ALL {
        assert_near(&gpu, &packed, method.into(), &format!("{method:?}"));
    }
}

#[test]
fn naga_accepts_the_fast_modules() {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    let check = |spirv: &[u8], capabilities| {
        let module = naga::front::spv::parse_u8_slice(spirv, &naga::front::spv::Options::default()).unwrap();
        assert!(!module.entry_points.is_empty());
        Validator::new(ValidationFlags::all(), capabilities).validate(&module).unwrap();
    };
    check(eyerays_modules::fast(), Capabilities::SUBGROUP);
    // What does not vote asks for no subgroups.
    let kernels = Kernels::parse(eyerays_modules::fast()).unwrap();
    for name in kernels.names().iter().filter(|name| name.starts_with("fast::")) {
        let spec = Specialisation::default().with_launch(Launch::GOES_ON);
        let words = kernels.cut(name, &spec.constants()).unwrap().words();
        check(bytemuck::cast_slice(&words), Capabilities::empty());
    }
}
