//! The frame of a surface: three unit axes at right angles, of which the third is the normal.

use crate::real::{SMALL, Scalar, TINY, V3};

/// A vector of the world, in the frame.
#[inline(always)]
pub(super) fn local<R: Scalar>([x, y, z]: [V3<R>; 3], v: V3<R>) -> V3<R> {
    V3::new(x.dot(v), y.dot(v), z.dot(v)).map(|c| c.flush(SMALL))
}

/// A unit vector of the frame, in the world.
#[inline(always)]
pub(super) fn world<R: Scalar>([x, y, z]: [V3<R>; 3], v: V3<R>) -> V3<R> {
    // Components of the frame are flushed below 2^-40 and those of its axes below 2^-60: no product is subnormal.
    (x * v.x + y * v.y + z * v.z).map(|c| c.flush(TINY)).renormalised()
}

/// The unit vector between two others.
#[inline(always)]
pub(super) fn half<R: Scalar>(a: V3<R>, b: V3<R>) -> V3<R> {
    (a + b).map(|c| c.flush(SMALL)).direction_and_length().0.map(|c| c.flush(SMALL))
}
