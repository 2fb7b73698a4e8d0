//! Traversal of nodes of eight children (Ylitie, Karras and Laine 2017: CWBVH): every ray by itself, in
//! every step at most one node and at most one triangle.
//!
//! The boxes lie on a grid of bytes. Instead of every plane, the grid is brought into the ray's terms:
//! a plane `origin + q * 2^e` is met at `q * (2^e * inverse) + (origin - start) * inverse`. With
//! coordinates in [-1, 1] that errs by less than 2.3 * 2^-22 times the inverse, and the entry into a
//! triangle's own box by 2^-22 times it; the quantised boxes' margin of 2^-19 covers both, so a node is
//! entered no later than any triangle's own box below it, and no order of visits can cull a hit.

use super::resumable::{Progress, Resumable, follow};
use super::step::occluded;
use super::step::triangle;
use super::{Method, Query};
use crate::buffer::read;
use crate::data::{NodeRef, STACK, WideNode, numbers};
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};
use crate::scene::Geometry;
use glam::{UVec4, Vec3};

/// See the module.
pub struct WideNodes;

/// Children that wait: inner nodes of one parent, or its triangles.
#[derive(Clone, Copy)]
struct Group {
    /// The parent's first inner child, or its first triangle.
    first: u32,
    /// For triangles a bit each. For nodes a bit each from bit 24 on, in the ray's order, the nearest in
    /// the highest; and in bits 0 to 7 which slots of the parent are inner nodes.
    waiting: u32,
}

const NODES: u32 = 0xff00_0000;

impl Group {
    const NOTHING: Group = Group { first: 0, waiting: 0 };

    #[inline(always)]
    fn has_nodes(self) -> bool {
        self.waiting & NODES != 0
    }
}

/// The groups in hand.
#[derive(Clone, Copy)]
pub struct Groups {
    nodes: Group,
    triangles: Group,
    depth: u32,
}

impl Progress for Groups {
    /// The root, a child without siblings, so that it comes first whatever the ray's order.
    #[inline(always)]
    fn start() -> Self {
        let root = Group { first: 0, waiting: 1 << 31 };
        Groups { nodes: root, triangles: Group::NOTHING, depth: 0 }
    }

    #[inline(always)]
    fn finished() -> Self {
        Groups { nodes: Group::NOTHING, triangles: Group::NOTHING, depth: 0 }
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        !self.nodes.has_nodes() && self.triangles.waiting == 0 && self.depth == 0
    }
}

impl Groups {
    /// Takes the nearest node that waits in hand; the rest of its group waits on. `inverted` is what the
    /// ray's order turns slots by.
    #[inline(always)]
    fn take(&mut self, inverted: u32, stack: &mut Stack) -> u32 {
        let mut group = self.nodes;
        if !group.has_nodes() {
            self.depth -= 1;
            let at = (2 * self.depth as usize) & (2 * STACK - 1);
            (group.first, group.waiting) = (stack[at], stack[at + 1]);
        }
        let place = 31 - group.waiting.leading_zeros();
        group.waiting &= !(1 << place);
        let slot = (place - 24) ^ inverted;
        if group.has_nodes() {
            let at = (2 * self.depth as usize) & (2 * STACK - 1);
            (stack[at], stack[at + 1]) = (group.first, group.waiting);
            self.depth += 1;
        }
        // The siblings before it.
        group.first + (group.waiting & ((1 << slot) - 1)).count_ones()
    }
}

/// Groups that wait, two words each.
type Stack = [u32; 2 * STACK];

impl<R: Scalar> Resumable<R> for WideNodes {
    type Cursor = Groups;
    type Stack = Stack;
    const EMPTY: Stack = [0; 2 * STACK];

    #[inline(always)]
    fn step<Q: Query>(
        geometry: &Geometry<'_>,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
        cursor: &mut Groups,
        stack: &mut Self::Stack,
    ) {
        if cursor.triangles.waiting == 0 {
            let node = cursor.take(inverted(ray), stack);
            let node = read(geometry.wide, node);
            Q::on_boxes(WideNode::ARITY as u32);
            (cursor.nodes, cursor.triangles) = open(&node, ray, hit);
        }
        if cursor.triangles.waiting != 0 {
            let place = 31 - cursor.triangles.waiting.leading_zeros();
            triangle::<Q, R>(geometry, NodeRef::leaf(cursor.triangles.first + place, 1), ray, hit);
            cursor.triangles.waiting &= !(1 << place);
            if Q::ANY && occluded(hit) {
                *cursor = Groups::finished();
            }
        }
    }
}

impl<R: Scalar> Method<R> for WideNodes {
    #[inline(always)]
    fn traverse<Q: Query>(geometry: &Geometry<'_>, ray: &Ray<R>, hit: &mut Hit<R>) {
        follow::<Q, R, Self>(geometry, ray, hit);
    }
}

