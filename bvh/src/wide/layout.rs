//! Wide nodes, and the order of primitives that both hierarchies share.

use eyerays_shader::data::{CwbvhNode, NodePair, NodeRef};
use rayon::prelude::*;

use super::{
    binary::{Binary, Node},
    collapse::{LEVELS, Leaves, Plan},
    grid::Grid,
    octant,
    record::{Child, Record},
};
use crate::{MAX_DEPTH, bounds::Bounds, tree};

/// The most wide nodes on a path from the root.
///
/// A traversal keeps the siblings still to visit on a level in one entry, so its stack never holds more
/// entries than this.
pub const MAX_WIDE_DEPTH: u32 = 32;

// Splitting a leaf may add a level to the binary tree; three binary levels always fit into one wide node.
const _: () = assert!((MAX_DEPTH + 1).div_ceil(LEVELS) <= MAX_WIDE_DEPTH);

/// The wide nodes, and the new order of slots.
pub(crate) struct Wide {
    pub nodes: Vec<CwbvhNode>,
    /// At each new slot, the slot of before.
    pub slots: Vec<u32>,
}

/// Makes wide nodes of node pairs, whose slots are in depth-first order: a parent before its children,
/// the inner children of a node in a row, and what is below one of them before the next. `bounds` are the slots' own boxes.
pub(crate) fn wide(pairs: &[NodePair], bounds: &[Bounds]) -> Wide {
    let own = |slot: u32| bounds[slot as usize];
    let plan = Plan::of(Binary { pairs, count: bounds.len(), own, most: Leaves::WIDE.most }, Leaves::WIDE);
    let levels = levels(&plan);
    let count = levels.iter().map(Vec::len).sum();
    let mut wide = Wide { nodes: vec![nothing(); count], slots: Vec::with_capacity(bounds.len()) };
    let (mut open, mut next) = (vec![(0, 0, 0)], 1);
    while let Some((level, place, number)) = open.pop() {
        let made: &Made = &levels[level][place as usize];
        let mut record = made.record;
        (record.first_child, record.first_triangle) = (next, wide.slots.len() as u32);
        wide.nodes[number as usize] = record.encode();
        made.leaves().for_each(|leaf| plan.each_slot(leaf, |slot| wide.slots.push(slot)));
        let inner = made.inner().count() as u32;
        open.extend((0..inner).rev().map(|i| (level + 1, made.first + i, next + i)));
        next += inner;
    }
    wide
}

/// A wide node, whose children are not numbered yet.
struct Made {
    record: Record,
    /// The binary node in each slot with a child.
    children: [Node; CwbvhNode::ARITY],
    /// The place of the first inner child on the next level.
    first: u32,
}

/// The nodes of every level, those of a parent in a row. Threads share a level.
fn levels<F: Fn(u32) -> Bounds + Sync>(plan: &Plan<'_, NodePair, F>) -> Vec<Vec<Made>> {
    let (mut levels, mut open) = (Vec::new(), vec![Node::ROOT]);
    while !open.is_empty() {
        let level = levels.len() as u32;
        let make = |list: &mut _, &node: &Node| Made::of(plan, node, level, list);
        let mut made: Vec<Made> = open.par_iter().map_init(Vec::new, make).collect();
        open.clear();
        for node in &mut made {
            node.first = open.len() as u32;
            open.extend(node.inner());
        }
        levels.push(made);
    }
    levels
}

impl Made {
    /// The wide node that a binary one becomes, so many wide ones below the root. `list` is for any use.
    fn of<F: Fn(u32) -> Bounds + Sync>(
        plan: &Plan<'_, NodePair, F>,
        node: Node,
        level: u32,
        list: &mut Vec<(Node, bool)>,
    ) -> Self {
        plan.children_at(node, level, list);
        let boxes: Vec<Bounds> = list.iter().map(|&(child, _)| plan.bounds(child)).collect();
        let grid = Grid::around(Bounds::around(boxes.iter().copied()));
        let record = Record { grid, first_child: 0, first_triangle: 0, children: [Record::NOWHERE; CwbvhNode::ARITY] };
        let mut made = Made { record, children: [Node::ROOT; CwbvhNode::ARITY], first: 0 };
        for (slot, child) in octant::slots(&boxes, |i| list[i].1).into_iter().enumerate() {
            let Some(i) = child else { continue };
            let (binary, is_leaf) = list[i];
            let what = if is_leaf { Child::Leaf { count: plan.count(binary) } } else { Child::Inner };
            made.record.children[slot] = (what, grid.planes(boxes[i]));
            made.children[slot] = binary;
        }
        made
    }

    /// The binary nodes of inner children, in the order of slots.
    fn inner(&self) -> impl Iterator<Item = Node> {
        self.of_kind(|child| child == Child::Inner)
    }

    /// Those of leaves.
    fn leaves(&self) -> impl Iterator<Item = Node> {
        self.of_kind(|child| matches!(child, Child::Leaf { .. }))
    }

    fn of_kind(&self, is: impl Fn(Child) -> bool) -> impl Iterator<Item = Node> {
        self.record.children.iter().zip(self.children).filter(move |((child, _), _)| is(*child)).map(|(_, node)| node)
    }
}

impl Wide {
    /// Brings the leaves of `pairs` from the slots of before to those of wide nodes, at each of which one of before is named. Within a leaf, they are in a row.
    pub fn renumber(slots: &[u32], pairs: &mut [NodePair]) {
        let mut new = vec![0; slots.len()];
        for (slot, &old) in (0..).zip(slots) {
            new[old as usize] = slot;
        }
        let moved = |reference: u32| match NodeRef(reference) {
            leaf if leaf.is_leaf() => {
                let first = tree::slots(leaf).map(|slot| new[slot as usize]).min().expect("a leaf has slots");
                NodeRef::leaf(first, leaf.count()).0
            }
            inner => inner.0,
        };
        pairs.par_iter_mut().for_each(|pair| {
            pair.left_min.w = moved(pair.left_min.w);
            pair.right_min.w = moved(pair.right_min.w);
        });
    }
}

/// A placeholder for a node until it is made.
fn nothing() -> CwbvhNode {
    bytemuck::Zeroable::zeroed()
}
