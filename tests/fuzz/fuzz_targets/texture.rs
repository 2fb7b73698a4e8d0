//! A texture or an environment.
#![no_main]

use std::io::Cursor;

use eyerays::image::{TextureBudget, decode_texture};
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: eyerays_fuzz::start(), |bytes: &[u8]| {
    if let Err(error) = decode_texture("texture", Cursor::new(bytes), &mut TextureBudget::default()) {
        eyerays_fuzz::check_line(&error);
    }
});
