//! Ways through the hierarchy. A method is one small file over the shared steps of [`step`].
//!
//! Every method finds the same hit: the least (t, primitive) among the slots whose own box the ray
//! meets, with t no less than the entry to that box. A node's box is wider than what it holds by more
//! than the tests of both may err, so it is entered no later, and no order of visits can cull the winner.

#[cfg(not(target_arch = "spirv"))]
mod bvh8;
pub mod cursor;
mod cwbvh;
mod hybrid;
mod if_if;
mod packet;
pub mod resumable;
mod speculative;
mod stack;
pub mod step;
mod while_while;

#[cfg(not(target_arch = "spirv"))]
pub use bvh8::Bvh8Method;
pub use cwbvh::CwbvhMethod;
pub use hybrid::{Cut, Hybrid, Interleaved, Sequential, StackMax};
pub use if_if::IfIf;
pub use packet::Packet;
pub use speculative::Speculative;
pub use while_while::WhileWhile;

use crate::ray::{Hit, Ray};
use crate::real::Real;
use crate::scene::Geometry;

/// What a ray asks for.
pub trait Query {
    /// Is any hit enough, and do transparent triangles not count? (Shadow rays, thesis 3.2.)
    const ANY: bool;

    /// Is told that a ray, or a packet, tests boxes of this number. Statistics alone listen.
    #[inline(always)]
    fn on_boxes(_tested: u32) {}
    /// Is told that a ray, or a packet, tests a triangle.
    #[inline(always)]
    fn on_triangle() {}
    /// Is told that a packet goes to a child; `_lanes` counts those of its rays that want it.
    #[inline(always)]
    fn on_child(_lanes: impl FnOnce() -> u32) {}
    /// Is told that rays of a packet go on by themselves, one after the other, or that the packet does.
    #[inline(always)]
    fn on_parted(_parted: bool) {}
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

/// A method that follows rays over any numbers: on a CPU, several lanes of several values at once.
#[cfg(not(target_arch = "spirv"))]
pub trait Together {
    /// Follows all rays from the root; as [`Method::traverse`] for each.
    fn together<R: Real, Q: Query>(geometry: &Geometry<'_>, rays: &[Ray<R>], hits: &mut [Hit<R>]);
}

#[cfg(test)]
mod tests;
