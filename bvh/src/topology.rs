//! A tree over primitives, without boxes.

use crate::spatial::Kind as Given;

/// What a node of a [`Topology`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Left and right child, by their numbers.
    Inner(u32, u32),
    /// Primitives in no order yet; a leaf if they are few, otherwise to be split at medians.
    Run,
}

/// A node and the primitives below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Node {
    pub kind: Kind,
    /// First slot of the subtree.
    pub first: u32,
    /// Slots of the subtree.
    pub count: u32,
}

/// A binary tree whose children come after their parents, and whose subtrees cover contiguous
/// slots. Node 0 is the root.
pub(crate) struct Topology {
    pub nodes: Vec<Node>,
    /// The primitive at each slot.
    pub order: Vec<u32>,
}

impl Topology {
    /// One run of all primitives.
    pub fn run(primitives: u32) -> Self {
        let node = Node { kind: Kind::Run, first: 0, count: primitives };
        Topology { nodes: vec![node], order: (0..primitives).collect() }
    }

    /// A tree in depth-first order, of about so many nodes: `given` tells what a node of another tree is, `members` adds the
    /// primitives of a leaf. Node 0 is the root of both.
    pub fn of(nodes: usize, given: impl Fn(u32) -> Given, members: impl Fn(u32, &mut Vec<u32>)) -> Self {
        let mut topology = Topology { nodes: Vec::with_capacity(nodes), order: Vec::new() };
        let mut open = vec![(0u32, None)];
        while let Some((number, parent)) = open.pop() {
            let new = topology.nodes.len() as u32;
            if let Some((parent, side)) = parent {
                topology.link(parent, side, new);
            }
            topology.nodes.push(Node { kind: Kind::Run, first: topology.order.len() as u32, count: 0 });
            match given(number) {
                Given::Leaf(leaf) => members(leaf, &mut topology.order),
                Given::Inner(left, right) => {
                    open.extend([(right, Some((new, Side::Right))), (left, Some((new, Side::Left)))])
                }
            }
        }
        topology.count();
        topology
    }

    /// Makes `child` a child of `parent`.
    fn link(&mut self, parent: u32, side: Side, child: u32) {
        let kind = &mut self.nodes[parent as usize].kind;
        *kind = match (side, *kind) {
            (Side::Left, _) => Kind::Inner(child, child),
            (Side::Right, Kind::Inner(left, _)) => Kind::Inner(left, child),
            (Side::Right, Kind::Run) => unreachable!("left children are linked first"),
        };
    }

    /// Fills in how many slots each subtree has.
    fn count(&mut self) {
        // In depth-first order, slots still to come at a node begin where the next node's do.
        let mut end = self.order.len() as u32;
        for i in (0..self.nodes.len()).rev() {
            let first = self.nodes[i].first;
            self.nodes[i].count = match self.nodes[i].kind {
                Kind::Run => end - first,
                Kind::Inner(left, right) => self.nodes[left as usize].count + self.nodes[right as usize].count,
            };
            end = first;
        }
    }
}

#[derive(Clone, Copy)]
enum Side {
    Left,
    Right,
}
