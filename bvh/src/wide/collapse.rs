//! Which nodes of the binary tree become wide nodes, at the least cost.
//!
//! Ylitie, Karras and Laine 2017, section 3.1: the cost of showing a subtree as at most `i` children of
//! one wide node follows from that of its children's subtrees, from the leaves up.

use eyerays_shader::data::{CwbvhNode, NodeRef};

use super::binary::{Binary, Kind, Node};
use super::layout::MAX_WIDE_DEPTH;
use crate::tree::{Children, Fold, filled, fold};

/// Cost of a step through a wide node, which tests eight boxes.
pub(crate) const NODE: f32 = 1.0;

/// Size and cost of the leaves of wide nodes.
#[derive(Clone, Copy)]
pub(crate) struct Leaves {
    /// The most triangles.
    pub most: u32,
    /// Cost of a leaf, whatever it holds.
    pub fixed: f32,
    /// Cost of each of its triangles.
    pub triangle: f32,
}

impl Leaves {
    /// The leaves of [`CwbvhNode`]; a triangle's cost is the paper's.
    pub const WIDE: Leaves = Leaves { most: CwbvhNode::MAX_LEAF, fixed: 0.0, triangle: 0.3 };

    /// The cost of a leaf of all triangles below a node.
    fn cost(self, node: &Node) -> f32 {
        if node.count > self.most {
            return f32::INFINITY;
        }
        node.bounds.half_area() * (self.fixed + node.count as f32 * self.triangle)
    }
}

/// The most children of a node, and the most roots that a subtree can be shown as.
const ARITY: usize = CwbvhNode::ARITY;

/// Choices for every node of a binary tree.
pub(crate) struct Plan {
    choices: Vec<Choices>,
}

/// How to show a subtree as at most `i + 1` children, at place `i`.
///
/// At place 0: [`Choices::LEAF`] or [`Choices::INNER`]. Elsewhere: how many children the left subtree
/// becomes, or 0 to do as at the place before. The last place also holds the children of the wide node
/// that the subtree's root becomes.
#[derive(Clone, Copy)]
struct Choices([u8; ARITY]);

impl Choices {
    /// All triangles in one leaf.
    const LEAF: u8 = 0;
    /// A wide node.
    const INNER: u8 = 1;
}

/// Costs of a subtree as at most 1 to 7 children.
type Costs = [f32; ARITY - 1];

impl Plan {
    /// The best choices.
    pub fn of(tree: &Binary, leaves: Leaves) -> Self {
        let mut choices = filled(Choices([Choices::LEAF; ARITY]), tree.nodes.len());
        let costing = Costing { tree, leaves };
        let (root, below) = choices.split_first_mut().expect("a root");
        if !tree.pairs.is_empty() {
            let children = fold(&tree.pairs, below.as_chunks_mut::<2>().0, &costing);
            *root = costing.node(0, &children).1;
        }
        Plan { choices }
    }

    /// The children of the wide node that binary node `number` becomes, in depth-first order: their
    /// numbers, and whether each is a leaf.
    pub fn children(&self, tree: &Binary, number: u32, children: &mut Vec<(u32, bool)>) {
        children.clear();
        self.show(tree, number, ARITY, children);
    }

    /// The children of the wide node that binary node `number` becomes, `level` wide nodes above it: the
    /// plan's, or [`three_levels`] if they would make the tree deeper than [`MAX_WIDE_DEPTH`].
    pub fn children_at(&self, tree: &Binary, number: u32, level: u32, children: &mut Vec<(u32, bool)>) {
        // With the plan's children, the remaining tree may be only one level lower.
        let rest = tree.nodes[number as usize].height.saturating_sub(1).div_ceil(LEVELS);
        if level + 1 + rest <= MAX_WIDE_DEPTH {
            self.children(tree, number, children);
        } else {
            three_levels(tree, number, children);
        }
    }

    /// Shows a subtree as at most `most` children, never as its own root.
    fn show(&self, tree: &Binary, number: u32, most: usize, children: &mut Vec<(u32, bool)>) {
        let Choices(choices) = self.choices[number as usize];
        let place = (1..most).rev().find(|&place| choices[place] > 0);
        match (place, tree.nodes[number as usize].kind) {
            (Some(place), Kind::Inner(left, right)) => {
                let share = usize::from(choices[place]);
                self.show(tree, left, share, children);
                self.show(tree, right, place + 1 - share, children);
            }
            _ => children.push((number, choices[0] == Choices::LEAF)),
        }
    }
}

/// Finds costs and choices, from the leaves up.
struct Costing<'a> {
    tree: &'a Binary,
    leaves: Leaves,
}

impl Costing<'_> {
    /// The costs and choices of a node, given its children's costs, if it has any.
    fn node(&self, number: usize, children: &Option<[Costs; 2]>) -> (Costs, Choices) {
        let node = &self.tree.nodes[number];
        let leaf = self.leaves.cost(node);
        match children {
            None => ([leaf; ARITY - 1], Choices([Choices::LEAF; ARITY])),
            Some([left, right]) => best(node, leaf, left, right),
        }
    }
}

impl Fold<Children> for Costing<'_> {
    /// The costs of both children of a pair.
    type Known = Option<[Costs; 2]>;
    /// The choices of both.
    type Note = [Choices; 2];

    fn leaf(&self, _: NodeRef) -> Self::Known {
        None
    }

    fn pair(&self, number: usize, _: &Children, below: [Self::Known; 2], note: &mut [Choices; 2]) -> Self::Known {
        let [left, right] = [0, 1].map(|side| self.node(2 * number + 1 + side, &below[side]));
        *note = [left.1, right.1];
        Some([left.0, right.0])
    }
}

