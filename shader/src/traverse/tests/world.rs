//! Worlds to trace rays in: triangles that tie, overlap and degenerate, below hierarchies as bad as they may be.

use bytemuck::Zeroable;
use glam::{UVec4, Vec3};
use proptest::prelude::*;

use super::super::leaf::{Leaf, Primitives};
use super::super::{Method, Query};
use crate::bvh8::{Bvh8Node, Bvh8Ref, Bvh8View, LeafKind, MOST, Triangle4};
use crate::data::{
    CentredPair, CwbvhNode, Effects, Frame, MAX_LEAF, NodePair, NodeRef, Primitive, Specialisation, Tuning,
};
use crate::ray::{Hit, Ray};
use crate::real::{Real, Scalar, V3};
use crate::scene::{LaunchContext, TraceContext};

/// A hierarchy made by halving the list: bad trees must find the same hits.
fn build(triangles: &[Primitive]) -> Vec<NodePair> {
    fn child(triangles: &[Primitive], first: u32, nodes: &mut Vec<NodePair>) -> (Vec3, Vec3, NodeRef) {
        let (least, greatest) = triangles
            .iter()
            .map(Primitive::bounds)
            .reduce(|(a, b), (c, d)| (a.min(c), b.max(d)))
            .expect("a child has triangles");
        let count = triangles.len() as u32;
        let node =
            if count <= MAX_LEAF { NodeRef::leaf(first, count) } else { NodeRef::inner(pair(triangles, first, nodes)) };
        (least, greatest, node)
    }
    fn pair(triangles: &[Primitive], first: u32, nodes: &mut Vec<NodePair>) -> u32 {
        let place = nodes.len();
        nodes.push(NodePair::zeroed());
        let (left, right) = triangles.split_at(triangles.len() / 2);
        let left_child = child(left, first, nodes);
        let right_child = child(right, first + left.len() as u32, nodes);
        nodes[place] = NodePair::new(left_child, right_child);
        place as u32
    }
    let mut nodes = Vec::new();
    pair(triangles, 0, &mut nodes);
    nodes
}

/// A wide hierarchy made by splitting the list in eighths, its nodes in breadth-first order. Every box is the whole
/// grid, so it tests only whether all nodes and triangles are visited.
fn build_cwbvh(triangles: &[Primitive]) -> Vec<CwbvhNode> {
    let all = 0..triangles.len() as u32;
    let mut open = vec![all];
    let mut nodes = Vec::new();
    while nodes.len() < open.len() {
        let range = open[nodes.len()].clone();
        let step = range.len().div_ceil(CwbvhNode::ARITY).max(3) as u32;
        let (first_child, mut inner, mut all) = (open.len() as u32, 0, 0);
        // Leaves lie behind inner nodes: the last part alone may be shorter than the others.
        let last = range.start + (range.len() as u32 - 1) / step * step;
        let leaves = if step <= CwbvhNode::MAX_LEAF { range.start } else { last };
        for (slot, first) in range.clone().step_by(step as usize).enumerate() {
            let part = first..(first + step).min(range.end);
            if part.len() as u32 <= CwbvhNode::MAX_LEAF {
                all |= ((1 << part.len()) - 1) << (3 * slot);
            } else {
                inner |= 1 << slot;
                open.push(part);
            }
        }
        let exponent = 127 + 2;
        nodes.push(CwbvhNode {
            grid: crate::data::pack(Vec3::splat(-2.0), inner << 24 | exponent << 16 | exponent << 8 | exponent),
            children: UVec4::new(first_child, leaves, all, 0),
            low_x_low_y: UVec4::ZERO,
            low_z_high_x: UVec4::new(0, 0, u32::MAX, u32::MAX),
            high_y_high_z: UVec4::MAX,
        });
    }
    nodes
}

