//! Kernels in the compiler of a driver that this machine has no device for: Mesa's RADV on null hardware.

use std::path::{Path, PathBuf};
use std::process::Command;

use eyerays::scene_io;
use eyerays_tests::driver::{Driver, kernels};
use eyerays_tests::{pack, settings};

/// The family of GPUs that RADV compiles for without one.
const FAMILY: (&str, &str) = ("RADV_FORCE_FAMILY", "navi21");

/// More than any kernel's instructions there: `finishes`, which has coats, fibres, films and all else at once, has the most, 18,816, and
/// no register of it is spilled to memory; of the others `frosted` has, 11,094.
const MOST: f64 = 22_000.0;

/// Mesa's compiler needs more than a thread's usual stack.
const STACK: usize = 64 << 20;

fn radv() -> Option<PathBuf> {
    let all = std::fs::read_dir("/usr/share/vulkan/icd.d").ok()?;
    all.filter_map(|entry| Some(entry.ok()?.path())).find(|path| path.to_string_lossy().contains("radeon_icd"))
}

fn shipped_scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let all = std::fs::read_dir(folder).expect("the scenes").map(|entry| entry.expect("a file").path());
    let mut scenes: Vec<_> = all.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    scenes.sort();
    scenes
}

/// The driver is chosen by the environment, which a process has for itself.
#[test]
fn every_kernel_of_every_shipped_scene_compiles_for_a_gpu_that_is_not_here() {
    if std::env::var(FAMILY.0).is_ok() {
        std::thread::Builder::new().stack_size(STACK).spawn(compile_all).expect("a thread").join().expect("no panic");
        return;
    }
    let Some(driver) = radv() else {
        println!("left out: Mesa's driver of AMD GPUs is not installed");
        return;
    };
    let name = "every_kernel_of_every_shipped_scene_compiles_for_a_gpu_that_is_not_here";
    let again = Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", name, "--nocapture"])
        .env(FAMILY.0, FAMILY.1)
        .env("VK_DRIVER_FILES", &driver)
        .env("VK_ICD_FILENAMES", &driver)
        .output()
        .expect("the same test again");
    println!("{}", String::from_utf8_lossy(&again.stdout));
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
}

fn compile_all() {
    let driver = Driver::open().expect("RADV on null hardware");
    let scenes = shipped_scenes();
    assert!(scenes.len() >= 12, "{scenes:?}");
    for path in scenes {
        let (scene, _) = scene_io::load(&path).unwrap_or_else(|e| panic!("{e}"));
        let packed = pack(&scene, &scene.cameras[0], settings(&scene, (64, 64), 1)).packed;
        for (name, kernel) in kernels(&packed) {
            let told = driver.compile(&kernel, &name).unwrap_or_else(|e| panic!("{}, {name}: {e}", path.display()));
            let instructions = told.iter().find(|(what, _)| what == "Instructions").expect("RADV counts them").1;
            println!("{}, {name}: {instructions} instructions", path.file_stem().expect("a name").display());
            assert!(instructions > 0.0 && instructions < MOST, "{}, {name}: {told:?}", path.display());
        }
    }
}
