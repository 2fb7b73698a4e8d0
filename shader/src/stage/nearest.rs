//! What is nearest to the points of a stream.

use super::{Found, Segment};
use crate::real::Scalar;
use crate::scene::Hierarchy;
use crate::traverse;

/// The triangle that is nearest to where ray `slot` starts, and the square of its distance there; none beyond the ray's limit.
#[inline(always)]
pub fn nearest<R: Scalar>(hierarchy: &Hierarchy<'_>, slot: u32, stream: &[R::Record]) -> Found<R> {
    let Segment { origin, limit, .. } = Segment::<R>::load(hierarchy.base.frame.slots, slot, stream);
    let mut found = Found { t: limit, ..Found::nothing() };
    traverse::nearest(hierarchy, origin, &mut found);
    found
}
