//! Correctly rounded division and square root in integers, for devices that promise neither.
//!
//! The device's own quotient or root of the mantissas is an estimate within a few units in the last place: Vulkan allows 2.5 of a
//! quotient, and about 7 of a root, which may be one over an inverse root. From below the least number that it may stand for, steps
//! of powers of two by the exact remainder lead to the number itself: without a loop, which compilers unroll wherever one of these
//! functions is called. Subnormal operands count as zero and subnormal results become zero. [`native`] gives the same bits from a
//! CPU's instructions.

use spirv_std::num_traits::Float;

const SIGN: u32 = 0x8000_0000;
const INFINITY: u32 = 0x7f80_0000;
const NAN: u32 = 0x7fc0_0000;
const ONE: u32 = 0x3f80_0000;
const BELOW_TWO: u32 = 0x3fff_ffff;
const HALF: u32 = 0x3f00_0000;
const FRACTION: u32 = 0x007f_ffff;
const HIDDEN: u32 = 0x0080_0000;

#[inline(always)]
fn exponent(bits: u32) -> u32 {
    (bits >> 23) & 255
}

/// How far a quotient's estimate may be above the quotient's whole part.
const QUOTIENT_OFF: u32 = 4;
/// The same of a root.
const ROOT_OFF: u32 = 8;

/// The estimate's mantissa, forced into [1, 2).
#[inline(always)]
fn mantissa_of_estimate(estimate: f32) -> u32 {
    let bits = estimate.to_bits();
    let bits = if bits < ONE { ONE } else { bits };
    let bits = if bits > BELOW_TWO { BELOW_TWO } else { bits };
    (bits & FRACTION) | HIDDEN
}

/// A whole part that is up to 7 more, with the remainder of that.
#[inline(always)]
fn settled(q: u32, rest: u32, divisor: u32) -> (u32, u32) {
    let step = |(q, rest): (u32, u32), size: u32| {
        let takes = size * divisor;
        if rest >= takes { (q + size, rest - takes) } else { (q, rest) }
    };
    step(step(step((q, rest), 4), 2), 1)
}

/// Sign, biased exponent (out of range gives zero or infinity) and a mantissa of 2^23 to 2^24.
#[inline(always)]
fn assemble(sign: u32, biased: i32, mantissa: u32) -> u32 {
    let carried = mantissa >> 24 == 1;
    let biased = if carried { biased + 1 } else { biased };
    if biased < 1 {
        sign
    } else if biased > 254 {
        sign | INFINITY
    } else {
        sign | ((biased as u32) << 23) | (mantissa & FRACTION)
    }
}

/// Quotient where an operand is zero, subnormal, infinite or NaN.
#[inline(always)]
fn special_quotient(a: u32, b: u32, sign: u32) -> u32 {
    let (ea, eb) = (exponent(a), exponent(b));
    let nan = (ea == 255 && a & FRACTION != 0) || (eb == 255 && b & FRACTION != 0);
    if nan || (ea == 0 && eb == 0) || (ea == 255 && eb == 255) {
        NAN
    } else if ea == 0 || eb == 255 {
        sign
    } else {
        sign | INFINITY
    }
}

/// The whole part of the quotient of two mantissas, the first not less, in units of 2^-23, from an estimate; and its remainder.
#[inline(always)]
fn quotient(ma: u32, mb: u32, estimate: f32) -> (u32, u32) {
    let q = mantissa_of_estimate(estimate) - QUOTIENT_OFF;
    // Only the low 32 bits: the true remainder of so close a quotient fits them.
    settled(q, (ma << 23).wrapping_sub(q.wrapping_mul(mb)), mb)
}

/// `a / b`, rounded to nearest even.
#[inline(never)]
pub fn div(a: f32, b: f32) -> f32 {
    let (ua, ub) = (a.to_bits(), b.to_bits());
    let (ea, eb) = (exponent(ua), exponent(ub));
    let sign = (ua ^ ub) & SIGN;
    let bits = if ea == 0 || eb == 0 || ea == 255 || eb == 255 {
        special_quotient(ua, ub, sign)
    } else {
        let mb = (ub & FRACTION) | HIDDEN;
        let ma = (ua & FRACTION) | HIDDEN;
        let less = ma < mb;
        let ma = if less { ma << 1 } else { ma };
        let biased = ea as i32 - eb as i32 + if less { 126 } else { 127 };
        let (q, rest) = quotient(ma, mb, ma as f32 / mb as f32);
        // No quotient of two mantissas lies halfway between two numbers, but for those below the least normal one: the one halfway
        // between that and the greatest subnormal rounds up to even.
        let least = biased == 0 && q == HIDDEN + FRACTION;
        let rounded = if 2 * rest > mb { q + 1 } else { q };
        assemble(sign, if least { 1 } else { biased }, if least { HIDDEN } else { rounded })
    };
    f32::from_bits(bits)
}

/// 2^47 over a mantissa, rounded, from an estimate of the reciprocal of the mantissa in [1, 2).
#[inline(always)]
fn inverse(m: u32, estimate: f32) -> u32 {
    // In units of 2^-24, from 1/2 to 1.
    let q = estimate.to_bits().wrapping_sub(HALF - HIDDEN + QUOTIENT_OFF);
    let (q, rest) = settled(q, 0u32.wrapping_sub(q.wrapping_mul(m)), m);
    // No quotient lies halfway.
    if 2 * rest > m { q + 1 } else { q }
}

