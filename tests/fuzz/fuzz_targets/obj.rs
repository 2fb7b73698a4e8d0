//! A Wavefront mesh.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(init: eyerays_fuzz::start(), |bytes: &[u8]| eyerays_fuzz::read("file.obj", bytes));
