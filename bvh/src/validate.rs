//! The proof that kernels may index a hierarchy without checks.

use std::sync::atomic::{AtomicBool, Ordering};

use eyerays_shader::data::{Bounds as Record, MAX_LEAF, NodePair, NodeRef, numbers};

use crate::{
    BuildError, MAX_DEPTH,
    bounds::Bounds,
    tree::{self, position},
};

/// Subtrees of fewer pairs are left to one thread.
const FEW: usize = 4096;

/// Checks a hierarchy over the own boxes of slots: the pairs are a tree in depth-first order, every slot lies in exactly one
/// leaf, every box contains exactly what is below it, and no path has more than [`MAX_DEPTH`] pairs. Takes linear time.
///
/// # Errors
///
/// The first rule broken in depth-first order; slots that are in no leaf or in two come last.
pub fn validate(nodes: &[NodePair], bounds: &[Record]) -> Result<(), BuildError> {
    let primitives = bounds.len();
    if primitives == 0 {
        return Err(BuildError::NoPrimitives);
    }
    if nodes.is_empty() {
        return Err(BuildError::PairOutOfRange { pair: 0, child: 0, pairs: 0 });
    }
    let proof = Proof { nodes, bounds, met: unmet(primitives) };
    let slots = proof.subtree(0, nodes.len(), 0)?;
    match missing(&proof.met) {
        Some(primitive) => Err(BuildError::PrimitiveLost { primitive }),
        // As many as there are, and each at least once.
        None if slots == primitives => Ok(()),
        None => Err(BuildError::PrimitiveTwice { primitive: proof.twice() }),
    }
}

/// Checks that `order` names each of `count` references exactly once.
pub(crate) fn order(order: &[u32], count: usize) -> Result<(), BuildError> {
    let met = unmet(count);
    let is_out = |&number: &u32| met.get(number as usize).map(|met| met.store(true, Ordering::Relaxed)).is_none();
    if let Some(place) = position(order, is_out) {
        return Err(BuildError::PrimitiveTwice { primitive: order[place] });
    }
    match missing(&met) {
        Some(primitive) => Err(BuildError::PrimitiveLost { primitive }),
        None if order.len() == count => Ok(()),
        None => {
            let mut once = Once::new(count);
            let twice = order.iter().find(|&&number| !once.meet(number));
            Err(BuildError::PrimitiveTwice { primitive: *twice.expect("more than there are numbers") })
        }
    }
}

/// Both children of a pair: box and reference.
pub(crate) fn children(pair: &NodePair) -> [(Bounds, NodeRef); 2] {
    [
        (Bounds::new(numbers(pair.left_min), numbers(pair.left_max)), pair.left()),
        (Bounds::new(numbers(pair.right_min), numbers(pair.right_max)), pair.right()),
    ]
}

/// Is this [`NodePair::EMPTY`]?
pub(crate) fn is_empty(bounds: Bounds, reference: NodeRef) -> bool {
    let (min, max, empty) = NodePair::EMPTY;
    reference == empty && bounds == Bounds::new(min, max)
}

/// A hierarchy that is checked, and what its leaves have so far.
struct Proof<'a> {
    nodes: &'a [NodePair],
    bounds: &'a [Record],
    met: Vec<AtomicBool>,
}

