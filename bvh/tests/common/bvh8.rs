//! A check of what a CPU loads.

use eyerays_bvh::{Bvh, Bvh8, MAX_WIDE_DEPTH};
use eyerays_shader::bvh8::{Bvh8Node, Bvh8Ref, LeafKind, MOST, Sphere4, Triangle4};
use eyerays_shader::data::{Bounds, CentredPair, Primitive, numbers};

use super::{Corners, around, union};

/// Lays out a hierarchy, each slot's primitive a triangle, the diagonal of its box, or in long runs also spheres and disks, and
/// checks every promise.
pub fn check(bvh: &Bvh) {
    let diagonal = |b: &Bounds| [numbers(b.least), numbers(b.greatest), numbers(b.least)];
    let triangle = |b: &Bounds| Primitive::triangle(diagonal(b), 0, 0, 0);
    check_of(bvh, bvh.bounds.iter().map(triangle).collect());
    let mixed = |(slot, b): (usize, &Bounds)| match slot / 7 % 4 {
        0 => Primitive::sphere(numbers(b.least), 0.5, slot as u32, 0, 0),
        1 => Primitive::disk(numbers(b.least), glam::Vec3::X, 0.5, slot as u32, 0, 0),
        _ => triangle(b),
    };
    check_of(bvh, bvh.bounds.iter().enumerate().map(mixed).collect());
}

fn check_of(bvh: &Bvh, primitives: Vec<Primitive>) {
    let pairs: Vec<CentredPair> = bvh.nodes.iter().map(CentredPair::from).collect();
    let bvh8 = Bvh8::of(&pairs, &primitives, &bvh.bounds);
    let blocks = [bvh8.triangles.len(), bvh8.spheres.len(), bvh8.mixed.len()].map(|count| vec![false; count]);
    let (nodes, slots) = (vec![false; bvh8.nodes.len()], vec![false; bvh.bounds.len()]);
    let mut walk = Walk { bvh, bvh8: &bvh8, primitives: &primitives, nodes, blocks, slots };
    walk.node(0, 1);
    let met = walk.nodes.iter().chain(walk.blocks.iter().flatten()).chain(&walk.slots);
    assert!(met.into_iter().all(|met| *met), "something is not reached");
}

/// A walk and what it has met.
struct Walk<'a> {
    bvh: &'a Bvh,
    bvh8: &'a Bvh8,
    primitives: &'a [Primitive],
    nodes: Vec<bool>,
    /// By kind of leaf.
    blocks: [Vec<bool>; 3],
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
        assert!(
            !std::mem::replace(&mut self.blocks[child.kind() as usize][child.index()], true),
            "a leaf is met twice"
        );
        let slots = match child.kind() {
            LeafKind::Triangles => self.triangles(&self.bvh8.triangles[child.index()]),
            LeafKind::Spheres => self.spheres(&self.bvh8.spheres[child.index()]),
            LeafKind::Mixed => self.bvh8.mixed[child.index()].indices().to_vec(),
        };
        let own = |slot: &u32| {
            assert!(!std::mem::replace(&mut self.slots[*slot as usize], true), "a slot is met twice");
            self.bvh.bounds[*slot as usize]
        };
        around(&slots.iter().map(own).collect::<Vec<_>>())
    }

    /// The slots of a leaf's triangles, whose vertices are those of the records.
    fn triangles(&self, block: &Triangle4) -> Vec<u32> {
        let lanes = (0..MOST).filter(|&lane| !block.vertices[0][0][lane].is_nan());
        let slots = lanes.map(|lane| {
            let slot = block.primitive_indices[lane];
            let vertex = |vertex: usize| [0, 1, 2].map(|axis| block.vertices[vertex][axis][lane]);
            let corners = self.primitives[slot as usize].vertices().map(|corner| corner.to_array());
            assert_eq!([0, 1, 2].map(vertex), corners, "a triangle's vertices");
            slot
        });
        slots.collect()
    }

    /// The slots of a leaf's spheres, which are those of the records.
    fn spheres(&self, block: &Sphere4) -> Vec<u32> {
        let lanes = (0..MOST).filter(|&lane| !block.centres[0][lane].is_nan());
        let slots = lanes.map(|lane| {
            let slot = block.primitive_indices[lane];
            let sphere = &self.primitives[slot as usize];
            assert_eq!([0, 1, 2].map(|axis| block.centres[axis][lane]), sphere.centre().to_array(), "a centre");
            assert_eq!((block.radii[lane], block.numbers[lane]), (sphere.radius(), sphere.number()));
            slot
        });
        slots.collect()
    }
}
