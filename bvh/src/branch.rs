//! Trees as they grow: pieces, each of one thread, below pairs.

use eyerays_shader::data::NodeRef;
use rayon::prelude::*;

use crate::tree::{Children, filled};

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
pub(crate) mod tests {
    use super::*;
    use crate::tree::height;

    /// A tree of so many leaves of one item each, halved, with as many pairs for one thread as `few` leaves have.
    pub fn halved(first: u32, count: u32, few: u32) -> Branch<Vec<u32>> {
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
}
