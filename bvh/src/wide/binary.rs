//! The binary tree as input of the collapse, with leaves as small as those of wide nodes.

use eyerays_shader::data::{CentredPair, NodePair, NodeRef, numbers};

use crate::{
    bounds::Bounds,
    tree::{Pair, slots},
    validate::children,
};

/// A pair that has its children's boxes.
pub(crate) trait Boxed: Pair {
    /// That of the left child or of the right one.
    fn bounds(&self, side: usize) -> Bounds;
}

impl Boxed for NodePair {
    fn bounds(&self, side: usize) -> Bounds {
        children(self)[side].0
    }
}

impl Boxed for CentredPair {
    fn bounds(&self, side: usize) -> Bounds {
        let (centre, half) = [(self.left_centre, self.left_half), (self.right_centre, self.right_half)][side];
        Bounds::new(numbers(centre) - numbers(half), numbers(centre) + numbers(half))
    }
}

/// A node's number: 0 for the root, `2 p + 1` and `2 p + 2` for the children of pair `p`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Node(u32);

impl Node {
    pub const ROOT: Node = Node(0);
    /// Of halves of a leaf, beside twice its number.
    const HALF: u32 = 1 << 31;

    /// Both nodes of a pair.
    fn of_pair(pair: u32) -> [Node; 2] {
        [Node(2 * pair + 1), Node(2 * pair + 2)]
    }

    fn halves(self) -> [Node; 2] {
        [0, 1].map(|half| Node(Node::HALF | self.0 << 1 | half))
    }

    /// The leaf of which it is a half, and which one.
    pub fn half(self) -> Option<(Node, usize)> {
        (self.0 & Node::HALF != 0).then_some((Node((self.0 & !Node::HALF) >> 1), self.0 as usize & 1))
    }

    /// Its place in a list of all but halves.
    pub fn place(self) -> usize {
        self.0 as usize
    }
}

// A tree with a leaf to halve has fewer pairs than references.
const _: () = assert!(4 * (NodeRef::MAX_INDEX as u64) < Node::HALF as u64);

/// A tree of pairs. A leaf of more than `most` slots is a node of two leaves, its halves.
pub(crate) struct Binary<'a, P, F> {
    pub pairs: &'a [P],
    /// How many slots there are.
    pub count: usize,
    /// The own box of a slot.
    pub own: F,
    pub most: u32,
}

impl<P: Boxed, F: Fn(u32) -> Bounds> Binary<'_, P, F> {
    /// What refers to a node that is no half.
    fn reference(&self, node: Node) -> NodeRef {
        match (node.place(), self.count) {
            // Its sibling is empty.
            (0, 1) => NodeRef::leaf(0, 1),
            (0, _) => NodeRef::ROOT,
            (place, _) => self.pairs[(place - 1) / 2].children()[(place - 1) % 2],
        }
    }

    /// The children of an inner node.
    pub fn children(&self, node: Node) -> Option<[Node; 2]> {
        if node.half().is_some() {
            return None;
        }
        match self.reference(node) {
            leaf if leaf.is_leaf() => (leaf.count() > self.most).then(|| node.halves()),
            inner => Some(Node::of_pair(inner.index())),
        }
    }

    /// A node's box. `parting` tells how the leaf of a half is parted.
    pub fn bounds(&self, node: Node, parting: impl Fn(Node) -> Parting) -> Bounds {
        if let Some((leaf, half)) = node.half() {
            return self.half(self.reference(leaf), parting(leaf), half);
        }
        match (node.place(), self.count) {
            (0, 1) => (self.own)(0),
            (0, _) => self.pairs[0].bounds(0).union(self.pairs[0].bounds(1)),
            (place, _) => self.pairs[(place - 1) / 2].bounds((place - 1) % 2),
        }
    }

    /// The box of a leaf's half.
    pub fn half(&self, leaf: NodeRef, parting: Parting, half: usize) -> Bounds {
        Bounds::around(parting.slots(leaf, half).map(&self.own))
    }

    /// Goes through the slots below a node from left to right.
    pub fn each_slot(&self, node: Node, parting: impl Fn(Node) -> Parting, of: &mut impl FnMut(u32)) {
        match node.half() {
            Some((leaf, half)) => parting(leaf).slots(self.reference(leaf), half).for_each(of),
            None => self.each_below(self.reference(node), of),
        }
    }

    fn each_below(&self, node: NodeRef, of: &mut impl FnMut(u32)) {
        if node.is_leaf() {
            return slots(node).for_each(of);
        }
        self.pairs[node.index() as usize].children().into_iter().for_each(|child| self.each_below(child, of));
    }

    /// How a leaf that is too large is parted at least cost by the surface area heuristic.
    pub fn parting(&self, leaf: NodeRef) -> Parting {
        let boxes: Vec<Bounds> = slots(leaf).map(&self.own).collect();
        best_parting(&boxes, self.most)
    }
}

/// Which slots of a leaf are in its first half, a bit for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Parting(u8);

impl Parting {
    /// Of a leaf that is no halves.
    pub const NONE: Parting = Parting(0);

    /// The slots of a half.
    fn slots(self, leaf: NodeRef, half: usize) -> impl Iterator<Item = u32> {
        slots(leaf).zip(0..).filter(move |&(_, i)| usize::from(self.0 >> i & 1 == 0) == half).map(|(slot, _)| slot)
    }

    /// How many of so many slots are in either half.
    pub fn counts(self, all: u32) -> [u32; 2] {
        let first = self.0.count_ones();
        [first, all - first]
    }
}

/// How to part a leaf of four or five triangles with these boxes, so that no half has more than `most`, at least cost.
fn best_parting(boxes: &[Bounds], most: u32) -> Parting {
    let all = (1u32 << boxes.len()) - 1;
    let cost = |set: u32| {
        let members = (0..boxes.len()).filter(|i| set >> i & 1 == 1);
        set.count_ones() as f32 * Bounds::around(members.map(|i| boxes[i])).half_area()
    };
    let fits = |set: &u32| [*set, all & !set].iter().all(|s| s.count_ones() <= most);
    // The last triangle is always in the second half, so that no parting is tried twice.
    let sets = (1..=all / 2).filter(fits).map(|set| (cost(set) + cost(all & !set), set));
    let (_, set) = sets.min_by(|a, b| a.0.total_cmp(&b.0)).expect("some parting fits");
    Parting(set as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(x: f32) -> Bounds {
        Bounds::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0])
    }

    #[test]
    fn a_large_leaf_is_parted_at_the_gap() {
        let parted = |places: &[f32]| {
            let boxes: Vec<Bounds> = places.iter().map(|&x| cube(x)).collect();
            let leaf = NodeRef::leaf(3, boxes.len() as u32);
            let parting = best_parting(&boxes, 3);
            [0, 1].map(|half| parting.slots(leaf, half).map(|slot| slot - 3).collect::<Vec<_>>())
        };
        assert_eq!(parted(&[0.0, 9.0, 1.0, 10.0, 2.0]), [vec![1, 3], vec![0, 2, 4]]);
        assert_eq!(parted(&[9.0, 0.0, 10.0, 1.0]), [vec![0, 2], vec![1, 3]]);
    }
}
