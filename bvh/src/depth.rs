//! Limiting the depth.

use eyerays_shader::data::{MAX_LEAF, NodeRef, STACK};

use crate::{
    bounds::Bounds,
    branch::{Grown, Piece},
    median,
    tree::{Children, Fold, filled, fold, height},
};

/// The most node pairs on a path from the root.
///
/// A traversal visits the pairs of one path at a time and pushes at most one child a pair, so it
/// never holds more entries than this; one entry of its stack is left for a sentinel.
pub const MAX_DEPTH: u32 = STACK as u32 - 1;

// The root itself can always be split at medians.
const _: () = assert!((NodeRef::MAX_INDEX).ilog2() < MAX_DEPTH);

/// What a hierarchy may be at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Pairs on a path.
    depth: u32,
    /// References of a leaf where subtrees are built anew.
    leaf: u32,
}

impl Limits {
    /// Of a tree whose leaves have one reference each.
    pub const SINGLE: Limits = Limits { depth: MAX_DEPTH, leaf: 1 };

    /// Those of two hierarchies of which one begins in the leaves of the other: one stack serves both, and a leaf leads to one.
    pub const OF_LEVELS: Limits = Limits { depth: MAX_DEPTH / 2, leaf: 1 };
}

impl Default for Limits {
    fn default() -> Self {
        Limits { depth: MAX_DEPTH, leaf: MAX_LEAF }
    }
}

const _: () = assert!((NodeRef::MAX_INDEX).ilog2() < Limits::OF_LEVELS.depth);

/// A tree without paths longer than a limit: subtrees that are too deep are built anew by splits at medians. Nodes near
/// the root and shallow subtrees stay as they are. `order` is what is at each slot, by its number, and sorted within such
/// subtrees; `own` tells the box of a number.
///
/// The limit must be enough for median splits of the whole tree.
pub(crate) fn limit(
    tree: Vec<Children>,
    order: &mut [u32],
    own: impl Fn(u32) -> Bounds + Copy,
    Limits { depth: most, leaf }: Limits,
) -> Vec<Children> {
    if height(&tree) <= most {
        return tree;
    }
    let nothing = Below { height: 0, first: 0, count: 0 };
    let mut below = filled(nothing, tree.len());
    fold(&tree, &mut below, &Measure);
    // Leaves come from left to right, so each keeps its slots.
    let limited = Piece::grow((Subtree::Node(NodeRef::ROOT), 0), |(subtree, level), piece| {
        let [left, right] = match subtree.children(&tree, &below, level, most) {
            Ok(children) => children,
            Err((first, count)) if count <= leaf => return Grown::Leaf(piece.leaf(first..first + count)),
            Err((first, count)) => {
                let slots = first as usize..(first + count) as usize;
                let half = median::split(&mut order[slots], |&number| own(number), |&number| number) as u32;
                [Subtree::Run(first, half), Subtree::Run(first + half, count - half)]
            }
        };
        Grown::Pair((left, level + 1), (right, level + 1))
    });
    limited.pairs
}

/// A subtree that is still to be laid out.
#[derive(Clone, Copy)]
enum Subtree {
    /// That of a node, which fits if it is split at medians; as it is, it may be too deep.
    Node(NodeRef),
    /// Slots from a first one on, and their number.
    Run(u32, u32),
}

impl Subtree {
    /// The children, or the slots of a leaf or of what is to be split at medians.
    fn children(self, tree: &[Children], below: &[Below], level: u32, most: u32) -> Result<[Subtree; 2], (u32, u32)> {
        let pair = match self {
            Subtree::Run(first, count) => return Err((first, count)),
            Subtree::Node(leaf) if leaf.is_leaf() => return Err((leaf.index(), leaf.count())),
            Subtree::Node(inner) => inner.index() as usize,
        };
        let fits = |child: NodeRef| {
            let count = if child.is_leaf() { child.count() } else { below[child.index() as usize].count };
            level + 1 + median::height(count) <= most
        };
        let Below { height, first, count } = below[pair];
        if level + height <= most || tree[pair].into_iter().all(fits) {
            Ok(tree[pair].map(Subtree::Node))
        } else {
            Err((first, count))
        }
    }
}

/// What is below a pair.
#[derive(Clone, Copy)]
struct Below {
    /// Pairs on the longest path, itself among them.
    height: u32,
    first: u32,
    count: u32,
}

struct Measure;

impl Fold<Children> for Measure {
    type Known = Below;
    type Note = Below;

    fn leaf(&self, leaf: NodeRef) -> Below {
        Below { height: 0, first: leaf.index(), count: leaf.count() }
    }

    fn pair(&self, _: usize, _: &Children, [left, right]: [Below; 2], note: &mut Below) -> Below {
        let height = 1 + left.height.max(right.height);
        *note = Below { height, first: left.first, count: left.count + right.count };
        *note
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each pair has a leaf of one slot on the left and the rest on the right.
    fn chain(slots: u32) -> Vec<Children> {
        let rest = |pair| if pair + 2 < slots { NodeRef::inner(pair + 1) } else { NodeRef::leaf(pair + 1, 1) };
        (0..slots - 1).map(|pair| [NodeRef::leaf(pair, 1), rest(pair)]).collect()
    }

    /// A chain limited to paths of so many pairs.
    fn limited(slots: u32, most: u32) -> Vec<Children> {
        let mut order: Vec<u32> = (0..slots).collect();
        let own = |number: u32| Bounds::new([number as f32; 3], [number as f32 + 1.0; 3]);
        let tree = limit(chain(slots), &mut order, own, Limits { depth: most, ..Limits::default() });
        order.sort();
        assert_eq!(order, (0..slots).collect::<Vec<_>>());
        tree
    }

    #[test]
    fn a_chain_is_cut_where_the_rest_just_fits() {
        assert_eq!(height(&chain(1000)), 999);
        let tree = limited(1000, 20);
        assert_eq!(height(&tree), 20);
        // 988 slots need 8 levels, so 12 levels of the chain stay.
        let stays = tree.iter().zip(chain(1000)).take_while(|(now, before)| **now == *before).count();
        assert_eq!(stays, 12);
    }

    #[test]
    fn a_tree_that_fits_stays() {
        assert_eq!(limited(21, 20), chain(21));
        assert_ne!(limited(21, 19), chain(21));
    }

    #[test]
    fn the_whole_tree_is_built_anew_where_nothing_else_fits() {
        let most = median::height(1000);
        let tree = limited(1000, most);
        assert_eq!(height(&tree), most);
        assert!(tree[0].into_iter().all(|child| !child.is_leaf()));
    }
}
