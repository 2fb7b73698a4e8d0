//! `f64`: the reference that errors are measured against, from the same kernels.

use super::{Real, Scalar, TINY, V3};
use crate::ray::{Hit, Ray};

impl Real for f64 {
    type Mask = bool;
    type Index = u32;
    type Lane = f64;
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
    fn same(self, other: f64) -> bool {
        self == other
    }
    fn select(mask: bool, a: f64, b: f64) -> f64 {
        if mask { a } else { b }
    }
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    fn index(i: u32) -> u32 {
        i
    }
    fn equals(i: u32, other: u32) -> bool {
        i == other
    }
    fn precedes(i: u32, other: u32) -> bool {
        i < other
    }
    fn select_index(mask: bool, a: u32, b: u32) -> u32 {
        if mask { a } else { b }
    }
    /// Products of numbers of 2^-60 are far from subnormal, so nothing above that has to be zero.
    fn flush(self, least: f32) -> f64 {
        if f64::abs(self) < f64::from(least.min(TINY)) { 0.0 } else { self }
    }
    fn lanes(ray: &Ray<Self>, hit: &mut Hit<Self>, mask: bool, mut f: impl FnMut(&Ray<Self>, &mut Hit<Self>)) {
        if mask {
            f(ray, hit);
        }
    }
}

/// Three doubles and an integer, in host memory alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Record(f64, f64, f64, u32);

impl Scalar for f64 {
    type Eight = f64;
    type Four = f64;
    type Packet = Self;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = super::Native;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = super::Native;
    type Record = Record;

    fn store(v: V3<f64>, word: u32) -> Record {
        Record(v.x, v.y, v.z, word)
    }
    fn load(r: Record) -> (V3<f64>, u32) {
        (V3::new(r.0, r.1, r.2), r.3)
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
