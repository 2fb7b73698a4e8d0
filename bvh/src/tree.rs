//! Pairs of nodes in depth-first order, and how threads share them.
//!
//! A pair comes before what is below it, and what is below its left child before what is below its right one. So a
//! subtree's pairs lie in a row, and where those of the right child start tells how many those of the left are: threads
//! divide a tree wherever it is large, without another record of it.

use eyerays_shader::data::{CentredPair, NodePair, NodeRef};
use rayon::prelude::*;

/// A subtree of so many pairs is left to one thread.
const CHUNK: usize = 4096;
/// Below so many pairs a subtree is left to one thread, whatever its size: calls are not nested deeper.
const NESTED: u32 = 128;

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

/// How many of the pairs below pair `first`, `count` with itself, are below its left child.
fn left_count([left, right]: Children, first: usize, count: usize) -> usize {
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

/// A tree as it grows, whose leaves hold items.
pub(crate) enum Branch<I> {
    /// Left and right.
    Inner(Box<[Branch<I>; 2]>),
    /// What one thread has grown.
    Piece(Piece<I>),
}

/// A small tree.
pub(crate) struct Piece<I> {
    /// In depth-first order, numbered from 0; none if it is a leaf of all items.
    pub pairs: Vec<Children>,
    /// Those of its leaves, from left to right.
    pub items: I,
}

/// Items, wherever they are.
pub(crate) trait Items: Sync {
    /// What they become.
    type Item: Copy + Send + Sync;

    /// How many there are.
    fn count(&self) -> usize;

    /// Writes them to as many places.
    fn write(&self, to: &mut [Self::Item]);
}

impl<T: Copy + Send + Sync> Items for Vec<T> {
    type Item = T;

    fn count(&self) -> usize {
        self.len()
    }

    fn write(&self, to: &mut [T]) {
        to.copy_from_slice(self);
    }
}

impl<T> Piece<Vec<T>> {
    /// Adds a leaf of these items. Returns what refers to it.
    pub fn leaf(&mut self, items: impl IntoIterator<Item = T>) -> NodeRef {
        let first = self.items.len();
        self.items.extend(items);
        NodeRef::leaf(first as u32, (self.items.len() - first) as u32)
    }

    /// Grows a tree in an empty piece: `next` tells what refers to a node, and its children if it is a pair.
    pub fn grow<N>(root: N, mut next: impl FnMut(N, &mut Self) -> Grown<N>) -> Self {
        let mut piece = Piece { pairs: Vec::new(), items: Vec::new() };
        let mut open = vec![(root, None)];
        while let Some((node, parent)) = open.pop() {
            let reference = match next(node, &mut piece) {
                Grown::Leaf(leaf) => leaf,
                Grown::Pair(left, right) => {
                    let pair = piece.pairs.len();
                    piece.pairs.push([NodeRef::ROOT; 2]);
                    open.extend([(right, Some((pair, 1))), (left, Some((pair, 0)))]);
                    NodeRef::inner(pair as u32)
                }
            };
            if let Some((pair, side)) = parent {
                piece.pairs[pair][side as usize] = reference;
            }
        }
        piece
    }
}

/// What a node becomes in a piece.
pub(crate) enum Grown<N> {
    /// A leaf that was added.
    Leaf(NodeRef),
    /// A pair of these nodes.
    Pair(N, N),
}

/// A tree of the same pairs, whose leaves `regrown` adds to the piece that they are in, as a leaf or a pair of leaves of its own.
pub(crate) fn regrow<P: Pair, T: Send>(
    pairs: &[P],
    leaf: &(impl Fn(NodeRef, &mut Piece<Vec<T>>) -> NodeRef + Sync),
) -> Branch<Vec<T>> {
    regrow_subtree(0, pairs, leaf, 0)
}

fn regrow_subtree<P: Pair, T: Send>(
    first: usize,
    pairs: &[P],
    leaf: &(impl Fn(NodeRef, &mut Piece<Vec<T>>) -> NodeRef + Sync),
    level: u32,
) -> Branch<Vec<T>> {
    if pairs.len() <= CHUNK || level == NESTED {
        return Branch::Piece(Piece::grow(NodeRef::inner(first as u32), |node, piece| {
            if node.is_leaf() {
                return Grown::Leaf(leaf(node, piece));
            }
            let [left, right] = pairs[node.index() as usize - first].children();
            Grown::Pair(left, right)
        }));
    }
    let children = pairs[0].children();
    let left = left_count(children, first, pairs.len());
    let (left_pairs, right_pairs) = pairs[1..].split_at(left);
    let go = |child: NodeRef, first, pairs: &[P]| {
        if !child.is_leaf() {
            return regrow_subtree(first, pairs, leaf, level + 1);
        }
        Branch::Piece(Piece::grow(child, |node, piece| Grown::Leaf(leaf(node, piece))))
    };
    let (left, right) =
        rayon::join(|| go(children[0], first + 1, left_pairs), || go(children[1], first + 1 + left, right_pairs));
    Branch::Inner(Box::new([left, right]))
}

impl<I: Items> Branch<I> {
    /// All pairs, and all items from left to right.
    pub fn flat(self, nothing: I::Item) -> (Vec<Children>, Vec<I::Item>) {
        let mut pieces = Pieces { places: Vec::new(), above: Vec::new(), pairs: 0, items: 0 };
        pieces.add(&self);
        let mut pairs: Vec<Children> = filled([NodeRef::ROOT; 2], pieces.pairs as usize);
        let mut items = filled(nothing, pieces.items as usize);
        for &(number, children) in &pieces.above {
            pairs[number as usize] = children;
        }
        let (mut rest, mut more, mut at) = (&mut pairs[..], &mut items[..], 0);
        let cut = |place: &Place<'_, I>| {
            rest.split_off_mut(..(place.pair - at) as usize).expect("as counted");
            at = place.pair + place.piece.pairs.len() as u32;
            let own = rest.split_off_mut(..place.piece.pairs.len()).expect("as counted");
            (own, more.split_off_mut(..place.piece.items.count()).expect("as counted"))
        };
        let slices: Vec<_> = pieces.places.iter().map(cut).collect();
        pieces.places.par_iter().zip(slices).for_each(|(place, (pairs, items))| {
            place.piece.items.write(items);
            for (to, children) in pairs.iter_mut().zip(&place.piece.pairs) {
                *to = children.map(|child| moved(child, place.pair, place.item));
            }
        });
        (pairs, items)
    }
}

