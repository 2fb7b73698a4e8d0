//! Which nodes of the binary tree become wide nodes, at the least cost.
//!
//! Ylitie, Karras and Laine 2017, section 3.1: the cost of showing a subtree as at most `i` children of
//! one wide node follows from that of its children's subtrees, from the leaves up.

use eyerays_shader::data::{CwbvhNode, NodeRef};

use super::binary::{Binary, Boxed, Node, Parting};
use super::layout::MAX_WIDE_DEPTH;
use crate::{
    MAX_DEPTH,
    bounds::Bounds,
    tree::{Fold, filled, fold},
};

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

    /// The cost of a leaf of so many triangles in a box.
    fn cost(self, bounds: Bounds, count: u32) -> f32 {
        if count > self.most {
            return f32::INFINITY;
        }
        bounds.half_area() * (self.fixed + count as f32 * self.triangle)
    }
}

/// The most children of a node, and the most roots that a subtree can be shown as.
const ARITY: usize = CwbvhNode::ARITY;

/// A binary tree with choices for every node.
pub(crate) struct Plan<'a, P, F> {
    tree: Binary<'a, P, F>,
    notes: Vec<Note>,
}

/// What is noted for a node.
#[derive(Clone, Copy)]
struct Note {
    /// Slots below it.
    count: u32,
    /// Inner nodes on the longest path down from it.
    height: u8,
    parting: Parting,
    choices: Choices,
}

impl Note {
    const NONE: Note = Note { count: 1, height: 0, parting: Parting::NONE, choices: Choices::NONE };
}

// A leaf that is two halves adds a level.
const _: () = assert!(MAX_DEPTH < u8::MAX as u32);

/// How to show a subtree as at most `i + 1` children, at place `i`.
///
/// At place 0: [`Choices::LEAF`] or [`Choices::INNER`]. Elsewhere: how many children the left subtree
/// becomes, or 0 to do as at the place before. The last place also holds the children of the wide node
/// that the subtree's root becomes.
#[derive(Clone, Copy)]
struct Choices([u8; ARITY]);

impl Choices {
    /// Those of a leaf.
    const NONE: Choices = Choices([Choices::LEAF; ARITY]);
    /// All triangles in one leaf.
    const LEAF: u8 = 0;
    /// A wide node.
    const INNER: u8 = 1;
}

/// Costs of a subtree as at most 1 to 7 children.
type Costs = [f32; ARITY - 1];

impl<'a, P: Boxed, F: Fn(u32) -> Bounds + Sync> Plan<'a, P, F> {
    /// The best choices; leaves of wide nodes have no more slots than those of the tree.
    pub fn of(tree: Binary<'a, P, F>, leaves: Leaves) -> Self {
        if tree.count == 1 {
            return Plan { tree, notes: vec![Note::NONE] };
        }
        let mut notes = filled(Note::NONE, 1 + 2 * tree.pairs.len());
        let costing = Costing { tree: &tree, leaves };
        let (root, below) = notes.split_first_mut().expect("a root");
        let all = fold(tree.pairs, below.as_chunks_mut::<2>().0, &costing);
        *root = costing.node(tree.bounds(Node::ROOT, |_| Parting::NONE), &all).1;
        Plan { tree, notes }
    }

    /// The children of the wide node that a binary node becomes, in depth-first order: their numbers, and whether each is
    /// a leaf.
    fn children(&self, node: Node, children: &mut Vec<(Node, bool)>) {
        children.clear();
        self.show(node, ARITY, children);
    }

    /// The children of the wide node that a binary node becomes, `level` wide nodes above it, in depth-first order: their
    /// numbers, and whether each is a leaf. They are the plan's, or those of [`Plan::three_levels`] if the plan's would make
    /// the tree deeper than [`MAX_WIDE_DEPTH`].
    pub fn children_at(&self, node: Node, level: u32, children: &mut Vec<(Node, bool)>) {
        // With the plan's children, the remaining tree may be only one level lower.
        let rest = u32::from(self.notes[node.place()].height).saturating_sub(1).div_ceil(LEVELS);
        if level + 1 + rest <= MAX_WIDE_DEPTH {
            self.children(node, children);
        } else {
            self.three_levels(node, children);
        }
    }

