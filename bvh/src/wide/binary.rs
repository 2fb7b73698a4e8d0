//! The binary tree as input of the collapse, with leaves as small as those of wide nodes.

use eyerays_shader::data::NodeRef;

use crate::{
    bounds::Bounds,
    branch::{Branch, Piece, regrow},
    tree::{Children, Fold, Pair, filled, fold, slots},
};

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Left and right child, by their numbers.
    Inner(u32, u32),
    /// Primitives, at most as many as the wide nodes' leaves hold.
    Leaf,
}

/// A node and the places below it, which are in a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub bounds: Bounds,
    pub first: u32,
    pub count: u32,
    /// Inner nodes on the longest path down from here.
    pub height: u32,
    pub kind: Kind,
}

impl Node {
    /// A placeholder.
    const NONE: Node = Node { bounds: Bounds::EMPTY, first: 0, count: 0, height: 0, kind: Kind::Leaf };
}

/// A tree whose children come after their parents. Node 0 is the root; the children of pair `p` are nodes `2 p + 1` and
/// `2 p + 2`.
pub(crate) struct Binary {
    /// None if the root is a leaf.
    pub pairs: Vec<Children>,
    pub nodes: Vec<Node>,
    /// The slot at each place, from left to right.
    pub order: Vec<u32>,
}

impl Binary {
    /// The tree of `pairs` over slots with these own boxes. A leaf of more than `most` becomes a pair of two.
    pub fn of<P: Pair>(pairs: &[P], bounds: &[Bounds], most: u32) -> Self {
        let parted: Branch<Vec<u32>> = match bounds.len() {
            // Its sibling is empty.
            1 => Branch::Piece(Piece { pairs: Vec::new(), items: vec![0] }),
            _ => regrow(pairs, &|leaf: NodeRef, piece: &mut Piece<Vec<u32>>| part(leaf, piece, bounds, most)),
        };
        let (pairs, order) = parted.flat(0);
        let mut nodes = filled(Node::NONE, 1 + 2 * pairs.len());
        let totals = Totals { order: &order, bounds };
        let (root, below) = nodes.split_first_mut().expect("a root");
        *root = match order[..] {
            [_] => totals.leaf(NodeRef::leaf(0, 1)),
            _ => fold(&pairs, below.as_chunks_mut::<2>().0, &totals),
        };
        Binary { pairs, nodes, order }
    }
}

/// Adds a leaf, in two parts if it has more than `most`.
fn part(leaf: NodeRef, piece: &mut Piece<Vec<u32>>, bounds: &[Bounds], most: u32) -> NodeRef {
    if leaf.count() <= most {
        return piece.leaf(slots(leaf));
    }
    let mut slots: Vec<u32> = slots(leaf).collect();
    let half = best_part(&mut slots, bounds, most) as usize;
    let halves = [&slots[..half], &slots[half..]].map(|half| piece.leaf(half.iter().copied()));
    piece.pairs.push(halves);
    NodeRef::inner(piece.pairs.len() as u32 - 1)
}

/// Notes both nodes of a pair.
struct Totals<'a> {
    order: &'a [u32],
    bounds: &'a [Bounds],
}

impl Fold<Children> for Totals<'_> {
    type Known = Node;
    type Note = [Node; 2];

    fn leaf(&self, leaf: NodeRef) -> Node {
        let (first, count) = (leaf.index(), leaf.count());
        let slots = &self.order[first as usize..(first + count) as usize];
        let around = Bounds::around(slots.iter().map(|&slot| self.bounds[slot as usize]));
        Node { bounds: around, first, count, height: 0, kind: Kind::Leaf }
    }

    fn pair(&self, number: usize, _: &Children, [left, right]: [Node; 2], nodes: &mut [Node; 2]) -> Node {
        *nodes = [left, right];
        let child = 2 * number as u32 + 1;
        Node {
            bounds: left.bounds.union(right.bounds),
            first: left.first,
            count: left.count + right.count,
            height: 1 + left.height.max(right.height),
            kind: Kind::Inner(child, child + 1),
        }
    }
}

/// Sorts a leaf of four or five triangles into two parts of at most `most` and of least
/// cost by the surface area heuristic, and returns the first part's length.
fn best_part(triangles: &mut [u32], bounds: &[Bounds], most: u32) -> u32 {
    let all = (1u32 << triangles.len()) - 1;
    let members = |set: u32| (0..triangles.len()).filter(move |i| set >> i & 1 == 1);
    let cost = |set: u32| {
        let around = Bounds::around(members(set).map(|i| bounds[triangles[i] as usize]));
        set.count_ones() as f32 * around.half_area()
    };
    let fits = |set: &u32| [*set, all & !set].iter().all(|s| s.count_ones() <= most);
    // The last triangle is always in the second part, so that no split is tried twice.
    let sets = (1..=all / 2).filter(fits).map(|set| (cost(set) + cost(all & !set), set));
    let (_, set) = sets.min_by(|a, b| a.0.total_cmp(&b.0)).expect("some parting fits");
    let parts: Vec<u32> = members(set).chain(members(all & !set)).map(|i| triangles[i]).collect();
    triangles.copy_from_slice(&parts);
    set.count_ones()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(x: f32) -> Bounds {
        Bounds::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0])
    }

    #[test]
    fn a_large_leaf_is_split_at_the_gap() {
        let bounds: Vec<Bounds> = [0.0, 9.0, 1.0, 10.0, 2.0].map(cube).into();
        let mut triangles = [0, 1, 2, 3, 4];
        assert_eq!(best_part(&mut triangles, &bounds, 3), 2);
        assert_eq!(triangles, [1, 3, 0, 2, 4]);
        let mut four = [1, 0, 3, 2];
        assert_eq!(best_part(&mut four, &bounds, 3), 2);
        assert_eq!(four, [1, 3, 0, 2]);
    }
}
