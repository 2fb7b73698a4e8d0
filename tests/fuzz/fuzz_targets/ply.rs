//! A mesh in the Polygon File Format.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(init: eyerays_fuzz::start(), |bytes: &[u8]| eyerays_fuzz::read("file.ply", bytes));
