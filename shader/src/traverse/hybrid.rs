//! Hybrid traversals (thesis 6.2.3 and 6.2.4): as a packet as long as that pays, then ray by ray.
//! They differ in when the packet splits ([`SplitPolicy`]) and in whether it rejoins ([`Turn`]).

use core::marker::PhantomData;

use super::cursor::{Cursor, Stack};
use super::lanes::RayLanes;
use super::leaf::Leaf;
use super::packet::{goes, visit_leaf};
use super::resumable::{Progress, finish};
use super::step::children;
use super::{IfIf, Method, Query};
use crate::data::{Effects, NodeRef, STACK};
use crate::ray::{Hit, Ray};
use crate::real::{Mask, Real};
use crate::scene::TraceContext;
use crate::warp::Warp;

/// When a packet splits.
pub trait SplitPolicy {
    /// With `depth` nodes on the stack, does the whole packet split?
    fn full(context: &TraceContext<'_>, depth: u32) -> bool;
    /// Do the rays that hit a child leave the packet, which has `active` rays, to visit it alone?
    fn few(context: &TraceContext<'_>, wanting: impl FnOnce() -> u32, active: impl FnOnce() -> u32) -> bool;
}

/// Splits when a small stack is full (thesis: stack max).
pub struct StackMax;

impl SplitPolicy for StackMax {
    #[inline(always)]
    fn full(context: &TraceContext<'_>, depth: u32) -> bool {
        depth >= context.base.spec.tuning.stack_max()
    }
    #[inline(always)]
    fn few(_: &TraceContext<'_>, _: impl FnOnce() -> u32, _: impl FnOnce() -> u32) -> bool {
        false
    }
}

/// Splits at a child that too few rays hit (thesis: cut).
pub struct Cut;

impl SplitPolicy for Cut {
    #[inline(always)]
    fn full(_: &TraceContext<'_>, _: u32) -> bool {
        false
    }
    #[inline(always)]
    fn few(context: &TraceContext<'_>, wanting: impl FnOnce() -> u32, active: impl FnOnce() -> u32) -> bool {
        100 * wanting() < context.base.spec.tuning.cut() * active()
    }
}

/// When split rays are traced.
pub trait Turn {
    /// Do they rejoin the packet once their branch is done (interleaved), or never (sequential)?
    const REJOINS: bool;
}

/// The packet finishes first, then every ray continues alone (thesis 6.2.3).
pub struct Sequential;
impl Turn for Sequential {
    const REJOINS: bool = false;
}

/// Every branch is finished before the packet continues (thesis 6.2.4).
pub struct Interleaved;
impl Turn for Interleaved {
    const REJOINS: bool = true;
}

/// See the module.
pub struct Hybrid<W, S, T>(PhantomData<(W, S, T)>);

/// Nodes to visit ray by ray after the packet, and by which rays.
struct DeferredStack<R: Real> {
    nodes: Stack,
    /// The copies of meshes that they are in.
    instances: super::stack::Stack<u32, STACK>,
    rays: [R::Mask; STACK],
    count: u32,
}

impl<R: Real> DeferredStack<R> {
    /// Adds a node of a copy of a mesh or of none, for some rays.
    #[inline(always)]
    fn put(&mut self, context: &TraceContext<'_>, (node, instance): (NodeRef, u32), rays: R::Mask) {
        self.nodes.put(self.count, node);
        if context.base.spec.effects.has(Effects::INSTANCED) {
            self.instances.put(self.count, instance);
        }
        self.rays[self.count as usize & (STACK - 1)] = rays;
        self.count += 1;
    }

    /// The node at an index, and the copy that it is in.
    ///
    /// # Safety
    /// It has been put there.
    #[inline(always)]
    unsafe fn node(&self, context: &TraceContext<'_>, index: u32) -> (NodeRef, u32) {
        // SAFETY: the caller's.
        let node = unsafe { self.nodes.get(index) };
        if context.base.spec.effects.has(Effects::INSTANCED) {
            // SAFETY: likewise.
            return (node, unsafe { self.instances.get(index) });
        }
        (node, Hit::<f32>::NOTHING)
    }
}

impl<R: RayLanes, W: Warp, S: SplitPolicy, T: Turn> Method<R> for Hybrid<W, S, T> {
    #[inline(always)]
    fn traverse<Q: Query, L: Leaf>(context: &TraceContext<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        let mut stack = Stack::new();
        let mut cursor = Cursor::new();
        let mut deferred = DeferredStack::<R> {
            nodes: Stack::new(),
            instances: super::stack::Stack::new(),
            rays: [everyone::<R>(); STACK],
            count: 0,
        };
        while !cursor.is_done() {
            if S::full(context, cursor.depth()) {
                if T::REJOINS {
                    alone::<Q, L, R>(context, (cursor.node, cursor.instance), everyone::<R>(), ray, hit);
                    // SAFETY: it pushes to no other stack.
                    unsafe { cursor.pop(&stack) };
                } else {
                    // SAFETY: likewise.
                    unsafe { part::<Q, L, R>(context, &cursor, &stack, ray, hit) };
                    cursor.finish();
                }
            } else if cursor.node.is_leaf() {
                // SAFETY: likewise.
                unsafe { visit_leaf::<Q, L, R, W>(context, ray, hit, &mut cursor, &stack) };
            } else {
                let pair = cursor.open(&context.hierarchy(), ray.time);
                let instance = cursor.instance;
                Q::on_boxes(2);
                let wanted = children(&pair, ray, hit);
                let left = together::<Q, L, R, W, S, T>(
                    context,
                    (pair.left(), instance),
                    wanted.left,
                    ray,
                    (hit, &mut deferred),
                );
                let right = together::<Q, L, R, W, S, T>(
                    context,
                    (pair.right(), instance),
                    wanted.right,
                    ray,
                    (hit, &mut deferred),
                );
                let right_first = W::any(wanted.left & wanted.right & wanted.right_first);
                // SAFETY: likewise.
                unsafe { cursor.descend(&pair, left, right, right_first, &mut stack) };
            }
        }
        while deferred.count > 0 {
            deferred.count -= 1;
            // SAFETY: every index below the count has been set.
            let node = unsafe { deferred.node(context, deferred.count) };
            alone::<Q, L, R>(context, node, deferred.rays[deferred.count as usize & (STACK - 1)], ray, hit);
        }
    }
}

#[cfg(not(target_arch = "spirv"))]
impl<W: Warp, S: SplitPolicy, T: Turn> super::Together for Hybrid<W, S, T> {
    #[inline(always)]
    fn together<R: RayLanes, Q: Query, L: Leaf>(context: &TraceContext<'_>, rays: &[Ray<R>], hits: &mut [Hit<R>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            Self::traverse::<Q, L>(context, ray, hit);
        }
    }
}

/// All rays of the packet.
#[inline(always)]
fn everyone<R: Real>() -> R::Mask {
    R::splat(0.0).le(R::splat(0.0))
}

/// Does the packet visit a child? If too few rays hit it, they visit it one by one, now or later.
#[inline(always)]
fn together<Q: Query, L: Leaf, R: RayLanes, W: Warp, S: SplitPolicy, T: Turn>(
    context: &TraceContext<'_>,
    node: (NodeRef, u32),
    rays: R::Mask,
    ray: &Ray<R>,
    (hit, deferred): (&mut Hit<R>, &mut DeferredStack<R>),
) -> bool {
    if !S::few(context, || W::count(rays), || W::count(everyone::<R>())) {
        return goes::<Q, R, W>(rays);
    }
    if !rays.any() {
        return false;
    }
    if T::REJOINS || deferred.count == STACK as u32 {
        alone::<Q, L, R>(context, node, rays, ray, hit);
    } else {
        deferred.put(context, node, rays);
    }
    false
}

/// Traces every ray of the mask through a branch by itself.
#[inline(always)]
fn alone<Q: Query, L: Leaf, R: RayLanes>(
    context: &TraceContext<'_>,
    (node, instance): (NodeRef, u32),
    rays: R::Mask,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    Q::on_parted(true);
    R::each_lane(ray, hit, rays, |ray, hit| {
        let mut stack = Stack::new();
        // SAFETY: a cursor at a node has pushed nothing.
        unsafe { finish::<Q, L, R::Lane, IfIf>(context, ray, hit, Cursor::at(node, instance), &mut stack) };
    });
    Q::on_parted(false);
}

/// Traces every ray by itself through what the packet has left to visit.
///
/// # Safety
/// All that the cursor has pushed is on the shared stack.
#[inline(always)]
unsafe fn part<Q: Query, L: Leaf, R: RayLanes>(
    context: &TraceContext<'_>,
    cursor: &Cursor,
    shared: &Stack,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) {
    Q::on_parted(true);
    R::each_lane(ray, hit, everyone::<R>(), |ray, hit| {
        let mut stack = Stack::new();
        let mut i = 0;
        while i < cursor.depth() {
            // SAFETY: every index below the depth has been set.
            stack.put(i, unsafe { shared.get(i) });
            i += 1;
        }
        // SAFETY: all that is on the shared stack is on this one.
        unsafe { finish::<Q, L, R::Lane, IfIf>(context, ray, hit, *cursor, &mut stack) };
    });
    Q::on_parted(false);
}
