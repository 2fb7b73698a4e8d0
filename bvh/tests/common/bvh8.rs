//! A check of what a CPU loads.

use eyerays_bvh::{Bvh, Bvh8, MAX_WIDE_DEPTH};
use eyerays_shader::bvh8::{Bvh8Node, Bvh8Ref};
use eyerays_shader::data::{Bounds, CentredPair, Triangle, numbers};

use super::{Corners, around, union};

/// Lays out a hierarchy, each slot's triangle the diagonal of its box, and checks every promise.
pub fn check(bvh: &Bvh) {
    let pairs: Vec<CentredPair> = bvh.nodes.iter().map(CentredPair::from).collect();
    let diagonal = |b: &Bounds| [numbers(b.least), numbers(b.greatest), numbers(b.least)];
    let triangles: Vec<Triangle> = bvh.bounds.iter().map(|b| Triangle::new(diagonal(b), 0, 0, 0)).collect();
    let bvh8 = Bvh8::of(&pairs, &triangles, &bvh.bounds);
    let (nodes, blocks) = (vec![false; bvh8.nodes.len()], vec![false; bvh8.blocks.len()]);
    let mut walk = Walk { bvh, bvh8: &bvh8, nodes, blocks, slots: vec![false; bvh.bounds.len()] };
    walk.node(0, 1);
    assert!(walk.nodes.iter().chain(&walk.blocks).chain(&walk.slots).all(|met| *met), "something is not reached");
}

/// A walk and what it has met.
struct Walk<'a> {
    bvh: &'a Bvh,
    bvh8: &'a Bvh8,
    nodes: Vec<bool>,
    blocks: Vec<bool>,
    slots: Vec<bool>,
}

impl Walk<'_> {
    /// The box around what is below a node.
    fn node(&mut self, number: usize, depth: u32) -> Corners {
        assert!(depth <= MAX_WIDE_DEPTH, "too deep");
        assert!(!std::mem::replace(&mut self.nodes[number], true), "a node is met twice");
        let node = self.bvh8.nodes[number];
        let mut all: Option<Corners> = None;
        for (child, &reference) in node.children.iter().enumerate() {
            let planes = |side: usize| [0, 1, 2].map(|axis| node.planes[axis][side][child]);
            if planes(0)[0] > planes(1)[0] {
                assert_eq!([planes(0), planes(1)], Bvh8Node::NOWHERE.map(|plane| [plane; 3]), "a box of nothing");
                continue;
            }
            let below = self.child(reference, depth);
            let (least, greatest) = (below.0.to_array(), below.1.to_array());
            for axis in 0..3 {
                // Singles of this size are a multiple of 2^-24 at most, so half of that is what rounding takes.
                let margin = f64::from(Bvh8Node::MARGIN) - 0.5f64.powi(24);
                assert!(f64::from(planes(0)[axis]) <= f64::from(least[axis]) - margin, "a lesser plane");
                assert!(f64::from(planes(1)[axis]) >= f64::from(greatest[axis]) + margin, "a greater plane");
            }
            all = Some(all.map_or(below, |all| union(all, below)));
        }
        all.expect("a node has a child")
    }

    /// The box around a child.
    fn child(&mut self, child: Bvh8Ref, depth: u32) -> Corners {
        if !child.is_leaf() {
            return self.node(child.index(), depth + 1);
        }
        assert!(!std::mem::replace(&mut self.blocks[child.index()], true), "a block is met twice");
        let block = self.bvh8.blocks[child.index()];
        let mut bounds = Vec::new();
        for (lane, &slot) in block.triangle_indices.iter().enumerate() {
            let vertex = |vertex: usize| [0, 1, 2].map(|axis| block.vertices[vertex][axis][lane]);
            if vertex(0)[0].is_nan() {
                continue;
            }
            assert!(!std::mem::replace(&mut self.slots[slot as usize], true), "a slot is met twice");
            let own = self.bvh.bounds[slot as usize];
            let corners = [own.least, own.greatest, own.least].map(|corner| numbers(corner).to_array());
            assert_eq!([0, 1, 2].map(vertex), corners, "a triangle's vertices");
            bounds.push(own);
        }
        around(&bounds)
    }
}
