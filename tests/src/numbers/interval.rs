//! The number that a kernel computes, and between which bounds lies the one that it should have.
//!
//! Operations are not inlined: kernels are, all of them, and would take minutes to compile.

use std::ops::{Add, Mul, Neg, Sub};

use eyerays_shader::one_lane;
use eyerays_shader::real::{Real, Scalar, V3};

/// An `f32`, which branches follow, and bounds of what exact arithmetic gives on the way that they take. Where kernels
/// flush, the bounds stay with the number that was flushed.
///
/// Bounds are rounded outwards, so that they hold whatever the operands are between theirs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// What the kernel computes.
    pub value: f32,
    /// The exact result is not less.
    pub low: f64,
    /// The exact result is not greater.
    pub high: f64,
}

impl Interval {
    /// An exact number.
    pub const fn exact(value: f32) -> Self {
        Interval { value, low: value as f64, high: value as f64 }
    }

    /// Bounds that were rounded to nearest.
    fn rounded(value: f32, low: f64, high: f64) -> Self {
        // What overflows or is no number bounds nothing.
        let low = if low.is_nan() { f64::NEG_INFINITY } else { low.next_down() };
        let high = if high.is_nan() { f64::INFINITY } else { high.next_up() };
        Interval { value, low, high }
    }

    /// The least and the greatest of four results.
    fn hull(value: f32, results: [f64; 4]) -> Self {
        if results.iter().any(|r| r.is_nan()) {
            return Interval { value, low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        let (least, greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        Self::rounded(value, results.into_iter().fold(least, f64::min), results.into_iter().fold(greatest, f64::max))
    }

    /// The most that the value may differ from the exact result.
    pub fn error(&self) -> f64 {
        let value = f64::from(self.value);
        (value - self.low).max(self.high - value)
    }

    /// Lies a number between the bounds?
    pub fn contains(&self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }
}

impl Add for Interval {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        Self::rounded(self.value + other.value, self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        Self::rounded(self.value - other.value, self.low - other.high, self.high - other.low)
    }
}

impl Mul for Interval {
    type Output = Self;
    #[inline(never)]
    fn mul(self, o: Self) -> Self {
        let products = [self.low * o.low, self.low * o.high, self.high * o.low, self.high * o.high];
        Self::hull(self.value * o.value, products)
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        Interval { value: -self.value, low: -self.high, high: -self.low }
    }
}

impl Real for Interval {
    eyerays_shader::alone!();
    const ROUNDOFF: Self = Interval::exact(<f32 as Real>::ROUNDOFF);

    fn splat(x: f32) -> Self {
        Interval::exact(x)
    }
    #[inline(never)]
    fn div(self, d: Self) -> Self {
        let value = Real::div(self.value, d.value);
        if d.contains(0.0) {
            return Interval { value, low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        Self::hull(value, [self.low / d.low, self.low / d.high, self.high / d.low, self.high / d.high])
    }
    #[inline(never)]
    fn reciprocal(self) -> Self {
        Interval { value: Real::reciprocal(self.value), ..Self::exact(1.0).div(self) }
    }
    #[inline(never)]
    fn sqrt(self) -> Self {
        let root = |x: f64| x.max(0.0).sqrt();
        Self::rounded(Real::sqrt(self.value), root(self.low), root(self.high))
    }
    fn lt(self, other: Self) -> bool {
        self.value < other.value
    }
    fn le(self, other: Self) -> bool {
        self.value <= other.value
    }
    fn eq(self, other: Self) -> bool {
        self.value == other.value
    }
    #[inline(never)]
    fn abs(self) -> Self {
        let (low, high) = (self.low.abs(), self.high.abs());
        let least = if self.contains(0.0) { 0.0 } else { low.min(high) };
        Interval { value: self.value.abs(), low: least, high: low.max(high) }
    }
    #[inline(never)]
    fn min(self, other: Self) -> Self {
        let value = Real::min(self.value, other.value);
        Interval { value, low: self.low.min(other.low), high: self.high.min(other.high) }
    }
    #[inline(never)]
    fn max(self, other: Self) -> Self {
        let value = Real::max(self.value, other.value);
        Interval { value, low: self.low.max(other.low), high: self.high.max(other.high) }
    }
    #[inline(never)]
    fn flush(self, least: f32) -> Self {
        Interval { value: Real::flush(self.value, least), ..self }
    }
    /// Exact arithmetic leaves no rest.
    #[inline(never)]
    fn difference_and_rest(self, other: Self) -> (Self, Self) {
        let (_, rest) = self.value.difference_and_rest(other.value);
        (self - other, Interval { value: rest, ..Self::default() })
    }
    #[inline(never)]
    fn product_and_rest(self, other: Self) -> (Self, Self) {
        let (_, rest) = self.value.product_and_rest(other.value);
        (self * other, Interval { value: rest, ..Self::default() })
    }
}

/// Three intervals and an integer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Record([Interval; 3], u32);

one_lane!(Interval);

eyerays_shader::lone_rays!(Interval);

impl Scalar for Interval {
    eyerays_shader::no_registers!(Self, Self);
    type Record = Record;

    fn store(v: V3<Self>, word: u32) -> Record {
        Record([v.x, v.y, v.z], word)
    }
    fn load(Record([x, y, z], word): Record) -> (V3<Self>, u32) {
        (V3::new(x, y, z), word)
    }
    fn log2(self) -> Self {
        let log = |x: f64| x.max(f64::MIN_POSITIVE).log2();
        let slack = |x: f64| 4.0 * f64::EPSILON * x.abs();
        let (low, high) = (log(self.low), log(self.high));
        Interval { value: Scalar::log2(self.value), low: low - slack(low), high: high + slack(high) }
    }
    /// The standard library's power is good to more than 4 of its units.
    #[inline(never)]
    fn pow(self, exponent: Self) -> Self {
        let power = |x: f64, y: f64| x.max(0.0).powf(y.max(0.0));
        let all = [(self.low, exponent.low), (self.low, exponent.high), (self.high, exponent.low)];
        let [a, b, c] = all.map(|(x, y)| power(x, y));
        let bounds = Self::hull(0.0, [a, b, c, power(self.high, exponent.high)]);
        let slack = 4.0 * f64::EPSILON;
        let value = Scalar::pow(self.value, exponent.value);
        Interval { value, low: bounds.low * (1.0 - slack), high: bounds.high * (1.0 + slack) }
    }
    fn binade(self) -> (Self, Self) {
        let (power, inverse) = self.value.binade();
        (Interval::exact(power), Interval::exact(inverse))
    }
    fn floor_index(self) -> i32 {
        Scalar::floor_index(self.value)
    }
    fn to_f32(self) -> f32 {
        self.value
    }
    fn is_finite(self) -> bool {
        self.value.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use proptest::prelude::*;

    fn rational(x: f64) -> BigRational {
        BigRational::from_float(x).expect("a finite number")
    }

    /// An interval around a number, and an exact number in it.
    fn interval() -> impl Strategy<Value = (Interval, f64)> {
        let number = prop_oneof![-1f32..1.0, -1e-9f32..1e-9, Just(0f32), -1e9f32..1e9];
        (number, 0f64..1e-3, 0f64..1e-3, 0f64..1.0).prop_map(|(value, below, above, at)| {
            let (low, high) = (f64::from(value) - below, f64::from(value) + above);
            (Interval { value, low, high }, (low + at * (high - low)).clamp(low, high))
        })
    }

    fn holds(interval: Interval, exact: &BigRational) -> bool {
        let below = interval.low.is_infinite() || rational(interval.low) <= *exact;
        below && (interval.high.is_infinite() || *exact <= rational(interval.high))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4_000))]

        /// Exact numbers between the operands' bounds: their exact results lie between the result's.
        #[test]
        fn every_operation_keeps_the_exact_result((a, x) in interval(), (b, y) in interval()) {
            let (p, q) = (rational(x), rational(y));
            prop_assert!(holds(a + b, &(&p + &q)));
            prop_assert!(holds(a - b, &(&p - &q)));
            prop_assert!(holds(a * b, &(&p * &q)));
            prop_assert!(holds(-a, &-&p));
            prop_assert!(holds(a.abs(), &rational(x.abs())));
            let (least, greatest) = if p < q { (&p, &q) } else { (&q, &p) };
            prop_assert!(holds(a.min(b), least) && holds(a.max(b), greatest));
            prop_assert!(holds(a.flush(1e-3), &p));
            let ((difference, over), (product, rest)) = (a.difference_and_rest(b), a.product_and_rest(b));
            prop_assert!(holds(difference + over, &(&p - &q)) && holds(product + rest, &(&p * &q)));
            if b.value != 0.0 && y != 0.0 {
                prop_assert!(holds(a.div(b), &(&p / &q)));
                prop_assert!(holds(b.reciprocal(), &q.recip()));
            }
            if x >= 0.0 {
                let root = a.abs().sqrt();
                prop_assert!(rational(root.low.max(0.0)).pow(2) <= p && p <= rational(root.high).pow(2));
            }
        }

        /// The value is what `f32` alone computes, the way of every branch with it.
        #[test]
        fn the_value_is_the_kernels((a, _) in interval(), (b, _) in interval()) {
            prop_assert_eq!((a * b + a).value, a.value * b.value + a.value);
            prop_assert_eq!((a.lt(b), a.min(b).value), (a.value < b.value, Real::min(a.value, b.value)));
            prop_assert_eq!(a.div(b).value.to_bits(), Real::div(a.value, b.value).to_bits());
        }
    }
}
