//! The wide hierarchy as a CPU loads it, see [`eyerays_shader::bvh8`]: nodes collapsed from the pairs for leaves
//! that are tested four triangles at once.

use eyerays_shader::bvh8::{Bvh8Node, Bvh8View, MOST, Mixed4, Sphere4, Triangle4};
use eyerays_shader::data::{Bounds as Record, CentredPair, Primitive};

use super::{
    binary::Binary,
    collapse::{Leaves, Plan},
    fill::Collapse,
};
use crate::bounds::Bounds;

const _: () = assert!(CentredPair::MARGIN >= Bvh8Node::MARGIN);

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
        // As wide as the pairs' boxes are already.
        let own = |slot: u32| {
            let primitive = || Bounds::of(&primitives[slot as usize]);
            bounds.get(slot as usize).map_or_else(primitive, Bounds::read).widened(Bvh8Node::MARGIN)
        };
        let leaves = Leaves { most: MOST as u32, fixed: TRIANGLE4, triangle: 0.0 };
        let tree = Binary { pairs, count: primitives.len(), own, most: leaves.most };
        Collapse { plan: Plan::of(tree, leaves), primitives }.run()
    }

    /// What a launch borrows.
    pub fn borrow(&self) -> Bvh8View<'_> {
        Bvh8View { nodes: &self.nodes, triangles: &self.triangles, spheres: &self.spheres, mixed: &self.mixed }
    }
}
