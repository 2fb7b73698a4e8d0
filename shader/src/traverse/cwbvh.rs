//! Traversal of nodes of eight children (Ylitie, Karras and Laine 2017: CWBVH): every ray by itself, in
//! every step at most one node and at most one primitive.
//!
//! The boxes lie on a grid of bytes. The grid is transformed instead of every plane: the ray crosses plane
//! `origin + q * step` at `f * extent + start`, where `extent` is 256 steps times the inverse and `f` is
//! 1 + q / 256, or 256 + q / 256 for every second child, and `start` compensates for the 1 or the 256.
//!
//! With coordinates in [-1, 1] that errs by less than 9 * 2^-24 and 3/256 of a step, as a shift of the plane, the
//! entry into a primitive's own box by 4 * 2^-24, and its widened exit by 17 * 2^-24. The quantised boxes' margin of
//! 2^-19 and 1/64 of a step covers all, so a node is entered no later than any primitive's own box below it, and no
//! order of visits can cull a hit.

use super::Query;
use super::leaf::{Leaf, occluded};
use super::nested;
use super::resumable::{Progress, Resumable, stepwise};
use crate::buffer::read;
use crate::data::{CwbvhNode, STACK, numbers};
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};
use crate::scene::TraceContext;
use glam::{UVec4, Vec3};

/// See the module.
pub struct CwbvhMethod;

/// Inner nodes of one parent that are still to visit.
#[derive(Clone, Copy)]
struct Nodes {
    /// The parent's first.
    first: u32,
    /// A bit each from bit 24 on, in the ray's order, the nearest in the highest; and in bits 0 to 7 which slots
    /// of the parent are inner nodes.
    waiting: u32,
}

/// The bits of inner nodes.
const NODES: u32 = 0xff00_0000;

impl Nodes {
    const NOTHING: Nodes = Nodes { first: 0, waiting: 0 };

    #[inline(always)]
    fn any(self) -> bool {
        self.waiting & NODES != 0
    }
}

/// Primitives of one parent that are still to test.
#[derive(Clone, Copy)]
struct Primitives {
    /// The parent's first.
    first: u32,
    /// Bits of those still to test.
    waiting: u32,
    /// Bits of all.
    all: u32,
}

impl Primitives {
    const NOTHING: Primitives = Primitives { first: 0, waiting: 0, all: 0 };

    /// Takes one and returns its index.
    #[inline(always)]
    fn take(&mut self) -> u32 {
        let bit = 1 << (31 - self.waiting.leading_zeros());
        self.waiting ^= bit;
        self.first + (self.all & (bit - 1)).count_ones()
    }
}

/// The current groups.
#[derive(Clone, Copy)]
pub struct Groups {
    nodes: Nodes,
    primitives: Primitives,
    depth: u32,
}

impl Progress for Groups {
    /// The root, a child without siblings, so that it comes first whatever the ray's order.
    #[inline(always)]
    fn start() -> Self {
        Groups { nodes: Nodes { first: 0, waiting: 1 << 31 }, ..Self::finished() }
    }

    #[inline(always)]
    fn finished() -> Self {
        Groups { nodes: Nodes::NOTHING, primitives: Primitives::NOTHING, depth: 0 }
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        !self.nodes.any() && self.primitives.waiting == 0 && self.depth == 0
    }
}

impl Groups {
    /// Takes the nearest node and pushes the rest of its group. Slots are XORed with `inverted` to get the ray's
    /// order.
    ///
    /// # Safety
    /// A node or a group is left, and all groups that were pushed are on this stack.
    #[inline(always)]
    unsafe fn take(&mut self, inverted: u32, stack: &mut Stack) -> u32 {
        let mut group = self.nodes;
        if !group.any() {
            self.depth -= 1;
            // SAFETY: every index below the depth has been set.
            group = unsafe { Nodes { first: stack.get(2 * self.depth), waiting: stack.get(2 * self.depth + 1) } };
        }
        let place = 31 - group.waiting.leading_zeros();
        group.waiting &= !(1 << place);
        let slot = (place - 24) ^ inverted;
        if group.any() {
            stack.put(2 * self.depth, group.first);
            stack.put(2 * self.depth + 1, group.waiting);
            self.depth += 1;
        }
        // Counts the siblings before it.
        group.first + (group.waiting & ((1 << slot) - 1)).count_ones()
    }
}

/// Groups still to visit, two words each.
pub type Stack = super::stack::Stack<u32, { 2 * STACK }>;

stepwise!(CwbvhMethod);

impl<R: Scalar> Resumable<R> for CwbvhMethod {
    type Cursor = Groups;
    type Stack = Stack;

    #[inline(always)]
    fn stack() -> Stack {
        Stack::new()
    }

    #[inline(always)]
    unsafe fn step<Q: Query, L: Leaf>(
        context: &TraceContext<'_>,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
        cursor: &mut Groups,
        stack: &mut Self::Stack,
    ) {
        if cursor.primitives.waiting == 0 {
            // SAFETY: it is not done, and no primitive waits.
            let node = unsafe { cursor.take(inverted(ray), stack) };
            let node = read(context.wide, node);
            Q::on_boxes(CwbvhNode::ARITY as u32);
            (cursor.nodes, cursor.primitives) = open(&node, ray, hit);
        }
        if cursor.primitives.waiting != 0 {
            let index = cursor.primitives.take();
            nested::intersect::<Q, L, R>(context, index, ray, hit);
            if Q::ANY && occluded(hit) {
                *cursor = Groups::finished();
            }
        }
    }
}

