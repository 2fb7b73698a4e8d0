//! The binary tree as input of the collapse, with leaves as small as those of wide nodes.

use eyerays_shader::data::NodeRef;

use crate::bounds::Bounds;

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Left and right child, by their numbers.
    Inner(u32, u32),
    /// Triangles, at most as many as the wide nodes' leaves hold.
    Leaf,
}

/// A node and the slots below it, which are contiguous.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub bounds: Bounds,
    pub first: u32,
    pub count: u32,
    /// Inner nodes on the longest path down from here.
    pub height: u32,
    pub kind: Kind,
}

/// A tree whose children come after their parents. Node 0 is the root.
pub(crate) struct Binary {
    pub nodes: Vec<Node>,
}

impl Binary {
    /// The tree of `pairs`, whose slots are in depth-first order. A leaf of more triangles than `most`
    /// becomes an inner node of two, for which `order` is sorted within the leaf.
    pub fn of(
        pairs: impl ExactSizeIterator<Item = [(Bounds, NodeRef); 2]>,
        order: &mut [u32],
        bounds: &[Bounds],
        most: u32,
    ) -> Self {
        if let [only] = order[..] {
            return Binary { nodes: vec![leaf(bounds[only as usize], 0, 1)] };
        }
        let mut nodes = vec![inner(Bounds::EMPTY, 0)];
        nodes.reserve(2 * pairs.len());
        for pair in pairs {
            nodes.extend(pair.map(|(bounds, reference)| node(bounds, reference)));
        }
        let mut tree = Binary { nodes };
        for i in 0..tree.nodes.len() {
            if tree.nodes[i].kind == Kind::Leaf && tree.nodes[i].count > most {
                tree.part(i, order, bounds, most);
            }
        }
        tree.sum();
        tree
    }

    /// Splits a leaf where that costs least.
    fn part(&mut self, number: usize, order: &mut [u32], bounds: &[Bounds], most: u32) {
        let Node { first, count, .. } = self.nodes[number];
        let slots = &mut order[first as usize..(first + count) as usize];
        let half = best_part(slots, bounds, most);
        self.nodes[number].kind = Kind::Inner(self.nodes.len() as u32, self.nodes.len() as u32 + 1);
        let (left, right) = slots.split_at(half as usize);
        for (slots, first) in [(left, first), (right, first + half)] {
            let around = Bounds::around(slots.iter().map(|&t| bounds[t as usize]));
            self.nodes.push(leaf(around, first, slots.len() as u32));
        }
    }

    /// Fills in the totals of inner nodes.
    fn sum(&mut self) {
        for i in (0..self.nodes.len()).rev() {
            if let Kind::Inner(left, right) = self.nodes[i].kind {
                let [left, right] = [left, right].map(|child| self.nodes[child as usize]);
                let node = &mut self.nodes[i];
                node.bounds = left.bounds.union(right.bounds);
                node.first = left.first;
                node.count = left.count + right.count;
                node.height = 1 + left.height.max(right.height);
            }
        }
    }
}

/// A pair's child. The children of pair `p` are nodes `2 p + 1` and `2 p + 2`.
fn node(bounds: Bounds, reference: NodeRef) -> Node {
    let index = reference.index();
    if reference.is_leaf() { leaf(bounds, index, reference.count()) } else { inner(bounds, index) }
}

fn leaf(bounds: Bounds, first: u32, count: u32) -> Node {
    Node { bounds, first, count, height: 0, kind: Kind::Leaf }
}

fn inner(bounds: Bounds, pair: u32) -> Node {
    Node { bounds, first: 0, count: 0, height: 0, kind: Kind::Inner(2 * pair + 1, 2 * pair + 2) }
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
