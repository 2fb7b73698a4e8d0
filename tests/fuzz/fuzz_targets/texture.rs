//! A texture or an environment.
#![no_main]

use std::io::Cursor;

use libfuzzer_sys::fuzz_target;

fuzz_target!(init: eyerays_fuzz::start(), |bytes: &[u8]| {
    if let Err(error) = eyerays::image::decode_texture("texture", Cursor::new(bytes)) {
        eyerays_fuzz::check_line(&error);
    }
});
