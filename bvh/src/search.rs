//! The search for a topology, by obvhs.

use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, DEFAULT_MAX_STACK_DEPTH, leaf_collapser::collapse, node::Bvh2Node},
    ploc::PlocBuilder,
};

use crate::{
    Quality,
    bounds::Bounds,
    cluster::Clusters,
    reinsertion::Reinsertion,
    spatial::{Kind, Tree},
    topology::Topology,
};

/// A tree over primitives, given by their boxes: clustering, reinsertion, and leaves of several primitives where that is
/// cheaper. The depth has no bound.
pub(crate) fn search(bounds: &[Bounds], quality: Quality) -> Topology {
    let (clusters, parameters) = (Clusters::of(bounds), quality.parameters());
    let around = |group| Bounds::around(clusters.members(group).iter().map(|&t| bounds[t as usize]));
    let boxes: Vec<Aabb> = (0..clusters.len() as u32).map(|group| aabb(&around(group))).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        parameters.ploc_search_distance,
        &boxes,
        (0..boxes.len() as u32).collect(),
        parameters.sort_precision,
        parameters.search_depth_threshold,
    );
    let share = parameters.reinsertion_batch_ratio;
    reinsert(&mut tree, share);
    collapse(&mut tree, parameters.max_prims_per_leaf, parameters.collapse_traversal_cost);
    reinsert(&mut tree, share * parameters.post_collapse_reinsertion_batch_ratio_multiplier);
    let members = |leaf: &Bvh2Node, order: &mut Vec<u32>| {
        for primitive in leaf.first_index..leaf.first_index + leaf.prim_count {
            order.extend(clusters.members(tree.primitive_indices[primitive as usize]));
        }
    };
    topology(&tree, members)
}

/// The tree that split primitives, or a better one of its leaves.
pub(crate) fn improve(start: &Tree, bounds: &[Bounds], quality: Quality) -> Topology {
    let share = quality.reinsertion();
    if share == 0.0 {
        let children = |number| match start.nodes[number as usize] {
            Kind::Inner(left, right) => Some([left, right]),
            Kind::Leaf(_) => None,
        };
        let members = |number, order: &mut Vec<u32>| match start.nodes[number as usize] {
            Kind::Leaf(leaf) => order.extend(start.members(leaf)),
            Kind::Inner(..) => {}
        };
        return Topology::of(start.nodes.len(), children, members);
    }
    let mut tree = Bvh2::zeroed(start.nodes.len().div_ceil(2));
    let mut around = vec![Bounds::EMPTY; start.nodes.len()];
    for (i, kind) in start.nodes.iter().enumerate().rev() {
        around[i] = match *kind {
            Kind::Leaf(leaf) => Bounds::around(start.members(leaf).map(|member| bounds[member as usize])),
            Kind::Inner(left, right) => around[left as usize].union(around[right as usize]),
        };
        tree.nodes[i] = match *kind {
            Kind::Leaf(leaf) => Bvh2Node::new(aabb(&around[i]), 1, leaf),
            Kind::Inner(left, _) => Bvh2Node::new(aabb(&around[i]), 0, left),
        };
    }
    reinsert(&mut tree, share);
    topology(&tree, |leaf, order| order.extend(start.members(leaf.first_index)))
}

/// Moves nodes where that costs less; the first pass tries `share` of them.
fn reinsert(tree: &mut Bvh2, share: f32) {
    // Up to this depth, obvhs searches with a stack that forgets candidates when it is full; the
    // one it takes for deeper trees panics then.
    tree.max_depth = DEFAULT_MAX_STACK_DEPTH;
    Reinsertion::new(share).run(tree);
}

/// The tree without boxes; `members` adds the primitives of a leaf.
fn topology(tree: &Bvh2, mut members: impl FnMut(&Bvh2Node, &mut Vec<u32>)) -> Topology {
    let node = |number: u32| &tree.nodes[number as usize];
    let children = |number| (!node(number).is_leaf()).then(|| [node(number).first_index, node(number).first_index + 1]);
    Topology::of(tree.nodes.len(), children, |number, order| members(node(number), order))
}

fn aabb(bounds: &Bounds) -> Aabb {
    Aabb::new(bounds.min, bounds.max)
}
