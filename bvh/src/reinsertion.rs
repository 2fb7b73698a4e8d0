//! Which nodes obvhs tries to reinsert elsewhere in the tree.
//!
//! obvhs can choose by itself, but has no bound on its work, and where there are millions of nodes
//! its radix sort leaves equal ones in an order that depends on the number of threads.

use obvhs::bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer};

/// The most comparisons that the first pass may make; they take seconds. Trying every node of a
/// million scattered triangles takes 8e8; where all triangles overlap, the work would be quadratic
/// (100,000 that span the scene: 1.3e10, and 17 s).
const WORK: f32 = 2e9;

/// A sequence of passes, each over fewer and larger nodes (1, 1/3, 1/5 ... 1/31 of the first), as
/// obvhs' own.
pub(crate) struct Reinsertion {
    /// The part of all nodes that the first pass tries.
    share: f32,
}

impl Reinsertion {
    /// Passes of which the first tries `share` (0 to 1) of all nodes; 0 for none.
    pub fn new(share: f32) -> Self {
        Reinsertion { share }
    }

    /// Moves nodes of `tree` to where the surface areas above them become smaller.
    pub fn run(&self, tree: &mut Bvh2) {
        if self.share <= 0.0 || tree.nodes.len() < 3 {
            return;
        }
        let first = self.first(tree);
        let mut optimizer = ReinsertionOptimizer::default();
        for divisor in (1..32).step_by(2) {
            let count = (first / divisor as f32) as usize;
            let candidates = largest(tree, count.max(1));
            optimizer.run_with_candidates(tree, &candidates, 1);
        }
    }

    /// How many candidates the first pass tries.
    fn first(&self, tree: &Bvh2) -> f32 {
        (tree.nodes.len() as f32 * self.share).min(WORK / visits(tree))
    }
}

/// About how many nodes a candidate is compared with: those that a random ray would meet.
fn visits(tree: &Bvh2) -> f32 {
    let area = |node: &Bvh2Node| f64::from(node.aabb().half_area());
    let sum: f64 = tree.nodes.iter().map(area).sum();
    (sum / area(&tree.nodes[0])) as f32
}

/// The `count` largest of the nodes near the root; of equal nodes, the ones of least number.
fn largest(tree: &Bvh2, count: usize) -> Vec<u32> {
    // obvhs numbers pairs from the root on, so the first nodes hold nearly all large ones.
    let near = tree.nodes.iter().take(2 * (count + 1)).zip(0u32..).skip(1);
    // The bits of positive numbers are ordered as the numbers are.
    let mut keys: Vec<u64> =
        near.map(|(node, id)| u64::from(node.aabb().half_area().to_bits()) << 32 | u64::from(!id)).collect();
    let count = count.min(keys.len());
    if count < keys.len() {
        keys.select_nth_unstable_by(count, |a, b| b.cmp(a));
    }
    keys.truncate(count);
    keys.sort_unstable_by(|a, b| b.cmp(a));
    keys.into_iter().map(|key| !(key as u32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use obvhs::aabb::Aabb;

    /// Nodes of equal boxes.
    fn overlapping(primitives: usize) -> Bvh2 {
        let mut tree = Bvh2::zeroed(primitives);
        let cube = Aabb::new([0.0; 3].into(), [1.0; 3].into());
        tree.nodes.fill(Bvh2Node::new(cube, 1, 0));
        tree
    }

    #[test]
    fn work_is_bounded_where_everything_overlaps() {
        let all = |primitives| Reinsertion::new(1.0).first(&overlapping(primitives));
        assert_eq!(all(1000), 1999.0);
        let candidates = all(100_000);
        assert!(candidates * 199_999.0 <= 1.0001 * WORK && candidates > 1000.0);
    }

    #[test]
    fn candidates_are_the_largest_then_the_first() {
        let mut tree = overlapping(6);
        let cube = |edge: f32| Aabb::new([0.0; 3].into(), [edge; 3].into());
        for (id, edge) in [9.0, 2.0, 3.0, 2.0, 3.0, 1.0, 7.0].into_iter().enumerate() {
            tree.nodes[id].set_aabb(cube(edge));
        }
        assert_eq!(largest(&tree, 3), [6, 2, 4]);
        assert_eq!(largest(&tree, 2), [2, 4], "only nodes near the root are tried");
        assert_eq!(largest(&tree, 100).len(), 10);
    }
}
