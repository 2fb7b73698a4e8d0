//! Correctly rounded division and square root in integers, for devices that promise neither.
//!
//! The device's own quotient or root of the mantissas is an estimate within a few units in the last
//! place; an exact integer remainder corrects it. Subnormal operands count as zero and subnormal
//! results become zero. [`native`] gives the same bits from a CPU's instructions.

use spirv_std::num_traits::Float;

const SIGN: u32 = 0x8000_0000;
const INFINITY: u32 = 0x7f80_0000;
const NAN: u32 = 0x7fc0_0000;
const ONE: u32 = 0x3f80_0000;
const BELOW_TWO: u32 = 0x3fff_ffff;
const HALF: u32 = 0x3f00_0000;
const BELOW_ONE: u32 = 0x3f7f_ffff;
const FRACTION: u32 = 0x007f_ffff;
const HIDDEN: u32 = 0x0080_0000;

#[inline(always)]
fn exponent(bits: u32) -> u32 {
    (bits >> 23) & 255
}

/// The estimate's mantissa with one more bit, forced into [1, 2).
#[inline(always)]
fn mantissa_of_estimate(estimate: f32) -> u32 {
    let bits = estimate.to_bits();
    let bits = if bits < ONE { ONE } else { bits };
    let bits = if bits > BELOW_TWO { BELOW_TWO } else { bits };
    ((bits & FRACTION) | HIDDEN) << 1
}

/// Rounds a 25-bit mantissa to nearest, ties to even; `rest` tells whether anything lies below it.
#[inline(always)]
fn round(mantissa: u32, rest: bool) -> u32 {
    let half = mantissa & 1 == 1;
    let m = mantissa >> 1;
    if half && (rest || m & 1 == 1) { m + 1 } else { m }
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

/// The mantissa of a quotient, of one more bit, near `q`; and does anything lie below it?
#[inline(always)]
fn quotient(ma: u32, mb: u32, mut q: u32) -> (u32, bool) {
    // Only the low 32 bits: the true remainder of so close a quotient fits them.
    let mut rest = (ma << 24).wrapping_sub(q.wrapping_mul(mb)) as i32;
    while rest < 0 {
        q -= 1;
        rest += mb as i32;
    }
    while rest >= mb as i32 {
        q += 1;
        rest -= mb as i32;
    }
    (q, rest != 0)
}

/// The mantissa of a root, of one more bit, near `s`, by the low 32 bits of its square; and does anything lie below it?
#[inline(always)]
fn root(square: u32, mut s: u32) -> (u32, bool) {
    let mut rest = square.wrapping_sub(s.wrapping_mul(s)) as i32;
    while rest < 0 {
        rest += 2 * s as i32 - 1;
        s -= 1;
    }
    while rest > 2 * s as i32 {
        rest -= 2 * s as i32 + 1;
        s += 1;
    }
    (s, rest != 0)
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
        let (q, rest) = quotient(ma, mb, mantissa_of_estimate(ma as f32 / mb as f32));
        // The one tie between the greatest subnormal and the least normal number rounds up to even.
        let least = biased == 0 && q >= 0x01ff_fffe;
        let q = if least { 1 << 24 } else { q };
        assemble(sign, if least { 1 } else { biased }, round(q, rest))
    };
    f32::from_bits(bits)
}

/// One over a number, rounded to nearest: [`div`] where neither the number nor the result is zero, subnormal,
/// infinite or NaN, at half its price.
#[inline(never)]
pub fn reciprocal(b: f32) -> f32 {
    let bits = b.to_bits();
    let m = (bits & FRACTION) | HIDDEN;
    // 2^47 / m, or 2^24 - 1 for a power of two, whose reciprocal is put right below.
    let estimate = (1.0 / f32::from_bits(ONE | (bits & FRACTION))).to_bits();
    let estimate = if estimate < HALF { HALF } else { estimate };
    let estimate = if estimate > BELOW_ONE { BELOW_ONE } else { estimate };
    let mut q = (estimate & FRACTION) | HIDDEN;
    // Twice what is left, its low 32 bits; no quotient lies halfway.
    let mut rest = 0u32.wrapping_sub(q.wrapping_mul(m)).wrapping_mul(2) as i32;
    while rest > m as i32 {
        q += 1;
        rest -= 2 * m as i32;
    }
    while rest < -(m as i32) {
        q -= 1;
        rest += 2 * m as i32;
    }
    let power = m == HIDDEN;
    let exponent = (if power { 254 } else { 253u32 }).wrapping_sub(exponent(bits)) << 23;
    f32::from_bits((bits & SIGN) | exponent | if power { 0 } else { q & FRACTION })
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
        let (s, rest) = root(m << (25 + odd), mantissa_of_estimate(Float::sqrt(v)));
        let biased = ((ea as i32 - 127 - odd as i32) >> 1) + 127;
        assemble(0, biased, round(s, rest))
    };
    f32::from_bits(bits)
}

/// The same functions from a CPU's correctly rounded instructions.
#[cfg(not(target_arch = "spirv"))]
pub mod native {
    /// Subnormals become zeros of their sign.
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
    use super::{div, native, quotient, reciprocal, root, sqrt};
    use proptest::prelude::*;

    /// Operands whose quotients lie on ties, at the range's ends, and every special.
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
    fn reciprocals_are_the_processors() {
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
    fn roots_of_corners_are_the_processors() {
        for a in CORNERS.iter().flat_map(|&a| [a, a | super::SIGN]) {
            let x = f32::from_bits(a);
            assert!(agree(sqrt(x), native::sqrt(x)), "sqrt {a:08x}: {:?}", sqrt(x));
        }
    }

    /// A device's estimate may be off by units in the last place, which a CPU's never is.
    #[test]
    fn estimates_are_corrected() {
        for m in (1u64 << 23..1 << 24).step_by(13) {
            for (odd, off) in (0..2).flat_map(|odd| (-6..=6).map(move |off| (odd, off))) {
                let square = m << (25 + odd);
                let exact = square.isqrt();
                let near = exact.saturating_add_signed(off).clamp(1 << 24, (1 << 25) - 1) as u32;
                assert_eq!(root(square as u32, near), (exact as u32, exact * exact != square), "{m} {odd} {off}");
                let dividend = m + (m ^ 0x5a_5a5a) % m;
                let (exact, rest) = ((dividend << 24) / m, (dividend << 24) % m != 0);
                let near = exact.saturating_add_signed(off) as u32;
                assert_eq!(quotient(dividend as u32, m as u32, near), (exact as u32, rest), "{dividend} / {m} {off}");
            }
        }
    }

    /// Every mantissa of both parities: the whole of the root's rounding.
    #[test]
    fn roots_of_all_mantissas_are_the_processors() {
        for bits in 0x3f80_0000..0x4080_0000u32 {
            let x = f32::from_bits(bits);
            assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "{bits:08x}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1 << 20))]

        #[test]
        fn quotients_are_the_processors(a: u32, b: u32) {
            let (x, y) = (f32::from_bits(a), f32::from_bits(b));
            prop_assert!(agree(div(x, y), native::div(x, y)));
        }
    }
}
