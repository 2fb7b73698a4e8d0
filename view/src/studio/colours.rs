//! Numbers as colours.

use eyerays::compare::ramp;
use eyerays::error::Result;
use eyerays::image::{self, Encoding, quantise_to_byte};
use eyerays::layers::{Layer, Values};
use eyerays::math;
use eyerays::picture::Picture;

/// A picture of a layer, and what its colours mean where they have a scale.
pub(super) struct Coloured {
    /// Row by row.
    pub bytes: Vec<[u8; 4]>,
    /// From black, and to the brightest colour.
    pub scale: Option<[f64; 2]>,
}

/// The values of a layer in colours: vectors by their axes, numbers of things apart from each other, all others from dark to bright.
pub(super) fn coloured(layer: Layer, values: &Values) -> Result<Coloured> {
    Ok(match values {
        Values::Light(picture) | Values::Colours(picture) => {
            Coloured { bytes: image::screen(picture, &Encoding::default())?, scale: None }
        }
        Values::Vectors(picture) | Values::Coordinates(picture) | Values::Ways(picture) => {
            let byte = |v: f32| ((v * 0.5 + 0.5).clamp(0.0, 1.0) * 255.0).round() as u8;
            let bytes = picture.pixels.iter().map(|&[x, y, z]| [byte(x), byte(y), byte(z), 255]);
            Coloured { bytes: bytes.collect(), scale: None }
        }
        Values::Numbers(numbers) if matches!(layer, Layer::Object | Layer::Material | Layer::Primitive) => {
            Coloured { bytes: numbers.iter().map(|&number| apart(number)).collect(), scale: None }
        }
        Values::Numbers(numbers) => heat(numbers.iter().map(|&number| f64::from(number))),
        Values::Lengths(lengths) if layer == Layer::Depth => depth(lengths),
        Values::Lengths(lengths) => heat(lengths.iter().map(|&length| f64::from(length))),
        Values::Shares(_) | Values::Parts(_) => Coloured { bytes: Vec::new(), scale: None },
    })
}

/// Bright lines between the primitives that are seen, on grey that tells how they are turned.
pub(super) fn wires(normals: &Picture, primitives: &[u32]) -> Coloured {
    let width = normals.width as usize;
    let of = |(at, (&primitive, &[x, y, z])): (usize, (&u32, &[f32; 3]))| {
        let is_last = (at + 1).is_multiple_of(width);
        let right = primitives.get(at + 1).filter(|_| !is_last).unwrap_or(&primitive);
        let below = primitives.get(at + width).unwrap_or(&primitive);
        if (right, below) != (&primitive, &primitive) {
            return [235, 235, 235, 255];
        }
        // Axes apart from each other, and nothing is black.
        opaque([((0.3 * x.abs() + 0.5 * y.abs() + 0.2 * z.abs()) * 160.0) as u8; 3])
    };
    let bytes = primitives.iter().zip(&normals.pixels).enumerate().map(of).collect();
    Coloured { bytes, scale: None }
}

/// From black for 0 to the brightest for the greatest that is finite.
fn heat(values: impl Iterator<Item = f64> + Clone) -> Coloured {
    let most = values.clone().filter(|value| value.is_finite()).fold(0.0, f64::max);
    let shown = |value: f64| if most > 0.0 { ramp((value / most).min(1.0)) } else { [0.0; 3] };
    let bytes = values.map(|value| opaque(shown(value).map(|channel| quantise_to_byte(channel.into()))));
    Coloured { bytes: bytes.collect(), scale: Some([0.0, most]) }
}

/// Grey, by the logarithm of the distance: white for the nearest.
fn depth(lengths: &[f32]) -> Coloured {
    let finite =
        || lengths.iter().map(|&length| f64::from(length)).filter(|length| length.is_finite() && *length > 0.0);
    let (near, far) = finite().fold((f64::INFINITY, 0.0), |(near, far): (f64, f64), d| (near.min(d), far.max(d)));
    let span = if far > near { math::log2(far / near) } else { 1.0 };
    let grey = |&length: &f32| {
        let length = f64::from(length);
        let share = if length.is_finite() && length > 0.0 { 1.0 - 0.9 * math::log2(length / near) / span } else { 0.0 };
        opaque([(share.clamp(0.0, 1.0) * 255.0).round() as u8; 3])
    };
    Coloured { bytes: lengths.iter().map(grey).collect(), scale: (far > 0.0).then_some([far, near]) }
}

fn opaque([red, green, blue]: [u8; 3]) -> [u8; 4] {
    [red, green, blue, 255]
}

/// A colour for a number from 1, far from those of the numbers beside it; black for nothing.
fn apart(number: u32) -> [u8; 4] {
    if number == 0 {
        return [0, 0, 0, 255];
    }
    // Hues by the golden ratio, in three brightnesses.
    let hue = number.wrapping_mul(0x9e37_79b9) >> 8;
    let (place, bright) = (f64::from(hue) / f64::from(1 << 24) * 6.0, [1.0, 0.75, 0.5][number as usize % 3]);
    let channel = |shift: f64| ((place + shift).rem_euclid(6.0) - 3.0).abs() - 1.0;
    opaque([0.0, 4.0, 2.0].map(|shift| (channel(shift).clamp(0.0, 1.0).mul_add(0.8, 0.2) * bright * 255.0) as u8))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn a_thousand_things_have_a_thousand_colours_and_nothing_is_black() {
        let colours: BTreeSet<_> = (0..1000).map(apart).collect();
        assert!(colours.len() > 980, "{}", colours.len());
        assert_eq!(apart(0), [0, 0, 0, 255]);
    }

    #[test]
    fn more_is_brighter_and_the_scale_is_told() {
        let Coloured { bytes, scale } = coloured(Layer::Visits, &Values::Numbers(vec![0, 5, 10, 20])).unwrap();
        let bright: Vec<u32> = bytes.iter().map(|&[r, g, b, _]| u32::from(r) + u32::from(g) + u32::from(b)).collect();
        assert!(bright.is_sorted() && bright[0] == 0 && bright[3] > 500, "{bright:?}");
        assert_eq!(scale, Some([0.0, 20.0]));
        let Coloured { bytes, .. } = coloured(Layer::Visits, &Values::Numbers(vec![0; 4])).unwrap();
        assert_eq!(bytes, [[0, 0, 0, 255]; 4]);
    }

    #[test]
    fn lines_are_where_one_primitive_is_beside_another() {
        let normals = Picture::from_pixels(3, 2, vec![[0.0, 1.0, 0.0]; 6]).unwrap();
        // The last of a row and the first of the next are not beside each other.
        let bytes = wires(&normals, &[1, 1, 2, 1, 1, 1]).bytes;
        assert_eq!(
            bytes.iter().map(|pixel| pixel[0] > 200).collect::<Vec<_>>(),
            [false, true, true, false, false, false]
        );
    }

    #[test]
    fn near_is_brighter_than_far_and_nothing_is_black() {
        let lengths = vec![1.0, 2.0, 4.0, f32::INFINITY];
        let Coloured { bytes, scale } = coloured(Layer::Depth, &Values::Lengths(lengths)).unwrap();
        assert_eq!(bytes.iter().map(|pixel| pixel[0]).collect::<Vec<_>>(), [255, 140, 25, 0]);
        assert_eq!(scale, Some([4.0, 1.0]));
    }
}
