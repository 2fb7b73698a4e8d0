//! A library of materials, and a mesh that takes two of them.
#![no_main]

use libfuzzer_sys::fuzz_target;

const MESH: &str =
    "mtllib file.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl one\nf 1/1 2/1 3/1\nusemtl two\nf 1 3 2\n";

fuzz_target!(init: eyerays_fuzz::start(), |bytes: &[u8]| {
    eyerays_fuzz::place("file.mtl", bytes);
    eyerays_fuzz::read("file.obj", MESH.as_bytes());
});
