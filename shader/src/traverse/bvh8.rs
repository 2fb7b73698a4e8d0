//! Traversal of nodes of eight children on a CPU, see [`crate::bvh8`]. Every ray by itself, with the boxes and
//! primitives in the vectors' lanes.
//!
//! A ray crosses plane `p` at `p * inverse - offset`, which errs by the rounding of the offset, of the product and of
//! the difference: with coordinates in [-1, 1], by less than 4 * 2^-24 of a shift of the plane. A primitive's own
//! box may be entered 4 * 2^-24 earlier than it says and left 17 * 2^-24 later: below [`Bvh8Node::MARGIN`]
//! together, so that a box is hit, and entered no later, wherever a primitive's own box inside it is. That leaves room
//! to round entry distances to single precision.

use core::marker::PhantomData;
use core::mem::MaybeUninit;

use super::leaf::{Leaf, occluded};
use super::{Method, Query};
use crate::bvh8::{Bvh8Node, Bvh8Ref, LeafKind};
use crate::ray::{Hit, Ray};
use crate::real::{Lanes, Native, Scalar, SimdIsa, V3};
use crate::scene::TraceContext;

/// See the module. The vectors of `V` test boxes and primitives.
pub struct Bvh8Method<V = Native>(PhantomData<V>);

impl<R: Scalar, V: SimdIsa<R>> Method<R> for Bvh8Method<V> {
    #[inline(always)]
    fn traverse<Q: Query, L: Leaf>(context: &TraceContext<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        let mut walk = Walk::<R, V>::new(ray);
        while walk.step::<Q, L>(context, ray, hit) {}
    }
}

/// A ray on its way.
pub(super) struct Walk<R: Scalar, V: SimdIsa<R>> {
    boxes: Boxes<R, V::Eight>,
    stack: Stack,
    at: Bvh8Ref,
}

impl<R: Scalar, V: SimdIsa<R>> Walk<R, V> {
    /// At the root.
    #[inline(always)]
    pub fn new(ray: &Ray<R>) -> Self {
        Walk { boxes: Boxes::new(ray), stack: Stack::new(), at: Bvh8Ref::ROOT }
    }

    /// At the root, for another ray.
    #[inline(always)]
    pub fn turn(&mut self, ray: &Ray<R>) {
        (self.boxes, self.stack.count, self.at) = (Boxes::new(ray), 0, Bvh8Ref::ROOT);
    }

    /// Visits a node or a leaf. Is anything left?
    #[inline(always)]
    pub fn step<Q: Query, L: Leaf>(&mut self, context: &TraceContext<'_>, ray: &Ray<R>, hit: &mut Hit<R>) -> bool {
        let Walk { boxes, stack, at } = self;
        if at.is_leaf() {
            L::intersect_block::<Q, R, V::Four>(context, *at, ray, hit);
            if Q::ANY && occluded(hit) {
                return false;
            }
        } else {
            Q::on_boxes(8);
            let node = &context.bvh8.nodes[at.index()];
            let (met, near) = boxes.meet(node, hit.t);
            let sorted = if Q::ANY { None } else { V::sorted(met, &near, &node.children.map(|child| child.0)) };
            if let Some(entries) = sorted {
                stack.put_all(&entries, met.count_ones() as usize);
            } else if let Some(next) = if Q::ANY { first(node, met, stack) } else { nearest(node, met, &near, stack) } {
                *at = next;
                return true;
            }
        }
        match stack.take(hit.t.to_f32()) {
            Some(next) => {
                *at = next;
                true
            }
            None => false,
        }
    }

    /// Asks for what the next step reads, which is then on its way from memory while other rays take theirs.
    #[inline(always)]
    pub fn prefetch(&self, context: &TraceContext<'_>) {
        let index = self.at.index();
        if !self.at.is_leaf() {
            prefetch(&context.bvh8.nodes[index]);
        } else if self.at.kind() == LeafKind::Triangles {
            prefetch(&context.bvh8.triangles[index]);
        }
    }
}

/// Asks for all lines of a cache that hold something.
#[inline(always)]
fn prefetch<T>(of: &T) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..size_of::<T>().div_ceil(64) {
        use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing, and each address is in `of` or where that ends.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(core::ptr::from_ref(of).cast::<i8>().byte_add(64 * line)) };
    }
    let _ = of;
}

/// A ray, prepared for box tests.
struct Boxes<R: Scalar, E: Lanes<R>> {
    inverse: V3<E>,
    /// The negated offset.
    start: V3<E>,
    /// For each axis the planes that the ray enters through: 0 for the lower ones, 1 for the upper ones.
    near: [usize; 3],
    scalar: PhantomData<R>,
}

impl<R: Scalar, E: Lanes<R>> Boxes<R, E> {
    #[inline(always)]
    fn new(ray: &Ray<R>) -> Self {
        let (inverse, start) = (ray.inverse, -ray.offset);
        let zero = R::splat(0.0);
        Boxes {
            inverse: V3::new(E::all(inverse.x), E::all(inverse.y), E::all(inverse.z)),
            start: V3::new(E::all(start.x), E::all(start.y), E::all(start.z)),
            near: [inverse.x.lt(zero) as usize, inverse.y.lt(zero) as usize, inverse.z.lt(zero) as usize],
            scalar: PhantomData,
        }
    }

