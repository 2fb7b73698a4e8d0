use std::io::{self, Cursor, Write};
use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::about::About;
use crate::layers::{Layer, Values};
use crate::picture::Picture;

pub(super) const FORMATS: [Format; 3] = [Format::Png, Format::Exr, Format::Hdr];

pub(super) const SIXTEEN: Encoding =
    Encoding { exposure_ev: 0.0, bits: BitDepth::Sixteen, half: false, tone: ToneMap::None, white: None };

pub(super) fn bytes(picture: &Picture, format: Format, encoding: &Encoding) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode(picture, format, encoding, &mut bytes).unwrap();
    bytes
}

fn round_trip(picture: &Picture, format: Format, encoding: &Encoding) -> Picture {
    decode(Cursor::new(bytes(picture, format, encoding))).unwrap()
}

/// A picture with every kind of value.
pub(super) fn odd_picture() -> Picture {
    let values = [
        [0.0, -0.0, 1.0],
        [0.5, 0.18, 1e-6],
        [-1.0, 3.5, 1e30],
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY],
        [f32::MIN_POSITIVE, f32::from_bits(1), f32::MAX],
        [f32::from_bits(0xffc0_1234), 1e-45, 2.0],
    ];
    Picture::from_pixels(3, 2, values.to_vec()).unwrap()
}

#[test]
fn exr_keeps_every_bit() {
    let picture = odd_picture();
    let back = round_trip(&picture, Format::Exr, &Encoding::default());
    assert!(picture.bits_equal(&back), "{back:?}");
}

#[test]
fn layers_are_channels_of_their_names_with_numbers_as_they_are() {
    use ::exr::prelude::{FlatSamples, read_first_flat_layer_from_file};
    let picture = |value: f32| Picture::from_pixels(2, 1, vec![[value, 2.0 * value, -value], [value; 3]]).unwrap();
    let layers = [
        (Layer::Normal, Values::Vectors(picture(0.5))),
        (Layer::Object, Values::Numbers(vec![0, u32::MAX])),
        (Layer::Depth, Values::Lengths(vec![f32::INFINITY, 1e-30])),
        (Layer::Direct, Values::Light(picture(0.25))),
    ];
    let encoding = Encoding { exposure_ev: 1.0, half: true, ..Encoding::default() };
    let mut bytes = Vec::new();
    encode_layers(&picture(1.0), &layers, &encoding, &mut bytes).unwrap();
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), &bytes).unwrap();
    let image = read_first_flat_layer_from_file(file.path()).unwrap();
    let channels: Vec<_> =
        image.layer_data.channel_data.list.iter().map(|c| (c.name.to_string(), &c.sample_data)).collect();
    let names: Vec<_> = channels.iter().map(|(name, _)| name.as_str()).collect();
    let expected =
        ["B", "G", "R", "depth.Z", "direct.B", "direct.G", "direct.R", "normal.X", "normal.Y", "normal.Z", "object.id"];
    assert_eq!(names, expected);
    let of = |name: &str| channels.iter().find(|(own, _)| own == name).unwrap().1.clone();
    assert_eq!(of("object.id"), FlatSamples::U32(vec![0, u32::MAX]));
    assert_eq!(of("depth.Z"), FlatSamples::F32(vec![f32::INFINITY, 1e-30]));
    let halves = |values: [f32; 2]| FlatSamples::F16(values.map(::exr::prelude::f16::from_f32).into());
    // Light is exposed, other vectors are not.
    assert_eq!((of("direct.G"), of("normal.Y"), of("R")), (halves([1.0, 0.5]), halves([1.0, 0.5]), halves([2.0, 2.0])));
    let short = [(Layer::Depth, Values::Lengths(vec![1.0]))];
    let error = encode_layers(&picture(1.0), &short, &encoding, &mut Vec::new()).unwrap_err();
    assert_eq!(error.to_string(), "the layer depth has other pixels than the picture; render it again");
    // Who asks for no layer reads the picture.
    assert_eq!(decode(Cursor::new(&bytes)).unwrap().pixels, [[2.0, 4.0, -2.0], [2.0; 3]]);
}

