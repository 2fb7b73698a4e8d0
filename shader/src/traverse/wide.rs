//! Traversal of nodes of eight children (Ylitie, Karras and Laine 2017: CWBVH): every ray by itself, in
//! every step at most one node and at most one triangle.
//!
//! The boxes lie on a grid of bytes. Instead of every plane, the grid is brought into the ray's terms:
//! a plane `origin + q * 2^e` is met at `q * (2^e * inverse) + (origin - start) * inverse`. With
//! coordinates in [-1, 1] that errs by less than 2.3 * 2^-22 times the inverse, and the entry into a
//! triangle's own box by 2^-22 times it; the quantised boxes' margin of 2^-19 covers both, so a node is
//! entered no later than any triangle's own box below it, and no order of visits can cull a hit.

use super::resumable::{Progress, Resumable, follow};
use super::step::{occluded, triangle};
use super::{Method, Query};
use crate::buffer::read;
use crate::data::{NodeRef, STACK, WideNode, numbers};
use crate::intersect::span;
use crate::ray::{Hit, Ray};
use crate::real::{Lanes, Octet, Real, Scalar, V3};
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

/// Two words a group.
type Waiting = [u32; 2 * STACK];

impl Groups {
    #[inline(always)]
    fn push(&mut self, group: Group, stack: &mut Waiting) {
        let at = 2 * self.depth as usize & (2 * STACK - 1);
        stack[at] = group.first;
        stack[at + 1] = group.waiting;
        self.depth += 1;
    }

    #[inline(always)]
    fn pop(&mut self, stack: &Waiting) -> Group {
        self.depth -= 1;
        let at = 2 * self.depth as usize & (2 * STACK - 1);
        Group { first: stack[at], waiting: stack[at + 1] }
    }

    /// Takes the nearest node that waits in hand; the rest of its group waits on. `inverted` is what the
    /// ray's order turns slots by.
    #[inline(always)]
    fn take(&mut self, inverted: u32, stack: &mut Waiting) -> u32 {
        let mut group = if self.nodes.has_nodes() { self.nodes } else { self.pop(stack) };
        let place = 31 - group.waiting.leading_zeros();
        group.waiting &= !(1 << place);
        if group.has_nodes() {
            self.push(group, stack);
        }
        let slot = (place - 24) ^ inverted;
        // The siblings before it.
        group.first + (group.waiting & ((1 << slot) - 1)).count_ones()
    }
}

impl<R: Scalar> Resumable<R> for WideNodes {
    type Cursor = Groups;
    type Stack = Waiting;
    const EMPTY: Waiting = [0; 2 * STACK];

