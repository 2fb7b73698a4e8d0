//! What the targets have in common: a file of some bytes is a scene, or is refused in a line.
//!
//! ```text
//! cargo install cargo-fuzz
//! cd tests/fuzz && mkdir -p corpus/gltf && cargo +nightly fuzz run gltf --fuzz-dir . corpus/gltf seeds/gltf -- -max_total_time=3600 -max_len=16384
//! ```

use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;

use eyerays::cpu;
use eyerays::job::Job;
use eyerays::error::{Error, Result};
use eyerays::method::Traversal;
use eyerays::quality::Bvh;
use eyerays::scene::{Integrator, Scene, Settings, Transport};
use eyerays::scene_io;
use eyerays::view::View;

/// A scene of more is not packed: that is tried by other tests, and takes long.
const MOST_PRIMITIVES: usize = 1000;

/// Lets panics that a reader catches pass in silence. Others still end the fuzzer, which catches them itself.
pub fn start() {
    std::panic::set_hook(Box::new(|_| ()));
}

/// Reads a file of that name with these bytes, and draws what it holds.
pub fn read(name: &str, bytes: &[u8]) {
    let read = scene_io::load(&place(name, bytes));
    let drawn = read.and_then(|(scene, _)| if scene.primitives() <= MOST_PRIMITIVES { draw(&scene) } else { Ok(()) });
    if let Err(error) = drawn {
        check_line(&error);
    }
}

/// Draws a small picture of a scene.
fn draw(scene: &Scene) -> Result<()> {
    let transport = Transport { integrator: Integrator::Path, ..scene.settings.transport };
    let settings = Settings { size: (4, 4), samples: 1, spp: 1, bounces: 2, transport, ..scene.settings };
    let packed = Job::new(scene, settings, Bvh::Fast.quality())?;
    let view = View::new(&packed, &scene.cameras[0])?;
    cpu::render::<f32>(&packed, &view, Traversal::default(), 1, &|_| ()).map(drop)
}

/// Keeps a file of that name with these bytes.
pub fn place(name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder().join(name);
    fs::write(&path, bytes).expect("there is room for a file");
    path
}

/// What is refused is refused in one line.
pub fn check_line(error: &Error) {
    let line = error.to_string();
    assert!(!line.is_empty() && !line.contains('\n'), "{line:?} is no line");
}

/// This process' folder for files, emptied by the next process of its number.
fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("eyerays-fuzz-{}", std::process::id()));
        fs::remove_dir_all(&folder).ok();
        fs::create_dir_all(&folder).expect("there is a folder for temporary files");
        folder
    })
}
