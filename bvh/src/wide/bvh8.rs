//! The wide hierarchy as a CPU loads it, see [`eyerays_shader::bvh8`]: nodes collapsed from the pairs for leaves
//! that are tested four triangles at once.

use eyerays_shader::bvh8::{Bvh8Node, Bvh8Ref, Bvh8View, LeafKind, MOST, Mixed4, Sphere4, Triangle4};
use eyerays_shader::data::{Bounds as Record, CentredPair, NodeRef, Primitive};
use rayon::prelude::*;

use super::{
    binary::{Binary, Node},
    collapse::{Leaves, Plan},
};
use crate::bounds::Bounds;

/// The cost of a [`Triangle4`] relative to that of a node, which tests eight boxes.
const TRIANGLE4: f32 = 0.6;

/// Nodes and leaves, owned.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bvh8 {
    /// Nodes, the root first, a parent before its children.
    pub nodes: Vec<Bvh8Node>,
    /// The leaves of triangles, in the order of the nodes.
    pub triangles: Vec<Triangle4>,
    /// The leaves of spheres.
    pub spheres: Vec<Sphere4>,
    /// The leaves of others, or of several kinds.
    pub mixed: Vec<Mixed4>,
}

impl Bvh8 {
    /// What it holds.
    pub fn bytes(&self) -> usize {
        let Bvh8 { nodes, triangles, spheres, mixed } = self;
        let leaves = size_of_val(&triangles[..]) + size_of_val(&spheres[..]) + size_of_val(&mixed[..]);
        size_of_val(&nodes[..]) + leaves
    }

    /// Converts a validated hierarchy of `pairs`, its triangles by slot and their own boxes by slot, none
    /// unless triangles are split.
    pub fn of(pairs: &[CentredPair], primitives: &[Primitive], bounds: &[Record]) -> Self {
        let bounds: Vec<Bounds> = match bounds {
            [] => primitives.par_iter().map(Bounds::of).collect(),
            split => split.par_iter().map(Bounds::read).collect(),
        };
        let leaves = Leaves { most: MOST as u32, fixed: TRIANGLE4, triangle: 0.0 };
        let (tree, order) = binary(pairs, &bounds, leaves.most);
        let plan = Plan::of(&tree, leaves);
        let mut bvh8 = Bvh8 { nodes: vec![Bvh8Node::EMPTY], ..Bvh8::default() };
        let (mut open, mut children) = (vec![(0, 0, 0)], Vec::new());
        while let Some((number, node, level)) = open.pop() {
            plan.children_at(&tree, node, level, &mut children);
            let area = |child: &(u32, bool)| tree.nodes[child.0 as usize].bounds.half_area();
            children.sort_by(|a, b| area(b).total_cmp(&area(a)));
            let first = open.len();
            for (i, &(child, is_leaf)) in children.iter().enumerate() {
                let Node { bounds, first, count, .. } = tree.nodes[child as usize];
                let reference = if is_leaf {
                    bvh8.leaf(&order[first as usize..(first + count) as usize], primitives)
                } else {
                    bvh8.nodes.push(Bvh8Node::EMPTY);
                    open.push((bvh8.nodes.len() - 1, child, level + 1));
                    Bvh8Ref::inner(bvh8.nodes.len() as u32 - 1)
                };
                set(&mut bvh8.nodes[number], i, bounds, reference);
            }
            open[first..].reverse();
        }
        bvh8
    }

    /// Adds the primitives of a leaf, by their indices.
    fn leaf(&mut self, indices: &[u32], primitives: &[Primitive]) -> Bvh8Ref {
        let of = |index: &u32| &primitives[*index as usize];
        let numbered = indices.iter().map(|index| (*index, of(index)));
        let (kind, blocks) = if indices.iter().all(|index| of(index).is_triangle()) {
            self.triangles.push(Triangle4::of(numbered));
            (LeafKind::Triangles, self.triangles.len())
        } else if indices.iter().all(|index| of(index).is_sphere()) {
            self.spheres.push(Sphere4::of(numbered));
            (LeafKind::Spheres, self.spheres.len())
        } else {
            self.mixed.push(Mixed4::of(indices.iter().copied()));
            (LeafKind::Mixed, self.mixed.len())
        };
        Bvh8Ref::leaf(kind, blocks as u32 - 1)
    }

    /// What a launch borrows.
    pub fn borrow(&self) -> Bvh8View<'_> {
        Bvh8View { nodes: &self.nodes, triangles: &self.triangles, spheres: &self.spheres, mixed: &self.mixed }
    }
}

/// The binary tree with leaves of at most `most` triangles, and the slots in its order.
fn binary(pairs: &[CentredPair], bounds: &[Bounds], most: u32) -> (Binary, Vec<u32>) {
    let (references, mut order) = depth_first(pairs, bounds.len());
    let boxed = |reference: NodeRef| {
        let first = reference.index() as usize;
        // Boxes of inner nodes follow from these.
        let slots = order.get(first..first + reference.count() as usize).unwrap_or_default();
        (Bounds::around(slots.iter().map(|&slot| bounds[slot as usize])), reference)
    };
    let boxes: Vec<_> = references.par_iter().map(|pair| pair.map(boxed)).collect();
    let tree = Binary::of(boxes.into_iter(), &mut order, bounds, most);
    (tree, order)
}

/// The references of every pair, with slots counted in depth-first order, and the slot at each of these places.
fn depth_first(pairs: &[CentredPair], slots: usize) -> (Vec<[NodeRef; 2]>, Vec<u32>) {
    let mut references: Vec<[NodeRef; 2]> = pairs.par_iter().map(|p| [p.left(), p.right()]).collect();
    let mut order = Vec::with_capacity(slots);
    if slots == 1 {
        return (references, vec![0]);
    }
    let mut open = vec![(0, 1), (0, 0)];
    while let Some((pair, side)) = open.pop() {
        let reference = references[pair][side];
        if reference.is_leaf() {
            references[pair][side] = NodeRef::leaf(order.len() as u32, reference.count());
            order.extend(reference.index()..reference.index() + reference.count());
        } else {
            open.extend([(reference.index() as usize, 1), (reference.index() as usize, 0)]);
        }
    }
    (references, order)
}

/// Puts a child into a node.
fn set(node: &mut Bvh8Node, child: usize, bounds: Bounds, reference: Bvh8Ref) {
    let margin = f64::from(Bvh8Node::MARGIN);
    for axis in 0..3 {
        node.planes[axis][0][child] = (f64::from(bounds.min[axis]) - margin) as f32;
        node.planes[axis][1][child] = (f64::from(bounds.max[axis]) + margin) as f32;
    }
    node.children[child] = reference;
}
