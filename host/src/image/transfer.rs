//! The sRGB transfer function (IEC 61966-2-1), between linear light and what a PNG stores.

use std::sync::LazyLock;

use crate::math;

/// From linear light to the sRGB signal, both in [0, 1]. What is less, and NaN, becomes 0;
/// what is more becomes 1.
pub fn linear_to_srgb(linear: f64) -> f64 {
    if linear > 0.003_130_8 {
        1.055 * math::pow(linear.min(1.0), 1.0 / 2.4) - 0.055
    } else if linear > 0.0 {
        12.92 * linear
    } else {
        0.0
    }
}

/// From the sRGB signal to linear light, both in [0, 1].
pub fn srgb_to_linear(signal: f64) -> f64 {
    if signal <= 0.040_45 { signal / 12.92 } else { math::pow((signal + 0.055) / 1.055, 2.4) }
}

/// The nearest of `steps + 1` sRGB values for linear light; `steps` is 255 or 65,535.
pub(super) fn quantise(linear: f64, steps: f64) -> f64 {
    (linear_to_srgb(linear) * steps).round()
}

/// The least linear light of each sRGB value of 8 bits but 0: a search among them takes a fifth of a power.
static LEAST_OF_VALUE: LazyLock<Vec<f64>> = LazyLock::new(|| (1..=255).map(|value| least(value, 255.0)).collect());

/// The nearest sRGB value of 8 bits for linear light, which is what a PNG has: 0 for what is less than 0 and for NaN, 255
/// for what is more than 1.
pub fn quantise_to_byte(linear: f64) -> u8 {
    LEAST_OF_VALUE.partition_point(|&least| least <= linear) as u8
}

/// The least linear light that becomes a value of 8 bits or more, which is not 0.
pub(crate) fn least_of_byte(value: u8) -> f64 {
    LEAST_OF_VALUE[usize::from(value) - 1]
}

/// The least linear light that becomes `value` of `steps` or more; the bits of positive numbers have their order.
fn least(value: u32, steps: f64) -> f64 {
    let (mut below, mut above) = (0.0f64.to_bits(), 1.0f64.to_bits());
    while above - below > 1 {
        let middle = below.midpoint(above);
        let reaches = quantise(f64::from_bits(middle), steps) >= f64::from(value);
        *(if reaches { &mut above } else { &mut below }) = middle;
    }
    f64::from_bits(above)
}

/// Linear light for every one of `steps + 1` sRGB values, so that equal values decode equally.
pub(super) fn linear_table(steps: u16) -> Vec<f32> {
    (0..=steps).map(|step| srgb_to_linear(f64::from(step) / f64::from(steps)) as f32).collect()
}

/// [`linear_table`] of 8 bits.
static LIGHT_OF_BYTE: LazyLock<Vec<f32>> = LazyLock::new(|| linear_table(u8::MAX.into()));

/// Linear light for an sRGB value of 8 bits.
pub(crate) fn byte_to_linear(byte: u8) -> f32 {
    LIGHT_OF_BYTE[usize::from(byte)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decoding_and_encoding_again_changes_no_value() {
        for steps in [255, 65_535] {
            for (step, &linear) in linear_table(steps).iter().enumerate() {
                let back = quantise(linear.into(), steps.into());
                assert_eq!(back, step as f64, "of {steps}");
            }
        }
    }

    #[test]
    fn known_values() {
        assert_eq!(quantise(0.5, 255.0), 188.0);
        assert_eq!(quantise(0.215_860_5, 255.0), 128.0);
        assert_eq!(quantise(1.0, 65_535.0), 65_535.0);
        assert_eq!(quantise(0.001, 255.0), 3.0);
    }

    #[test]
    fn greater_light_is_never_a_lesser_value() {
        let floats = (0..=1.0_f32.to_bits()).step_by(997).map(f32::from_bits);
        let joint = 0.003_130_8_f32.to_bits();
        let around = (joint - 20_000..joint + 20_000).map(f32::from_bits);
        for range in [floats.collect::<Vec<_>>(), around.collect()] {
            let values = range.iter().map(|&v| quantise(v.into(), 65_535.0));
            assert!(values.is_sorted());
        }
    }

    #[test]
    fn a_byte_is_found_where_the_function_has_it() {
        let below = |x: f64| f64::from_bits(x.to_bits() - 1);
        let joints = LEAST_OF_VALUE.iter().flat_map(|&least| [least, below(least), f64::from(least as f32)]);
        let spread = (0..=1.0_f32.to_bits()).step_by(4099).map(|bits| f64::from(f32::from_bits(bits)));
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, -0.0, 0.0, 2.0, 1.0, 5e-324];
        for linear in joints.chain(spread).chain(odd) {
            assert_eq!(f64::from(quantise_to_byte(linear)), quantise(linear, 255.0), "{linear:e}");
        }
    }

    #[test]
    fn what_is_no_light_has_a_place() {
        for dark in [f64::NAN, f64::NEG_INFINITY, -1.0, -0.0, 0.0] {
            assert_eq!(quantise(dark, 255.0), 0.0);
        }
        for bright in [1.0, 2.0, f64::MAX, f64::INFINITY] {
            assert_eq!(quantise(bright, 255.0), 255.0);
        }
    }
}
