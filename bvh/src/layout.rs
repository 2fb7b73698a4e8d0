//! From a tree to node pairs with their boxes.

use bytemuck::Zeroable;
use eyerays_shader::data::{NodePair, NodeRef};

use crate::{
    bounds::Bounds,
    tree::{Children, Fold, filled, fold, slots},
};

/// The pairs of a tree with their boxes; `own` tells that of a slot.
pub(crate) fn pairs(tree: &[Children], own: impl Fn(u32) -> Bounds + Sync) -> Vec<NodePair> {
    let mut pairs = filled(NodePair::zeroed(), tree.len());
    fold(tree, &mut pairs, &Boxes(own));
    pairs
}

/// The only pair of a tree of one primitive.
pub(crate) fn single(bounds: Bounds) -> NodePair {
    NodePair::new(bounds.child(NodeRef::leaf(0, 1)), NodePair::EMPTY)
}

struct Boxes<F>(F);

impl<F: Fn(u32) -> Bounds + Sync> Fold<Children> for Boxes<F> {
    type Known = Bounds;
    type Note = NodePair;

    fn leaf(&self, leaf: NodeRef) -> Bounds {
        Bounds::around(slots(leaf).map(&self.0))
    }

    fn pair(&self, _: usize, pair: &Children, [left, right]: [Bounds; 2], note: &mut NodePair) -> Bounds {
        *note = NodePair::new(left.child(pair[0]), right.child(pair[1]));
        left.union(right)
    }
}
