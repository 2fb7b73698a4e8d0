//! Wide nodes, and the order of primitives that both hierarchies share.

use eyerays_shader::data::{CwbvhNode, NodePair, NodeRef};

use super::{
    binary::{Binary, Node},
    collapse::{LEVELS, Leaves, Plan},
    grid::Grid,
    octant,
    record::{Child, Record},
};
use crate::{MAX_DEPTH, bounds::Bounds, validate::children};

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
    /// At each new slot, the slot in depth-first order.
    slots: Vec<u32>,
}

/// Makes wide nodes of node pairs, whose slots are in depth-first order: a parent before its children,
/// the inner children of a node in a row, and what is below one of them before the next. `order` is
/// sorted within large leaves of the pairs; [`Wide::renumber`] does the rest.
pub(crate) fn wide(pairs: &[NodePair], order: &mut [u32], bounds: &[Bounds]) -> Wide {
    let tree = Binary::of(pairs.iter().map(children), order, bounds, Leaves::WIDE.most);
    let plan = Plan::of(&tree, Leaves::WIDE);
    let mut wide = Wide { nodes: vec![nothing()], slots: Vec::with_capacity(order.len()) };
    let mut list = Vec::new();
    let mut open = vec![Open { number: 0, node: 0, level: 0 }];
    while let Some(Open { number, node, level }) = open.pop() {
        plan.children_at(&tree, node, level, &mut list);
        let first = open.len();
        wide.add(number, &tree, &list, |number, node| open.push(Open { number, node, level: level + 1 }));
        open[first..].reverse();
    }
    wide
}

/// A wide node that is still to be made.
struct Open {
    /// Its number among wide nodes.
    number: u32,
    /// Its number in the binary tree.
    node: u32,
    /// Wide nodes above it.
    level: u32,
}

impl Wide {
    /// Makes wide node `number` of its children. Calls `open` with the numbers, wide and binary, of inner ones.
    fn add(&mut self, number: u32, tree: &Binary, children: &[(u32, bool)], mut open: impl FnMut(u32, u32)) {
        let node = |child: usize| &tree.nodes[children[child].0 as usize];
        let mut record = Record {
            grid: Grid::around(Bounds::around((0..children.len()).map(|i| node(i).bounds))),
            first_child: self.nodes.len() as u32,
            first_triangle: self.slots.len() as u32,
            children: [Record::NOWHERE; CwbvhNode::ARITY],
        };
        let boxes: Vec<Bounds> = (0..children.len()).map(|i| node(i).bounds).collect();
        for (slot, child) in octant::slots(&boxes, |i| children[i].1).into_iter().enumerate() {
            let Some(i) = child else { continue };
            let (binary, is_leaf) = children[i];
            let what = if is_leaf { Child::Leaf { count: node(i).count } } else { Child::Inner };
            record.children[slot] = (what, record.grid.planes(boxes[i]));
            if is_leaf {
                self.slots.extend(run(node(i)));
            } else {
                open(self.nodes.len() as u32, binary);
                self.nodes.push(nothing());
            }
        }
        self.nodes[number as usize] = record.encode();
    }

    /// Brings `order`, and the leaves of `pairs`, from the slots of depth-first order to those of the
    /// wide nodes.
    pub fn renumber(&self, pairs: &mut [NodePair], order: &mut Vec<u32>) {
        let mut new = vec![0; order.len()];
        for (slot, &old) in (0..).zip(&self.slots) {
            new[old as usize] = slot;
        }
        *order = self.slots.iter().map(|&old| order[old as usize]).collect();
        let moved = |reference: u32| match NodeRef(reference) {
            leaf if leaf.is_leaf() => NodeRef::leaf(new[leaf.index() as usize], leaf.count()).0,
            inner => inner.0,
        };
        for pair in pairs {
            pair.left_min.w = moved(pair.left_min.w);
            pair.right_min.w = moved(pair.right_min.w);
        }
    }
}

/// The slots below a node.
fn run(node: &Node) -> std::ops::Range<u32> {
    node.first..node.first + node.count
}

/// A placeholder for a node until it is made.
fn nothing() -> CwbvhNode {
    bytemuck::Zeroable::zeroed()
}
