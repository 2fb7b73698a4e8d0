//! Vectors of three numbers; every sum is from left to right.

use super::{Real, Scalar};
use core::ops::{Add, Mul, Neg, Sub};
use glam::Vec3;

/// A vector, point or linear RGB colour over any [`Real`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct V3<R> {
    /// First component, or red.
    pub x: R,
    /// Second component, or green.
    pub y: R,
    /// Third component, or blue.
    pub z: R,
}

impl<R: Real> V3<R> {
    /// A vector of three components.
    #[inline(always)]
    pub fn new(x: R, y: R, z: R) -> Self {
        V3 { x, y, z }
    }

    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(v: Vec3) -> Self {
        V3::new(R::splat(v.x), R::splat(v.y), R::splat(v.z))
    }

    /// All components zero.
    #[inline(always)]
    pub fn zero() -> Self {
        V3::splat(Vec3::ZERO)
    }

    /// `x*x' + y*y' + z*z'`, added in this order.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The right-handed cross product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        V3::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// Component by component.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        V3::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }

    /// As far from one vector to another as a share says.
    #[inline(always)]
    pub fn mix(self, other: Self, share: R) -> Self {
        self + (other - self) * share
    }

    /// Applies a function to every component.
    #[inline(always)]
    pub fn map(self, f: impl Fn(R) -> R) -> Self {
        V3::new(f(self.x), f(self.y), f(self.z))
    }

    /// Magnitudes.
    #[inline(always)]
    pub fn abs(self) -> Self {
        self.map(R::abs)
    }

    /// Lesser components.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        V3::new(self.x.min(other.x), self.y.min(other.y), self.z.min(other.z))
    }

    /// Greater components.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        V3::new(self.x.max(other.x), self.y.max(other.y), self.z.max(other.z))
    }

    /// Component by component `self * a + b`, by [`Real::fused`].
    #[inline(always)]
    pub fn fused(self, a: Self, b: Self) -> Self {
        V3::new(self.x.fused(a.x, b.x), self.y.fused(a.y, b.y), self.z.fused(a.z, b.z))
    }

    /// Component by component, by [`Real::difference_and_rest`].
    #[inline(always)]
    pub fn difference_and_rest(self, other: Self) -> (Self, Self) {
        let (x, y, z) = (
            self.x.difference_and_rest(other.x),
            self.y.difference_and_rest(other.y),
            self.z.difference_and_rest(other.z),
        );
        (V3::new(x.0, y.0, z.0), V3::new(x.1, y.1, z.1))
    }

    /// Every component times `factor`, by [`Real::product_and_rest`].
    #[inline(always)]
    pub fn product_and_rest(self, factor: R) -> (Self, Self) {
        let (x, y, z) =
            (factor.product_and_rest(self.x), factor.product_and_rest(self.y), factor.product_and_rest(self.z));
        (V3::new(x.0, y.0, z.0), V3::new(x.1, y.1, z.1))
    }

    /// Lesser components, by [`Real::lesser`].
    #[inline(always)]
    pub fn lesser(self, other: Self) -> Self {
        V3::new(self.x.lesser(other.x), self.y.lesser(other.y), self.z.lesser(other.z))
    }

    /// Greater components, by [`Real::greater`].
    #[inline(always)]
    pub fn greater(self, other: Self) -> Self {
        V3::new(self.x.greater(other.x), self.y.greater(other.y), self.z.greater(other.z))
    }

    /// The greatest component.
    #[inline(always)]
    pub fn greatest(self) -> R {
        self.x.max(self.y).max(self.z)
    }

    /// `a` where the mask holds, else `b`.
    #[inline(always)]
    pub fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        V3::new(R::select(mask, a.x, b.x), R::select(mask, a.y, b.y), R::select(mask, a.z, b.z))
    }

    /// Unit vector and length, of components that are zero or between 2^-40 and 2^60; a zero vector gives itself and zero.
    #[inline(always)]
    pub fn direction_and_length(self) -> (Self, R) {
        let length = self.dot(self).sqrt();
        let none = length.eq(R::splat(0.0));
        let shrink = R::select(none, R::splat(1.0), length).reciprocal();
        ((self * shrink).map(|c| c.flush(super::TINY)), length)
    }

    /// A vector whose length is 1 but for an error made one whose length errs by less than half the square of that, beside rounding:
    /// a step of Newton's method, without division or root.
    #[inline(always)]
    pub fn renormalised(self) -> Self {
        let grow = R::splat(1.5) - R::splat(0.5) * self.dot(self);
        (self * grow).map(|c| c.flush(super::TINY))
    }
}

impl<R: Scalar> V3<R> {
    /// As [`V3::direction_and_length`], of any components: they are scaled by a power of two first, so that no square over- or
    /// underflows.
    #[inline(always)]
    pub fn normalised(self) -> (Self, R) {
        let (power, inverse) = self.abs().greatest().binade();
        let (unit, length) = (self * inverse).map(|c| c.flush(super::SMALL)).direction_and_length();
        (unit, length * power)
    }
}

impl<R: Real> Add for V3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        V3::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<R: Real> Sub for V3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        V3::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<R: Real> Mul<R> for V3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        V3::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl<R: Real> Neg for V3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        V3::new(-self.x, -self.y, -self.z)
    }
}