    /// Shows a subtree as at most `most` children, never as its own root.
    fn show(&self, node: Node, most: usize, children: &mut Vec<(Node, bool)>) {
        let Choices(choices) = if node.half().is_some() { Choices::NONE } else { self.notes[node.place()].choices };
        let place = (1..most).rev().find(|&place| choices[place] > 0);
        match place.and_then(|place| Some((place, self.tree.children(node)?))) {
            Some((place, [left, right])) => {
                let share = usize::from(choices[place]);
                self.show(left, share, children);
                self.show(right, place + 1 - share, children);
            }
            None => children.push((node, choices[0] == Choices::LEAF)),
        }
    }

    /// As [`Plan::children`], whatever it costs: the nodes three levels below, which lowers what is left of
    /// the binary tree by three levels.
    fn three_levels(&self, node: Node, children: &mut Vec<(Node, bool)>) {
        children.clear();
        self.show_levels(node, LEVELS, children);
    }

    fn show_levels(&self, node: Node, levels: u32, children: &mut Vec<(Node, bool)>) {
        match self.tree.children(node) {
            Some(below) if levels > 0 => {
                below.into_iter().for_each(|child| self.show_levels(child, levels - 1, children));
            }
            inner => children.push((node, inner.is_none())),
        }
    }

    /// A node's box.
    pub fn bounds(&self, node: Node) -> Bounds {
        self.tree.bounds(node, |leaf| self.parting(leaf))
    }

    /// How many slots are below a node.
    pub fn count(&self, node: Node) -> u32 {
        match node.half() {
            Some((leaf, half)) => self.parting(leaf).counts(self.notes[leaf.place()].count)[half],
            None => self.notes[node.place()].count,
        }
    }

    /// Goes through the slots below a node from left to right.
    pub fn each_slot(&self, node: Node, mut of: impl FnMut(u32)) {
        self.tree.each_slot(node, |leaf| self.parting(leaf), &mut of);
    }

    fn parting(&self, leaf: Node) -> Parting {
        self.notes[leaf.place()].parting
    }
}

/// Finds costs and choices, from the leaves up.
struct Costing<'t, 'a, P, F> {
    tree: &'t Binary<'a, P, F>,
    leaves: Leaves,
}

/// What is below a node.
struct Below {
    /// The costs of its children, if it has any.
    children: Option<[Costs; 2]>,
    count: u32,
    height: u8,
    parting: Parting,
}

impl<P: Boxed, F: Fn(u32) -> Bounds> Costing<'_, '_, P, F> {
    /// The costs of a node and what is noted for it, given what is below.
    fn node(&self, bounds: Bounds, below: &Below) -> (Costs, Note) {
        let leaf = self.leaves.cost(bounds, below.count);
        let (costs, choices) = match &below.children {
            None => ([leaf; ARITY - 1], Choices::NONE),
            Some([left, right]) => best(bounds.half_area() * NODE, leaf, left, right),
        };
        let Below { count, height, parting, .. } = *below;
        (costs, Note { count, height, parting, choices })
    }
}

impl<P: Boxed, F: Fn(u32) -> Bounds + Sync> Fold<P> for Costing<'_, '_, P, F> {
    type Known = Below;
    /// Of both children.
    type Note = [Note; 2];

    fn leaf(&self, leaf: NodeRef) -> Below {
        let count = leaf.count();
        if count <= self.tree.most {
            return Below { children: None, count, height: 0, parting: Parting::NONE };
        }
        let parting = self.tree.parting(leaf);
        let half = |half: usize| {
            let bounds = self.tree.half(leaf, parting, half);
            [self.leaves.cost(bounds, parting.counts(count)[half]); ARITY - 1]
        };
        Below { children: Some([half(0), half(1)]), count, height: 1, parting }
    }

    fn pair(&self, _: usize, pair: &P, [left, right]: [Below; 2], note: &mut [Note; 2]) -> Below {
        let (left_costs, left_note) = self.node(pair.bounds(0), &left);
        let (right_costs, right_note) = self.node(pair.bounds(1), &right);
        *note = [left_note, right_note];
        Below {
            children: Some([left_costs, right_costs]),
            count: left.count + right.count,
            height: 1 + left.height.max(right.height),
            parting: Parting::NONE,
        }
    }
}

/// Levels of the binary tree that fit into any wide node.
pub(crate) const LEVELS: u32 = CwbvhNode::ARITY.ilog2();

