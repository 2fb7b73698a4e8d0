//! Ways through the hierarchy. A method is one small file over the shared steps of [`step`].
//!
//! Every method finds the same hit: the least (t, primitive) among the triangles whose own box the
//! ray meets, with t clamped into that box. An ancestor's box is entered no later than a triangle's
//! own (the box test is monotone), so no order of visits can cull the winner.

pub mod cursor;
mod if_if;
mod packet;
pub mod step;

pub use if_if::IfIf;
pub use packet::Packet;

use crate::ray::{Hit, Ray};
use crate::real::Real;
use crate::scene::Geometry;

/// What a ray asks for.
pub trait Query {
    /// Is any hit enough, and do transparent triangles not count? (Shadow rays, thesis 3.2.)
    const ANY: bool;
}

/// The closest hit.
pub struct Closest;
impl Query for Closest {
    const ANY: bool = false;
}

/// Whether anything opaque lies before the limit; [`step::occluded`] tells.
pub struct Occlusion;
impl Query for Occlusion {
    const ANY: bool = true;
}

/// A way through the hierarchy, for rays over the numbers that it can follow.
pub trait Method<R: Real> {
    /// Follows a ray from the root and leaves what it finds in `hit`, which holds its limit before.
    fn traverse<Q: Query>(geometry: &Geometry<'_>, ray: &Ray<R>, hit: &mut Hit<R>);
}

#[cfg(test)]
mod tests;
