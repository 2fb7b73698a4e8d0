//! Numbers as whole multiples of a quantum: their sums are exact and have no order.

/// A whole number of quanta in two's complement, its lowest word first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quanta(pub u32, pub u32, pub u32, pub u32);

impl Quanta {
    /// A number in quanta of 2^-`fraction`, rounded to the nearest, halves away from zero. Its magnitude is at most
    /// 2^`most`, where `most + fraction` is at most 104 and `fraction` at most 100; larger ones, infinity and NaN become the last
    /// number below.
    #[inline(always)]
    pub fn of(x: f32, fraction: u32, most: u32) -> Self {
        let bits = x.to_bits();
        let (greatest, exponent) = (126 + most, (bits >> 23) & 255);
        let is_over = exponent > greatest;
        let exponent = if is_over { greatest } else { exponent };
        let mantissa = if is_over { 0xff_ffff } else { (bits & 0x7f_ffff) | 0x80_0000 };
        // The mantissa's last bit is worth 2^(exponent - 150).
        let left = (exponent + fraction) as i32 - 150;
        let right = if left >= 0 {
            0
        } else if left < -25 {
            25
        } else {
            -left as u32
        };
        let mantissa = (mantissa + ((1 << right) >> 1)) >> right;
        let left = if left < 0 { 0 } else { left as u32 };
        let (word, bit) = (left >> 5, left & 31);
        let (low, high) = (mantissa << bit, (mantissa >> 1) >> (31 - bit));
        let at = |below: u32, own: u32| {
            if word == own {
                low
            } else if word == below {
                high
            } else {
                0
            }
        };
        let whole = Quanta(at(NOWHERE, 0), at(0, 1), at(1, 2), at(2, 3));
        if bits >> 31 == 0 { whole } else { whole.negative() }
    }

    /// The sum; its carry out of the last word is lost.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        let (first, carry) = add(self.0, other.0, 0);
        let (second, carry) = add(self.1, other.1, carry);
        let (third, carry) = add(self.2, other.2, carry);
        Quanta(first, second, third, add(self.3, other.3, carry).0)
    }

    #[inline(always)]
    fn negative(self) -> Self {
        Quanta(!self.0, !self.1, !self.2, !self.3).plus(Quanta(1, 0, 0, 0))
    }
}

/// No word's number.
const NOWHERE: u32 = u32::MAX;

/// Two words and a carry: their sum and the carry of it.
#[inline(always)]
fn add(a: u32, b: u32, carry: u32) -> (u32, u32) {
    let sum = a.wrapping_add(b);
    let whole = sum.wrapping_add(carry);
    (whole, (sum < a) as u32 | (whole < sum) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// As a number of the machine.
    fn number(q: Quanta) -> i128 {
        (u128::from(q.3) << 96 | u128::from(q.2) << 64 | u128::from(q.1) << 32 | u128::from(q.0)) as i128
    }

    /// By double precision, which holds a number of single precision in any quantum; `round` takes halves away from zero.
    fn wanted(x: f32, fraction: u32, most: u32) -> i128 {
        let limit = 2f64.powi(most as i32 - 24) * f64::from((1 << 24) - 1);
        let x = if x.is_finite() { f64::from(x) } else { limit.copysign(x.into()) };
        (x.clamp(-limit, limit) * 2f64.powi(fraction as i32)).round() as i128
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100_000))]

        #[test]
        fn any_number_is_the_nearest_whole_number_of_quanta(bits: u32, fraction in 0u32..=64, most in 1u32..=40) {
            let x = f32::from_bits(bits);
            prop_assert_eq!(number(Quanta::of(x, fraction, most)), wanted(x, fraction, most), "{}", x);
        }

        #[test]
        fn sums_are_exact(a: i64, b: i64, high: i32) {
            let whole = |x: i64, high: i32| (i128::from(high) << 64) + i128::from(x);
            let words = |n: i128| Quanta(n as u32, (n >> 32) as u32, (n >> 64) as u32, (n >> 96) as u32);
            let (a, b) = (whole(a, high), whole(b, high / 3));
            prop_assert_eq!(number(words(a).plus(words(b))), a + b);
        }
    }

    #[test]
    fn halves_are_rounded_away_from_zero_and_the_largest_is_below_the_limit() {
        let of = |x| number(Quanta::of(x, 4, 8));
        assert_eq!([1.0 / 32.0, -1.0 / 32.0, 1.0 / 33.0, 0.0, -0.0, 1e-40].map(of), [1, -1, 0, 0, 0, 0]);
        let last = (((1 << 24) - 1) as f32 / (1 << 16) as f32 * 16.0).round() as i128;
        assert_eq!([256.0, f32::MAX, f32::INFINITY, f32::NAN].map(of), [last; 4]);
        assert_eq!(of(f32::NEG_INFINITY), -last);
    }
}
