//! Correctly rounded division and square root in integers, for devices that promise neither.
//!
//! The device's own reciprocal of a mantissa, or its inverse root, gives an estimate within a few units in the last place. A step of
//! Newton's method in single precision brings it to within one, and the exact remainder in integers settles that one. Nothing branches: compilers copy these functions into a kernel a hundred times, and what they take grows faster with blocks
//! than with instructions. Subnormal operands count as zero and subnormal results become zero. [`native`] gives the same bits from a
//! CPU's instructions.

#[cfg(target_arch = "spirv")]
use super::device::inverse_root;

const SIGN: u32 = 0x8000_0000;
const INFINITY: u32 = 0x7f80_0000;
const NAN: u32 = 0x7fc0_0000;
const ONE: u32 = 0x3f80_0000;
const HALF: u32 = 0x3f00_0000;
const FRACTION: u32 = 0x007f_ffff;
const HIDDEN: u32 = 0x0080_0000;
/// The size of a unit of a mantissa in [1, 2).
const UNIT: f32 = 1.0 / HIDDEN as f32;

#[inline(always)]
fn exponent(bits: u32) -> u32 {
    (bits >> 23) & 255
}

#[inline(always)]
fn mantissa(bits: u32) -> u32 {
    (bits & FRACTION) | HIDDEN
}

/// The same mantissa in [1, 2).
#[inline(always)]
fn fraction(bits: u32) -> f32 {
    f32::from_bits((bits & FRACTION) | ONE)
}

/// A number of units that is within one of the nearest to `whole / divisor`, and its remainder, made the nearest and its own remainder.
/// Remainders have a sign and fit 31 bits.
#[inline(always)]
fn settled(q: u32, rest: u32, divisor: u32) -> (u32, i32) {
    let (divisor, rest) = (divisor as i32, rest as i32);
    let more = (2 * rest > divisor) as i32 - (2 * rest < -divisor) as i32;
    (q.wrapping_add(more as u32), rest - more * divisor)
}

/// The quotient of two mantissas, the first not less, in units of 2^-23, from the second's fraction and an estimate of one over it; and
/// what is left of the first. No quotient lies halfway between two numbers.
#[inline(always)]
fn quotient(ma: u32, mb: u32, fraction: f32, inverse: f32) -> (u32, i32) {
    let whole = ma as f32 * UNIT;
    let estimate = whole * inverse;
    // What is left after rounding of the product, and of this sum, is less than one unit and a half.
    let nearer = estimate + (whole - estimate * fraction) * inverse;
    // The bits of numbers around 1 and 2 are units, but for a binade's end, where half of them or two of them are one.
    let q = nearer.to_bits().wrapping_sub(ONE - HIDDEN);
    // Only the low 32 bits: the true remainder of so close a quotient fits them.
    settled(q, (ma << 23).wrapping_sub(q.wrapping_mul(mb)), mb)
}

/// A biased exponent as it is, but for that of zero and infinity far outside of what any result has.
#[inline(always)]
fn stretched(exponent: u32) -> i32 {
    let far = 8 * exponent as i32 - 1020;
    if is_special(exponent) { far } else { exponent as i32 }
}

/// The exponent of zero and subnormal numbers, and that of infinity and NaN.
#[inline(always)]
fn is_special(exponent: u32) -> bool {
    (exponent + 1) & 254 == 0
}

/// `a / b`, rounded to nearest even.
#[inline(never)]
pub fn div(a: f32, b: f32) -> f32 {
    let (ua, ub) = (a.to_bits(), b.to_bits());
    let (ea, eb) = (exponent(ua), exponent(ub));
    let (ma, mb) = (mantissa(ua), mantissa(ub));
    let less = (ma < mb) as u32;
    let divisor = fraction(ub);
    let (q, rest) = quotient(ma << less, mb, divisor, 1.0 / divisor);
    let biased = stretched(ea) - stretched(eb) + 127 - less as i32;
    // The quotient halfway between the least normal number and the greatest subnormal one rounds up to even, as all above it do.
    let least = (biased == 0) & (q == HIDDEN + FRACTION) & (rest >= 0);
    let q = q + least as u32;
    let biased = biased + (q >> 24) as i32;
    let finite = ((biased as u32) << 23) | (q & FRACTION);
    let magnitude = if biased > 254 { INFINITY } else { finite };
    let magnitude = if biased < 1 { 0 } else { magnitude };
    let is_nan = (ua & !SIGN > INFINITY) | (ub & !SIGN > INFINITY) | ((ea == eb) & is_special(ea));
    f32::from_bits(if is_nan { NAN } else { magnitude | ((ua ^ ub) & SIGN) })
}

