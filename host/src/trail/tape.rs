//! What a method's kernel does with a ray, told by the kernel's own hooks.

use std::cell::RefCell;

use eyerays_shader::bvh8::Bvh8Ref;
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{F32xN, Lanes, Native, Real, Scalar};
use eyerays_shader::scene::TraceContext;
use eyerays_shader::traverse::{
    self, Bvh8Method, Closest, Cut, Hybrid, IfIf, Interleaved, Leaf, Packet, Primitives, Query, Sequential,
    Speculative, StackMax, WhileWhile,
};
use eyerays_shader::warp::Alone;

use super::block::{Block, LANES};
use crate::follower;
use crate::method::Method;

/// Something that a kernel does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Event {
    /// It tests the boxes of a node.
    Node,
    /// It tests a primitive, by its index in leaf order and the copy of a mesh.
    Primitive(u32, u32),
    /// It tests a leaf of up to four primitives.
    Block(Bvh8Ref),
    /// Rays of a packet go on one by one, or the packet goes on.
    Parted(bool),
}

thread_local! {
    static EVENTS: RefCell<Vec<Event>> = const { RefCell::new(Vec::new()) };
}

fn note(event: Event) {
    EVENTS.with_borrow_mut(|events| events.push(event));
}

/// The closest hit, with hooks that take notes.
struct Noted;

impl Query for Noted {
    const ANY: bool = false;

    fn on_boxes(_: u32) {
        note(Event::Node);
    }

    fn on_parted(parted: bool) {
        note(Event::Parted(parted));
    }
}

/// Leaves of any primitives that take notes of what is tested.
struct NotedLeaf;

impl Leaf for NotedLeaf {
    fn intersect<Q: Query, R: Real>(context: &TraceContext<'_>, place: (u32, u32), ray: &Ray<R>, hit: &mut Hit<R>) {
        note(Event::Primitive(place.0, place.1));
        intersect(context, place, ray, hit);
    }

    fn intersect_block<Q: Query, R: Scalar, F: Lanes<R>>(
        context: &TraceContext<'_>,
        leaf: Bvh8Ref,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
    ) {
        note(Event::Block(leaf));
        Primitives::intersect_block::<Q, R, F>(context, leaf, ray, hit);
    }
}

/// Tests a primitive for the closest hit.
// Compiled once for all methods: their copies of it took minutes.
#[inline(never)]
pub(super) fn intersect<R: Real>(context: &TraceContext<'_>, place: (u32, u32), ray: &Ray<R>, hit: &mut Hit<R>) {
    Primitives::intersect::<Closest, R>(context, place, ray, hit);
}

/// What a method's kernel does with the ray of a lane, or with its packet, and what the ray finds.
pub(super) fn of(method: Method, context: &TraceContext<'_>, block: &Block, lane: usize) -> (Vec<Event>, Hit<f32>) {
    EVENTS.with_borrow_mut(Vec::clear);
    let hit = follower(method)(context, block, lane);
    (EVENTS.take(), hit)
}

/// Follows the ray of a lane.
type Follow = fn(&TraceContext<'_>, &Block, usize) -> Hit<f32>;

/// How a method's rays are followed.
fn follower(method: Method) -> Follow {
    use {packet as plainly, packet as together};
    eyerays_shader::for_each_method!(follower method alone::<Bvh8Method<Native>>)
}

fn alone<M: traverse::Method<f32>>(context: &TraceContext<'_>, block: &Block, lane: usize) -> Hit<f32> {
    let (ray, limit) = block.ray(lane);
    let mut hit = Hit::none(limit);
    M::traverse::<Noted, NotedLeaf>(context, &ray, &mut hit);
    hit
}

fn packet<M: traverse::Method<F32xN<LANES>>>(context: &TraceContext<'_>, block: &Block, lane: usize) -> Hit<f32> {
    let (ray, mut hit) = block.packet();
    M::traverse::<Noted, NotedLeaf>(context, &ray, &mut hit);
    hit.lane(lane)
}
