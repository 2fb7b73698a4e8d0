//! Traversal of nodes of eight children (Ylitie, Karras and Laine 2017: CWBVH): every ray by itself, in
//! every step at most one node and at most one triangle.
//!
//! The boxes lie on a grid of bytes. Instead of every plane, the grid is brought into the ray's terms:
//! a plane `origin + q * 2^e` is met at `q * (2^e * inverse) + (origin - start) * inverse`. With
//! coordinates in [-1, 1] that errs by less than 2.3 * 2^-22 times the inverse, and the entry into a
//! triangle's own box by 2^-22 times it; the quantised boxes' margin of 2^-19 covers both, so a node is
//! entered no later than any triangle's own box below it, and no order of visits can cull a hit.

use core::marker::PhantomData;

use super::resumable::{Progress, Resumable, follow};
use super::step::occluded;
#[cfg(not(target_arch = "spirv"))]
use super::step::several;
#[cfg(target_arch = "spirv")]
use super::step::triangle;
use super::waiting::Waiting;
use super::{Method, Query};
use crate::buffer::read;
#[cfg(target_arch = "spirv")]
use crate::data::NodeRef;
use crate::data::{WideNode, numbers};
use crate::ray::{Hit, Ray};
use crate::real::{Native, Octet, Scalar, V3, Vectors};
use crate::scene::Geometry;
use glam::{UVec4, Vec3};

/// See the module. `V` are the vectors that test boxes and triangles.
pub struct WideNodes<V = Native>(PhantomData<V>);

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
const SIBLINGS: u32 = 0xff;

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
    /// ray's order turns slots by. [`NOTHING`] if that node is known to lie beyond `limit`.
    #[inline(always)]
    fn take<R: Scalar, E: Octet<R>>(&mut self, inverted: u32, limit: R, stack: &mut Waiting<R, E>) -> u32 {
        let mut group = self.nodes;
        if !group.has_nodes() {
            self.depth -= 1;
            (group.first, group.waiting) = stack.get(self.depth);
        }
        let place = 31 - group.waiting.leading_zeros();
        group.waiting &= !(1 << place);
        let slot = (place - 24) ^ inverted;
        // The root alone is none of its group's inner nodes.
        if group.waiting & SIBLINGS != 0 && stack.is_beyond(self.depth, slot, limit) {
            self.nodes = group;
            return NOTHING;
        }
        if group.has_nodes() {
            stack.put(self.depth, group.first, group.waiting);
            self.depth += 1;
        }
        // The siblings before it.
        group.first + (group.waiting & ((1 << slot) - 1)).count_ones()
    }
}

/// No node.
const NOTHING: u32 = u32::MAX;

impl<R: Scalar, V: Vectors<R>> Resumable<R> for WideNodes<V> {
    type Cursor = Groups;
    type Stack = Waiting<R, V::Eight>;
    const EMPTY: Self::Stack = Waiting::NONE;

    #[inline(always)]
    fn step<Q: Query>(
        geometry: &Geometry<'_>,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
        cursor: &mut Groups,
        stack: &mut Self::Stack,
    ) {
        if cursor.triangles.waiting == 0 {
            let node = cursor.take::<R, V::Eight>(inverted(ray), hit.t, stack);
            if node == NOTHING {
                return;
            }
            let node = read(geometry.wide, node);
            Q::on_boxes(WideNode::ARITY as u32);
            let near;
            (cursor.nodes, cursor.triangles, near) = open::<R, V>(&node, ray, hit);
            stack.enter(cursor.depth, near);
        }
        if cursor.triangles.waiting != 0 {
            cursor.triangles.waiting = triangles::<Q, R, V>(geometry, cursor.triangles, ray, hit);
            if Q::ANY && occluded(hit) {
                *cursor = Groups::finished();
            }
        }
    }
}