/// The same in full precision, by eighths down to four triangles, with the boxes' real bounds.
fn build_bvh8(triangles: &[Primitive]) -> (Vec<Bvh8Node>, Vec<Triangle4>) {
    let (mut nodes, mut blocks) = (vec![Bvh8Node::EMPTY], Vec::new());
    let mut open = vec![(0, 0..triangles.len())];
    while let Some((node, range)) = open.pop() {
        let step = range.len().div_ceil(8).max(MOST);
        for (child, first) in range.clone().step_by(step).enumerate() {
            let part = first..(first + step).min(range.end);
            let boxes = triangles[part.clone()].iter().map(Primitive::bounds);
            let (least, greatest) = boxes.reduce(|(a, b), (c, d)| (a.min(c), b.max(d))).expect("a part has triangles");
            let planes = [least - Bvh8Node::MARGIN, greatest + Bvh8Node::MARGIN];
            for (axis, side) in (0..6).map(|i| (i / 2, i % 2)) {
                nodes[node].planes[axis][side][child] = planes[side][axis];
            }
            nodes[node].children[child] = if part.len() <= MOST {
                blocks.push(Triangle4::of(part.map(|slot| (slot as u32, &triangles[slot]))));
                Bvh8Ref::leaf(LeafKind::Triangles, blocks.len() as u32 - 1)
            } else {
                nodes.push(Bvh8Node::EMPTY);
                open.push((nodes.len() - 1, part));
                Bvh8Ref::inner(nodes.len() as u32 - 1)
            };
        }
    }
    (nodes, blocks)
}

/// Triangles, in every form that methods walk.
pub struct World {
    pub triangles: Vec<Primitive>,
    nodes: Vec<CentredPair>,
    wide: Vec<CwbvhNode>,
    bvh8: (Vec<Bvh8Node>, Vec<Triangle4>),
    words: Vec<UVec4>,
    frame: Frame,
    effects: Effects,
}

impl World {
    pub fn new(triangles: Vec<Primitive>, effects: u32) -> Self {
        let nodes = build(&triangles).iter().map(CentredPair::from).collect();
        let words = bytemuck::cast_slice(&triangles).to_vec();
        let (wide, bvh8) = (build_cwbvh(&triangles), build_bvh8(&triangles));
        World { triangles, nodes, wide, bvh8, words, frame: Frame::zeroed(), effects: Effects(effects) }
    }

    pub fn context(&self) -> TraceContext<'_> {
        let spec = Specialisation { effects: self.effects, tuning: Tuning::new(2, 60), ..Specialisation::default() };
        TraceContext {
            base: LaunchContext::new(&self.frame, spec, &self.words, &[]),
            nodes: bytemuck::cast_slice(&self.nodes),
            wide: &self.wide,
            bvh8: Bvh8View { nodes: &self.bvh8.0, triangles: &self.bvh8.1, ..Bvh8View::default() },
            cutout: Default::default(),
        }
    }

    pub fn trace<M: Method<R>, Q: Query, R: Real>(&self, ray: &Ray<R>, limit: f32) -> Hit<R> {
        let mut hit = Hit::none(R::splat(limit));
        M::traverse::<Q, Primitives>(&self.context(), ray, &mut hit);
        hit
    }

    pub fn brute_force<Q: Query, R: Scalar>(&self, ray: &Ray<R>, limit: f32) -> Hit<R> {
        let mut hit = Hit::none(R::splat(limit));
        for slot in (0..self.triangles.len() as u32).rev() {
            Primitives::intersect::<Q, R>(&self.context(), (slot, u32::MAX), ray, &mut hit);
        }
        hit
    }
}

pub fn ray<R: Scalar>(origin: [f32; 3], direction: [f32; 3]) -> Ray<R> {
    Ray::new(V3::splat(Vec3::from(origin)), V3::splat(Vec3::from(direction)))
}

/// Coordinates on a coarse grid, so that vertices, edges, planes and whole triangles coincide.
pub fn grid() -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3((-4i8..=4).prop_map(|k| f32::from(k) / 8.0))
}

pub fn soup() -> impl Strategy<Value = Vec<Primitive>> {
    prop::collection::vec((prop::array::uniform3(grid()), any::<bool>()), 2..80).prop_map(|soup| {
        let count = soup.len() as u32;
        soup.iter()
            .zip(0..)
            .map(|((t, clear), i)| {
                Primitive::triangle(
                    t.map(Vec3::from),
                    (i * 37) % count.next_power_of_two(),
                    0,
                    if *clear { Primitive::TRANSPARENT } else { 0 },
                )
            })
            .collect()
    })
}
