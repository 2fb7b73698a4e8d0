//! Prints what the compiler of the first GPU's driver tells of the kernels of scenes, as a table: registers, spilled ones, sizes.
//!
//! ```sh
//! cargo run --release -p eyerays-tests --example statistics -- scenes/room.toml scenes/cornell_path.toml
//! ```

use std::path::Path;

use eyerays::scene_io;
use eyerays_tests::driver::{Driver, kernels};
use eyerays_tests::pack;

fn main() {
    let scenes: Vec<String> = std::env::args().skip(1).collect();
    let Some(driver) = Driver::open() else {
        eprintln!("no driver here tells of its compiler's work (VK_KHR_pipeline_executable_properties)");
        std::process::exit(1);
    };
    println!("{}\n", driver.name);
    for path in &scenes {
        let (scene, _) = scene_io::load(Path::new(path)).unwrap_or_else(|e| panic!("{e}"));
        let packed = pack(&scene, &scene.cameras[0], scene.settings).packed;
        for (name, kernel) in kernels(&packed) {
            let told = driver.compile(&kernel, &name).unwrap_or_else(|e| panic!("{path}, {name}: {e}"));
            let told: Vec<String> = told.iter().map(|(what, number)| format!("{what} {number}")).collect();
            println!("{path}, {name}, {} instructions of SPIR-V: {}", kernel.instructions(), told.join(", "));
        }
    }
}