impl<R: Scalar, V: Vectors<R>> Method<R> for WideNodes<V> {
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
fn open<R: Scalar, V: Vectors<R>>(node: &WideNode, ray: &Ray<R>, hit: &Hit<R>) -> (Group, Group, V::Eight) {
    let opening = Opening::<R, V::Eight>::new(node, ray, hit.t);
    // A loop is not always unrolled.
    let (first, near) = opening.turn(0);
    let waiting = first
        | opening.turn(1).0
        | opening.turn(2).0
        | opening.turn(3).0
        | opening.turn(4).0
        | opening.turn(5).0
        | opening.turn(6).0
        | opening.turn(7).0;
    let nodes = Group { first: node.children.x, waiting: (waiting & NODES) | (node.grid.w >> 24) };
    (nodes, Group { first: node.children.y, waiting: waiting & !NODES }, near)
}

/// Tests the triangle with the highest bit of a group and returns the others' bits.
#[cfg(target_arch = "spirv")]
#[inline(always)]
fn triangles<Q: Query, R: Scalar, V: Vectors<R>>(
    geometry: &Geometry<'_>,
    group: Group,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) -> u32 {
    let place = 31 - group.waiting.leading_zeros();
    triangle::<Q, R>(geometry, NodeRef::leaf(group.first + place, 1), ray, hit);
    group.waiting & !(1 << place)
}

/// Tests the triangles with the highest bits of a group and returns the others' bits.
#[cfg(not(target_arch = "spirv"))]
#[inline(always)]
fn triangles<Q: Query, R: Scalar, V: Vectors<R>>(
    geometry: &Geometry<'_>,
    group: Group,
    ray: &Ray<R>,
    hit: &mut Hit<R>,
) -> u32 {
    several::<Q, R, V::Four>(geometry, group.first, group.waiting, ray, hit)
}

/// A node in a ray's terms.
struct Opening<R: Scalar, E: Octet<R>> {
    /// Where the ray meets the grid's origin.
    start: V3<R>,
    /// How far it is to the next plane.
    step: V3<R>,
    /// Where the ray ends.
    limit: R,
    /// Bytes of the lesser planes, an axis after the other.
    low: [[u32; 2]; 3],
    /// Bytes of the greater planes.
    high: [[u32; 2]; 3],
    /// Does the ray enter by the greater ones?
    down: [bool; 3],
    /// What waits at each child if it is met.
    children: E::Children,
}

impl<R: Scalar, E: Octet<R>> Opening<R, E> {
    #[inline(always)]
    fn new(node: &WideNode, ray: &Ray<R>, limit: R) -> Self {
        let power = |shift: u32| f32::from_bits(((node.grid.w >> shift) & 255) << 23);
        let scale = V3::<R>::splat(Vec3::new(power(0), power(8), power(16)));
        let first = |q: UVec4| [q.x, q.y];
        let last = |q: UVec4| [q.z, q.w];
        let zero = R::splat(0.0);
        Opening {
            start: (V3::splat(numbers(node.grid)) - ray.origin).times(ray.inverse),
            step: scale.times(ray.inverse),
            limit,
            low: [first(node.low_x_low_y), last(node.low_x_low_y), first(node.low_z_high_x)],
            high: [last(node.low_z_high_x), first(node.high_y_high_z), last(node.high_y_high_z)],
            down: [ray.inverse.x.lt(zero), ray.inverse.y.lt(zero), ray.inverse.z.lt(zero)],
            children: E::children(last(node.children), inverted(ray)),
        }
    }

    /// What waits of a box and those that are tested with it, if it is the first of them; and where the ray
    /// enters these boxes.
    #[inline(always)]
    fn turn(&self, first: u32) -> (u32, E) {
        if !first.is_multiple_of(E::COUNT) {
            return (0, E::splat(0.0));
        }
        let all = |v: V3<R>| V3::new(E::all(v.x), E::all(v.y), E::all(v.z));
        let (start, step) = (all(self.start), all(self.step));
        let x = E::sides(self.down[0], self.low[0], self.high[0], first);
        let y = E::sides(self.down[1], self.low[1], self.high[1], first);
        let z = E::sides(self.down[2], self.low[2], self.high[2], first);
        let near = E::latest(V3::new(x.0, y.0, z.0).fused(step, start));
        let end = E::earliest(V3::new(x.1, y.1, z.1).fused(step, start), E::all(self.limit));
        (E::waiting(near.le(end), &self.children, first), near)
    }
}
