//! The proof that kernels may index a hierarchy without checks.

use eyerays_shader::data::{Bounds as Record, MAX_LEAF, NodePair, NodeRef, numbers};

use crate::{BuildError, MAX_DEPTH, bounds::Bounds};

/// Checks a hierarchy over the own boxes of slots: every pair is reached exactly once from the root,
/// every slot lies in exactly one leaf, every box contains exactly what is below it, and no path has
/// more than [`MAX_DEPTH`] pairs. Takes linear time.
///
/// # Errors
///
/// The first rule broken in depth-first order; pairs and slots that are never reached come last.
pub fn validate(nodes: &[NodePair], bounds: &[Record]) -> Result<(), BuildError> {
    let primitives = bounds.len();
    if primitives == 0 {
        return Err(BuildError::NoPrimitives);
    }
    let mut walk =
        Walk { nodes, bounds, pairs: Once::new(nodes.len()), slots: Once::new(primitives), open: Vec::new() };
    walk.enter(0, NodeRef::ROOT, 0)?;
    while let Some((pair, level)) = walk.open.pop() {
        for (bounds, reference) in children(&nodes[pair as usize]) {
            if primitives == 1 && is_empty(bounds, reference) {
                continue;
            }
            walk.child(pair, level, bounds, reference)?;
        }
    }
    if let Some(pair) = walk.pairs.missing() {
        return Err(BuildError::PairUnreached { pair });
    }
    match walk.slots.missing() {
        Some(primitive) => Err(BuildError::PrimitiveLost { primitive }),
        None => Ok(()),
    }
}

/// Checks that `order` names each of `count` references exactly once.
pub(crate) fn order(order: &[u32], count: usize) -> Result<(), BuildError> {
    let mut once = Once::new(count);
    for &primitive in order {
        if !once.meet(primitive) {
            return Err(BuildError::PrimitiveTwice { primitive });
        }
    }
    match once.missing() {
        Some(primitive) => Err(BuildError::PrimitiveLost { primitive }),
        None => Ok(()),
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

/// A walk through the tree and what it has reached so far.
struct Walk<'a> {
    nodes: &'a [NodePair],
    bounds: &'a [Record],
    pairs: Once,
    slots: Once,
    /// Pairs to visit, and how many are above each.
    open: Vec<(u32, u32)>,
}

impl Walk<'_> {
    /// Checks one child of `pair`, which has `level` pairs above it.
    fn child(&mut self, pair: u32, level: u32, bounds: Bounds, reference: NodeRef) -> Result<(), BuildError> {
        let below = if reference.is_leaf() {
            self.leaf(pair, reference)?
        } else {
            self.enter(pair, reference, level + 1)?;
            let [(left, _), (right, _)] = children(&self.nodes[reference.index() as usize]);
            left.union(right)
        };
        if bounds.contains(below) { Ok(()) } else { Err(BuildError::BoxTooSmall { pair }) }
    }

    /// Visits the pair that `parent` refers to.
    fn enter(&mut self, parent: u32, reference: NodeRef, level: u32) -> Result<(), BuildError> {
        let pair = reference.index();
        if pair as usize >= self.nodes.len() {
            return Err(BuildError::PairOutOfRange { pair: parent, child: pair, pairs: self.nodes.len() });
        }
        if !self.pairs.meet(pair) {
            return Err(BuildError::PairReachedTwice { pair });
        }
        if level >= MAX_DEPTH {
            return Err(BuildError::TooDeep { pair });
        }
        self.open.push((pair, level));
        Ok(())
    }

    /// Marks the slots of a leaf and returns the box around their primitives.
    fn leaf(&mut self, pair: u32, leaf: NodeRef) -> Result<Bounds, BuildError> {
        let (first, count) = (leaf.index(), leaf.count());
        let slots = first..first + count;
        let primitives = self.bounds.len();
        if count > MAX_LEAF || slots.end as usize > primitives {
            return Err(BuildError::LeafOutOfRange { pair, first, count, primitives });
        }
        match slots.clone().find(|&slot| !self.slots.meet(slot)) {
            Some(primitive) => Err(BuildError::PrimitiveTwice { primitive }),
            None => Ok(Bounds::around(slots.map(|slot| Bounds::read(&self.bounds[slot as usize])))),
        }
    }
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
        assert_eq!(order(&[2, 0, 2], 3), twice(2));
        let lost = |primitive| Err(BuildError::PrimitiveLost { primitive });
        assert_eq!(order(&[2, 0], 3), lost(1));
    }
}
