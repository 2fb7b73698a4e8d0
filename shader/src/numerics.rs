//! The functions that exact arithmetic is built from, one at a time: tests compare their bits between devices.

use crate::real::{Real, Scalar, power, turns};
use glam::UVec4;

/// What is evaluated.
pub mod function {
    /// `a / b`.
    pub const QUOTIENT: u32 = 0;
    /// `1 / a`, both normal.
    pub const RECIPROCAL: u32 = 1;
    /// The square root of `a`.
    pub const ROOT: u32 = 2;
    /// `a` to the power of `b`, see [`crate::real::power::pow`].
    pub const POWER: u32 = 3;
    /// The logarithm of `a`, see [`crate::real::power::log2`].
    pub const LOGARITHM: u32 = 4;
    /// 2 to the power of `a`, see [`crate::real::power::exp2`].
    pub const EXPONENTIAL: u32 = 5;
    /// The cosine of an angle of `a` steps, see [`crate::real::turns::cos_sin`].
    pub const COSINE: u32 = 6;
    /// Its sine.
    pub const SINE: u32 = 7;
    /// The angle of (`b`, `a`), see [`crate::real::turns::atan2`].
    pub const ANGLE: u32 = 8;
}

/// The bits of a function's value in exact precision, from the bits of its operands `a` and `b` and its number.
#[inline(always)]
pub fn evaluate(operation: UVec4) -> u32 {
    let (a, b) = (f32::from_bits(operation.x), f32::from_bits(operation.y));
    let value = match operation.z {
        function::QUOTIENT => Real::div(a, b),
        function::RECIPROCAL => Real::reciprocal(a),
        function::ROOT => Real::sqrt(a),
        function::POWER => Scalar::pow(a, b),
        function::LOGARITHM => power::log2(a),
        function::EXPONENTIAL => power::exp2(a),
        function::COSINE => turns::cos_sin(operation.x).0,
        function::SINE => turns::cos_sin(operation.x).1,
        _ => turns::atan2(a, b),
    };
    value.to_bits()
}
