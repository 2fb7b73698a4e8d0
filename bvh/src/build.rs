//! From references to a hierarchy.

use eyerays_shader::data::{BOX_PADDING, Bounds as Record, CwbvhNode, MAX_LEAF, NodePair, NodeRef};
use rayon::prelude::*;

use crate::{
    BuildError, MAX_DEPTH, Quality, Reference, References,
    bounds::Bounds,
    layout, search,
    spatial::Tree,
    topology::Topology,
    validate::{self, validate},
    wide::{validate_wide, wide},
};

/// A validated hierarchy, as pairs and as wide nodes. Both have the same primitives at the same slots.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// The node pairs, the root's first, then in depth-first order.
    pub nodes: Vec<NodePair>,
    /// The wide nodes, the root first.
    pub wide: Vec<CwbvhNode>,
    /// The primitive at each slot of a leaf, as an index into the primitives of the references.
    pub order: Vec<u32>,
    /// The own box at each slot: that of the primitive, or of the part that the slot stands for.
    pub bounds: Vec<Record>,
}

impl Bvh {
    /// Brings the primitives, or one item a primitive, into the order of slots.
    ///
    /// # Panics
    ///
    /// If there are fewer items than primitives.
    pub fn gather<T: Copy + Send + Sync>(&self, items: &[T]) -> Vec<T> {
        self.order.par_iter().map(|&i| items[i as usize]).collect()
    }
}

/// Builds the hierarchy of references to primitives in the normalised scene.
///
/// The same references give the same hierarchy, whatever the number of rayon's threads. Every box of
/// a pair contains exactly what is below it, no leaf has more than [`MAX_LEAF`] references, and no path
/// has more than [`MAX_DEPTH`] pairs; [`validate_wide`] tells what wide nodes promise.
///
/// # Errors
///
/// [`BuildError::NoPrimitives`], [`BuildError::TooManyPrimitives`], and [`BuildError::Reference`] if a
/// box is empty, or not in [-1, 1] except for its padding. Any other error is a defect of the builder that
/// its validation found.
pub fn build(references: &References, quality: Quality) -> Result<Bvh, BuildError> {
    let list = &references.list;
    check_count(list.len())?;
    check_boxes(list)?;
    let bounds: Vec<Bounds> = list.par_iter().map(|r| Bounds::read(&r.bounds)).collect();
    let (mut nodes, mut order) = match bounds[..] {
        [only] => (vec![layout::single(only)], vec![0]),
        _ => {
            let mut topology = topology(&bounds, references.tree.as_ref(), quality);
            topology.limit_depth(MAX_DEPTH);
            (layout::pairs(&mut topology, &bounds), topology.order)
        }
    };
    validate::order(&order, list.len())?;
    let wide = wide(&nodes, &mut order, &bounds);
    wide.renumber(&mut nodes, &mut order);
    let at = |&slot: &u32| list[slot as usize];
    let bvh = Bvh {
        nodes,
        wide: wide.nodes,
        order: order.par_iter().map(|slot| at(slot).primitive).collect(),
        bounds: order.par_iter().map(|slot| at(slot).bounds).collect(),
    };
    let proofs = rayon::join(|| validate(&bvh.nodes, &bvh.bounds), || validate_wide(&bvh.wide, &bvh.bounds));
    proofs.0.and(proofs.1)?;
    Ok(bvh)
}

/// The tree before its depth is limited.
fn topology(bounds: &[Bounds], tree: Option<&Tree>, quality: Quality) -> Topology {
    let count = bounds.len() as u32;
    if count <= MAX_LEAF {
        return Topology::run(count);
    }
    match tree {
        Some(tree) => search::improve(tree, bounds, quality),
        None => search::search(bounds, quality),
    }
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

/// obvhs can handle neither NaN nor areas that overflow.
fn check_boxes(references: &[Reference]) -> Result<(), BuildError> {
    let normalised = |reference: &Reference| {
        let Bounds { min, max } = Bounds::read(&reference.bounds);
        (0..3).all(|i| -MOST <= min[i] && min[i] <= max[i] && max[i] <= MOST)
    };
    match references.par_iter().position_first(|r| !normalised(r)) {
        Some(reference) => Err(BuildError::Reference { reference: reference as u32 }),
        None => Ok(()),
    }
}

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
