//! Layers of OpenEXR files, read one by one.

use std::fs;
use std::io::Cursor;

use ::exr::prelude::{
    AnyChannel, AnyChannels, Encoding as Compression, FlatSamples, Image, ImageAttributes, IntegerBounds,
    Layer as Part, LayerAttributes, SmallVec, WritableImage, f16,
};

use super::tests::{odd_picture, striped_picture};
use super::*;
use crate::compare::compare;
use crate::layers::{Layer, Values};
use crate::picture::Picture;

type Channels = [(&'static str, FlatSamples)];

fn floats(values: [f32; 6]) -> FlatSamples {
    FlatSamples::F32(values.to_vec())
}

/// A part of 3 x 2 pixels.
fn part(name: &str, channels: &Channels) -> Part<AnyChannels<FlatSamples>> {
    let list: SmallVec<[_; 4]> =
        channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone())).collect();
    Part::new((3, 2), LayerAttributes::named(name), Compression::SMALL_LOSSLESS, AnyChannels::sort(list))
}

fn file(parts: &[Part<AnyChannels<FlatSamples>>]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions((3, 2)));
    let image = Image::from_layers(attributes, parts.iter().cloned().collect::<SmallVec<[_; 2]>>());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn layer(bytes: &[u8], name: &str) -> Picture {
    decode_layer(Cursor::new(bytes), name).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn refusal(bytes: &[u8], name: &str) -> String {
    decode_layer(Cursor::new(bytes), name).expect_err(name).message()
}

fn greys(values: [f32; 6]) -> Picture {
    Picture::from_pixels(3, 2, values.map(|value| [value; 3]).to_vec()).unwrap()
}

const STEPS: [f32; 6] = [0.0, -0.0, f32::INFINITY, 1e-30, -4.5, 1e30];

#[test]
fn layers_that_are_written_are_read_with_every_bit() {
    let (light, vectors) = (odd_picture(), odd_picture());
    let layers = [
        (Layer::Albedo, Values::Colours(light.clone())),
        (Layer::Normal, Values::Vectors(vectors.clone())),
        (Layer::Depth, Values::Lengths(STEPS.to_vec())),
        (Layer::Object, Values::Numbers(vec![0, 1, 2, 3, 4, 1 << 24])),
    ];
    let mut bytes = Vec::new();
    encode_layers(&light, &layers, &Encoding::default(), &mut bytes).unwrap();
    for (name, values) in [("colour", &light), ("albedo", &light), ("normal", &vectors), ("depth", &greys(STEPS))] {
        let picture = layer(&bytes, name);
        assert!(picture.bits_equal(values), "{name}: {picture:?}");
    }
    assert!(layer(&bytes, "object").bits_equal(&greys([0.0, 1.0, 2.0, 3.0, 4.0, 16_777_216.0])));
    assert_eq!(refusal(&bytes, "direct"), "has no layer \"direct\"; it has albedo, colour, depth, normal, object");
}

#[test]
fn equal_infinities_are_no_difference_and_others_are() {
    let [a, b] = [STEPS, STEPS.map(f32::abs)].map(greys);
    assert!(compare(&a, &a).unwrap().bit_equal && !compare(&a, &a).unwrap().exceeds(0.5));
    assert_eq!(compare(&a, &b).unwrap().largest_difference, 9.0);
    assert!(compare(&a, &greys([0.0; 6])).unwrap().largest_difference.is_infinite());
}

#[test]
fn channels_of_other_programs_are_layers_too() {
    let bytes = file(&[part(
        "main",
        &[
            ("ViewLayer.Depth.Z", floats(STEPS)),
            ("N.x", floats([1.0; 6])),
            ("N.y", floats([2.0; 6])),
            ("N.z", floats([3.0; 6])),
            ("Z", floats(STEPS)),
            ("mask", FlatSamples::F16(vec![f16::from_f32(0.5); 6])),
            ("fog.V", floats(STEPS)),
            ("glow.Y", floats(STEPS)),
            ("glow.A", floats([1.0; 6])),
            ("uv.U", floats([1.0; 6])),
            ("uv.V", floats([1.0; 6])),
            ("crypto", FlatSamples::U32(vec![u32::MAX; 6])),
        ],
    )]);
    for name in ["ViewLayer.Depth", "Z", "fog", "glow"] {
        assert!(layer(&bytes, name).bits_equal(&greys(STEPS)), "{name}");
    }
    assert_eq!(layer(&bytes, "N").pixels, [[1.0, 2.0, 3.0]; 6]);
    assert_eq!(layer(&bytes, "mask").pixels, [[0.5; 3]; 6]);
    assert!(refusal(&bytes, "uv").starts_with("has a layer \"uv\" of the channels U, V; "));
    assert!(refusal(&bytes, "crypto").starts_with("has the number 4294967295; those above 16777216 are not read"));
}

#[test]
fn a_part_of_a_file_is_a_layer_of_its_name() {
    let light = part("beauty", &[("R", floats([1.0; 6])), ("G", floats([2.0; 6])), ("B", floats([3.0; 6]))]);
    let bytes = file(&[part("far", &[("Z", floats(STEPS))]), light]);
    assert!(layer(&bytes, "far").bits_equal(&greys(STEPS)));
    assert_eq!(layer(&bytes, "beauty").pixels, [[1.0, 2.0, 3.0]; 6]);
    assert_eq!(refusal(&bytes, "near"), "has no layer \"near\"; it has beauty, far");
}

#[test]
fn greys_are_a_picture_of_three_equal_channels() {
    let bytes = file(&[part("main", &[("Y", floats(STEPS)), ("A", floats([1.0; 6])), ("depth.Z", floats([7.0; 6]))])]);
    assert!(decode(Cursor::new(&bytes)).unwrap().bits_equal(&greys(STEPS)));
    assert!(layer(&bytes, "colour").bits_equal(&greys(STEPS)));
    let differences = [("Y", floats(STEPS)), ("RY", floats(STEPS)), ("BY", floats(STEPS))];
    let error = decode(Cursor::new(file(&[part("main", &differences)]))).unwrap_err().message();
    assert!(error.contains("no channels called R, G and B"), "{error}");
}

#[test]
fn data_beside_the_display_are_cut_off_and_what_they_leave_out_is_black() {
    let attributes = LayerAttributes::named("main").with_position((-1, 1).into());
    let list: SmallVec<[_; 4]> = [AnyChannel::new("Y", floats([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))].into_iter().collect();
    let shifted = Part::new((3, 2), attributes, Compression::SMALL_LOSSLESS, AnyChannels::sort(list));
    let bytes = file(&[shifted]);
    assert!(layer(&bytes, "colour").bits_equal(&greys([0.0, 0.0, 0.0, 2.0, 3.0, 0.0])));
}

#[test]
fn a_missing_layer_is_an_error_that_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    fs::write(&path, file(&[part("main", &[("Y", floats(STEPS))])])).unwrap();
    let error = read_layer(&path, "depth").unwrap_err().to_string();
    assert!(error.ends_with("a.exr: has no layer \"depth\"; it has colour"), "{error}");
    let mut png = Vec::new();
    encode(&striped_picture(), Format::Png, &Encoding::default(), &mut png).unwrap();
    assert!(refusal(&png, "depth").contains("not an EXR image"));
}

#[test]
fn a_damaged_file_is_refused_or_read_but_no_panic() {
    let layers = [(Layer::Depth, Values::Lengths((0..striped_picture().pixels.len()).map(|i| i as f32).collect()))];
    let mut whole = Vec::new();
    encode_layers(&striped_picture(), &layers, &Encoding::default(), &mut whole).unwrap();
    let depth = layer(&whole, "depth");
    for end in 0..whole.len() {
        if let Ok(part) = decode_layer(Cursor::new(&whole[..end]), "depth") {
            assert!(part.bits_equal(&depth), "at {end}");
        }
    }
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x81;
        let _ = decode_layer(Cursor::new(&damaged), "depth");
    }
}

#[test]
fn a_layer_that_claims_more_data_than_a_picture_has_is_refused_before_memory_is_taken() {
    let bytes = file(&[part("main", &[("Y", floats(STEPS))])]);
    for window in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = bytes.windows(window.len()).position(|found| found == window).unwrap() + window.len() + 4;
        let mut damaged = bytes.clone();
        damaged[at + 8..at + 12].copy_from_slice(&1_000_000_000i32.to_le_bytes());
        for error in [refusal(&damaged, "colour"), decode(Cursor::new(&damaged)).unwrap_err().message()] {
            assert!(error.contains("too large"), "{error}");
        }
    }
}