/// One over a number, rounded to nearest: [`div`] where neither the number nor the result is zero, subnormal,
/// infinite or NaN, for fewer instructions.
#[inline(never)]
pub fn reciprocal(b: f32) -> f32 {
    let bits = b.to_bits();
    let fraction = bits & FRACTION;
    let q = inverse(fraction | HIDDEN, 1.0 / f32::from_bits(ONE | fraction));
    // The mantissa's highest bit adds one to the exponent, and that of a power of two's reciprocal adds two.
    f32::from_bits((bits & SIGN) | (252u32.wrapping_sub(exponent(bits)) << 23).wrapping_add(q))
}

/// The whole part of the root of a mantissa, from the low 32 bits of its square and an estimate; and its remainder.
#[inline(always)]
fn root(square: u32, estimate: f32) -> (u32, u32) {
    let s = mantissa_of_estimate(estimate) - ROOT_OFF;
    let step = |(s, rest): (u32, u32), size: u32| {
        let takes = size * (2 * s + size);
        if rest >= takes { (s + size, rest - takes) } else { (s, rest) }
    };
    step(step(step(step((s, square.wrapping_sub(s.wrapping_mul(s))), 8), 4), 2), 1)
}

/// The square root, rounded to nearest even; NaN for a negative number, -0 for -0.
#[inline(never)]
pub fn sqrt(a: f32) -> f32 {
    let ua = a.to_bits();
    let ea = exponent(ua);
    let bits = if ea == 0 {
        ua & SIGN
    } else if ea == 255 && ua & FRACTION != 0 || ua & SIGN != 0 {
        NAN
    } else if ea == 255 {
        INFINITY
    } else {
        // The exponent's parity goes into the mantissa: v lies in [1, 4), its root in [1, 2).
        let odd = (ea & 1) ^ 1;
        let m = (ua & FRACTION) | HIDDEN;
        let v = f32::from_bits(((127 + odd) << 23) | (ua & FRACTION));
        let (s, rest) = root(m << (23 + odd), Float::sqrt(v));
        let biased = ((ea as i32 - 127 - odd as i32) >> 1) + 127;
        // No root lies halfway: the square of that is no whole number.
        assemble(0, biased, if rest > s { s + 1 } else { s })
    };
    f32::from_bits(bits)
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
    use super::{FRACTION, HALF, HIDDEN, ONE, div, inverse, native, quotient, reciprocal, root, sqrt};
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

    /// Every mantissa, and every exponent that has a normal reciprocal.
    #[test]
    fn reciprocals_equal_the_processors() {
        for bits in 0x3f80_0000..=0x4000_0000u32 {
            let x = f32::from_bits(bits);
            assert_eq!(reciprocal(x).to_bits(), (1.0 / x).to_bits(), "{bits:08x}");
            assert_eq!(reciprocal(-x).to_bits(), (-1.0 / x).to_bits(), "-{bits:08x}");
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

    /// Every mantissa with both parities of the exponent, which covers all of the root's rounding.
    #[test]
    fn roots_of_all_mantissas_equal_the_processors() {
        for bits in 0x3f80_0000..0x4080_0000u32 {
            let x = f32::from_bits(bits);
            assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "{bits:08x}");
        }
    }

    /// A quotient of 1 that is estimated below it, and the greatest, estimated at 2 and above.
    #[test]
    fn estimates_may_leave_their_binade() {
        let beside = |x: f32, off| f32::from_bits(x.to_bits().wrapping_add_signed(off));
        for off in -3..=3 {
            for m in [HIDDEN, HIDDEN + 1, 2 * HIDDEN - 1] {
                assert_eq!(quotient(m, m, beside(1.0, off)), (1 << 23, 0));
            }
            let (most, least) = (2 * HIDDEN - 1, HIDDEN);
            assert_eq!(quotient(most, least, beside(1.999_999_9, off)), (most, 0));
        }
        for off in -7..=7 {
            assert_eq!(root(HIDDEN << 23, beside(1.0, off)), (1 << 23, 0));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1 << 20))]

        /// A device's own result may be off by some units: Vulkan allows a quotient 2.5.
        #[test]
        fn estimates_may_be_off(a in HIDDEN..2 * HIDDEN, b in HIDDEN..2 * HIDDEN, odd: bool, off in -3i32..=3) {
            let beside = |x: f32, off| f32::from_bits(x.to_bits().wrapping_add_signed(off));
            let fraction = |m: u32| f32::from_bits(ONE | (m & FRACTION));
            let (more, less) = (a.max(b), a.min(b));
            let (q, rest) = quotient(more, less, beside(fraction(more) / fraction(less), off));
            let whole = u64::from(more) << 23;
            prop_assert_eq!((u64::from(q), u64::from(rest)), (whole / u64::from(less), whole % u64::from(less)));
            let v = if odd { 2.0 * fraction(a) } else { fraction(a) };
            let square = u64::from(a) << (23 + u32::from(odd));
            let (s, rest) = root(square as u32, beside(v.sqrt(), 2 * off));
            prop_assert_eq!((u64::from(s), u64::from(rest)), (square.isqrt(), square - square.isqrt().pow(2)));
            let reciprocal = 1.0 / fraction(a);
            prop_assert_eq!(inverse(a, beside(reciprocal, off)), reciprocal.to_bits() - (HALF - HIDDEN));
        }

        #[test]
        fn quotients_are_the_processors(a: u32, b: u32) {
            let (x, y) = (f32::from_bits(a), f32::from_bits(b));
            prop_assert!(agree(div(x, y), native::div(x, y)));
        }
    }
}
