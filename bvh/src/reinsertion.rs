//! Which nodes obvhs tries to reinsert elsewhere in the tree.
//!
//! obvhs can choose by itself, but has no bound on its work, and where there are millions of nodes
//! its radix sort leaves equal ones in an order that depends on the number of threads.

use obvhs::bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer};
use rayon::prelude::*;

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
        let mut candidates: Vec<u32> = (1..tree.nodes.len() as u32).into_par_iter().collect();
        for divisor in (1..32).step_by(2) {
            let count = (first / divisor as f32) as usize;
            // Nodes that grow large on the way are few.
            candidates = largest(tree, &candidates, count.max(1));
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
    let sums: Vec<f64> = tree.nodes.par_chunks(CHUNK).map(|nodes| nodes.iter().map(area).sum()).collect();
    (sums.iter().sum::<f64>() / area(&tree.nodes[0])) as f32
}

/// Nodes that a thread takes at a time.
const CHUNK: usize = 1 << 14;
/// Bits of a positive number that tell its exponent and the first three of its fraction.
const CLASS: u32 = 8 + 3;

/// The `count` largest of these nodes; of equal ones, those of least number. The largest comes first.
fn largest(tree: &Bvh2, nodes: &[u32], count: usize) -> Vec<u32> {
    // The bits of positive numbers are ordered as the numbers are.
    let area = |node: u32| tree.nodes[node as usize].aabb().half_area().to_bits();
    let class = |area: u32| (area >> (31 - CLASS)) as usize;
    let counted = |nodes: &[u32]| {
        let mut classes = vec![0u32; 1 << CLASS];
        nodes.iter().for_each(|&node| classes[class(area(node))] += 1);
        classes
    };
    let classes = nodes.par_chunks(CHUNK).map(counted).reduce_with(|mut all, some| {
        all.iter_mut().zip(some).for_each(|(all, some)| *all += some);
        all
    });
    let mut reached = 0;
    let enough = |&(_, in_class): &(usize, u32)| {
        reached += in_class as usize;
        reached >= count
    };
    let least = classes.unwrap_or_default().into_iter().enumerate().rev().find(enough).map_or(0, |(class, _)| class);
    let key = |&node: &u32| u64::from(area(node)) << 32 | u64::from(!node);
    let mut keys: Vec<u64> = nodes.par_iter().map(key).filter(|key| class((key >> 32) as u32) >= least).collect();
    keys.par_sort_unstable_by(|a, b| b.cmp(a));
    keys.truncate(count);
    keys.into_par_iter().map(|key| !(key as u32)).collect()
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
        let largest = |nodes: &[u32], count| largest(&tree, nodes, count);
        assert_eq!(largest(&[1, 2, 3, 4, 5, 6], 3), [6, 2, 4]);
        assert_eq!(largest(&[1, 2, 3, 4, 5], 2), [2, 4], "only those asked for are tried");
        assert_eq!(largest(&[3, 1, 5], 100), [1, 3, 5]);
    }
}
