//! Fast precision by both routes to the driver: passthrough, and naga's, which machines without Vulkan take.

use eyerays::cpu;
use eyerays::gpu::{Renderer, Route, Want};
use eyerays::method::Method;
use eyerays_shader::modules;
use eyerays_tests::{SHIPPED, differences, gpu, pack, settings, shipped};

/// At least 99.9 % of the pixels lie within 1e-4 of exact. (Measured with lavapipe at this size, over every scene
/// and method: all do, and all but one of 19,200 within 1e-5.)
fn assert_near(naga: bool) {
    let Some(gpu) = gpu(&Want { naga, ..Want::default() }) else { return };
    assert!(!naga || gpu.route == Route::Naga);
    for name in SHIPPED {
        let scene = shipped(name);
        let packed = pack(&scene, &scene.cameras[0], settings(&scene, (160, 120), 1));
        let (exact, _) = cpu::render::<f32>(&packed, Method::default(), 0, &|_| ()).unwrap();
        for method in methods(name) {
            let renderer = Renderer::new(&gpu, &packed, false, method).unwrap_or_else(|e| panic!("{name}: {e}"));
            let fast = renderer.render(&|_| ()).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(fast.rays.non_finite, 0, "{name}, {method:?}");
            let differences = differences(&exact, &fast.film);
            let far = differences.iter().filter(|&&difference| difference > 1e-4).count();
            assert!(1000 * far <= differences.len(), "{name}, {method:?}: {far} pixels of {}", differences.len());
        }
    }
}

/// Compiling kernels takes the time here, so that one scene must do for the methods that are not the default.
fn methods(scene: &str) -> Vec<Method> {
    if scene == "whitted" { Method::ALL.to_vec() } else { vec![Method::default()] }
}

#[test]
fn passthrough() {
    assert_near(false);
}

#[test]
fn through_naga() {
    assert_near(true);
}

#[test]
fn naga_accepts_the_fast_modules() {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    for (spirv, capabilities) in
        [(modules::FAST, Capabilities::empty()), (modules::FAST_SUBGROUP, Capabilities::SUBGROUP)]
    {
        let module = naga::front::spv::parse_u8_slice(spirv, &naga::front::spv::Options::default()).unwrap();
        assert!(!module.entry_points.is_empty());
        Validator::new(ValidationFlags::all(), capabilities).validate(&module).unwrap();
    }
}
