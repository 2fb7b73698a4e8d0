//! Hybrid traversals (thesis 6.2.3 and 6.2.4): together as a packet as long as that pays, then every
//! ray by itself. They differ in when rays part ([`Switch`]) and in whether they meet again ([`Turn`]).

use core::marker::PhantomData;

use super::cursor::{Cursor, Stack};
use super::packet::visit_leaf;
use super::step::children;
use super::{Method, Query, if_if};
use crate::buffer::read;
use crate::data::{NodeRef, STACK};
use crate::ray::{Hit, Ray};
use crate::real::{Mask, Real};
use crate::scene::Geometry;
use crate::warp::Warp;

/// When a packet parts.
pub trait Switch {
    /// Does it part for good, `depth` nodes waiting?
    fn full(geometry: &Geometry<'_>, depth: u32) -> bool;
    /// Do those who want a child part from the `active` rays of the packet?
    fn few(geometry: &Geometry<'_>, wanting: u32, active: u32) -> bool;
}

/// Parts when a small stack is full (thesis: stack max).
pub struct StackMax;

impl Switch for StackMax {
    #[inline(always)]
    fn full(geometry: &Geometry<'_>, depth: u32) -> bool {
        depth >= geometry.tuning.stack_max()
    }
    #[inline(always)]
    fn few(_: &Geometry<'_>, _: u32, _: u32) -> bool {
        false
    }
}

/// Parts from a child that too few rays want (thesis: cut).
pub struct Cut;

impl Switch for Cut {
    #[inline(always)]
    fn full(_: &Geometry<'_>, _: u32) -> bool {
        false
    }
    #[inline(always)]
    fn few(geometry: &Geometry<'_>, wanting: u32, active: u32) -> bool {
        100 * wanting < geometry.tuning.cut() * active
    }
}

/// What parted rays do in the end.
pub trait Turn {
    /// Do they meet again once their branch is done (interleaved), or never (sequential)?
    const MEETS: bool;
}

/// The packet ends first, then every ray goes on by itself (thesis 6.2.3).
pub struct Sequential;
impl Turn for Sequential {
    const MEETS: bool = false;
}

/// Every branch is ended before the packet goes on (thesis 6.2.4).
pub struct Interleaved;
impl Turn for Interleaved {
    const MEETS: bool = true;
}

/// See the module.
pub struct Hybrid<W, S, T>(PhantomData<(W, S, T)>);

/// Nodes that some rays left for later, and which rays.
struct Later<R: Real> {
    nodes: Stack,
    rays: [R::Mask; STACK],
}

impl<R: Real, W: Warp, S: Switch, T: Turn> Method<R> for Hybrid<W, S, T> {
    #[inline(always)]
    fn traverse<Q: Query>(geometry: &Geometry<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        let mut stack = [0; STACK];
        let mut cursor = Cursor::new();
        let everyone = R::splat(0.0).le(R::splat(0.0));
        let mut later = Later::<R> { nodes: [0; STACK], rays: [everyone; STACK] };
        let mut waiting = 0;
        while !cursor.done {
            if S::full(geometry, cursor.depth()) {
                if T::MEETS {
                    alone::<Q, R>(geometry, cursor.node, everyone, ray, hit);
                    cursor.pop(&stack);
                } else {
                    part::<Q, R>(geometry, &cursor, &stack, ray, hit);
                    cursor.done = true;
                }
            } else if cursor.node.is_leaf() {
                visit_leaf::<Q, R, W>(geometry, ray, hit, &mut cursor, &stack);
            } else {
                let pair = read(geometry.nodes, cursor.node.index());
                let wanted = children(&pair, ray, hit);
                let mut go = |node: NodeRef, rays: R::Mask, hit: &mut Hit<R>| {
                    let few = S::few(geometry, W::count(rays), W::count(everyone));
                    if few && rays.any() {
                        if T::MEETS || waiting == STACK {
                            alone::<Q, R>(geometry, node, rays, ray, hit);
                        } else {
                            later.nodes[waiting & (STACK - 1)] = node.0;
                            later.rays[waiting & (STACK - 1)] = rays;
                            waiting += 1;
                        }
                    }
                    W::any(rays) && !few
                };
                let left = go(pair.left(), wanted.left, hit);
                let right = go(pair.right(), wanted.right, hit);
                let right_first = W::any(wanted.left & wanted.right & wanted.right_first);
                cursor.descend(&pair, left, right, right_first, &mut stack);
            }
        }
        while waiting > 0 {
            waiting -= 1;
            let at = waiting & (STACK - 1);
            alone::<Q, R>(geometry, NodeRef(later.nodes[at]), later.rays[at], ray, hit);
        }
    }
}

/// Every ray of the mask follows a branch by itself.
#[inline(always)]
fn alone<Q: Query, R: Real>(geometry: &Geometry<'_>, node: NodeRef, rays: R::Mask, ray: &Ray<R>, hit: &mut Hit<R>) {
    R::lanes(ray, hit, rays, |ray, hit| {
        let mut stack = [0; STACK];
        if_if::finish::<Q, R::Lane>(geometry, ray, &mut stack, Cursor::at(node), hit);
    });
}

/// Every ray goes on by itself with what the packet has left.
#[inline(always)]
fn part<Q: Query, R: Real>(geometry: &Geometry<'_>, cursor: &Cursor, shared: &Stack, ray: &Ray<R>, hit: &mut Hit<R>) {
    let everyone = R::splat(0.0).le(R::splat(0.0));
    R::lanes(ray, hit, everyone, |ray, hit| {
        let mut stack = [0; STACK];
        let mut i = 0;
        while i < cursor.depth() as usize {
            stack[i & (STACK - 1)] = shared[i & (STACK - 1)];
            i += 1;
        }
        if_if::finish::<Q, R::Lane>(geometry, ray, &mut stack, *cursor, hit);
    });
}
