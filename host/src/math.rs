//! Functions of real numbers with the same bits on every platform.
//!
//! Those of std are the platform's own, whose last bits differ, and with them pictures and files would. These are
//! software, the same code everywhere; clippy forbids std's (`clippy.toml`). Arithmetic and square roots of std are
//! correctly rounded everywhere.

pub use libm::{acos, asin, atan, atan2, cos, exp2, log as ln, log2, log10, pow, sin, sincos as sin_cos, tan};

/// The greatest power of two that is no more than a positive normal number.
pub fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << (f64::MANTISSA_DIGITS - 1);
    f64::from_bits(x.to_bits() & EXPONENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_below_is_the_greatest_that_a_number_holds() {
        for exponent in -1022..=1023 {
            let power = 2f64.powi(exponent);
            for x in [power, power.next_up(), power * (2.0 - f64::EPSILON)] {
                assert_eq!(power_of_two_below(x), power, "{x:e}");
            }
        }
    }

    /// Of numbers at which the GNU C library of x86-64 gives others.
    #[test]
    fn the_bits_are_those_of_the_code() {
        let found = [
            (tan(0.082), 0x3fb5_0a07_8054_5225),
            (atan(0.044), 0x3fa6_8373_58a6_ba44),
            (sin(0.117), 0x3fbd_e23a_e6d7_63c7),
            (cos(0.24), 0x3fef_1533_606b_4659),
            (exp2(1.972 / 100.0), 0x3ff0_385f_3ee7_ddfe),
            (ln(0.01), 0xc012_6bb1_bbb5_5516),
            (log2(0.165), 0xc004_cbb2_c51d_0aed),
            (log10(0.054), 0xbff4_481d_7b1c_4103),
            (pow(0.028, 2.4), 0x3f28_9609_024c_d92e),
        ];
        for (value, bits) in found {
            assert_eq!(value.to_bits(), bits, "{value}");
        }
    }
}