/// As [`Plan::children`], whatever it costs: the nodes three levels below, which lowers what is left of
/// the binary tree by three levels.
pub(crate) fn three_levels(tree: &Binary, number: u32, children: &mut Vec<(u32, bool)>) {
    fn show(tree: &Binary, number: u32, levels: u32, children: &mut Vec<(u32, bool)>) {
        match tree.nodes[number as usize].kind {
            Kind::Inner(left, right) if levels > 0 => {
                show(tree, left, levels - 1, children);
                show(tree, right, levels - 1, children);
            }
            kind => children.push((number, kind == Kind::Leaf)),
        }
    }
    children.clear();
    show(tree, number, LEVELS, children);
}

/// Levels of the binary tree that fit into any wide node.
pub(crate) const LEVELS: u32 = CwbvhNode::ARITY.ilog2();

/// The best choices for an inner node, given its children's costs.
fn best(node: &Node, leaf: f32, left: &Costs, right: &Costs) -> (Costs, Choices) {
    let mut choices = [0; ARITY];
    let mut shared = [f32::INFINITY; ARITY];
    for place in 1..ARITY {
        for share in 1..=place {
            let cost = left[share - 1] + right[place - share];
            if cost < shared[place] {
                (shared[place], choices[place]) = (cost, share as u8);
            }
        }
    }
    let inner = shared[ARITY - 1] + node.bounds.half_area() * NODE;
    let mut costs = [leaf.min(inner); ARITY - 1];
    choices[0] = if leaf <= inner { Choices::LEAF } else { Choices::INNER };
    for place in 1..ARITY - 1 {
        if shared[place] < costs[place - 1] {
            costs[place] = shared[place];
        } else {
            (costs[place], choices[place]) = (costs[place - 1], 0);
        }
    }
    (costs, Choices(choices))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bounds::Bounds,
        branch::{Grown, Piece},
    };

    /// A tree over boxes, as nested lists of two would give it.
    fn tree(leaves: &[Bounds], halve: impl Fn(usize) -> usize + Copy) -> Binary {
        let all = (0, leaves.len() as u32);
        let piece = Piece::grow(all, |(first, count): (u32, u32), piece| {
            if count == 1 {
                return Grown::Leaf(piece.leaf([first]));
            }
            let half = halve(count as usize) as u32;
            Grown::Pair((first, half), (first + half, count - half))
        });
        Binary::of(&piece.pairs, leaves, CwbvhNode::MAX_LEAF)
    }

    fn cubes(count: u32, step: f32) -> Vec<Bounds> {
        let cube = |x: f32| Bounds::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]);
        (0..count).map(|i| cube(i as f32 * step)).collect()
    }

    /// Least costs found so far, by node and most children.
    type Memory = std::collections::HashMap<(u32, usize), f32>;

    /// The least cost of showing a subtree as at most `most` children, by trying everything.
    fn least(tree: &Binary, number: u32, most: usize, memory: &mut Memory) -> f32 {
        if let Some(&known) = memory.get(&(number, most)) {
            return known;
        }
        let node = &tree.nodes[number as usize];
        let cost = match (node.kind, most) {
            (Kind::Leaf, _) => Leaves::WIDE.cost(node),
            (_, 1) => Leaves::WIDE.cost(node).min(least_inner(tree, number, memory)),
            _ => least_shared(tree, number, most, memory).min(least(tree, number, most - 1, memory)),
        };
        memory.insert((number, most), cost);
        cost
    }

    /// The least cost of a subtree whose root is a wide node.
    fn least_inner(tree: &Binary, number: u32, memory: &mut Memory) -> f32 {
        least_shared(tree, number, ARITY, memory) + tree.nodes[number as usize].bounds.half_area() * NODE
    }

    fn least_shared(tree: &Binary, number: u32, most: usize, memory: &mut Memory) -> f32 {
        let Kind::Inner(left, right) = tree.nodes[number as usize].kind else { unreachable!() };
        let costs = (1..most).map(|share| least(tree, left, share, memory) + least(tree, right, most - share, memory));
        costs.fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn no_plan_costs_less() {
        for (count, step) in [(2, 2.0), (5, 0.1), (9, 3.0), (40, 0.5), (100, 1.5)] {
            for halve in [|n: usize| n / 2, |_: usize| 1, |n: usize| n.div_ceil(3)] {
                let tree = tree(&cubes(count, step), halve);
                let (got, want) =
                    (cost(&tree, &Plan::of(&tree, Leaves::WIDE), 0), least_inner(&tree, 0, &mut Memory::new()));
                assert!((got - want).abs() < 1e-3 * want, "{count} cubes {step} apart: {got} {want}");
            }
        }
    }

    /// The cost of the wide node that a binary node becomes.
    fn cost(tree: &Binary, plan: &Plan, number: u32) -> f32 {
        let mut children = Vec::new();
        plan.children(tree, number, &mut children);
        assert!(children.len() <= ARITY);
        let below = children.iter().map(|&(child, is_leaf)| {
            if is_leaf { Leaves::WIDE.cost(&tree.nodes[child as usize]) } else { cost(tree, plan, child) }
        });
        below.sum::<f32>() + tree.nodes[number as usize].bounds.half_area() * NODE
    }

    #[test]
    fn three_levels_of_a_chain_and_of_a_full_tree() {
        let mut children = Vec::new();
        three_levels(&tree(&cubes(32, 1.0), |n| n / 2), 0, &mut children);
        assert_eq!(children.len(), 8);
        assert!(children.iter().all(|&(_, is_leaf)| !is_leaf));
        three_levels(&tree(&cubes(32, 1.0), |_| 1), 0, &mut children);
        assert_eq!(children.iter().filter(|&&(_, is_leaf)| is_leaf).count(), 3);
        assert_eq!(children.len(), 4);
    }
}