    #[inline(always)]
    fn step<Q: Query>(
        geometry: &Geometry<'_>,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
        cursor: &mut Groups,
        stack: &mut Waiting,
    ) {
        if cursor.triangles.waiting == 0 {
            let node = read(geometry.wide, cursor.take(inverted(ray), stack));
            Q::on_boxes(WideNode::ARITY as u32);
            (cursor.nodes, cursor.triangles) = open(&node, ray, hit);
        }
        let mut first = true;
        while cursor.triangles.waiting != 0 && (first || geometry.tuning.cut() == 26) {
            first = false;
            let place = 31 - cursor.triangles.waiting.leading_zeros();
            cursor.triangles.waiting &= !(1 << place);
            triangle::<Q, R>(geometry, NodeRef::leaf(cursor.triangles.first + place, 1), ray, hit);
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
    let met = Grid::new(node, ray).met(hit.t);
    let inverted = inverted(ray) * 0x0101_0101;
    let waiting = waiting(node.children.z, inverted, met) | waiting(node.children.w, inverted, met >> 4);
    let nodes = Group { first: node.children.x, waiting: (waiting & NODES) | (node.grid.w >> 24) };
    (nodes, Group { first: node.children.y, waiting: waiting & !NODES })
}

/// The bits of four children that are met, given their bytes: of all four at once as far as possible
/// (Ylitie et al. 2017, appendix).
#[inline(always)]
fn waiting(children: u32, inverted: u32, met: u32) -> u32 {
    // Places from 24 on, whose bits 3 and 4 are set, are those of inner nodes.
    let is_inner = ((children & (children << 1) & 0x1010_1010) >> 4) * 0xff;
    let places = (children ^ (inverted & is_inner)) & 0x1f1f_1f1f;
    let bits = (children >> 5) & 0x0707_0707;
    child(bits, places, met, 0)
        | child(bits, places, met, 1)
        | child(bits, places, met, 2)
        | child(bits, places, met, 3)
}

#[inline(always)]
fn child(bits: u32, places: u32, met: u32, i: u32) -> u32 {
    if (met >> i) & 1 == 1 { ((bits >> (8 * i)) & 7) << ((places >> (8 * i)) & 31) } else { 0 }
}

/// A node's grid in a ray's terms.
struct Grid<R: Real> {
    /// Where the ray meets the grid's origin.
    start: V3<R>,
    /// How far it is to the next plane.
    step: V3<R>,
    /// Bytes of the planes that the ray enters by, an axis after the other.
    near: [[u32; 2]; 3],
    /// Bytes of the planes that it leaves by.
    far: [[u32; 2]; 3],
}

impl<R: Scalar> Grid<R> {
    #[inline(always)]
    fn new(node: &WideNode, ray: &Ray<R>) -> Self {
        let power = |shift: u32| f32::from_bits(((node.grid.w >> shift) & 255) << 23);
        let scale = V3::<R>::splat(Vec3::new(power(0), power(8), power(16)));
        let low = |q: UVec4| [q.x, q.y];
        let high = |q: UVec4| [q.z, q.w];
        let sides = |inverse: R, low: [u32; 2], high: [u32; 2]| {
            if inverse.lt(R::splat(0.0)) { (high, low) } else { (low, high) }
        };
        let x = sides(ray.inverse.x, low(node.low_x_low_y), high(node.low_z_high_x));
        let y = sides(ray.inverse.y, high(node.low_x_low_y), low(node.high_y_high_z));
        let z = sides(ray.inverse.z, low(node.low_z_high_x), high(node.high_y_high_z));
        Grid {
            start: (V3::splat(numbers(node.grid)) - ray.origin).times(ray.inverse),
            step: scale.times(ray.inverse),
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
        }
    }

    /// A bit for each of the eight boxes that the ray meets before `limit`. (A loop is not always unrolled.)
    #[inline(always)]
    fn met(&self, limit: R) -> u32 {
        self.turn(0, limit)
            | self.turn(1, limit)
            | self.turn(2, limit)
            | self.turn(3, limit)
            | self.turn(4, limit)
            | self.turn(5, limit)
            | self.turn(6, limit)
            | self.turn(7, limit)
    }

    /// The bits of a box and those that are tested with it, if it is the first of them.
    #[inline(always)]
    fn turn(&self, first: u32, limit: R) -> u32 {
        if first.is_multiple_of(R::Eight::COUNT) { self.meets(first, limit) << first } else { 0 }
    }

    /// A bit for each of [`Lanes::COUNT`] boxes from `first` on that the ray meets before `limit`.
    #[inline(always)]
    fn meets(&self, first: u32, limit: R) -> u32 {
        let all = |v: V3<R>| V3::new(R::Eight::all(v.x), R::Eight::all(v.y), R::Eight::all(v.z));
        let planes = |b: &[[u32; 2]; 3]| {
            V3::new(R::Eight::bytes(b[0], first), R::Eight::bytes(b[1], first), R::Eight::bytes(b[2], first))
        };
        let (start, step) = (all(self.start), all(self.step));
        let at = |q: V3<R::Eight>| q.fused(step, start);
        let met = span(at(planes(&self.near)), at(planes(&self.far)));
        R::Eight::bits(met.near.le(met.far) & met.near.le(R::Eight::all(limit)))
    }
}
