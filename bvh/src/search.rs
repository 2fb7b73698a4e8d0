//! The search for a better tree, by obvhs.

use eyerays_shader::data::NodeRef;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, DEFAULT_MAX_STACK_DEPTH, node::Bvh2Node},
};

use crate::{
    bounds::Bounds,
    branch::{Branch, Grown, Piece},
    reinsertion::Reinsertion,
    tree::{Children, Fold, fold, slots},
};

/// Down to this level, threads share what is below a pair.
const LEVELS: u32 = 12;

/// A tree of the same leaves that costs less, and its slots from left to right. A first pass tries to move `share` of the
/// nodes. The depth has no bound.
pub(crate) fn improve(pairs: &[Children], own: impl Fn(u32) -> Bounds + Sync, share: f32) -> (Vec<Children>, Vec<u32>) {
    let mut tree = Bvh2::zeroed(pairs.len() + 1);
    let (root, below) = tree.nodes.split_first_mut().expect("a root");
    let around = fold(pairs, below.as_chunks_mut::<2>().0, &Boxes(own));
    *root = node(around, NodeRef::ROOT);
    // Up to this depth, obvhs searches with a stack that forgets candidates when it is full; the
    // one it takes for deeper trees panics then.
    tree.max_depth = DEFAULT_MAX_STACK_DEPTH;
    Reinsertion::new(share).run(&mut tree);
    branch(&tree, 0, 0).flat(0)
}

/// Both nodes of each pair. Those of pair `p` are nodes `2 p + 1` and `2 p + 2`.
struct Boxes<F>(F);

impl<F: Fn(u32) -> Bounds + Sync> Fold<Children> for Boxes<F> {
    type Known = Bounds;
    type Note = [Bvh2Node; 2];

    fn leaf(&self, leaf: NodeRef) -> Bounds {
        Bounds::around(slots(leaf).map(&self.0))
    }

    fn pair(&self, _: usize, pair: &Children, [left, right]: [Bounds; 2], nodes: &mut [Bvh2Node; 2]) -> Bounds {
        *nodes = [node(left, pair[0]), node(right, pair[1])];
        left.union(right)
    }
}

fn node(bounds: Bounds, reference: NodeRef) -> Bvh2Node {
    let first = if reference.is_leaf() { reference.index() } else { 2 * reference.index() + 1 };
    Bvh2Node::new(Aabb::new(bounds.min, bounds.max), reference.count(), first)
}

/// What is below a node, with the slots of its leaves.
fn branch(tree: &Bvh2, number: u32, level: u32) -> Branch<Vec<u32>> {
    let node = &tree.nodes[number as usize];
    if node.is_leaf() || level == LEVELS {
        return Branch::Piece(Piece::grow(number, |number, piece| {
            let Bvh2Node { first_index: first, prim_count: count, .. } = tree.nodes[number as usize];
            if count > 0 { Grown::Leaf(piece.leaf(first..first + count)) } else { Grown::Pair(first, first + 1) }
        }));
    }
    let below = |child| branch(tree, child, level + 1);
    let (left, right) = rayon::join(|| below(node.first_index), || below(node.first_index + 1));
    Branch::Inner(Box::new([left, right]))
}