#[test]
fn an_exr_is_compressed_and_its_bytes_do_not_hang_on_the_threads() {
    let flat = Picture::new(256, 1100).unwrap();
    let size = flat.pixels.len() * 12;
    assert!(bytes(&flat, Format::Exr, &Encoding::default()).len() < size / 50);
    let noise =
        (0..flat.pixels.len() as u32).map(|i| [0, 1, 2].map(|c| f32::from_bits((3 * i + c).wrapping_mul(0x9e37_79b9))));
    let noise = Picture::from_pixels(256, 1100, noise.collect()).unwrap();
    let of_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bytes(&noise, Format::Exr, &Encoding::default()))
    };
    let (one, many) = (of_threads(1), of_threads(5));
    assert!(one == many);
    assert!(noise.bits_equal(&decode(Cursor::new(one)).unwrap()));
}

#[test]
fn half_an_exr_has_the_nearest_floats_of_16_bits_and_keeps_the_finite_finite() {
    let half = |exposure_ev| Encoding { exposure_ev, half: true, ..Encoding::default() };
    let values = [
        [0.1, -0.0, 65_504.0],
        [65_519.9, 65_520.0, -1e30],
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY],
        [6e-8, 1e-9, f32::MAX],
    ];
    let picture = Picture::from_pixels(2, 2, values.to_vec()).unwrap();
    let back = round_trip(&picture, Format::Exr, &half(0.0));
    assert_eq!(back.pixels[0], [0.099_975_586, 0.0, 65_504.0]);
    assert!(back.pixels[0][1].is_sign_negative());
    assert_eq!(back.pixels[1], [65_504.0, 65_504.0, -65_504.0]);
    assert!(back.pixels[2][0].is_nan());
    assert_eq!(back.pixels[2][1..], [f32::INFINITY, f32::NEG_INFINITY]);
    assert_eq!(back.pixels[3], [2f32.powi(-24), 0.0, 65_504.0]);
    let brighter = round_trip(&picture, Format::Exr, &half(1.0));
    assert_eq!(brighter.pixels[0], [0.199_951_17, 0.0, 65_504.0]);
    let noise = (0..4096).map(|i| [i, i + 1, i + 2].map(|i| (i * 7919 % 4099) as f32 / 4099.0)).collect();
    let noise = Picture::from_pixels(64, 64, noise).unwrap();
    let (whole, halved) = (bytes(&noise, Format::Exr, &Encoding::default()), bytes(&noise, Format::Exr, &half(0.0)));
    assert!(2 * halved.len() < whole.len() + 500, "{} {}", halved.len(), whole.len());
    for format in [Format::Png, Format::Hdr] {
        let error = encode(&picture, format, &half(0.0), io::sink()).unwrap_err();
        assert!(error == Error::NoHalf { format: format.name() }, "{error}");
    }
}

#[test]
fn png_keeps_every_value_it_has() {
    let depths = [(Encoding::default(), 255_u16), (SIXTEEN, 65_535)];
    for (encoding, steps) in depths {
        let table = transfer::linear_table(steps);
        let pixels = table.iter().map(|&v| [v, v, 1.0 - v]).collect::<Vec<_>>();
        let height = pixels.len() as u32 / 256;
        let picture = Picture::from_pixels(256, height, pixels).unwrap();
        let once = round_trip(&picture, Format::Png, &encoding);
        let kept = picture.pixels.iter().zip(&once.pixels);
        assert!(kept.clone().all(|(a, b)| a[..2] == b[..2]));
        assert!(once.bits_equal(&round_trip(&once, Format::Png, &encoding)));
        assert_eq!(bytes(&once, Format::Png, &encoding), bytes(&picture, Format::Png, &encoding));
    }
}

#[test]
fn hdr_keeps_a_hundredth_of_the_brightest_channel() {
    let values = [1e-30, 1e-3, 0.18, 0.999_999_94, 1.0, 200.0, 65_535.996, 1e30];
    let pixels = values.iter().map(|&v| [v, v / 3.0, 0.0]).collect();
    let picture = Picture::from_pixels(8, 1, pixels).unwrap();
    let back = round_trip(&picture, Format::Hdr, &Encoding::default());
    for (a, b) in picture.pixels.iter().zip(&back.pixels) {
        let close = a.iter().zip(b).all(|(x, y)| (x - y).abs() <= a[0] / 100.0);
        assert!(close, "{a:?} {b:?}");
    }
    assert!(back.bits_equal(&round_trip(&back, Format::Hdr, &Encoding::default())));
}

