//! Powers from polynomials of `+` and `*`: the same bits on every device.

use super::FAINT;

const SQRT_HALF: u32 = 0x3f35_04f3;

/// Minimax for log2(1 + f) / f on [sqrt(1/2) - 1, sqrt(2) - 1]; largest error 6e-9 before rounding.
const LOG: [f32; 10] = [
    core::f32::consts::LOG2_E,
    -0.721_347_33,
    0.480_897_9,
    -0.360_696_43,
    0.288_585_25,
    -0.239_636_54,
    0.204_296_42,
    -0.190_613_31,
    0.187_824_53,
    -0.112_970_71,
];

/// Minimax for 2^f on [-1/2, 1/2]; largest relative error 2e-9 before rounding.
const EXP: [f32; 7] =
    [1.0, core::f32::consts::LN_2, 0.240_226_46, 0.055_503_286, 0.009_618_489, 0.001_339_993_1, 0.000_153_458];

/// Base-2 logarithm of a positive normal number, within 4e-7 absolutely and, near 1, relatively.
#[inline(always)]
pub fn log2(x: f32) -> f32 {
    let bits = x.to_bits().wrapping_sub(SQRT_HALF);
    let exponent = (bits as i32) >> 23;
    let mantissa = f32::from_bits((bits & 0x007f_ffff).wrapping_add(SQRT_HALF));
    let f = mantissa - 1.0;
    let mut sum = LOG[9];
    let mut i = 9;
    while i > 0 {
        i -= 1;
        sum = sum * f + LOG[i];
    }
    exponent as f32 + f * sum
}

/// 2 to the power of `x` in [-100, 100], within 2e-7 relatively.
#[inline(always)]
pub fn exp2(x: f32) -> f32 {
    // Adding and taking away 1.5 * 2^23 rounds to a whole number.
    let whole = (x + 12_582_912.0) - 12_582_912.0;
    let f = x - whole;
    let mut sum = EXP[6];
    let mut i = 6;
    while i > 0 {
        i -= 1;
        sum = sum * f + EXP[i];
    }
    sum * f32::from_bits(((whole as i32 + 127) as u32) << 23)
}

/// `x` in [0, 1] to the power of `exponent` in [0, 1e9], zero where that is below 2^-100.
/// The relative error is at most 4e-7 times the greater of 1 and `|log2|` of the result: 4e-5 at the least result.
/// `x` to the power of 0 is 1, 0 to any other power 0.
#[inline(always)]
pub fn pow(x: f32, exponent: f32) -> f32 {
    if exponent == 0.0 {
        return 1.0;
    }
    if x < FAINT {
        return 0.0;
    }
    let log = log2(x) * exponent;
    if log < -100.0 { 0.0 } else { exp2(if log > 100.0 { 100.0 } else { log }) }
}

#[cfg(test)]
mod tests {
    use super::pow;
    use proptest::prelude::*;

    #[test]
    fn ends_are_exact() {
        assert_eq!(pow(1.0, 0.0), 1.0);
        assert_eq!(pow(0.0, 0.0), 1.0);
        assert_eq!(pow(0.0, 1e-3), 0.0);
        assert_eq!(pow(1.0, 1e9), 1.0);
        assert_eq!(pow(0.5, 10.0), 1.0 / 1024.0);
        assert_eq!(pow(0.5, 101.0), 0.0);
        let least = 1.0 / (1u128 << 100) as f32;
        assert_eq!(pow(least, 1.0), least);
        assert_eq!(pow(0.75 * least, 0.5), 0.0);
        assert_eq!(pow(2.0, 1e9), 1.0 / least);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1 << 18))]

        #[test]
        fn error_is_as_stated(distance in -24f64..0.0, log_result in -99f64..-1e-6) {
            let x = (1.0 - distance.exp2()) as f32;
            prop_assume!(x > 0.0 && x < 1.0);
            let exponent = (log_result / f64::from(x).log2()) as f32;
            let exact = f64::from(x).powf(f64::from(exponent));
            let error = (f64::from(pow(x, exponent)) - exact).abs() / exact;
            prop_assert!(error <= 4e-7 * exact.log2().abs().max(1.0), "{x}^{exponent}: {error:e}");
        }
    }
}