/// As many of the same, written by all threads.
pub(crate) fn filled<T: Copy + Send + Sync>(value: T, count: usize) -> Vec<T> {
    rayon::iter::repeat_n(value, count).collect()
}

/// A child of a piece whose first pair and item have these numbers.
fn moved(child: NodeRef, pair: u32, item: u32) -> NodeRef {
    if child.is_leaf() {
        NodeRef::leaf(item + child.index(), child.count())
    } else {
        NodeRef::inner(pair + child.index())
    }
}

/// Where everything of a branch comes.
struct Pieces<'b, I> {
    places: Vec<Place<'b, I>>,
    /// Pairs above pieces, with their numbers.
    above: Vec<(u32, Children)>,
    /// How many there are so far.
    pairs: u32,
    items: u32,
}

/// The numbers of a piece's first pair and item.
struct Place<'b, I> {
    piece: &'b Piece<I>,
    pair: u32,
    item: u32,
}

impl<'b, I: Items> Pieces<'b, I> {
    /// Adds a branch, and returns what refers to it.
    fn add(&mut self, branch: &'b Branch<I>) -> NodeRef {
        let (pair, item) = (self.pairs, self.items);
        match branch {
            Branch::Inner(children) => {
                self.pairs += 1;
                let place = self.above.len();
                self.above.push((pair, [NodeRef::ROOT; 2]));
                let [left, right] = &**children;
                self.above[place].1 = [self.add(left), self.add(right)];
                NodeRef::inner(pair)
            }
            Branch::Piece(piece) => {
                self.pairs += piece.pairs.len() as u32;
                self.items += piece.items.count() as u32;
                self.places.push(Place { piece, pair, item });
                if piece.pairs.is_empty() { NodeRef::leaf(item, self.items - item) } else { NodeRef::inner(pair) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree of so many leaves of one item each, halved, with as many pairs for one thread as `few` leaves have.
    fn halved(first: u32, count: u32, few: u32) -> Branch<Vec<u32>> {
        if count > few {
            let half = count / 2;
            return Branch::Inner(Box::new([halved(first, half, few), halved(first + half, count - half, few)]));
        }
        Branch::Piece(Piece::grow((first, count), |(first, count), piece| {
            if count == 1 {
                return Grown::Leaf(piece.leaf([first]));
            }
            let half = count / 2;
            Grown::Pair((first, half), (first + half, count - half))
        }))
    }

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
    fn pairs_are_in_depth_first_order_and_items_from_left_to_right_whatever_one_thread_grew() {
        let (pairs, items) = halved(0, 11, 11).flat(0);
        assert_eq!(items, (0..11).collect::<Vec<_>>());
        for few in [1, 2, 5] {
            assert_eq!(halved(0, 11, few).flat(0), (pairs.clone(), items.clone()), "{few}");
        }
        let [left, right] = pairs[0];
        assert_eq!((left, right), (NodeRef::inner(1), NodeRef::inner(5)));
        assert_eq!(height(&pairs), 4);
    }

    #[test]
    fn many_threads_fold_and_regrow_what_one_does() {
        let count = 5 * CHUNK as u32;
        let (pairs, _) = halved(0, count, 64).flat(0);
        let (mut notes, mut swept) = (vec![(0, 0); pairs.len()], vec![(0, 0); pairs.len()]);
        assert_eq!(fold(&pairs, &mut notes, &Slots), (0, count));
        sweep(0, &pairs, &mut swept, &Slots);
        assert_eq!(notes, swept);
        let same = |leaf: NodeRef, piece: &mut Piece<Vec<u32>>| piece.leaf(leaf.index()..leaf.index() + leaf.count());
        assert_eq!(regrow(&pairs, &same).flat(0), (pairs, (0..count).collect()));
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
