//! A layer of an EXR file of another program, as `diff --layer` reads it.
#![no_main]

use std::io::Cursor;

use eyerays::image::decode_layer;
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: eyerays_fuzz::start(), |bytes: &[u8]| {
    if let Err(error) = decode_layer(Cursor::new(bytes), "albedo") {
        eyerays_fuzz::check_line(&error);
    }
});