/// What a slot is XORed with for a ray, so that the nearest child has the highest bit: slot `s` is the
/// first for a ray whose direction is negative on the axes of the bits of `s`.
#[inline(always)]
fn inverted<R: Scalar>(ray: &Ray<R>) -> u32 {
    let zero = R::splat(0.0);
    let bit = |c: R, bit: u32| if c.lt(zero) { 0 } else { bit };
    bit(ray.inverse.x, 1) | bit(ray.inverse.y, 2) | bit(ray.inverse.z, 4)
}

/// Tests the eight boxes of a node. Returns the inner children that are hit, and the primitives of the leaves that are.
#[inline(always)]
fn open<R: Scalar>(node: &CwbvhNode, ray: &Ray<R>, hit: &Hit<R>) -> (Nodes, Primitives) {
    let opening = Opening::<R>::new(node, ray, hit.t);
    // Not a loop, since it is not always unrolled.
    let met = opening.met(0)
        | opening.met(1)
        | opening.met(2)
        | opening.met(3)
        | opening.met(4)
        | opening.met(5)
        | opening.met(6)
        | opening.met(7);
    let (inner, primitives) = (node.grid.w, node.children.z);
    let nodes = Nodes { first: node.children.x, waiting: turned(met & inner & NODES, inverted(ray)) | (inner >> 24) };
    (nodes, Primitives { first: node.children.y, waiting: met & primitives, all: primitives })
}

/// Bits of slots in a ray's order: bit 24 + `slot` becomes bit 24 + (`slot` XOR `inverted`).
#[inline(always)]
fn turned(slots: u32, inverted: u32) -> u32 {
    let (by_1, by_2, by_4) = (inverted & 1, inverted & 2, inverted & 4);
    let slots = ((slots << by_1) & 0xaa00_0000) | ((slots >> by_1) & 0x5500_0000);
    let slots = ((slots << by_2) & 0xcc00_0000) | ((slots >> by_2) & 0x3300_0000);
    ((slots << by_4) & 0xf000_0000) | ((slots >> by_4) & 0x0f00_0000)
}

/// A node's grid, transformed for a ray.
struct Opening<R: Scalar> {
    /// Where the ray crosses the plane 256 steps before the grid's origin, and the one 256 * 256 steps before it.
    start: [V3<R>; 2],
    /// The length of 256 steps along the ray.
    extent: V3<R>,
    /// Where the ray ends.
    limit: R,
    /// Planes that the ray enters through, by axis: words to be read as they are for children 0, 1, 4 and 5, and
    /// rotated by half for the others.
    near: [[u32; 4]; 3],
    /// Planes that it leaves through.
    far: [[u32; 4]; 3],
}

impl<R: Scalar> Opening<R> {
    #[inline(always)]
    fn new(node: &CwbvhNode, ray: &Ray<R>, limit: R) -> Self {
        let power = |shift: u32| f32::from_bits(((node.grid.w >> shift) & 255) << 23);
        let extent = V3::<R>::splat(Vec3::new(power(0), power(8), power(16))).times(ray.inverse);
        let start = (V3::splat(numbers(node.grid)) - ray.origin).times(ray.inverse);
        let first = |q: UVec4| [q.x, q.y];
        let last = |q: UVec4| [q.z, q.w];
        let zero = R::splat(0.0);
        let x = sides(ray.inverse.x.lt(zero), first(node.low_x_low_y), last(node.low_z_high_x));
        let y = sides(ray.inverse.y.lt(zero), last(node.low_x_low_y), first(node.high_y_high_z));
        let z = sides(ray.inverse.z.lt(zero), first(node.low_z_high_x), last(node.high_y_high_z));
        Opening {
            start: [start - extent, start - extent * R::splat(256.0)],
            extent,
            limit,
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
        }
    }

    /// The bits that a child may have in the node's masks, if its box is hit; else none.
    #[inline(always)]
    fn met(&self, child: u32) -> u32 {
        let start = self.start[if child & 1 == 1 { 0 } else { 1 }];
        let near = self.planes(&self.near, child).fused(self.extent, start);
        let far = self.planes(&self.far, child).fused(self.extent, start);
        if R::max_entry(near).le(R::min_exit(far, self.limit)) { (1 << (24 + child)) | (7 << (3 * child)) } else { 0 }
    }

    /// A child's planes: in units of 256 steps and 1 too large for odd children, 256 too large for the others.
    #[inline(always)]
    fn planes(&self, words: &[[u32; 4]; 3], child: u32) -> V3<R> {
        let word = (child >> 1) as usize & 3;
        V3::new(plane(words[0][word], child), plane(words[1][word], child), plane(words[2][word], child))
    }
}

/// The near and the far planes, given the lower and the upper ones.
#[inline(always)]
fn sides(down: bool, low: [u32; 2], high: [u32; 2]) -> ([u32; 4], [u32; 4]) {
    if down { (both(high), both(low)) } else { (both(low), both(high)) }
}

/// Two words, each followed by itself rotated by half.
#[inline(always)]
fn both([a, b]: [u32; 2]) -> [u32; 4] {
    [a, a.rotate_left(16), b, b.rotate_left(16)]
}

/// The plane of a child in its word, placed in the fraction of a float: of 1 for odd children, of 256 for the
/// others, whose plane lies 8 bits lower. That takes fewer instructions than converting the byte.
#[inline(always)]
fn plane<R: Scalar>(word: u32, child: u32) -> R {
    let bits = if child & 1 == 1 { (word & 0x007f_8000) | 0x3f80_0000 } else { (word & 0x7f80) | 0x4380_0000 };
    R::splat(f32::from_bits(bits))
}