/// The best choices for an inner node, given what it costs as a node and as a leaf, and its children's costs.
fn best(node: f32, leaf: f32, left: &Costs, right: &Costs) -> (Costs, Choices) {
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
    let inner = shared[ARITY - 1] + node;
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
        branch::{Grown, Piece},
        layout,
    };
    use eyerays_shader::data::NodePair;

    /// The pairs of a tree over boxes, as nested lists of two would give it.
    fn pairs(leaves: &[Bounds], halve: impl Fn(usize) -> usize + Copy) -> Vec<NodePair> {
        let all = (0, leaves.len() as u32);
        let piece = Piece::grow(all, |(first, count): (u32, u32), piece| {
            if count == 1 {
                return Grown::Leaf(piece.leaf([first]));
            }
            let half = halve(count as usize) as u32;
            Grown::Pair((first, half), (first + half, count - half))
        });
        layout::pairs(&piece.pairs, |slot| leaves[slot as usize])
    }

    type Own<'a> = &'a (dyn Fn(u32) -> Bounds + Sync);

    fn plan<'a>(pairs: &'a [NodePair], count: usize, own: Own<'a>) -> Plan<'a, NodePair, Own<'a>> {
        Plan::of(Binary { pairs, count, own, most: Leaves::WIDE.most }, Leaves::WIDE)
    }

    fn cubes(count: u32, step: f32) -> Vec<Bounds> {
        let cube = |x: f32| Bounds::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]);
        (0..count).map(|i| cube(i as f32 * step)).collect()
    }

    /// Least costs found so far, by node and most children.
    type Memory = std::collections::HashMap<(usize, usize), f32>;
    type Planned<'a> = Plan<'a, NodePair, Own<'a>>;

    fn leaf_cost(plan: &Planned<'_>, node: Node) -> f32 {
        Leaves::WIDE.cost(plan.bounds(node), plan.count(node))
    }

    /// The least cost of showing a subtree as at most `most` children, by trying everything.
    fn least(plan: &Planned<'_>, node: Node, most: usize, memory: &mut Memory) -> f32 {
        if let Some(&known) = memory.get(&(node.place(), most)) {
            return known;
        }
        let leaf = leaf_cost(plan, node);
        let cost = match (plan.tree.children(node), most) {
            (None, _) => leaf,
            (_, 1) => leaf.min(least_inner(plan, node, memory)),
            _ => least_shared(plan, node, most, memory).min(least(plan, node, most - 1, memory)),
        };
        memory.insert((node.place(), most), cost);
        cost
    }

    /// The least cost of a subtree whose root is a wide node.
    fn least_inner(plan: &Planned<'_>, node: Node, memory: &mut Memory) -> f32 {
        least_shared(plan, node, ARITY, memory) + plan.bounds(node).half_area() * NODE
    }

    fn least_shared(plan: &Planned<'_>, node: Node, most: usize, memory: &mut Memory) -> f32 {
        let [left, right] = plan.tree.children(node).unwrap();
        let costs = (1..most).map(|share| least(plan, left, share, memory) + least(plan, right, most - share, memory));
        costs.fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn no_plan_costs_less() {
        for (count, step) in [(2, 2.0), (5, 0.1), (9, 3.0), (40, 0.5), (100, 1.5)] {
            for halve in [|n: usize| n / 2, |_: usize| 1, |n: usize| n.div_ceil(3)] {
                let leaves = cubes(count, step);
                let pairs = pairs(&leaves, halve);
                let own = |slot: u32| leaves[slot as usize];
                let plan = plan(&pairs, leaves.len(), &own);
                let (got, want) = (cost(&plan, Node::ROOT), least_inner(&plan, Node::ROOT, &mut Memory::new()));
                assert!((got - want).abs() < 1e-3 * want, "{count} cubes {step} apart: {got} {want}");
            }
        }
    }

    /// The cost of the wide node that a binary node becomes.
    fn cost(plan: &Planned<'_>, node: Node) -> f32 {
        let mut children = Vec::new();
        plan.children(node, &mut children);
        assert!(children.len() <= ARITY);
        let below =
            children.iter().map(|&(child, is_leaf)| if is_leaf { leaf_cost(plan, child) } else { cost(plan, child) });
        below.sum::<f32>() + plan.bounds(node).half_area() * NODE
    }

    #[test]
    fn three_levels_of_a_chain_and_of_a_full_tree() {
        let (leaves, mut children) = (cubes(32, 1.0), Vec::new());
        let own = |slot: u32| leaves[slot as usize];
        let mut show = |halve: fn(usize) -> usize| {
            plan(&pairs(&leaves, halve), leaves.len(), &own).three_levels(Node::ROOT, &mut children);
            (children.len(), children.iter().filter(|&&(_, is_leaf)| is_leaf).count())
        };
        assert_eq!(show(|n| n / 2), (8, 0));
        assert_eq!(show(|_| 1), (4, 3));
    }
}
