//! A file of strands, binary if it begins as one, and a scene of it.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(init: eyerays_fuzz::start(), |bytes: &[u8]| {
    let name = if bytes.starts_with(b"HAIR") { "file.hair" } else { "file.txt" };
    eyerays_fuzz::place(name, bytes);
    eyerays_fuzz::read("file.toml", format!("[[mesh]]\nfile = \"{name}\"\nsides = 3\ntolerance = 0.2\n").as_bytes());
});
