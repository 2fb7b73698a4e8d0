//! `f64`: the reference that errors are measured against, from the same kernels.

use super::{Real, Scalar, TINY, V3};

impl Real for f64 {
    crate::alone!();
    const ROUNDOFF: f64 = 1.0 / (1u64 << 53) as f64;

    fn splat(x: f32) -> f64 {
        f64::from(x)
    }
    fn div(self, divisor: f64) -> f64 {
        self / divisor
    }
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    fn lt(self, other: f64) -> bool {
        self < other
    }
    fn le(self, other: f64) -> bool {
        self <= other
    }
    fn eq(self, other: f64) -> bool {
        self == other
    }
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    /// Halves of 26 bits would need another factor; a rest is far below what the reference is for.
    fn product_and_rest(self, other: f64) -> (f64, f64) {
        (self * other, 0.0)
    }
    /// Never runs on a device that flushes.
    fn flush_if_exact(self, _least: f32) -> f64 {
        self
    }
    /// Products of numbers of 2^-60 are far from subnormal, so nothing above that must be flushed.
    fn flush(self, least: f32) -> f64 {
        if f64::abs(self) < f64::from(least.min(TINY)) { 0.0 } else { self }
    }
}

/// Three doubles and an integer, in host memory alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Record(f64, f64, f64, u32);

impl Scalar for f64 {
    crate::no_registers!(f64, f64);
    type Record = Record;

    fn store(v: V3<f64>, word: u32) -> Record {
        Record(v.x, v.y, v.z, word)
    }
    fn load(r: Record) -> (V3<f64>, u32) {
        (V3::new(r.0, r.1, r.2), r.3)
    }
    fn binade(self) -> (f64, f64) {
        let exponent = ((self.to_bits() >> 52) & 2047).min(2045);
        (f64::from_bits(exponent << 52), f64::from_bits((2046 - exponent) << 52))
    }
    fn log2(self) -> f64 {
        f64::log2(self)
    }
    fn pow(self, exponent: f64) -> f64 {
        self.powf(exponent)
    }
    fn floor_index(self) -> i32 {
        self.clamp(-8_388_608.0, 8_388_608.0).floor() as i32
    }
    fn to_f32(self) -> f32 {
        self as f32
    }
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}