/// 2^47 over a mantissa, rounded, from its fraction and an estimate of one over that.
#[inline(always)]
fn inverse(m: u32, fraction: f32, estimate: f32) -> u32 {
    let nearer = estimate + (1.0 - estimate * fraction) * estimate;
    // In units of 2^-24, from 1/2 to 1. No quotient lies halfway.
    let q = nearer.to_bits().wrapping_sub(HALF - HIDDEN);
    settled(q, 0u32.wrapping_sub(q.wrapping_mul(m)), m).0
}

/// One over a number, rounded to nearest: [`div`] where neither the number nor the result is zero, subnormal,
/// infinite or NaN, for fewer instructions.
#[inline(never)]
pub fn reciprocal(b: f32) -> f32 {
    let bits = b.to_bits();
    let fraction = fraction(bits);
    let q = inverse(mantissa(bits), fraction, 1.0 / fraction);
    // The mantissa's highest bit adds one to the exponent, and that of a power of two's reciprocal adds two.
    f32::from_bits((bits & SIGN) | (252u32.wrapping_sub(exponent(bits)) << 23).wrapping_add(q))
}

/// The root of a square in units of 2^-23, rounded, from the low 32 bits of the square, its value in [1, 4), and an estimate of one
/// over the root.
#[inline(always)]
fn root(square: u32, value: f32, inverse: f32) -> u32 {
    let estimate = value * inverse;
    let nearer = estimate + (value - estimate * estimate) * (0.5 * inverse);
    let s = nearer.to_bits().wrapping_sub(ONE - HIDDEN) as i32;
    let rest = (square as i32).wrapping_sub(s.wrapping_mul(s));
    // No root lies halfway: the square of that is no whole number.
    (s + (rest > s) as i32 - (rest <= -s) as i32) as u32
}

/// About one over a root. Vulkan allows the device 2 units in the last place.
#[cfg(not(target_arch = "spirv"))]
fn inverse_root(x: f32) -> f32 {
    1.0 / x.sqrt()
}

/// The square root, rounded to nearest even; NaN for a negative number, -0 for -0.
#[inline(never)]
pub fn sqrt(a: f32) -> f32 {
    let ua = a.to_bits();
    let ea = exponent(ua);
    // The exponent's parity goes into the mantissa: the value lies in [1, 4), its root in [1, 2).
    let odd = (ea & 1) ^ 1;
    let value = f32::from_bits((ua & FRACTION) | (ONE + (odd << 23)));
    let s = root(mantissa(ua) << (23 + odd), value, inverse_root(value));
    let finite = (((ea + 127 - odd) >> 1) << 23).wrapping_add(s - HIDDEN);
    let bits = if ua == INFINITY { INFINITY } else { finite };
    let bits = if ua > INFINITY { NAN } else { bits };
    f32::from_bits(if ea == 0 { ua & SIGN } else { bits })
}

/// The same functions from a CPU's correctly rounded instructions.
#[cfg(not(target_arch = "spirv"))]
pub mod native {
    /// Flushes subnormals to zeros of their sign.
    #[inline(always)]
    fn flush(x: f32) -> f32 {
        if x.abs() < f32::MIN_POSITIVE { f32::from_bits(x.to_bits() & super::SIGN) } else { x }
    }

    /// See [`super::div`].
    #[inline(always)]
    pub fn div(a: f32, b: f32) -> f32 {
        flush(flush(a) / flush(b))
    }