    /// A bit for every box that the ray hits before a limit, and where it enters each.
    #[inline(always)]
    fn meet(&self, node: &Bvh8Node, limit: R) -> (u32, [f32; 8]) {
        let (mut met, mut near) = (0, [0.0; 8]);
        let mut first = 0;
        while first < 8 {
            let enter = self.planes(node, [self.near[0], self.near[1], self.near[2]], first);
            let leave = self.planes(node, [self.near[0] ^ 1, self.near[1] ^ 1, self.near[2] ^ 1], first);
            let entry = E::max_entry(enter);
            met |= E::bits(entry.le(E::min_exit(leave, E::all(limit)))) << first;
            entry.put(&mut near[first..]);
            first += E::COUNT as usize;
        }
        (met, near)
    }

    /// Where the ray crosses planes of the boxes from `first` on, one box a lane.
    #[inline(always)]
    fn planes(&self, node: &Bvh8Node, side: [usize; 3], first: usize) -> V3<E> {
        let plane = V3::new(
            E::taken(&node.planes[0][side[0] & 1][first..]),
            E::taken(&node.planes[1][side[1] & 1][first..]),
            E::taken(&node.planes[2][side[2] & 1][first..]),
        );
        plane.fused(self.inverse, self.start)
    }
}

/// The first child that is hit; the others are pushed in reverse order. Children are sorted by size: an any-hit ray is
/// done sooner in a larger child, whichever is nearer.
#[inline(always)]
fn first(node: &Bvh8Node, mut met: u32, stack: &mut Stack) -> Option<Bvh8Ref> {
    while met != 0 {
        let last = 31 - met.leading_zeros();
        met ^= 1 << last;
        let child = node.children[last as usize & 7];
        if met == 0 {
            return Some(child);
        }
        stack.put(entry(0.0, child));
    }
    None
}

/// The nearest child that is hit; the others are pushed, the nearest last.
#[inline(always)]
fn nearest(node: &Bvh8Node, met: u32, near: &[f32; 8], stack: &mut Stack) -> Option<Bvh8Ref> {
    if met == 0 {
        return None;
    }
    let child = |met: u32| {
        let i = met.trailing_zeros() as usize & 7;
        (entry(near[i], node.children[i]), met & (met - 1))
    };
    let (a, met) = child(met);
    if met == 0 {
        return Some(reference(a));
    }
    let (b, met) = child(met);
    let (first, second) = ordered(a, b);
    if met == 0 {
        stack.put(second);
        return Some(reference(first));
    }
    let (c, met) = child(met);
    let (second, third) = ordered(second, c);
    let (first, second) = ordered(first, second);
    if met == 0 {
        stack.put(third);
        stack.put(second);
        return Some(reference(first));
    }
    let from = stack.count;
    stack.put(third);
    stack.put(second);
    let (mut nearest, mut met) = (first, met);
    while met != 0 {
        let next;
        (next, met) = child(met);
        let (less, more) = ordered(nearest, next);
        nearest = less;
        stack.insert(from, more);
    }
    Some(reference(nearest))
}

/// Where a box is entered, and its child, as an integer: sorted by distance, since distances are at least +0.
#[inline(always)]
fn entry(near: f32, child: Bvh8Ref) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child.0)
}

#[inline(always)]
fn reference(entry: u64) -> Bvh8Ref {
    Bvh8Ref(entry as u32)
}

#[inline(always)]
fn ordered(a: u64, b: u64) -> (u64, u64) {
    (a.min(b), a.max(b))
}

/// The stack of entries.
struct Stack {
    entries: [MaybeUninit<u64>; Stack::MOST],
    count: usize,
}

impl Stack {
    /// Room for seven siblings on each level, of which `eyerays-bvh` allows 32; a power of two.
    const MOST: usize = 256;

    // Not a constant: all of it would be copied, the uninitialised part too.
    #[inline(always)]
    fn new() -> Self {
        Stack { entries: [const { MaybeUninit::uninit() }; Stack::MOST], count: 0 }
    }

    #[inline(always)]
    fn put(&mut self, entry: u64) {
        self.entries[self.count & (Stack::MOST - 1)] = MaybeUninit::new(entry);
        self.count += 1;
    }

    /// Puts the first `count` entries, the last on top.
    #[inline(always)]
    fn put_all(&mut self, entries: &[u64; 8], count: usize) {
        let start = self.count.min(Stack::MOST - 8);
        let room = &mut self.entries[start..start + 8];
        room.copy_from_slice(&entries.map(MaybeUninit::new));
        self.count += count;
    }

    /// Inserts an entry below those from index `from` on that are less.
    #[inline(always)]
    fn insert(&mut self, from: usize, entry: u64) {
        let mut index = self.count;
        while index > from && self.get(index - 1) < entry {
            self.entries[index & (Stack::MOST - 1)] = self.entries[(index - 1) & (Stack::MOST - 1)];
            index -= 1;
        }
        self.entries[index & (Stack::MOST - 1)] = MaybeUninit::new(entry);
        self.count += 1;
    }

    #[inline(always)]
    fn get(&self, index: usize) -> u64 {
        // SAFETY: every index below the count has been set.
        unsafe { self.entries[index & (Stack::MOST - 1)].assume_init() }
    }

    /// Pops the last entry whose box is entered before `limit`.
    #[inline(always)]
    fn take(&mut self, limit: f32) -> Option<Bvh8Ref> {
        while self.count > 0 {
            self.count -= 1;
            let entry = self.get(self.count);
            if f32::from_bits((entry >> 32) as u32) <= limit {
                return Some(reference(entry));
            }
        }
        None
    }
}
