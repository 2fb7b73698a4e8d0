//! `f32` with somebody who looks at every operand and result. As with intervals, operations are not inlined.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::marker::PhantomData;
use std::ops::{Add, Mul, Neg, Sub};
use std::panic::Location;
use std::sync::Mutex;

use eyerays_shader::one_lane;
use eyerays_shader::real::{Real, Scalar, V3};
use glam::UVec4;

/// What is done with the numbers that operations take and give.
pub trait Watch: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// An operand as the operation sees it.
    fn operand(x: f32, place: &'static Location<'static>) -> f32;
    /// A result as it is kept.
    fn result(x: f32) -> f32;
}

/// `f32` under a watch. Where the kernels flush, they may meet a subnormal; division and root take one for zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watched<W>(pub f32, PhantomData<W>);

/// Counts subnormal operands, see [`subnormals`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Count;

/// Flushes subnormal operands and results to zero, as a device may.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flush;

/// Numbers that count subnormal operands.
pub type Counting = Watched<Count>;
/// Numbers of a device that flushes subnormals to zero.
pub type Flushing = Watched<Flush>;

static SUBNORMALS: Mutex<BTreeMap<String, u64>> = Mutex::new(BTreeMap::new());

/// Where in the kernels [`Counting`] met subnormal operands so far, and how often.
pub fn subnormals() -> BTreeMap<String, u64> {
    SUBNORMALS.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone()
}

impl Watch for Count {
    fn operand(x: f32, place: &'static Location<'static>) -> f32 {
        if x.is_subnormal() {
            let mut all = SUBNORMALS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            *all.entry(place.to_string()).or_default() += 1;
        }
        x
    }

    fn result(x: f32) -> f32 {
        x
    }
}

impl Watch for Flush {
    fn operand(x: f32, _: &'static Location<'static>) -> f32 {
        Self::result(x)
    }

    fn result(x: f32) -> f32 {
        if x.is_subnormal() { 0f32.copysign(x) } else { x }
    }
}

impl<W: Watch> Watched<W> {
    fn new(x: f32) -> Self {
        Watched(W::result(x), PhantomData)
    }

    #[track_caller]
    fn seen(self) -> f32 {
        W::operand(self.0, Location::caller())
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $op:tt) => {
        impl<W: Watch> $trait for Watched<W> {
            type Output = Self;
            #[inline(never)]
            #[track_caller]
            fn $name(self, other: Self) -> Self {
                Self::new(self.seen() $op other.seen())
            }
        }
    };
}
operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);

impl<W: Watch> Neg for Watched<W> {
    type Output = Self;
    fn neg(self) -> Self {
        Watched(-self.0, PhantomData)
    }
}

/// For one watch, since lanes are implemented for types by themselves.
macro_rules! numbers {
    ($type:ty { $($own:tt)* }) => {
        one_lane!($type);

        impl Real for $type {
            eyerays_shader::alone!();
            const ROUNDOFF: Self = Watched(<f32 as Real>::ROUNDOFF, PhantomData);
            $($own)*

            fn splat(x: f32) -> Self {
                Watched(x, PhantomData)
            }
            #[inline(never)]
            fn div(self, divisor: Self) -> Self {
                Self::new(Real::div(self.0, divisor.0))
            }
            #[inline(never)]
            #[track_caller]
            fn reciprocal(self) -> Self {
                Self::new(Real::reciprocal(self.seen()))
            }
            #[inline(never)]
            fn sqrt(self) -> Self {
                Self::new(Real::sqrt(self.0))
            }
            #[inline(never)]
            #[track_caller]
            fn lt(self, other: Self) -> bool {
                self.seen() < other.seen()
            }
            #[inline(never)]
            #[track_caller]
            fn le(self, other: Self) -> bool {
                self.seen() <= other.seen()
            }
            #[inline(never)]
            #[track_caller]
            fn eq(self, other: Self) -> bool {
                self.seen() == other.seen()
            }
            fn abs(self) -> Self {
                Watched(self.0.abs(), PhantomData)
            }
            /// A named place: what is subnormal here becomes zero on every device.
            #[inline(never)]
            fn flush(self, least: f32) -> Self {
                Watched(Real::flush(self.0, least), PhantomData)
            }
        }

        impl Scalar for $type {
            eyerays_shader::no_registers!(Self, Self);
            type Record = UVec4;

            #[track_caller]
            fn store(v: V3<Self>, word: u32) -> UVec4 {
                <f32 as Scalar>::store(V3::new(v.x.seen(), v.y.seen(), v.z.seen()), word)
            }
            fn load(record: UVec4) -> (V3<Self>, u32) {
                (V3::splat(eyerays_shader::data::numbers(record)), record.w)
            }
            #[track_caller]
            fn log2(self) -> Self {
                Self::new(Scalar::log2(self.seen()))
            }
            #[track_caller]
            fn pow(self, exponent: Self) -> Self {
                Self::new(Scalar::pow(self.seen(), exponent.seen()))
            }
            #[track_caller]
            fn binade(self) -> (Self, Self) {
                let (power, inverse) = self.seen().binade();
                (Self::new(power), Self::new(inverse))
            }
            #[track_caller]
            fn floor_index(self) -> i32 {
                Scalar::floor_index(self.seen())
            }
            fn to_f32(self) -> f32 {
                self.0
            }
            fn is_finite(self) -> bool {
                self.0.is_finite()
            }
        }
    };
}
eyerays_shader::lone_rays!(Counting, Flushing);
numbers!(Counting {
    /// Its parts may be subnormal where the rest counts as zero whatever they are: see [`Flushing`], which looks into it.
    #[inline(never)]
    #[track_caller]
    fn product_and_rest(self, other: Self) -> (Self, Self) {
        let (product, rest) = self.seen().product_and_rest(other.seen());
        (Self::new(product), Self::new(rest))
    }
});
numbers!(Flushing {});

#[cfg(test)]
mod tests {
    use super::*;

    const TINY: f32 = f32::MIN_POSITIVE / 4.0;

    #[test]
    fn subnormal_operands_are_counted_where_they_are_used_and_not_where_they_are_flushed() {
        let x = Counting::splat(TINY);
        let at = |line: u32| {
            let place = format!("{}:{line}:", file!());
            subnormals().iter().find(|(at, _)| at.starts_with(&place)).map(|(_, &count)| count)
        };
        let _ = x.flush(1e-30) + Counting::splat(1.0);
        let _ = Counting::splat(f32::MIN_POSITIVE) * Counting::splat(0.25);
        assert_eq!((at(line!() - 2), at(line!() - 1)), (None, None));
        let _ = x + Counting::splat(1.0);
        assert_eq!(at(line!() - 1), Some(1));
        let _ = x.lt(x);
        assert_eq!(at(line!() - 1), Some(2));
    }

    #[test]
    fn flushing_numbers_have_no_subnormals() {
        let (x, least) = (Flushing::splat(TINY), Flushing::splat(f32::MIN_POSITIVE));
        assert_eq!((x * Flushing::splat(4.0)).0.to_bits(), 0);
        assert_eq!((least * Flushing::splat(-0.5)).0.to_bits(), (-0f32).to_bits());
    }
}
