//! The steps of `wide` on a CPU: nodes of eight children, and leaves of up to four primitives.

use eyerays_shader::bvh8::{Bvh8Node, Bvh8Ref, LeafKind};
use eyerays_shader::data::{Effects, NodeRef};
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{Real, V3};
use eyerays_shader::scene::TraceContext;

use super::step::{Child, Fate, Target, Visit};
use super::tape::Event;
use super::walk::{Waiting, Walk, Witness};

/// A child that waits, and where the ray enters its box.
struct Entry {
    child: Bvh8Ref,
    near: f32,
    depth: u32,
}

impl<W: Witness> Walk<'_, W> {
    /// Follows a ray from the root.
    pub(super) fn nodes(&mut self, (ray, hit): (&Ray<f32>, &mut Hit<f32>), lane: usize) {
        // Even a ray that goes nowhere visits the root.
        let mut waiting = vec![Entry { child: Bvh8Ref::ROOT, near: f32::NEG_INFINITY, depth: 0 }];
        while let Some(Entry { child, near, depth }) = waiting.pop() {
            if near > hit.t {
                self.witness.drop(1 << lane, target(self.context, child), near);
            } else if child.is_leaf() {
                self.block_leaf((ray, hit), lane, child, depth);
            } else {
                self.open_wide(ray, hit.t, lane, (child, depth), &mut waiting);
            }
        }
    }

    /// Tests the eight boxes of a node.
    fn open_wide(
        &mut self,
        ray: &Ray<f32>,
        limit: f32,
        lane: usize,
        (at, depth): (Bvh8Ref, u32),
        waiting: &mut Vec<Entry>,
    ) {
        self.witness.event(Event::Node);
        let context = self.context;
        let node = &context.bvh8.nodes[at.index()];
        let spans: [(f32, f32); 8] = std::array::from_fn(|child| span(node, child, ray, limit));
        let mut met: Vec<usize> = (0..8).filter(|&child| spans[child].0 <= spans[child].1).collect();
        met.sort_unstable_by_key(|&child| (spans[child].0.to_bits(), node.children[child].0));
        self.witness.visit(1 << lane, depth, |_| {
            let children = (0..8).filter(|&child| !is_missing(node, child)).map(|child| {
                let fate = match met.iter().position(|&other| other == child) {
                    None => Fate::Missed,
                    Some(0) => Fate::Next,
                    Some(_) => Fate::Pushed,
                };
                let (near, far) = spans[child];
                let is_met = u32::from(fate != Fate::Missed);
                let child = target(context, node.children[child]);
                Child { child, near: near.into(), far: far.into(), rays: is_met, fate }
            });
            Visit { node: at.index() as u32, copy: None, depth, rays: 1, children: children.collect() }
        });
        let below = |&child: &usize| Entry { child: node.children[child], near: spans[child].0, depth: depth + 1 };
        waiting.extend(met.iter().rev().map(below));
    }

    /// Tests all that a leaf holds.
    fn block_leaf(&mut self, (ray, hit): (&Ray<f32>, &mut Hit<f32>), lane: usize, leaf: Bvh8Ref, depth: u32) {
        self.witness.event(Event::Block(leaf));
        self.is_in_block = true;
        for index in indices(self.context, leaf) {
            let (context, nothing) = (self.context, Hit::<f32>::NOTHING);
            let primitive = context.primitive(index);
            if context.base.spec.effects.has(Effects::INSTANCED) && primitive.is_instance() {
                let node = NodeRef::inner(context.base.frame.pairs + primitive.number());
                self.single((ray, hit), lane, vec![Waiting { node, instance: nothing, depth: depth + 1 }]);
            } else {
                self.primitive((ray, hit), 1 << lane, (index, nothing));
            }
        }
        self.is_in_block = false;
    }
}

/// Where a ray is inside the box of a child, before a limit.
fn span(node: &Bvh8Node, child: usize, ray: &Ray<f32>, limit: f32) -> (f32, f32) {
    let (inverse, start) = (ray.inverse, -ray.offset);
    let planes = |far: bool| {
        let of = |axis: usize, inverse: f32| node.planes[axis][usize::from((inverse < 0.0) != far)][child];
        V3::new(of(0, inverse.x), of(1, inverse.y), of(2, inverse.z)).fused(inverse, start)
    };
    (f32::max_entry(planes(false)), f32::min_exit(planes(true), limit))
}

fn is_missing(node: &Bvh8Node, child: usize) -> bool {
    node.planes.iter().all(|planes| planes.map(|side| side[child]) == Bvh8Node::NOWHERE)
}

/// What a leaf holds, by indices in leaf order.
fn indices(context: &TraceContext<'_>, leaf: Bvh8Ref) -> Vec<u32> {
    let (blocks, index) = (&context.bvh8, leaf.index());
    let taken = |indices: [u32; 4], places: [f32; 4]| {
        // Where there is none, coordinates are NaN.
        indices.into_iter().zip(places).filter(|(_, place)| !place.is_nan()).map(|(index, _)| index).collect()
    };
    match leaf.kind() {
        LeafKind::Triangles => {
            let block = &blocks.triangles[index];
            taken(block.primitive_indices, block.vertices[0][0])
        }
        LeafKind::Spheres => {
            let block = &blocks.spheres[index];
            taken(block.primitive_indices, block.centres[0])
        }
        LeafKind::Mixed => blocks.mixed[index].indices().to_vec(),
    }
}

/// What a reference leads to.
fn target(context: &TraceContext<'_>, child: Bvh8Ref) -> Target {
    let number = child.index() as u32;
    match child.is_leaf() {
        true => Target::Leaf { number, primitives: indices(context, child).len() as u32 },
        false => Target::Node(number),
    }
}