impl Proof<'_> {
    /// Checks that the pairs from `first` to `end` are one subtree, `level` pairs below the root. Returns how many slots its
    /// leaves have together.
    fn subtree(&self, first: usize, end: usize, level: u32) -> Result<usize, BuildError> {
        let pair = first as u32;
        if level >= MAX_DEPTH {
            return Err(BuildError::TooDeep { pair });
        }
        let both = children(&self.nodes[first]);
        let [(_, left), (_, right)] = both;
        let middle = match (left.is_leaf(), right.is_leaf()) {
            (true, _) => first + 1,
            (_, true) => end,
            _ => right.index() as usize,
        };
        let parts = [(left, first + 1, middle), (right, middle, end)];
        for (child, from, to) in parts.into_iter().filter(|part| !part.0.is_leaf()) {
            self.check_place(pair, child, from, to, end)?;
        }
        if left.is_leaf() && right.is_leaf() && first + 1 < end {
            return Err(BuildError::PairUnreached { pair: pair + 1 });
        }
        for (bounds, child) in both {
            self.check_box(pair, bounds, child)?;
        }
        let below = |(child, from, to): (NodeRef, usize, usize)| match child.is_leaf() {
            true => Ok(child.count() as usize),
            false => self.subtree(from, to, level + 1),
        };
        let (left, right) = if end - first < FEW {
            (below(parts[0])?, below(parts[1])?)
        } else {
            let (left, right) = rayon::join(|| below(parts[0]), || below(parts[1]));
            (left?, right?)
        };
        // The empty sibling of a tree of one primitive is no other leaf.
        Ok(if is_empty(both[1].0, both[1].1) && self.bounds.len() == 1 { left } else { left + right })
    }

    /// Is a child's pair the first of those that are left for it, and are there any?
    fn check_place(&self, pair: u32, child: NodeRef, from: usize, to: usize, end: usize) -> Result<(), BuildError> {
        let (child, pairs) = (child.index(), self.nodes.len());
        if child as usize >= pairs {
            return Err(BuildError::PairOutOfRange { pair, child, pairs });
        }
        if child as usize != from || from >= to || to > end {
            return Err(BuildError::PairOutOfOrder { pair, child });
        }
        Ok(())
    }

    /// Does a child's box contain what is below it? Marks the slots of a leaf.
    fn check_box(&self, pair: u32, bounds: Bounds, child: NodeRef) -> Result<(), BuildError> {
        if self.bounds.len() == 1 && is_empty(bounds, child) {
            return Ok(());
        }
        let below = if child.is_leaf() {
            self.leaf(pair, child)?
        } else {
            let [(left, _), (right, _)] = children(&self.nodes[child.index() as usize]);
            left.union(right)
        };
        if bounds.contains(below) { Ok(()) } else { Err(BuildError::BoxTooSmall { pair }) }
    }

    /// Marks the slots of a leaf and returns the box around their primitives.
    fn leaf(&self, pair: u32, leaf: NodeRef) -> Result<Bounds, BuildError> {
        let (first, count) = (leaf.index(), leaf.count());
        let slots = first as usize..(first + count) as usize;
        let primitives = self.bounds.len();
        if count > MAX_LEAF || slots.end > primitives {
            return Err(BuildError::LeafOutOfRange { pair, first, count, primitives });
        }
        self.met[slots.clone()].iter().for_each(|met| met.store(true, Ordering::Relaxed));
        Ok(Bounds::around(self.bounds[slots].iter().map(Bounds::read)))
    }

    /// A slot that two leaves share.
    fn twice(&self) -> u32 {
        let mut once = Once::new(self.bounds.len());
        let leaves = self.nodes.iter().flat_map(|pair| [pair.left(), pair.right()]).filter(|child| child.is_leaf());
        let mut slots = leaves.flat_map(tree::slots);
        slots.find(|&slot| !once.meet(slot)).expect("leaves have more slots than there are")
    }
}

/// Numbers below `count`, none of which was met.
fn unmet(count: usize) -> Vec<AtomicBool> {
    (0..count).map(|_| AtomicBool::new(false)).collect()
}

/// The least number that was not met.
fn missing(met: &[AtomicBool]) -> Option<u32> {
    position(met, |met| !met.load(Ordering::Relaxed)).map(|number| number as u32)
}

/// Numbers that may each be marked once.
pub(crate) struct Once(Vec<bool>);

impl Once {
    /// Numbers below `count`, none marked.
    pub fn new(count: usize) -> Self {
        Once(vec![false; count])
    }

    /// Marks a number; false if it is out of range or was marked before.
    pub fn meet(&mut self, number: u32) -> bool {
        match self.0.get_mut(number as usize) {
            Some(met) => !std::mem::replace(met, true),
            None => false,
        }
    }

    /// The least number not marked.
    pub fn missing(&self) -> Option<u32> {
        self.0.iter().position(|met| !met).map(|i| i as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_is_a_permutation() {
        assert_eq!(order(&[2, 0, 1], 3), Ok(()));
        let twice = |primitive| Err(BuildError::PrimitiveTwice { primitive });
        assert_eq!(order(&[2, 0, 1, 0], 3), twice(0));
        assert_eq!(order(&[2, 0, 3], 3), twice(3));
        let lost = |primitive| Err(BuildError::PrimitiveLost { primitive });
        assert_eq!(order(&[2, 0], 3), lost(1));
        assert_eq!(order(&[2, 0, 2], 3), lost(1));
    }
}
