//! Whether a hierarchy that was kept is still one of its primitives.

use std::sync::atomic::{AtomicBool, Ordering};

use eyerays_shader::data::{NodePair, NodeRef, Primitive};
use rayon::prelude::*;

use crate::{
    BuildError, Bvh,
    bounds::Bounds,
    build::check_count,
    reference::check_coordinates,
    tree::{Fold, fold, slots},
    validate::{children, is_empty, validate},
};

impl Bvh {
    /// Checks a hierarchy that [`build`](crate::build()) did not make just now, without wide nodes: whether it keeps all that
    /// `build` promises, and whether its own boxes are those of the primitives, or parts that reach as far together.
    ///
    /// # Errors
    ///
    /// A rule that is broken.
    pub fn check(&self, primitives: &[Primitive]) -> Result<(), BuildError> {
        check_count(primitives.len())?;
        check_count(self.order.len())?;
        check_coordinates(primitives)?;
        if self.order.len() != self.bounds.len() {
            return Err(BuildError::Slots { order: self.order.len(), bounds: self.bounds.len() });
        }
        self.check_own(primitives)?;
        validate(&self.nodes, &self.bounds)?;
        if self.order.len() > 1 && fold(&self.nodes, &mut vec![(); self.nodes.len()], &Runs).is_none() {
            return Err(BuildError::SlotOrder);
        }
        let loose = self.nodes.par_iter().position_first(|pair| !self.is_tight(pair));
        loose.map_or(Ok(()), |pair| Err(BuildError::BoxTooLarge { pair: pair as u32 }))
    }

    /// Checks that every primitive has its box in a slot, or parts of it in several.
    fn check_own(&self, primitives: &[Primitive]) -> Result<(), BuildError> {
        let met: Vec<AtomicBool> = primitives.par_iter().map(|_| AtomicBool::new(false)).collect();
        let has_met = |primitive: u32| &met[primitive as usize];
        let part = |slot| {
            let primitive = self.order[slot as usize];
            let whole = primitives.get(primitive as usize).map(Bounds::of);
            let Some(whole) = whole.filter(|&whole| self.own(slot).is_part_of(whole)) else {
                return Some(Err(BuildError::BoxElsewhere { slot }));
            };
            if whole != self.own(slot) {
                return Some(Ok((primitive, slot)));
            }
            has_met(primitive).store(true, Ordering::Relaxed);
            None
        };
        let slots = (0..self.order.len() as u32).into_par_iter();
        let mut parts: Vec<(u32, u32)> = slots.filter_map(part).collect::<Result<_, _>>()?;
        parts.par_sort_unstable();
        parts.par_chunk_by(|a, b| a.0 == b.0).for_each(|parts| {
            let all = Bounds::around(parts.iter().map(|&(_, slot)| self.own(slot)));
            let primitive = parts[0].0;
            if all == Bounds::of(&primitives[primitive as usize]) {
                has_met(primitive).store(true, Ordering::Relaxed);
            }
        });
        match met.par_iter().position_first(|met| !met.load(Ordering::Relaxed)) {
            Some(primitive) => Err(BuildError::PrimitiveLost { primitive: primitive as u32 }),
            None => Ok(()),
        }
    }

    fn own(&self, slot: u32) -> Bounds {
        Bounds::read(&self.bounds[slot as usize])
    }

    /// Are both boxes of a validated pair no larger than what is below them?
    fn is_tight(&self, pair: &NodePair) -> bool {
        children(pair).into_iter().all(|(bounds, below)| is_empty(bounds, below) || bounds == self.around(below))
    }

    fn around(&self, below: NodeRef) -> Bounds {
        if below.is_leaf() {
            return Bounds::around(slots(below).map(|slot| self.own(slot)));
        }
        let [(left, _), (right, _)] = children(&self.nodes[below.index() as usize]);
        left.union(right)
    }
}

/// The slots below a pair, if they lie in a row from left to right: where they start and end.
struct Runs;

impl Fold<NodePair> for Runs {
    type Known = Option<[u32; 2]>;
    type Note = ();

    fn leaf(&self, leaf: NodeRef) -> Self::Known {
        Some([slots(leaf).start, slots(leaf).end])
    }

    fn pair(&self, _: usize, _: &NodePair, [left, right]: [Self::Known; 2], (): &mut ()) -> Self::Known {
        let ([start, middle], [next, end]) = (left?, right?);
        (middle == next).then_some([start, end])
    }
}
