//! A hierarchy whose primitives have moved: the same tree with other boxes (thesis 4.1.1).

use bytemuck::Zeroable;
use eyerays_shader::data::{CentredPair, NodePair, NodeRef, Primitive};
use rayon::prelude::*;

use crate::{
    BuildError, Bvh,
    bounds::Bounds,
    layout,
    reference::check_coordinates,
    statistics::Statistics,
    tree::{Fold, filled, fold, slots},
};

/// The hierarchy of primitives that have moved: a tree that was built over them where they were, with its primitives in the order of
/// slots, and the boxes of where they are. Parts of a split triangle get the box of all of it. Beside it is what it costs by the
/// surface area heuristic, as [`Statistics::sah_cost`] counts: one whose primitives have moved far is better built anew.
///
/// # Errors
/// The order does not name all of the primitives, or one of them is out of range.
pub fn refit(pairs: &[CentredPair], order: Vec<u32>, primitives: &[Primitive]) -> Result<(Bvh, f64), BuildError> {
    check_coordinates(primitives)?;
    let out = order.iter().find(|&&primitive| primitive as usize >= primitives.len());
    if let Some(&primitive) = out {
        return Err(BuildError::PrimitiveTwice { primitive });
    }
    let own = |slot: u32| Bounds::of(&primitives[order[slot as usize] as usize]);
    let bounds = (0..order.len() as u32).into_par_iter().map(|slot| own(slot).write()).collect();
    let (nodes, cost) = if order.len() == 1 {
        (vec![layout::single(own(0))], Statistics::TRAVERSAL + Statistics::INTERSECTION)
    } else {
        let mut nodes = filled(NodePair::zeroed(), pairs.len());
        let Known { bounds, cost } = fold(pairs, &mut nodes, &Boxes(own));
        (nodes, cost / area(bounds))
    };
    let bvh = Bvh { nodes, wide: Vec::new(), order, bounds };
    bvh.check(primitives)?;
    Ok((bvh, cost))
}

/// The slots of each pair: where those of its left child start and end, where those of its right child end, and 0.
///
/// # Panics
/// If slots do not lie in a row from left to right, as [`Bvh::widen`](crate::Bvh::widen) leaves them.
pub fn runs(pairs: &[CentredPair]) -> Vec<[u32; 4]> {
    if let [pair] = pairs
        && pair.right() == NodePair::EMPTY.2
        && pair.left() == NodeRef::leaf(0, 1)
    {
        return vec![[0, 1, 1, 0]];
    }
    let mut runs = vec![[0; 4]; pairs.len()];
    fold(pairs, &mut runs, &Runs);
    runs
}

/// What is known of a subtree: its box, and its cost times the root's area.
#[derive(Clone, Copy)]
struct Known {
    bounds: Bounds,
    cost: f64,
}

fn area(bounds: Bounds) -> f64 {
    f64::from(bounds.half_area())
}

struct Boxes<F>(F);

impl<F: Fn(u32) -> Bounds + Sync> Fold<CentredPair> for Boxes<F> {
    type Known = Known;
    type Note = NodePair;

    fn leaf(&self, leaf: NodeRef) -> Known {
        let bounds = Bounds::around(slots(leaf).map(&self.0));
        Known { bounds, cost: Statistics::INTERSECTION * f64::from(leaf.count()) * area(bounds) }
    }

    fn pair(&self, _: usize, pair: &CentredPair, [left, right]: [Known; 2], note: &mut NodePair) -> Known {
        *note = NodePair::new(left.bounds.child(pair.left()), right.bounds.child(pair.right()));
        let bounds = left.bounds.union(right.bounds);
        Known { bounds, cost: left.cost + right.cost + Statistics::TRAVERSAL * area(bounds) }
    }
}

struct Runs;

impl Fold<CentredPair> for Runs {
    type Known = [u32; 2];
    type Note = [u32; 4];

    fn leaf(&self, leaf: NodeRef) -> [u32; 2] {
        [slots(leaf).start, slots(leaf).end]
    }

    fn pair(&self, _: usize, _: &CentredPair, [left, right]: [[u32; 2]; 2], note: &mut [u32; 4]) -> [u32; 2] {
        assert_eq!(left[1], right[0], "slots in a row");
        *note = [left[0], left[1], right[1], 0];
        [left[0], right[1]]
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{Quality, build, split};

    /// So many triangles, each somewhere and of some size.
    fn heap(count: u32, rng: &mut fastrand::Rng) -> Vec<Primitive> {
        let mut place = |size: f32| Vec3::new(rng.f32() - 0.5, rng.f32() - 0.5, rng.f32() - 0.5) * size;
        (0..count)
            .map(|number| {
                let at = place(1.6);
                Primitive::triangle([at + place(0.3), at + place(0.3), at + place(0.3)], number, 0, 0)
            })
            .collect()
    }

    #[test]
    fn what_has_not_moved_has_the_boxes_that_it_had_and_what_has_is_checked() {
        let mut rng = fastrand::Rng::with_seed(5);
        for (count, budget) in [(1, 0.0), (2, 0.0), (5, 0.0), (6, 0.0), (300, 0.0), (10_000, 0.0), (3000, 0.5)] {
            let before = heap(count, &mut rng);
            let bvh = build(&split(&before, budget).unwrap(), Quality::Medium).unwrap();
            let pairs: Vec<CentredPair> = bvh.nodes.iter().map(CentredPair::from).collect();
            let (same, cost) = refit(&pairs, bvh.order.clone(), &before).unwrap();
            if budget == 0.0 {
                assert_eq!(same, bvh);
                let statistics = Statistics::of(&bvh, &before);
                assert!((cost / statistics.sah_cost - 1.0).abs() < 1e-9, "{cost}, {}", statistics.sah_cost);
            }
            // It is checked: every box contains what is below it, and no more.
            let (_, moved) = refit(&pairs, bvh.order.clone(), &heap(count, &mut rng)).unwrap();
            assert!(count < 300 || moved > 2.0 * cost, "a heap that is thrown again: {moved} from {cost}");
            for (pair, [first, middle, last, _]) in pairs.iter().zip(runs(&pairs)) {
                let is_run = |child: NodeRef, run| !child.is_leaf() || [slots(child).start, slots(child).end] == run;
                assert!(is_run(pair.left(), [first, middle]) && (count == 1 || is_run(pair.right(), [middle, last])));
            }
        }
    }

    #[test]
    fn other_primitives_are_refused() {
        let mut rng = fastrand::Rng::with_seed(6);
        let before = heap(50, &mut rng);
        let bvh = build(&split(&before, 0.0).unwrap(), Quality::Fast).unwrap();
        let pairs: Vec<CentredPair> = bvh.nodes.iter().map(CentredPair::from).collect();
        let fitted = |all: &[Primitive]| refit(&pairs, bvh.order.clone(), all).map(drop);
        assert_eq!(fitted(&before), Ok(()));
        assert!(matches!(fitted(&before[1..]), Err(BuildError::PrimitiveTwice { .. })));
        assert!(matches!(fitted(&heap(51, &mut rng)), Err(BuildError::PrimitiveLost { .. })));
        let mut far = before.clone();
        far[7] = Primitive::triangle([Vec3::splat(1.5); 3], 7, 0, 0);
        assert_eq!(fitted(&far), Err(BuildError::Coordinate { primitive: 7 }));
    }
}
