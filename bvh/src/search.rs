//! The search for a topology, by obvhs.

use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, DEFAULT_MAX_STACK_DEPTH, leaf_collapser::collapse},
    ploc::PlocBuilder,
};

use crate::{bounds::Bounds, reinsertion::Reinsertion};

/// A tree over primitives, given by their boxes: clustering, reinsertion, and leaves of several
/// primitives where that is cheaper. The depth has no bound.
pub(crate) fn search(primitives: &[Bounds], parameters: &BvhBuildParams) -> Bvh2 {
    let boxes: Vec<Aabb> = primitives.iter().map(|b| Aabb::new(b.min.into(), b.max.into())).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        parameters.ploc_search_distance,
        &boxes,
        (0..boxes.len() as u32).collect(),
        parameters.sort_precision,
        parameters.search_depth_threshold,
    );
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
