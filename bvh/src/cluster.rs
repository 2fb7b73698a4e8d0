//! Which primitives are grouped into one primitive for obvhs.
//!
//! PLOC merges two neighbours when each is the other's best partner. Among duplicates, evenly
//! spaced rows and boxes nested in one another all prefer the same side, so that one pair merges a
//! pass: the time is quadratic and the depth linear (100,000 duplicates: minutes, and 99,996
//! levels). A cheap trial clustering finds such runs; each becomes one primitive for obvhs and is split at
//! medians later.

use std::ops::Range;

use crate::{bounds::Bounds, morton};

/// How many neighbours along the Morton curve are checked together for stalling.
const RUN: usize = 256;
/// A run of [`RUN`] that merges fewer pairs than this in a pass has stalled. Of scattered boxes a third
/// merge.
const FEW: usize = 8;

/// Primitives in groups. A group is a primitive of the search.
pub(crate) struct Clusters {
    /// Primitive numbers, group by group.
    order: Vec<u32>,
    /// Where each group starts in `order`, and its length at the end.
    starts: Vec<u32>,
}

impl Clusters {
    /// Groups primitives by their boxes. Most groups have one primitive.
    pub fn of(bounds: &[Bounds]) -> Self {
        let order = morton::sorted(bounds);
        let mut glued = vec![false; order.len()];
        let mut nodes: Vec<Node> = (0..).zip(&order).map(|(i, &t)| (bounds[t as usize], i..i + 1)).collect();
        // A pass removes nodes from every full run. Fewer nodes than a run may merge slowly without harm.
        while nodes.len() > RUN {
            nodes = pass(&nodes, &mut glued);
        }
        let starts = (0..order.len() as u32).filter(|&i| !glued[i as usize]);
        let starts = starts.chain([order.len() as u32]).collect();
        Clusters { order, starts }
    }

    /// How many groups there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The primitives of a group.
    pub fn members(&self, group: u32) -> &[u32] {
        let group = group as usize;
        &self.order[self.starts[group] as usize..self.starts[group + 1] as usize]
    }
}

/// A box and the part of the Morton curve that it covers.
type Node = (Bounds, Range<u32>);

/// One pass of clustering, as obvhs does it between direct neighbours. Stalled runs become one node
/// and are glued together.
fn pass(nodes: &[Node], glued: &mut [bool]) -> Vec<Node> {
    let costs: Vec<f32> = nodes.windows(2).map(|w| w[0].0.union(w[1].0).half_area()).collect();
    // Ties go to the right, as in obvhs: that is why a row of equal boxes stalls.
    let merges = |i: usize| {
        i < costs.len() && (i == 0 || costs[i - 1] >= costs[i]) && (i + 1 == costs.len() || costs[i] < costs[i + 1])
    };
    let stalled = |run: &Range<usize>| run.clone().filter(|&j| merges(j)).count() * RUN < FEW * run.len();
    let run_from = |i: usize| i..(i + RUN).min(nodes.len());
    let mut next = Vec::with_capacity(nodes.len());
    let mut i = 0;
    while i < nodes.len() {
        let mut run = run_from(i);
        if run.len() == RUN && stalled(&run) {
            while stalled(&run_from(run.end)) {
                run.end = run_from(run.end).end;
            }
            next.push(glue(&nodes[run.clone()], glued));
            i = run.end;
            continue;
        }
        while i < run.end {
            let width = if merges(i) { 2 } else { 1 };
            next.push(join(&nodes[i..i + width]));
            i += width;
        }
    }
    next
}

/// One node instead of a stalled run, all of whose primitives become one group.
fn glue(nodes: &[Node], glued: &mut [bool]) -> Node {
    let node = join(nodes);
    glued[node.1.start as usize + 1..node.1.end as usize].fill(true);
    node
}

/// One node instead of neighbours.
fn join(nodes: &[Node]) -> Node {
    let covered = nodes[0].1.start..nodes[nodes.len() - 1].1.end;
    (Bounds::around(nodes.iter().map(|n| n.0)), covered)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unit cubes at these places along an axis.
    fn cubes(places: impl Iterator<Item = f32>) -> Vec<Bounds> {
        let cube = |x| Bounds::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]);
        places.map(cube).collect()
    }

    fn sizes(clusters: &Clusters) -> Vec<usize> {
        let groups = 0..clusters.len() as u32;
        groups.map(|i| clusters.members(i).len()).collect()
    }

    #[test]
    fn duplicates_and_even_rows_are_one_group() {
        assert_eq!(sizes(&Clusters::of(&cubes((0..5000).map(|_| 0.0)))), [5000]);
        assert_eq!(sizes(&Clusters::of(&cubes((0..5000).map(|i| i as f32)))), [5000]);
    }

    #[test]
    fn an_uneven_row_stays_apart() {
        let places = (0..5000u32).map(|i| (i * i % 4099) as f32 + i as f32 / 8192.0);
        assert_eq!(Clusters::of(&cubes(places)).len(), 5000);
    }

    #[test]
    fn groups_are_a_partition() {
        let places = (0..9000u32).map(|i| if i % 3 == 0 { 7.0 } else { (i * i % 8191) as f32 });
        let clusters = Clusters::of(&cubes(places));
        assert!((2..9000).contains(&clusters.len()));
        let groups = 0..clusters.len() as u32;
        let mut members: Vec<u32> = groups.flat_map(|i| clusters.members(i).to_vec()).collect();
        members.sort();
        assert!(members.into_iter().eq(0..9000));
    }
}
