//! Pairs of nodes in depth-first order, and how threads share them.
//!
//! A pair comes before what is below it, and what is below its left child before what is below its right one. So a
//! subtree's pairs lie in a row, and where those of the right child start tells how many those of the left are: threads
//! divide a tree wherever it is large, without another record of it.

use std::ops::Range;

use eyerays_shader::data::{CentredPair, NodePair, NodeRef};
use rayon::prelude::*;

/// A subtree of so many pairs is left to one thread.
pub(crate) const CHUNK: usize = 4096;
/// Below so many pairs a subtree is left to one thread, whatever its size: calls are not nested deeper.
pub(crate) const NESTED: u32 = 128;

/// What a pair's children are.
pub(crate) type Children = [NodeRef; 2];

/// A pair in some record.
pub(crate) trait Pair: Sync {
    /// Its children.
    fn children(&self) -> Children;
}

impl Pair for Children {
    fn children(&self) -> Children {
        *self
    }
}

impl Pair for NodePair {
    fn children(&self) -> Children {
        [self.left(), self.right()]
    }
}

impl Pair for CentredPair {
    fn children(&self) -> Children {
        [self.left(), self.right()]
    }
}

/// The slots of a leaf.
pub(crate) fn slots(leaf: NodeRef) -> Range<u32> {
    leaf.index()..leaf.index() + leaf.count()
}

/// How many of the pairs below pair `first`, `count` with itself, are below its left child.
pub(crate) fn left_count([left, right]: Children, first: usize, count: usize) -> usize {
    match (left.is_leaf(), right.is_leaf()) {
        (true, _) => 0,
        (_, true) => count - 1,
        _ => right.index() as usize - first - 1,
    }
}

/// What a [`fold`] does at leaves and at pairs.
pub(crate) trait Fold<P>: Sync {
    /// What is known of a subtree.
    type Known: Send;
    /// What is noted for a pair.
    type Note: Send;

    /// What is known of a leaf.
    fn leaf(&self, leaf: NodeRef) -> Self::Known;

    /// What is known of a pair of this number with two subtrees, and what is noted for it.
    fn pair(&self, number: usize, pair: &P, children: [Self::Known; 2], note: &mut Self::Note) -> Self::Known;
}

/// Goes through a tree of `pairs` from its leaves up, with a note for each pair. The result does not depend on the number of
/// threads.
pub(crate) fn fold<P: Pair, F: Fold<P>>(pairs: &[P], notes: &mut [F::Note], of: &F) -> F::Known {
    assert_eq!(pairs.len(), notes.len());
    subtree(0, pairs, notes, of, 0)
}

fn subtree<P: Pair, F: Fold<P>>(first: usize, pairs: &[P], notes: &mut [F::Note], of: &F, level: u32) -> F::Known {
    if pairs.len() <= CHUNK || level == NESTED {
        return sweep(first, pairs, notes, of);
    }
    let children = pairs[0].children();
    let left = left_count(children, first, pairs.len());
    let (note, below) = notes.split_first_mut().expect("as many as pairs");
    let (left_pairs, right_pairs) = pairs[1..].split_at(left);
    let (left_notes, right_notes) = below.split_at_mut(left);
    let go = |reference: NodeRef, first, pairs: &[P], notes: &mut [F::Note]| {
        if reference.is_leaf() { of.leaf(reference) } else { subtree(first, pairs, notes, of, level + 1) }
    };
    let (left, right) = rayon::join(
        || go(children[0], first + 1, left_pairs, left_notes),
        || go(children[1], first + 1 + left, right_pairs, right_notes),
    );
    of.pair(first, &pairs[0], [left, right], note)
}

/// From the last pair to the first: what is known of the children comes last then, the left one's on top.
fn sweep<P: Pair, F: Fold<P>>(first: usize, pairs: &[P], notes: &mut [F::Note], of: &F) -> F::Known {
    let mut known = Vec::new();
    for (i, (pair, note)) in pairs.iter().zip(notes).enumerate().rev() {
        let [left, right] = pair.children();
        let mut of_child = |child: NodeRef| {
            if child.is_leaf() { of.leaf(child) } else { known.pop().expect("a pair comes before what is below it") }
        };
        let children = [of_child(left), of_child(right)];
        known.push(of.pair(first + i, pair, children, note));
    }
    known.pop().expect("a tree has a pair")
}

/// The deepest path in pairs.
pub(crate) fn height<P: Pair>(pairs: &[P]) -> u32 {
    struct Height;
    impl<P> Fold<P> for Height {
        type Known = u32;
        type Note = ();

        fn leaf(&self, _: NodeRef) -> u32 {
            0
        }

        fn pair(&self, _: usize, _: &P, [left, right]: [u32; 2], (): &mut ()) -> u32 {
            1 + left.max(right)
        }
    }
    fold(pairs, &mut vec![(); pairs.len()], &Height)
}

/// As many of the same, written by all threads.
pub(crate) fn filled<T: Copy + Send + Sync>(value: T, count: usize) -> Vec<T> {
    rayon::iter::repeat_n(value, count).collect()
}

/// The place of the first item that is so, looked for by all threads: chunk by chunk, since asking after each item whether another thread
/// has found one takes longer than most items do.
pub(crate) fn position<T: Sync>(items: &[T], is: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    let in_chunk = |(chunk, items): (usize, &[T])| items.iter().position(&is).map(|place| chunk * CHUNK + place);
    items.par_chunks(CHUNK).enumerate().find_map_first(in_chunk)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::branch::tests::halved;

    /// The slots below each pair.
    struct Slots;

    impl Fold<Children> for Slots {
        type Known = (u32, u32);
        type Note = (u32, u32);

        fn leaf(&self, leaf: NodeRef) -> (u32, u32) {
            (leaf.index(), leaf.count())
        }

        fn pair(&self, _: usize, _: &Children, [left, right]: [(u32, u32); 2], note: &mut (u32, u32)) -> (u32, u32) {
            assert_eq!(left.0 + left.1, right.0, "slots in a row");
            *note = (left.0, left.1 + right.1);
            *note
        }
    }

    #[test]
    fn many_threads_fold_what_one_does() {
        let count = 5 * CHUNK as u32;
        let (pairs, _) = halved(0, count, 64).flat(0);
        let (mut notes, mut swept) = (vec![(0, 0); pairs.len()], vec![(0, 0); pairs.len()]);
        assert_eq!(fold(&pairs, &mut notes, &Slots), (0, count));
        sweep(0, &pairs, &mut swept, &Slots);
        assert_eq!(notes, swept);
    }

    #[test]
    fn the_first_place_is_found() {
        let items: Vec<usize> = (0..3 * CHUNK).collect();
        for first in [0, 1, CHUNK - 1, CHUNK, 2 * CHUNK + 7] {
            assert_eq!(position(&items, |&item| item >= first), Some(first));
        }
        assert_eq!(position(&items, |&item| item >= 3 * CHUNK), None);
    }

    #[test]
    fn a_chain_of_any_length_is_folded() {
        let count = 100_000;
        let rest = |pair| if pair + 2 < count { NodeRef::inner(pair + 1) } else { NodeRef::leaf(pair + 1, 1) };
        let pairs: Vec<Children> = (0..count - 1).map(|pair| [NodeRef::leaf(pair, 1), rest(pair)]).collect();
        assert_eq!(fold(&pairs, &mut vec![(0, 0); pairs.len()], &Slots), (0, count));
        assert_eq!(height(&pairs), count - 1);
    }
}
