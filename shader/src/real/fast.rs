//! `f32` with the device's own division, root and power: faster, and not the same on every device.

use super::single::{comparisons, records};
use super::{Real, Scalar, V3};
use crate::data;
use core::ops::{Add, Mul, Neg, Sub};
use glam::{UVec4, Vec3};
use spirv_std::num_traits::Float;

/// A single number at the device's own speed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Fast(pub f32);

#[inline(always)]
fn inner(x: Fast) -> f32 {
    x.0
}

macro_rules! operator {
    ($trait:ident, $name:ident, $op:tt) => {
        impl $trait for Fast {
            type Output = Fast;
            #[inline(always)]
            fn $name(self, other: Fast) -> Fast {
                Fast(self.0 $op other.0)
            }
        }
    };
}
operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);

impl Neg for Fast {
    type Output = Fast;
    #[inline(always)]
    fn neg(self) -> Fast {
        Fast(-self.0)
    }
}

impl Real for Fast {
    const ROUNDOFF: Fast = Fast(<f32 as Real>::ROUNDOFF);
    const EXACT: bool = false;

    comparisons!(Fast, inner);

    #[inline(always)]
    fn div(self, divisor: Fast) -> Fast {
        Fast(self.0 / divisor.0)
    }

    #[inline(always)]
    fn flush_if_exact(self, _least: f32) -> Fast {
        self
    }

    #[inline(always)]
    fn difference_and_rest(self, other: Fast) -> (Fast, Fast) {
        (self - other, Fast(0.0))
    }

    #[inline(always)]
    fn product_and_rest(self, other: Fast) -> (Fast, Fast) {
        (self * other, Fast(0.0))
    }

    #[inline(always)]
    fn sqrt(self) -> Fast {
        Fast(Float::sqrt(self.0))
    }
}

impl Scalar for Fast {
    crate::no_registers!(super::F32xN<8>, super::F32xN<4>);
    records!(Fast, inner);

    #[inline(always)]
    fn log2(self) -> Fast {
        Fast(Float::log2(self.0))
    }

    #[inline(always)]
    fn pow(self, exponent: Fast) -> Fast {
        // A device's power of zero may be NaN.
        if exponent.0 == 0.0 {
            Fast(1.0)
        } else if self.0 <= 0.0 {
            Fast(0.0)
        } else {
            Fast(Float::powf(self.0, exponent.0))
        }
    }
}
