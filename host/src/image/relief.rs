//! Image files that are heights or normals, which is to be seen by their colours.

use std::io::BufReader;
use std::path::Path;

use glam::DVec3;
use image::DynamicImage;

use super::read::{Size, distrusting, open};
use super::texels::{self, TextureBudget};
use crate::error::Result;
use crate::scene::Texture;
use crate::scene::displace::Heights;

/// What an image file tells of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Relief {
    /// It is a normal map.
    Normals(Texture),
    /// How high it is, by its first channel.
    Heights(Heights),
}

/// The most that the channels of a grey differ, in 255ths: JPEG files of greys are not quite grey.
const GREY: u8 = 16;
/// The least share of the texels of a normal map that have a colour; the others are between the parts of an atlas.
const LEAST_COLOURED: f64 = 1.0 / 8.0;
/// How far the means of red and green may be from the middle, and the least that blue's is above both.
const OFF_MIDDLE: f64 = 1.0 / 8.0;
/// How long the vectors of a normal map are in the mean.
const LENGTHS: std::ops::RangeInclusive<f64> = 0.8..=1.25;

/// Reads an image file as [`read_texture`](super::read_texture) if it is a normal map, and else as [`read_heights`](super::read_heights),
/// which leave the budget what it is.
///
/// # Errors
/// Those of both.
pub fn read_relief(path: &Path, budget: &mut TextureBudget) -> Result<Relief> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut left = budget.clone();
    let mut read = || {
        let (size, image) = texels::decoded(&name, BufReader::new(open(path)?), &mut left)?;
        distrusting(|| {
            if !is_of_normals(&image) {
                return Ok(Relief::Heights(texels::heights(size, image)));
            }
            let Size { width, height, .. } = size;
            Ok(Relief::Normals(Texture { name: name.to_string(), width, height, texels: texels::texels(image) }))
        })
    };
    let relief = read().map_err(|error| error.of(path))?;
    if let Relief::Normals(_) = relief {
        *budget = left;
    }
    Ok(relief)
}

/// Is it a normal map? What of it is not grey is mostly blue then, with red and green in the middle, and stands for vectors of unit
/// length.
fn is_of_normals(image: &DynamicImage) -> bool {
    if !image.color().has_color() {
        return false;
    }
    let image = image.to_rgb8();
    let (mut count, mut sums, mut length) = (0u64, [0u64; 3], 0.0);
    for &image::Rgb(channels) in image.pixels() {
        let [least, most] = [channels.iter().min(), channels.iter().max()].map(|channel| channel.copied().unwrap_or(0));
        if most - least <= GREY {
            continue;
        }
        count += 1;
        sums.iter_mut().zip(channels).for_each(|(sum, channel)| *sum += u64::from(channel));
        length += DVec3::from(channels.map(|channel| f64::from(channel) / 127.5 - 1.0)).length();
    }
    let all = f64::from(image.width()) * f64::from(image.height());
    if count == 0 || (count as f64) < all * LEAST_COLOURED {
        return false;
    }
    let [red, green, blue] = sums.map(|sum| sum as f64 / (255.0 * count as f64));
    let is_middle = |mean: f64| (mean - 0.5).abs() <= OFF_MIDDLE;
    is_middle(red)
        && is_middle(green)
        && blue - red.max(green) >= OFF_MIDDLE
        && LENGTHS.contains(&(length / count as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Luma, Rgb, Rgb32FImage, RgbImage};

    const SIDE: u32 = 64;

    fn picture(colour: impl Fn(f64, f64) -> [f64; 3]) -> DynamicImage {
        let share = |texel: u32| f64::from(texel) / f64::from(SIDE);
        let byte = |x: f64| (255.0 * x).round() as u8;
        DynamicImage::ImageRgb8(RgbImage::from_fn(SIDE, SIDE, |x, y| Rgb(colour(share(x), share(y)).map(byte))))
    }

    /// The colours of waves, the steeper the greater the slope.
    fn waves(slope: f64) -> impl Fn(f64, f64) -> [f64; 3] {
        move |u, v| {
            let [x, y] = [(40.0 * u).sin() * slope, (30.0 * v).cos() * slope];
            let length = (x * x + y * y + 1.0).sqrt();
            [x, y, 1.0].map(|x| 0.5 + 0.5 * x / length)
        }
    }

    #[test]
    fn normal_maps_are_told_by_their_colours() {
        for slope in [0.0, 0.02, 0.3, 1.0, 2.0] {
            assert!(is_of_normals(&picture(waves(slope))), "{slope}");
        }
        // An atlas whose parts do not cover it, before black and before grey.
        for rest in [0.0, 0.5] {
            let atlas = picture(|u, v| if u < 0.3 { waves(0.5)(u, v) } else { [rest; 3] });
            assert!(is_of_normals(&atlas), "{rest}");
        }
        let floats = Rgb32FImage::from_fn(4, 4, |_, _| Rgb([0.5, 0.5, 1.0]));
        assert!(is_of_normals(&DynamicImage::ImageRgb32F(floats)));
    }

    #[test]
    fn greys_and_colours_of_other_things_are_no_normals() {
        let grey = |u: f64, v: f64| [0.5 + 0.5 * (9.0 * u).sin() * (7.0 * v).cos(); 3];
        assert!(!is_of_normals(&picture(grey)));
        let tinted = picture(|u, v| [grey(u, v)[0] * 0.96, grey(u, v)[0] * 0.96, grey(u, v)[0]]);
        assert!(!is_of_normals(&tinted), "a grey of a JPEG file");
        let luma = image::GrayImage::from_fn(4, 4, |x, _| Luma([60 * x as u8]));
        assert!(!is_of_normals(&DynamicImage::ImageLuma8(luma)));
        for colour in [[0.6, 0.3, 0.2], [0.5, 0.5, 0.8], [0.1, 0.2, 1.0], [0.5, 0.5, 0.0], [0.0, 0.0, 0.0], [1.0; 3]] {
            assert!(!is_of_normals(&picture(|_, _| colour)), "{colour:?}");
        }
        // A mark of a few texels on heights.
        assert!(!is_of_normals(&picture(|u, v| if u < 0.1 { [0.5, 0.5, 1.0] } else { grey(u, v) })));
    }

    #[test]
    fn normals_take_their_share_and_heights_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        picture(waves(0.5)).save(path("n.png")).unwrap();
        picture(|u, _| [u; 3]).save(path("h.png")).unwrap();
        let mut budget = TextureBudget::of(20 * u64::from(SIDE * SIDE));
        let read = |name: &str, budget: &mut TextureBudget| read_relief(&path(name), budget).unwrap();
        assert!(matches!(read("h.png", &mut budget), Relief::Heights(_)));
        assert!(matches!(read("n.png", &mut budget), Relief::Normals(_)));
        // What is left is as much as slopes take, and no more.
        budget.take_floats(SIDE, SIDE).unwrap();
        let refused = budget.take_floats(1, 1).unwrap_err().message();
        assert!(refused.contains("which take 16 bytes, and the pictures before it leave 0"), "{refused}");
    }
}
