//! Image files of strangers: refused in a line, or read in full, but never a panic.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use ::image::{DynamicImage, ImageFormat, RgbImage};
use proptest::prelude::*;
use proptest::sample::Index;

use super::tests::{FORMATS, SIXTEEN, bytes, odd_picture, png_crc, striped_picture};
use super::*;
use crate::scene::{Texels, Texture};

#[test]
fn bad_files_are_one_line_with_their_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for format in FORMATS {
        let whole = bytes(&odd_picture(), format, &SIXTEEN);
        fs::write(path(&format!("half-{format}")), &whole[..whole.len() / 2]).unwrap();
        fs::write(path(&format!("head-{format}")), &whole[..12]).unwrap();
    }
    fs::write(path("empty"), b"").unwrap();
    fs::write(path("text"), b"P3 1 1 255 0 0 0\n").unwrap();
    fs::write(path("zero"), b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n").unwrap();
    fs::write(path("huge"), b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n").unwrap();
    fs::write(path("vast.png"), huge_png(100_000)).unwrap();
    fs::write(path("none.png"), huge_png(0)).unwrap();
    fs::create_dir(path("folder")).unwrap();
    let names: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
    let names = names.into_iter().map(|entry| entry.unwrap().path());
    for path in names.chain([path("missing"), path("text/below")]) {
        let error = read(&path).expect_err(&path.to_string_lossy());
        println!("{error}");
        assert_eq!(error.place(), Some((path.as_path(), None)));
        assert_eq!(error.to_string().lines().count(), 1);
    }
    let error = read(&path("vast.png")).unwrap_err();
    assert!(error.message().contains("too large"), "{error}");
}

/// A PNG of nothing but a header, so short that its size cannot be true.
fn huge_png(side: u32) -> Vec<u8> {
    let mut png = bytes(&odd_picture(), Format::Png, &SIXTEEN);
    png[16..20].copy_from_slice(&side.to_be_bytes());
    png[20..24].copy_from_slice(&side.to_be_bytes());
    let crc = png_crc(&png[12..29]);
    png[29..33].copy_from_slice(&crc);
    png
}

#[test]
fn a_truncated_file_is_never_another_picture() {
    for format in FORMATS {
        let whole = bytes(&striped_picture(), format, &SIXTEEN);
        let picture = decode(Cursor::new(&whole)).unwrap();
        for end in 0..whole.len() {
            match decode(Cursor::new(&whole[..end])) {
                Ok(part) => {
                    assert!(part.bits_equal(&picture), "{format} at {end}");
                    // Only what follows the pixels may be missing.
                    assert!(end + 16 >= whole.len(), "{format} at {end}");
                }
                Err(error) => assert!(!error.message().is_empty()),
            }
        }
    }
}

#[test]
fn a_decoder_that_panics_is_an_error() {
    // Empty runs whose multiplier overflows, which debug builds notice.
    let mut file = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 100\n".to_vec();
    file.extend([5; 4]);
    file.extend([1, 1, 1, 0].repeat(10));
    assert!(decode(Cursor::new(file)).is_err());
}

#[test]
fn a_header_without_end_is_given_up() {
    let folder = tempfile::tempdir().unwrap();
    for start in [&b"#?RADIANCE\nFORMAT="[..], b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"] {
        let path = folder.path().join("a.hdr");
        std::fs::write(&path, start).unwrap();
        std::fs::File::options().write(true).open(&path).unwrap().set_len(1 << 30).unwrap();
        let error = read(&path).unwrap_err();
        assert!(error.message().contains("holds more"), "{error}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn devices_are_not_read() {
    for device in ["/dev/zero", "/dev/null"] {
        let error = read(Path::new(device)).unwrap_err();
        assert!(error.message().contains("regular"), "{error}");
    }
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    assert!(encode(&odd_picture(), Format::Png, &SIXTEEN, full).is_err());
}

/// A decoder takes memory by the size of the data, which differs from that of the display in some files.
#[test]
fn an_exr_that_claims_more_data_than_its_display_is_refused_before_memory_is_taken() {
    let file = bytes(&striped_picture(), Format::Exr, &Encoding::default());
    let window = b"dataWindow\0box2i\0";
    let at = file.windows(window.len()).position(|bytes| bytes == window).unwrap() + window.len() + 4;
    for (corner, value) in [(8, 1_000_000_000i32), (12, 1_000_000_000), (8, 40_000)] {
        let mut damaged = file.clone();
        damaged[at + corner..at + corner + 4].copy_from_slice(&value.to_le_bytes());
        let error = decode(Cursor::new(damaged)).unwrap_err();
        assert!(error.message().contains("too large"), "{error}");
    }
}

/// Puts other bytes into a file, and cuts it off.
fn damage(file: &mut Vec<u8>, changes: &[(Index, u8)], cut: Option<Index>) {
    for &(at, byte) in changes {
        let at = at.index(file.len());
        file[at] = byte;
    }
    if let Some(cut) = cut {
        file.truncate(cut.index(file.len()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn random_bytes_never_panic(
        start in prop::sample::select(vec![&b""[..], b"\x89PNG\r\n\x1a\n", b"\x76\x2f\x31\x01", b"#?RADIANCE"]),
        rest in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        let _ = decode(Cursor::new([start, &rest].concat()));
    }

    #[test]
    fn damaged_files_never_panic(
        format in prop::sample::select(FORMATS.to_vec()),
        flips in prop::collection::vec(any::<(Index, u8)>(), 1..8),
        cut in any::<Option<Index>>(),
    ) {
        let mut file = bytes(&striped_picture(), format, &SIXTEEN);
        damage(&mut file, &flips, cut);
        let _ = decode(Cursor::new(file));
    }
}

const KINDS: [ImageFormat; 4] = [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::OpenExr, ImageFormat::Hdr];

/// A picture of 9 x 7 texels, no two of which are the same.
fn texture_file(kind: ImageFormat) -> Vec<u8> {
    let picture = DynamicImage::from(RgbImage::from_fn(9, 7, |x, y| image::Rgb([25 * x as u8, 30 * y as u8, 128])));
    let is_light = matches!(kind, ImageFormat::OpenExr | ImageFormat::Hdr);
    let picture = if is_light { picture.into_rgb32f().into() } else { picture };
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, kind).unwrap();
    bytes.into_inner()
}

#[test]
fn a_texture_of_every_kind_is_read() {
    for kind in KINDS {
        let texture = decode_texture("a", Cursor::new(texture_file(kind)), &mut TextureBudget::default()).unwrap();
        assert_eq!((texture.width, texture.height), (9, 7), "{kind:?}");
    }
}

#[test]
fn a_picture_of_another_kind_is_named_with_the_kinds_that_are_read() {
    let says =
        |bytes: &[u8]| decode_texture("a", Cursor::new(bytes), &mut TextureBudget::default()).unwrap_err().message();
    let named = |name: &str| {
        format!("is a {name} image, which is not read; convert it to PNG, JPEG, TGA, BMP, TIFF, EXR or HDR")
    };
    assert_eq!(says(b"RIFF\x10\0\0\0WEBPVP8 "), named("WebP"));
    assert_eq!(says(b"\xABKTX 20\xBB\r\n\x1A\n"), named("KTX"));
    assert_eq!(says(b"GIF89a"), "is not a PNG, JPEG, TGA, BMP, TIFF, EXR or HDR image; convert it to one of these");
}

#[test]
fn pictures_have_a_budget_that_is_asked_before_they_are_decoded() {
    let texel = |kind| if matches!(kind, ImageFormat::Png | ImageFormat::Jpeg) { 4 } else { 16 };
    for kind in KINDS {
        let file = texture_file(kind);
        let mut budget = TextureBudget::of(2 * 9 * 7 * texel(kind) - 1);
        assert!(decode_texture("a", Cursor::new(&file), &mut budget).is_ok(), "{kind:?}");
        // Cut off after its header, if that is not seen before.
        let end = file.len() - usize::from(kind != ImageFormat::Jpeg);
        let refused = decode_texture("a", Cursor::new(&file[..end]), &mut budget).unwrap_err().message();
        assert!(refused.starts_with("has 9x7 texels, which take "), "{kind:?}: {refused}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    #[test]
    fn a_damaged_texture_is_refused_in_a_line_or_whole(
        kind in prop::sample::select(KINDS.to_vec()),
        changes in prop::collection::vec(any::<(Index, u8)>(), 1..6),
        cut in prop::option::weighted(0.2, any::<Index>()),
    ) {
        let mut bytes = texture_file(kind);
        damage(&mut bytes, &changes, cut);
        match decode_texture("a", Cursor::new(bytes), &mut TextureBudget::default()) {
            Ok(Texture { width, height, texels, .. }) => {
                let count = match texels {
                    Texels::Bytes(texels) => texels.len(),
                    Texels::Floats(texels) => {
                        prop_assert!(texels.iter().all(|texel| texel.iter().all(|x| x.is_finite() && *x >= 0.0) && texel[3] <= 1.0));
                        texels.len()
                    }
                };
                prop_assert_eq!(count, (width * height) as usize);
            }
            Err(error) => prop_assert!(!error.to_string().contains('\n'), "{}", error),
        }
    }
}