#[test]
fn hdr_just_below_a_power_of_two_has_the_lesser_exponent() {
    for power in [2f32.powi(-100), 0.25, 1.0, 1024.0, 2f32.powi(100)] {
        let picture = Picture::from_pixels(1, 1, vec![[power.next_down(), power / 2.0, 0.0]]).unwrap();
        let back = round_trip(&picture, Format::Hdr, &Encoding::default());
        assert_eq!(back.pixels[0], [255.0 / 256.0 * power, power / 2.0, 0.0]);
    }
}

#[test]
fn what_is_no_light_has_a_place_in_png_and_hdr() {
    let png = round_trip(&odd_picture(), Format::Png, &Encoding::default());
    assert_eq!(png.pixels[0], [0.0, 0.0, 1.0]);
    assert_eq!(png.pixels[2], [0.0, 1.0, 1.0]);
    assert_eq!(png.pixels[3], [0.0, 1.0, 0.0]);
    let hdr = round_trip(&odd_picture(), Format::Hdr, &Encoding::default());
    assert_eq!(hdr.pixels[3][0], 0.0);
    assert!(hdr.pixels[3][1] > 1.6e38 && hdr.pixels[3][2] == 0.0);
    assert!(hdr.pixels[4][2] > 1.6e38);
    let dark = Picture::from_pixels(1, 1, vec![[1e-40; 3]]).unwrap();
    let dark = round_trip(&dark, Format::Hdr, &Encoding::default());
    assert_eq!(dark.pixels[0], [0.0; 3]);
}

#[test]
fn exposure_applies_to_every_format() {
    let picture = Picture::from_pixels(1, 1, vec![[0.25, 0.125, 0.5]]).unwrap();
    let brighter = Encoding { exposure_ev: 1.0, ..SIXTEEN };
    for format in FORMATS {
        let back = round_trip(&picture, format, &brighter).pixels[0];
        let wanted = [0.5, 0.25, 1.0];
        let close = |(a, b): (&f32, f32)| (a - b).abs() < 1e-4;
        assert!(back.iter().zip(wanted).all(close), "{format}: {back:?}");
    }
    for exposure_ev in [f32::NAN, f32::INFINITY, -300.0] {
        let encoding = Encoding { exposure_ev, ..SIXTEEN };
        assert!(encode(&picture, Format::Exr, &encoding, io::sink()).is_err());
    }
}

#[test]
fn a_png_has_the_values_of_its_tone_map() {
    for tone in [ToneMap::None, ToneMap::Neutral, ToneMap::Agx] {
        for (bits, steps) in [(BitDepth::Eight, 255_u16), (BitDepth::Sixteen, 65_535)] {
            let encoding = Encoding { exposure_ev: 0.7, bits, tone, ..Encoding::default() };
            let table = transfer::linear_table(steps);
            let scale = encoding.scale().unwrap();
            let shown = |pixel: &[f32; 3]| {
                let exposed = pixel.map(|v| f64::from(v) * scale);
                tone.apply(exposed).map(|v| table[transfer::quantise(v, steps.into()) as usize])
            };
            for picture in [odd_picture(), striped_picture()] {
                let wanted: Vec<_> = picture.pixels.iter().map(shown).collect();
                assert_eq!(round_trip(&picture, Format::Png, &encoding).pixels, wanted, "{tone} {steps}");
            }
        }
        let encoding = Encoding { tone, ..Encoding::default() };
        for format in [Format::Exr, Format::Hdr] {
            let written = encode(&odd_picture(), format, &encoding, io::sink());
            assert_eq!(written.err(), (tone != ToneMap::None).then_some(Error::NoTone { format: format.name() }));
        }
    }
}

#[test]
fn png_says_what_it_is() {
    let picture = Picture::new(2, 2).unwrap();
    let png = bytes(&picture, Format::Png, &Encoding::default());
    let software = format!("tEXtSoftware\0eyerays {}", env!("CARGO_PKG_VERSION"));
    for chunk in [&b"sRGB\0"[..], software.as_bytes()] {
        let at = png.windows(chunk.len()).position(|w| w == chunk).unwrap();
        assert_eq!(png[at + chunk.len()..][..4], png_crc(chunk));
        assert_eq!(png[at - 4..at], (chunk.len() as u32 - 4).to_be_bytes());
    }
}