    /// See [`super::sqrt`].
    #[inline(always)]
    pub fn sqrt(a: f32) -> f32 {
        flush(a).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use std::ops::RangeInclusive;

    use super::{HALF, HIDDEN, ONE, div, fraction, inverse, mantissa, native, quotient, reciprocal, root, sqrt};
    use proptest::prelude::*;

    /// Operands whose quotients lie on ties or at the ends of the range, and every special value.
    const CORNERS: [u32; 24] = [
        0,
        1,
        0x007f_ffff,
        0x0080_0000,
        0x0080_0001,
        0x00ff_ffff,
        0x3380_0000,
        0x3f00_0000,
        0x3f7f_ffff,
        0x3f80_0000,
        0x3f80_0001,
        0x3fff_ffff,
        0x4000_0000,
        0x4040_0000,
        0x4b00_0001,
        0x4b7f_ffff,
        0x7eff_ffff,
        0x7f00_0000,
        0x7f7f_fffe,
        0x7f7f_ffff,
        0x7f80_0000,
        0x7f80_0001,
        0x7fc0_0000,
        0x7fff_ffff,
    ];

    fn agree(soft: f32, hard: f32) -> bool {
        soft.to_bits() == hard.to_bits() || soft.is_nan() && hard.is_nan()
    }

    #[test]
    fn quotients_of_corners_are_the_processors() {
        for a in CORNERS.iter().flat_map(|&a| [a, a | super::SIGN]) {
            for b in CORNERS.iter().flat_map(|&b| [b, b | super::SIGN]) {
                let (x, y) = (f32::from_bits(a), f32::from_bits(b));
                assert!(agree(div(x, y), native::div(x, y)), "{a:08x} / {b:08x}: {:?}", div(x, y));
            }
        }
    }

    /// What a device may be off by: Vulkan allows a reciprocal 2.5 units in the last place and an inverse root 2.
    const MAY_BE_OFF: RangeInclusive<i32> = -3..=3;

    /// Every mantissa with every estimate that a device may have, and every exponent that has a normal reciprocal.
    #[test]
    fn reciprocals_equal_the_processors() {
        for m in HIDDEN..2 * HIDDEN {
            let (x, want) = (fraction(m), 1.0 / fraction(m));
            assert_eq!(reciprocal(x).to_bits(), want.to_bits(), "{x:e}");
            assert_eq!(reciprocal(-x).to_bits(), (-want).to_bits(), "-{x:e}");
            for off in MAY_BE_OFF {
                assert_eq!(inverse(m, x, beside(want, off)), want.to_bits() - (HALF - HIDDEN), "{x:e}, off by {off}");
            }
        }
        for exponent in 1..253u32 {
            for fraction in [0, 1, 0x12_3456, 0x40_0000, 0x7f_ffff] {
                let x = f32::from_bits(exponent << 23 | fraction);
                assert_eq!(reciprocal(x).to_bits(), (1.0 / x).to_bits(), "{x:e}");
            }
        }
    }

    #[test]
    fn roots_of_corners_equal_the_processors() {
        for a in CORNERS.iter().flat_map(|&a| [a, a | super::SIGN]) {
            let x = f32::from_bits(a);
            assert!(agree(sqrt(x), native::sqrt(x)), "sqrt {a:08x}: {:?}", sqrt(x));
        }
    }

    /// Every mantissa with both parities of the exponent, which covers all of the root's rounding, and every estimate that a device
    /// may have.
    #[test]
    fn roots_of_all_mantissas_equal_the_processors() {
        for bits in 0x3f80_0000..0x4080_0000u32 {
            let x = f32::from_bits(bits);
            assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "{bits:08x}");
            let (square, units) =
                (mantissa(bits) << (if x < 2.0 { 23 } else { 24 }), x.sqrt().to_bits() - (ONE - HIDDEN));
            for off in MAY_BE_OFF {
                assert_eq!(root(square, x, beside(1.0 / x.sqrt(), off)), units, "{x:e}, off by {off}");
            }
        }
    }

    fn beside(x: f32, off: i32) -> f32 {
        f32::from_bits(x.to_bits().wrapping_add_signed(off))
    }

    /// A quotient of 1 that is estimated below it, and the greatest, estimated at 2 and above.
    #[test]
    fn estimates_may_leave_their_binade() {
        for off in -8..=8 {
            for m in [HIDDEN, HIDDEN + 1, 2 * HIDDEN - 1] {
                assert_eq!(quotient(m, m, fraction(m), beside(1.0 / fraction(m), off)), (1 << 23, 0));
            }
            let (most, least) = (2 * HIDDEN - 1, HIDDEN);
            assert_eq!(quotient(most, least, 1.0, beside(1.0, off)), (most, 0));
            assert_eq!(root(HIDDEN << 23, 1.0, beside(1.0, off)), 1 << 23);
            let below_four = f32::from_bits(0x407f_ffff);
            assert_eq!(root((2 * HIDDEN - 1) << 24, below_four, beside(0.5, off)), 2 * HIDDEN - 1);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1 << 20))]

        /// A device's own result may be off by some units: Vulkan allows a quotient 2.5 and an inverse root 2.
        #[test]
        fn estimates_may_be_off(a in HIDDEN..2 * HIDDEN, b in HIDDEN..2 * HIDDEN, odd: bool, off in -8i32..=8) {
            let (more, less) = (a.max(b), a.min(b));
            let (q, rest) = quotient(more, less, fraction(less), beside(1.0 / fraction(less), off));
            let (whole, less) = (i64::from(more) << 23, i64::from(less));
            prop_assert_eq!(i64::from(rest), whole - i64::from(q) * less);
            prop_assert!(2 * i64::from(rest).abs() < less, "{rest} is left of {less}");
            let v = if odd { 2.0 * fraction(a) } else { fraction(a) };
            let square = u64::from(a) << (23 + u32::from(odd));
            let s = root(square as u32, v, beside(1.0 / v.sqrt(), off));
            // Twice a root has one more bit, which rounds it.
            prop_assert_eq!(u64::from(s), (4 * square).isqrt().div_ceil(2));
            let reciprocal = 1.0 / fraction(a);
            prop_assert_eq!(inverse(a, fraction(a), beside(reciprocal, off)), reciprocal.to_bits() - (HALF - HIDDEN));
        }

        #[test]
        fn quotients_are_the_processors(a: u32, b: u32) {
            let (x, y) = (f32::from_bits(a), f32::from_bits(b));
            prop_assert!(agree(div(x, y), native::div(x, y)));
        }
    }
}
