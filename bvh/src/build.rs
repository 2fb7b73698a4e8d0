//! From references to a hierarchy.

use eyerays_shader::data::{BOX_PADDING, Bounds as Record, CwbvhNode, NodePair, NodeRef};
use rayon::prelude::*;

use crate::{
    BuildError, Limits, Quality, References,
    bounds::Bounds,
    depth, layout, search,
    validate::{self, validate},
    wide::{Wide, validate_wide, wide},
};

/// A validated hierarchy.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// The node pairs, the root's first, then in depth-first order.
    pub nodes: Vec<NodePair>,
    /// The wide nodes, the root first: none before [`Bvh::widen`].
    pub wide: Vec<CwbvhNode>,
    /// The primitive at each slot of a leaf, as an index into the primitives of the references. Slots lie from left to right,
    /// or as wide nodes have them.
    pub order: Vec<u32>,
    /// The own box at each slot: that of the primitive, or of the part that the slot stands for.
    pub bounds: Vec<Record>,
}

impl Bvh {
    /// Makes wide nodes of the pairs, if there are none yet. Both have the same primitives at the same slots, whose order
    /// changes.
    ///
    /// # Errors
    ///
    /// A defect that the validation of wide nodes found.
    pub fn widen(&mut self) -> Result<(), BuildError> {
        if !self.wide.is_empty() {
            return Ok(());
        }
        let own: Vec<Bounds> = self.bounds.par_iter().map(Bounds::read).collect();
        let Wide { nodes, slots } = wide(&self.nodes, &own);
        Wide::renumber(&slots, &mut self.nodes);
        self.order = slots.par_iter().map(|&slot| self.order[slot as usize]).collect();
        self.bounds = slots.par_iter().map(|&slot| self.bounds[slot as usize]).collect();
        self.wide = nodes;
        validate_wide(&self.wide, &self.bounds).and_then(|()| validate(&self.nodes, &self.bounds))
    }
}

/// Builds the hierarchy of references to primitives in the normalised scene.
///
/// The same references give the same hierarchy, whatever the number of rayon's threads. Every box of
/// a pair contains exactly what is below it, no leaf has more than [`MAX_LEAF`](eyerays_shader::data::MAX_LEAF) references, and
/// no path has more than [`MAX_DEPTH`](crate::MAX_DEPTH) pairs; [`validate_wide`] tells what wide nodes promise.
///
/// # Errors
///
/// [`BuildError::TooManyPrimitives`], or a defect of the builder that its validation found.
pub fn build(references: &References, quality: Quality) -> Result<Bvh, BuildError> {
    build_within(references, quality, Limits::default())
}

/// The same with paths of no more pairs than a limit.
///
/// # Errors
///
/// As [`build`].
pub fn build_within(references: &References, quality: Quality, limits: Limits) -> Result<Bvh, BuildError> {
    let References { list, pairs } = references;
    let count = check_count(list.len())?;
    let own = |reference: u32| Bounds::read(&list[reference as usize].bounds);
    let (nodes, order) = if count == 1 {
        (vec![layout::single(own(0))], vec![0])
    } else {
        let (tree, mut order) = match quality.reinsertion() {
            0.0 => (pairs.clone(), (0..count).into_par_iter().collect()),
            share => search::improve(pairs, own, share),
        };
        let tree = depth::limit(tree, &mut order, own, limits);
        (layout::pairs(&tree, |slot| own(order[slot as usize])), order)
    };
    validate::order(&order, list.len())?;
    let at = |&slot: &u32| list[slot as usize];
    let bounds: Vec<Record> = order.par_iter().map(|slot| at(slot).bounds).collect();
    validate(&nodes, &bounds)?;
    let order = order.par_iter().map(|slot| at(slot).primitive).collect();
    Ok(Bvh { nodes, wide: Vec::new(), order, bounds })
}

/// The number of references, if a node reference can index so many.
pub(crate) fn check_count(count: usize) -> Result<u32, BuildError> {
    match u32::try_from(count) {
        Ok(0) => Err(BuildError::NoPrimitives),
        Ok(fits) if fits <= NodeRef::MAX_INDEX => Ok(fits),
        _ => Err(BuildError::TooManyPrimitives { count }),
    }
}

/// The greatest coordinate of an own box.
pub(crate) const MOST: f32 = 1.0 + BOX_PADDING;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_limited_by_what_a_reference_holds() {
        let most = NodeRef::MAX_INDEX as usize;
        assert_eq!(check_count(most), Ok(NodeRef::MAX_INDEX));
        assert_eq!(check_count(0), Err(BuildError::NoPrimitives));
        for count in [most + 1, 1 << 33] {
            let error = check_count(count).unwrap_err();
            assert_eq!(error, BuildError::TooManyPrimitives { count });
            let message = error.to_string();
            assert!(message.contains(&count.to_string()) && message.contains("536870911"));
        }
    }
}
