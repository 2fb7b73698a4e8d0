//! The search for a topology, by obvhs.

use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, DEFAULT_MAX_STACK_DEPTH, leaf_collapser::collapse, node::Bvh2Node},
    ploc::PlocBuilder,
};

use crate::{
    bounds::Bounds,
    reinsertion::Reinsertion,
    spatial::{Kind, Tree},
};

/// A tree over primitives, given by their boxes: clustering, then [`polish`]. The depth has no bound.
pub(crate) fn search(primitives: &[Bounds], parameters: &BvhBuildParams) -> Bvh2 {
    let boxes: Vec<Aabb> = primitives.iter().map(aabb).collect();
    let tree = PlocBuilder::with_capacity(boxes.len()).build(
        parameters.ploc_search_distance,
        &boxes,
        (0..boxes.len() as u32).collect(),
        parameters.sort_precision,
        parameters.search_depth_threshold,
    );
    polish(tree, parameters)
}

/// A tree over primitives, improved from a given tree whose leaves they are.
pub(crate) fn improve(start: &Tree, primitives: &[Bounds], parameters: &BvhBuildParams) -> Bvh2 {
    let mut tree = Bvh2::zeroed(primitives.len());
    tree.primitive_indices = (0..primitives.len() as u32).collect();
    let mut around = vec![Bounds::EMPTY; start.nodes.len()];
    for (i, kind) in start.nodes.iter().enumerate().rev() {
        around[i] = match *kind {
            Kind::Leaf(primitive) => primitives[primitive as usize],
            Kind::Inner(left, right) => around[left as usize].union(around[right as usize]),
        };
        tree.nodes[i] = match *kind {
            Kind::Leaf(primitive) => Bvh2Node::new(aabb(&around[i]), 1, primitive),
            Kind::Inner(left, _) => Bvh2Node::new(aabb(&around[i]), 0, left),
        };
    }
    polish(tree, parameters)
}

/// Reinsertion, and leaves of several primitives where that is cheaper.
fn polish(mut tree: Bvh2, parameters: &BvhBuildParams) -> Bvh2 {
    // Up to this depth, obvhs searches with a stack that forgets candidates when it is full; the
    // one it takes for deeper trees panics then.
    tree.max_depth = DEFAULT_MAX_STACK_DEPTH;
    let share = parameters.reinsertion_batch_ratio;
    Reinsertion::new(share).run(&mut tree);
    collapse(&mut tree, parameters.max_prims_per_leaf, parameters.collapse_traversal_cost);
    let again = parameters.post_collapse_reinsertion_batch_ratio_multiplier;
    Reinsertion::new(share * again).run(&mut tree);
    tree
}

fn aabb(bounds: &Bounds) -> Aabb {
    Aabb::new(bounds.min, bounds.max)
}