/// What a slot is turned by for a ray, so that the nearest child has the highest bit: slot `s` is the
/// first for a ray whose direction is negative on the axes of the bits of `s`.
#[inline(always)]
fn inverted<R: Scalar>(ray: &Ray<R>) -> u32 {
    let zero = R::splat(0.0);
    let bit = |c: R, bit: u32| if c.lt(zero) { 0 } else { bit };
    bit(ray.inverse.x, 1) | bit(ray.inverse.y, 2) | bit(ray.inverse.z, 4)
}

/// Tests the eight boxes of a node: the inner children that are met, and the triangles of those leaves.
#[inline(always)]
fn open<R: Scalar>(node: &WideNode, ray: &Ray<R>, hit: &Hit<R>) -> (Group, Group) {
    let opening = Opening::<R>::new(node, ray, hit.t);
    // A loop is not always unrolled.
    let waiting = opening.waiting(0)
        | opening.waiting(1)
        | opening.waiting(2)
        | opening.waiting(3)
        | opening.waiting(4)
        | opening.waiting(5)
        | opening.waiting(6)
        | opening.waiting(7);
    let nodes = Group { first: node.children.x, waiting: (waiting & NODES) | (node.grid.w >> 24) };
    (nodes, Group { first: node.children.y, waiting: waiting & !NODES })
}

/// A node in a ray's terms.
struct Opening<R: Scalar> {
    /// Where the ray meets the grid's origin.
    start: V3<R>,
    /// How far it is to the next plane.
    step: V3<R>,
    /// Where the ray ends.
    limit: R,
    /// Bytes of the planes that the ray enters by, an axis after the other.
    near: [[u32; 2]; 3],
    /// Bytes of the planes that it leaves by.
    far: [[u32; 2]; 3],
    /// Bytes of how many bits wait (3 to 0) at each child.
    bits: [u32; 2],
    /// Bytes of where they wait.
    places: [u32; 2],
}

impl<R: Scalar> Opening<R> {
    #[inline(always)]
    fn new(node: &WideNode, ray: &Ray<R>, limit: R) -> Self {
        let power = |shift: u32| f32::from_bits(((node.grid.w >> shift) & 255) << 23);
        let scale = V3::<R>::splat(Vec3::new(power(0), power(8), power(16)));
        let first = |q: UVec4| [q.x, q.y];
        let last = |q: UVec4| [q.z, q.w];
        let zero = R::splat(0.0);
        let x = sides(ray.inverse.x.lt(zero), first(node.low_x_low_y), last(node.low_z_high_x));
        let y = sides(ray.inverse.y.lt(zero), last(node.low_x_low_y), first(node.high_y_high_z));
        let z = sides(ray.inverse.z.lt(zero), first(node.low_z_high_x), last(node.high_y_high_z));
        let (children, inverted) = (last(node.children), inverted(ray));
        Opening {
            start: (V3::splat(numbers(node.grid)) - ray.origin).times(ray.inverse),
            step: scale.times(ray.inverse),
            limit,
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
            bits: [(children[0] >> 5) & 0x0707_0707, (children[1] >> 5) & 0x0707_0707],
            places: [places(children[0], inverted), places(children[1], inverted)],
        }
    }

    /// What waits of a child if its box is met.
    #[inline(always)]
    fn waiting(&self, child: u32) -> u32 {
        let near = V3::new(plane(self.near[0], child), plane(self.near[1], child), plane(self.near[2], child));
        let far = V3::new(plane(self.far[0], child), plane(self.far[1], child), plane(self.far[2], child));
        let near = R::latest(near.fused(self.step, self.start));
        if near.le(R::earliest(far.fused(self.step, self.start), self.limit)) {
            byte(self.bits, child) << byte(self.places, child)
        } else {
            0
        }
    }
}

/// The nearer and the farther planes of the lesser and the greater ones.
#[inline(always)]
fn sides(down: bool, low: [u32; 2], high: [u32; 2]) -> ([u32; 2], [u32; 2]) {
    if down { (high, low) } else { (low, high) }
}

/// The number of byte `i`.
#[inline(always)]
fn plane<R: Scalar>(words: [u32; 2], i: u32) -> R {
    R::splat(byte(words, i) as f32)
}

/// Byte `i` of two words.
#[inline(always)]
fn byte(words: [u32; 2], i: u32) -> u32 {
    let word = if i < 4 { words[0] } else { words[1] };
    (word >> (8 * (i & 3))) & 255
}

/// The places of four children, of all at once (Ylitie et al. 2017, appendix).
#[inline(always)]
fn places(children: u32, inverted: u32) -> u32 {
    // Bits 3 and 4 are set from 24 on.
    let is_inner = ((children & (children << 1) & 0x1010_1010) >> 4) * 0xff;
    (children ^ ((inverted * 0x0101_0101) & is_inner)) & 0x1f1f_1f1f
}
