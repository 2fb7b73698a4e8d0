//! Traversal methods. Each is one small file built from the shared steps of [`step`].
//!
//! Every method finds the same hit: the least (t, primitive). A hit lies in the own box of its primitive
//! ([`geometry::edge_on`](crate::geometry)), and a node's box is wider than its contents by more than the error of its test, so it is
//! entered no later than any hit below it, and no order of visits can cull the closest.

#[cfg(not(target_arch = "spirv"))]
mod bvh8;
mod cursor;
mod cwbvh;
mod hybrid;
mod if_if;
#[cfg(not(target_arch = "spirv"))]
mod interleaved8;
pub mod lanes;
pub mod leaf;
mod nearest;
mod nested;
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
#[cfg(not(target_arch = "spirv"))]
pub use interleaved8::{Rays, interleaved};
#[cfg(not(target_arch = "spirv"))]
pub use leaf::Triangles;
pub use leaf::{Crossings, Cutout, Leaf, Primitives};
pub use nearest::nearest;
pub use packet::Packet;
pub use speculative::Speculative;
pub use while_while::WhileWhile;

#[cfg(not(target_arch = "spirv"))]
use self::lanes::RayLanes;
use crate::ray::{Hit, Ray};
use crate::real::Real;
use crate::scene::TraceContext;

/// What a ray searches for.
pub trait Query {
    /// Is any hit enough, and do transparent primitives not count? (Shadow rays, thesis 3.2.)
    const ANY: bool;
    /// Are only surfaces met that are not there, but what is inside of them?
    const OPEN: bool = false;

    /// Called when a ray, or a packet, tests this many boxes. Only statistics implement these callbacks.
    #[inline(always)]
    fn on_boxes(_tested: u32) {}
    /// Called when a ray, or a packet, tests a primitive.
    #[inline(always)]
    fn on_primitive() {}
    /// Called when a packet visits a child; `_lanes` counts those of its rays that hit the child's box.
    #[inline(always)]
    fn on_child(_lanes: impl FnOnce() -> u32) {}
    /// Called when rays of a packet continue one by one (true), and when the packet continues (false).
    #[inline(always)]
    fn on_parted(_parted: bool) {}
}

/// The closest hit.
pub struct Closest;
impl Query for Closest {
    const ANY: bool = false;
}

/// Whether anything opaque lies before the limit; read the result with [`leaf::occluded`].
pub struct Occlusion;
impl Query for Occlusion {
    const ANY: bool = true;
}

/// The closest surface that is not there itself ([`Primitive::OPEN`](crate::data::Primitive)).
pub struct ClosestOpen;
impl Query for ClosestOpen {
    const ANY: bool = false;
    const OPEN: bool = true;
}

/// A traversal method, for the types of numbers that it supports.
pub trait Method<R: Real> {
    /// Traces a ray from the root. `hit` holds the ray's limit before and what was found after.
    fn traverse<Q: Query, L: Leaf>(context: &TraceContext<'_>, ray: &Ray<R>, hit: &mut Hit<R>);
}

/// A method that traces rays over any type of number: on a CPU, several lanes of several values at once.
#[cfg(not(target_arch = "spirv"))]
pub trait Together {
    /// Traces all rays from the root; as [`Method::traverse`] for each.
    fn together<R: RayLanes, Q: Query, L: Leaf>(context: &TraceContext<'_>, rays: &[Ray<R>], hits: &mut [Hit<R>]);
}

#[cfg(test)]
mod tests;