/// As other readers see it.
#[test]
fn a_picture_says_how_it_was_made() {
    let matrix: Vec<f32> = (0..16).map(|i| i as f32).collect();
    let about = About::default().with("scene", "café").with("samples", 3).with(About::WORLD_TO_NDC, matrix.clone());
    let picture = Picture { about: about.clone(), ..odd_picture() };
    let png = bytes(&picture, Format::Png, &Encoding::default());
    let reader = ::png::Decoder::new(io::Cursor::new(&png)).read_info().unwrap();
    let texts = &reader.info().uncompressed_latin1_text;
    let text = texts.iter().find(|text| text.keyword == "eyerays").unwrap();
    let of = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
    assert_eq!(of(&text.text), serde_json::Value::Object(about.facts().clone()));
    let exr = bytes(&picture, Format::Exr, &Encoding::default());
    let meta = ::exr::meta::MetaData::read_from_buffered(io::Cursor::new(&exr), true).unwrap();
    let own = &meta.headers[0].own_attributes;
    assert_eq!(own.world_to_normalized_device.map(Vec::from), Some(matrix));
    assert_eq!(own.world_to_camera, None);
    let Some(::exr::meta::attribute::AttributeValue::Text(text)) = own.other.get(&b"eyerays"[..]) else {
        panic!("no text: {own:?}");
    };
    assert_eq!(of(&text.to_string()), serde_json::Value::Object(about.facts().clone()));
    // Without anything to say, a file has no such place.
    assert!(!bytes(&odd_picture(), Format::Exr, &Encoding::default()).windows(7).any(|at| at == b"eyerays\0"));
}

#[test]
fn extensions_name_formats() {
    for (name, format) in [("a.png", Format::Png), ("b.x.EXR", Format::Exr), ("c.hdr", Format::Hdr)] {
        assert_eq!(Format::from_path(Path::new(name)), Ok(format));
    }
    for name in ["a.jpg", "png", ".png", "a.", ""] {
        let error = Format::from_path(Path::new(name)).unwrap_err().to_string();
        for format in [".png", ".exr", ".hdr"] {
            assert!(error.contains(format), "{error}");
        }
    }
    assert!(BitDepth::from_bits(10).is_err());
}

#[test]
fn a_writer_that_fails_is_an_error() {
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    for format in FORMATS {
        let error = encode(&odd_picture(), format, &SIXTEEN, Full).unwrap_err();
        assert!(error.message().contains("no space"), "{error}");
    }
}

/// The CRC of a PNG's chunk, of its type and data, by the specification's annex D.
pub(super) fn png_crc(chunk: &[u8]) -> [u8; 4] {
    let crc = chunk
        .iter()
        .fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |c, _| (c >> 1) ^ (0xedb8_8320 * (c & 1))));
    (!crc).to_be_bytes()
}

/// Wide enough for the run lengths of an HDR, with runs and without.
pub(super) fn striped_picture() -> Picture {
    let value = |i: u32| if i % 16 < 8 { 0.5 } else { 1.0 / i as f32 };
    let pixels = (0..48).map(|i| [value(i), 0.25, value(i + 3)]).collect();
    Picture::from_pixels(16, 3, pixels).unwrap()
}

