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
    Topology::of(tree.nodes.len(), kind(&tree), |number, order| {
        let leaf = &tree.nodes[number as usize];
        for primitive in leaf.first_index..leaf.first_index + leaf.prim_count {
            order.extend(clusters.members(tree.primitive_indices[primitive as usize]));
        }
    })
}

/// The tree that split primitives, or a better one of its leaves.
pub(crate) fn improve(start: &Tree, bounds: &[Bounds], quality: Quality) -> Topology {
    let share = quality.reinsertion();
    if share == 0.0 {
        let kind = |number| start.nodes[number as usize];
        return Topology::of(start.nodes.len(), kind, |leaf, order| order.extend(start.members(leaf)));
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
    let leaf = |number: u32| tree.nodes[number as usize].first_index;
    Topology::of(tree.nodes.len(), kind(&tree), |number, order| order.extend(start.members(leaf(number))))
}

/// Moves nodes where that costs less; the first pass tries `share` of them.
fn reinsert(tree: &mut Bvh2, share: f32) {
    // Up to this depth, obvhs searches with a stack that forgets candidates when it is full; the
    // one it takes for deeper trees panics then.
    tree.max_depth = DEFAULT_MAX_STACK_DEPTH;
    Reinsertion::new(share).run(tree);
}

/// What each node of a tree is: an inner one, or a leaf by its own number.
fn kind(tree: &Bvh2) -> impl Fn(u32) -> Kind {
    |number| match &tree.nodes[number as usize] {
        leaf if leaf.is_leaf() => Kind::Leaf(number),
        inner => Kind::Inner(inner.first_index, inner.first_index + 1),
    }
}

fn aabb(bounds: &Bounds) -> Aabb {
    Aabb::new(bounds.min, bounds.max)
}
