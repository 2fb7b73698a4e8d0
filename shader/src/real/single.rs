//! `f32`: exact arithmetic, the same bits on every device.

use super::{Real, Scalar, V3, power, soft};
use crate::data;
use glam::{UVec4, Vec3};

/// The parts of [`Real`] and [`Scalar`] that exact and fast `f32` share: comparisons and bits.
macro_rules! comparisons {
    ($wrap:expr, $inner:expr) => {
        $crate::alone!();

        #[inline(always)]
        fn splat(x: f32) -> Self {
            $wrap(x)
        }
        #[inline(always)]
        fn lt(self, other: Self) -> bool {
            $inner(self) < $inner(other)
        }
        #[inline(always)]
        fn le(self, other: Self) -> bool {
            $inner(self) <= $inner(other)
        }
        #[inline(always)]
        fn eq(self, other: Self) -> bool {
            $inner(self) == $inner(other)
        }
        #[inline(always)]
        fn abs(self) -> Self {
            #[cfg(target_arch = "spirv")]
            return $wrap(super::device::magnitude($inner(self)));
            #[cfg(not(target_arch = "spirv"))]
            $wrap($inner(self).abs())
        }
        #[cfg(target_arch = "spirv")]
        #[inline(always)]
        fn fused(self, a: Self, b: Self) -> Self {
            $wrap(super::device::fused($inner(self), $inner(a), $inner(b)))
        }
        #[cfg(target_arch = "spirv")]
        #[inline(always)]
        fn max_entry(enter: V3<Self>) -> Self {
            let [x, y, z] = [$inner(enter.x), $inner(enter.y), $inner(enter.z)];
            $wrap(super::device::greatest(x, y, z, 0.0))
        }
        #[cfg(target_arch = "spirv")]
        #[inline(always)]
        fn min_exit(leave: V3<Self>, limit: Self) -> Self {
            let [x, y, z] = [$inner(leave.x), $inner(leave.y), $inner(leave.z)];
            $wrap(super::device::least(x, y, z, $inner(limit)))
        }
        #[cfg(target_arch = "spirv")]
        #[inline(always)]
        fn lesser(self, other: Self) -> Self {
            $wrap(super::device::lesser($inner(self), $inner(other)))
        }
        #[cfg(target_arch = "spirv")]
        #[inline(always)]
        fn greater(self, other: Self) -> Self {
            $wrap(super::device::greater($inner(self), $inner(other)))
        }
    };
}
pub(super) use comparisons;

/// The parts of [`Scalar`] that exact and fast `f32` share.
macro_rules! records {
    ($wrap:expr, $inner:expr) => {
        type Record = UVec4;

        #[inline(always)]
        fn store(v: V3<Self>, word: u32) -> UVec4 {
            data::pack(Vec3::new($inner(v.x), $inner(v.y), $inner(v.z)), word)
        }
        #[inline(always)]
        fn load(record: UVec4) -> (V3<Self>, u32) {
            (V3::splat(data::numbers(record)), record.w)
        }
        #[inline(always)]
        fn binade(self) -> (Self, Self) {
            let (power, inverse) = super::single::binade($inner(self));
            ($wrap(power), $wrap(inverse))
        }
        #[inline(always)]
        fn floor_index(self) -> i32 {
            super::single::floor_index($inner(self))
        }
        #[inline(always)]
        fn to_f32(self) -> f32 {
            $inner(self)
        }
        #[inline(always)]
        fn is_finite(self) -> bool {
            ($inner(self).to_bits() >> 23) & 255 != 255
        }
    };
}
pub(super) use records;

/// The exponent's bits alone, and those of the exponent of the other sign.
#[inline(always)]
pub(super) fn binade(x: f32) -> (f32, f32) {
    let exponent = ((x.to_bits() >> 23) & 255).min(253);
    (f32::from_bits(exponent << 23), f32::from_bits((254 - exponent) << 23))
}

/// Truncation and a correction: both exact within the clamp.
#[inline(always)]
pub(super) fn floor_index(x: f32) -> i32 {
    let bound = 8_388_608.0;
    let x = if x < bound { x } else { bound };
    let x = if x > -bound { x } else { -bound };
    let whole = x as i32;
    if (whole as f32) > x { whole - 1 } else { whole }
}

#[inline(always)]
fn id(x: f32) -> f32 {
    x
}

impl Real for f32 {
    const ROUNDOFF: f32 = 1.0 / (1 << 24) as f32;

    comparisons!(id, id);

    #[inline(always)]
    fn div(self, divisor: f32) -> f32 {
        #[cfg(target_arch = "spirv")]
        return soft::div(self, divisor);
        #[cfg(not(target_arch = "spirv"))]
        soft::native::div(self, divisor)
    }

    #[inline(always)]
    fn reciprocal(self) -> f32 {
        #[cfg(target_arch = "spirv")]
        return soft::reciprocal(self);
        #[cfg(not(target_arch = "spirv"))]
        return 1.0 / self;
    }

    #[inline(always)]
    fn sqrt(self) -> f32 {
        #[cfg(target_arch = "spirv")]
        return soft::sqrt(self);
        #[cfg(not(target_arch = "spirv"))]
        soft::native::sqrt(self)
    }
}

impl Scalar for f32 {
    #[cfg(not(target_arch = "spirv"))]
    type Eight = super::F32xN<8>;
    #[cfg(not(target_arch = "spirv"))]
    type Four = super::F32xN<4>;
    #[cfg(not(target_arch = "spirv"))]
    type Packet = super::F32xN<8>;
    #[cfg(not(target_arch = "spirv"))]
    const VECTORISES: bool = true;

    records!(id, id);

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn run_avx2(task: impl super::Task<f32>) {
        task.run::<super::Avx2>();
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn run_avx512(task: impl super::Task<f32>) {
        task.run::<super::Avx512>();
    }

    #[inline(always)]
    fn log2(self) -> f32 {
        power::log2(self)
    }
    #[inline(always)]
    fn pow(self, exponent: f32) -> f32 {
        power::pow(self, exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::floor_index;

    #[test]
    fn floor_goes_down_on_both_sides_of_zero() {
        for (x, floor) in [(-1.0, -1), (-0.25, -1), (-0.0, 0), (0.75, 0), (1.0, 1), (1e30, 8_388_608)] {
            assert_eq!(floor_index(x), floor, "{x}");
        }
        assert_eq!(floor_index(-1e30), -8_388_608);
    }
}