#[test]
fn greys_and_alpha_are_read() {
    let image =
        image::DynamicImage::ImageLumaA16(image::ImageBuffer::from_raw(2, 1, vec![65_535, 0, 1_000, 30_000]).unwrap());
    let mut png = Cursor::new(Vec::new());
    image.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let picture = decode(Cursor::new(png.into_inner())).unwrap();
    let grey = transfer::linear_table(65_535)[1_000];
    assert_eq!(picture.pixels, [[1.0; 3], [grey; 3]]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn exr_keeps_any_bits(bits in prop::collection::vec(any::<[u32; 3]>(), 1..40)) {
        let pixels = bits.iter().map(|p| p.map(f32::from_bits)).collect();
        let picture = Picture::from_pixels(bits.len() as u32, 1, pixels).unwrap();
        prop_assert!(picture.bits_equal(&round_trip(&picture, Format::Exr, &SIXTEEN)));
    }

    #[test]
    fn any_picture_can_be_encoded_and_read(bits in prop::collection::vec(any::<[u32; 3]>(), 1..40)) {
        let pixels = bits.iter().map(|p| p.map(f32::from_bits)).collect();
        let picture = Picture::from_pixels(1, bits.len() as u32, pixels).unwrap();
        for format in [Format::Png, Format::Hdr] {
            let back = round_trip(&picture, format, &SIXTEEN);
            prop_assert!(back.pixels.as_flattened().iter().all(|v| v.is_finite() && *v >= 0.0));
        }
    }
}

/// What a file alone tells of the share that a name has of each pixel, as Cryptomatte's specification 1.2.0 has it.
fn share_by_the_file(path: &std::path::Path, layer: &str, name: &str) -> Vec<f32> {
    use ::exr::prelude::{AttributeValue, FlatSamples, read_first_flat_layer_from_file};
    let image = read_first_flat_layer_from_file(path).unwrap();
    let said: std::collections::BTreeMap<String, String> = image
        .layer_data
        .attributes
        .other
        .iter()
        .filter_map(|(key, value)| match value {
            AttributeValue::Text(text) => Some((key.to_string(), text.to_string())),
            _ => None,
        })
        .collect();
    let text = |key: &str| said[key].clone();
    let keys: Vec<String> = said.keys().cloned().collect();
    let of_layer = |key: &&String| key.starts_with("cryptomatte/") && key.ends_with("/name") && text(key) == layer;
    let key = keys.iter().find(of_layer).unwrap().strip_suffix("/name").unwrap();
    assert_eq!(
        (text(&format!("{key}/hash")), text(&format!("{key}/conversion"))),
        ("MurmurHash3_32".into(), "uint32_to_float32".into())
    );
    let manifest: serde_json::Value = serde_json::from_str(&text(&format!("{key}/manifest"))).unwrap();
    let id = f32::from_bits(u32::from_str_radix(manifest[name].as_str().unwrap(), 16).unwrap());
    let channel = |name: String| match &image.layer_data.channel_data.list.iter().find(|c| c.name == *name)?.sample_data
    {
        FlatSamples::F32(values) => Some(values.clone()),
        other => panic!("{name}: {other:?}"),
    };
    let mut shares = vec![0.0; image.layer_data.size.area()];
    for (number, [of_id, of_share]) in (0..).flat_map(|number| [(number, ["R", "G"]), (number, ["B", "A"])]) {
        let Some(ids) = channel(format!("{layer}{number:02}.{of_id}")) else { break };
        let found = channel(format!("{layer}{number:02}.{of_share}")).unwrap();
        let found = ids.into_iter().zip(found).map(|(own, share)| if own == id { share } else { 0.0 });
        shares.iter_mut().zip(found).for_each(|(sum, share)| *sum += share);
    }
    shares
}

#[test]
fn cryptomattes_are_read_by_who_knows_their_specification_alone() {
    use crate::cryptomatte::Counter;
    use rayon::prelude::*;
    let mut counter = Counter::new("CryptoMaterial", ["red", "blau \u{fc}ber", "red"].into_iter(), 3);
    for seen in [[Some(0), None, Some(1)], [Some(2), None, Some(0)], [Some(1), Some(1), None], [None, None, Some(1)]] {
        counter.add(seen.into_par_iter());
    }
    let matte = counter.done();
    let file = tempfile::NamedTempFile::new().unwrap();
    let picture = Picture::from_pixels(3, 1, vec![[0.5; 3]; 3]).unwrap();
    let layers = [(Layer::CryptoMaterial, Values::Shares(matte.clone()))];
    // Halves would be other numbers.
    let encoding = Encoding { half: true, ..Encoding::default() };
    encode_layers(&picture, &layers, &encoding, std::fs::File::create(file.path()).unwrap()).unwrap();
    let written = std::fs::read(file.path()).unwrap();
    for _ in 0..8 {
        let mut again = Vec::new();
        encode_layers(&picture, &layers, &encoding, &mut again).unwrap();
        assert!(again == written, "the same picture is the same bytes");
    }
    for (name, wanted) in [("red", [0.5, 0.0, 0.25]), ("blau \u{fc}ber", [0.25, 0.25, 0.5])] {
        assert_eq!(share_by_the_file(file.path(), "CryptoMaterial", name), wanted, "{name}");
        assert_eq!(matte.share(name), wanted, "{name}");
    }
}
