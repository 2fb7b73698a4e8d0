//! The tree whose planes split triangles.

use std::collections::VecDeque;

use super::part::Part;

/// A tree as it grows.
pub(super) enum Branch {
    /// Left and right.
    Inner(Box<[Branch; 2]>),
    /// At least one part.
    Leaf(Vec<Part>),
}

/// What a node of a [`Tree`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Left and right child, by their numbers.
    Inner(u32, u32),
    /// A leaf, by its number.
    Leaf(u32),
}

/// A tree in breadth-first order, siblings in a row, whose leaves cover references in their order. Node 0
/// is the root. The reinsertion relies on large nodes being among the first.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tree {
    pub nodes: Vec<Kind>,
    /// Where each leaf's references start, and their number at the end.
    pub starts: Vec<u32>,
}

/// Numbers the nodes of a grown tree and lays out its parts.
pub(super) fn flat(root: Branch) -> (Tree, Vec<Part>) {
    let mut tree = Tree { nodes: vec![Kind::Leaf(0)], starts: vec![0] };
    let mut parts = Vec::new();
    let mut open = VecDeque::from([(root, 0)]);
    while let Some((branch, number)) = open.pop_front() {
        tree.nodes[number] = match branch {
            Branch::Inner(children) => {
                let left = tree.nodes.len();
                tree.nodes.extend([Kind::Leaf(0); 2]);
                let [one, other] = *children;
                open.extend([(one, left), (other, left + 1)]);
                Kind::Inner(left as u32, left as u32 + 1)
            }
            Branch::Leaf(its) => {
                parts.extend(its);
                tree.starts.push(parts.len() as u32);
                Kind::Leaf(tree.starts.len() as u32 - 2)
            }
        };
    }
    (tree, parts)
}
