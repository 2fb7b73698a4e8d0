//! Limiting the depth.

use eyerays_shader::data::{NodeRef, STACK};

use crate::{
    median,
    topology::{Kind, Topology},
};

/// The most node pairs on a path from the root.
///
/// A traversal visits the pairs of one path at a time and pushes at most one child a pair, so it
/// never holds more entries than this; one entry of its stack is left for a sentinel.
pub const MAX_DEPTH: u32 = STACK as u32 - 1;

// The root itself can always be split at medians.
const _: () = assert!((NodeRef::MAX_INDEX).ilog2() < MAX_DEPTH);

impl Topology {
    /// Turns subtrees into runs until no path is longer than `most` pairs, once runs are split at
    /// medians. Nodes near the root and shallow subtrees stay as they are.
    ///
    /// `most` must be enough for median splits of the whole tree.
    pub(crate) fn limit_depth(&mut self, most: u32) {
        let heights = self.heights();
        // Each open node fits at its level if split at medians; as it is, it may be too deep.
        let mut open = vec![(0u32, 0u32)];
        while let Some((number, level)) = open.pop() {
            let node = &mut self.nodes[number as usize];
            let Kind::Inner(left, right) = node.kind else {
                continue;
            };
            if level + heights[number as usize] <= most {
                continue;
            }
            let fits = |child: u32| {
                let count = self.nodes[child as usize].count;
                level + 1 + median::height(count) <= most
            };
            if fits(left) && fits(right) {
                open.extend([(left, level + 1), (right, level + 1)]);
            } else {
                self.nodes[number as usize].kind = Kind::Run;
            }
        }
    }

    /// Levels of pairs below each node.
    fn heights(&self) -> Vec<u32> {
        let mut heights = vec![0u32; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate().rev() {
            heights[i] = match node.kind {
                Kind::Run => median::height(node.count),
                Kind::Inner(left, right) => 1 + heights[left as usize].max(heights[right as usize]),
            };
        }
        heights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::Node;

    /// Each inner node has a leaf of one primitive on the left and the rest on the right.
    fn chain(primitives: u32) -> Topology {
        let mut topology = Topology::run(primitives);
        topology.nodes.clear();
        for first in 0..primitives {
            let number = topology.nodes.len() as u32;
            let inner = first + 1 < primitives;
            let count = primitives - first;
            if inner {
                let kind = Kind::Inner(number + 1, number + 2);
                topology.nodes.push(Node { kind, first, count });
            }
            let kind = Kind::Run;
            let count = 1;
            topology.nodes.push(Node { kind, first, count });
        }
        topology
    }

    /// The nodes that are still part of the tree.
    fn reached(topology: &Topology) -> usize {
        let mut open = vec![0];
        let mut count = 0;
        while let Some(number) = open.pop() {
            count += 1;
            if let Kind::Inner(left, right) = topology.nodes[number as usize].kind {
                open.extend([left, right]);
            }
        }
        count
    }

    #[test]
    fn a_chain_is_cut_where_the_rest_just_fits() {
        let mut topology = chain(1000);
        assert_eq!(topology.heights()[0], 999);
        topology.limit_depth(20);
        assert_eq!(topology.heights()[0], 20);
        // 989 primitives need 8 levels, so 12 levels of the chain stay.
        assert_eq!(reached(&topology), 2 * 12 + 1);
    }

    #[test]
    fn a_tree_that_fits_stays() {
        let mut topology = chain(21);
        topology.limit_depth(20);
        assert_eq!(reached(&topology), 41);
        topology.limit_depth(19);
        assert!(reached(&topology) < 41);
    }

    #[test]
    fn the_whole_tree_becomes_a_run_where_nothing_else_fits() {
        let mut topology = chain(1000);
        topology.limit_depth(median::height(1000));
        assert_eq!(topology.heights()[0], 8);
        assert_eq!(reached(&topology), 1);
    }
}
