//! A glTF file, binary if it begins as one.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(init: eyerays_fuzz::start(), |bytes: &[u8]| {
    let name = if bytes.starts_with(b"glTF") { "file.glb" } else { "file.gltf" };
    eyerays_fuzz::read(name, bytes);
});
