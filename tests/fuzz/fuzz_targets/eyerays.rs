//! A binary scene. Fuzzers set `cfg(fuzzing)`, under which no hash is compared: files get past it to all that comes after.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(init: eyerays_fuzz::start(), |bytes: &[u8]| eyerays_fuzz::read("file.eyerays", bytes));
