//! The cheapest plane, among those between bins.

use eyerays_shader::data::{BOX_PADDING, Primitive};

use super::part::Part;
use crate::bounds::Bounds;

/// Bins an axis. With 16, Conference's rays visit a quarter more nodes.
const BINS: usize = 32;

/// A way to split a node, and its cost: the sum of the children's areas times references.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub cost: f32,
    pub axis: usize,
    /// The first bin on the right.
    bin: usize,
    /// The children's boxes.
    pub children: [Bounds; 2],
}

/// The bins of an axis.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    start: f32,
    width: f32,
}

impl Axis {
    /// Bins between two coordinates; none if they are equal.
    fn between(start: f32, end: f32) -> Option<Self> {
        let width = (end - start) / BINS as f32;
        (width > 0.0).then_some(Axis { start, width })
    }

    fn bin(self, place: f32) -> usize {
        (((place - self.start) / self.width) as usize).min(BINS - 1)
    }

    /// Where a bin starts.
    fn plane(self, bin: usize) -> f32 {
        self.start + self.width * bin as f32
    }
}

/// Half the surface area of a box with its padding, so that boxes without extent differ too.
pub(super) fn area(bounds: Bounds) -> f32 {
    if bounds.is_empty() {
        return 0.0;
    }
    let [x, y, z] = bounds.extent().map(|e| e + 2.0 * BOX_PADDING);
    x * y + y * z + z * x
}

/// What is in a bin: the box around it, how many parts start here, and how many end.
type Bin = (Bounds, u32, u32);

const NOTHING: Bin = (Bounds::EMPTY, 0, 0);

/// The cheapest plane between bins.
fn cheapest(bins: &[Bin; BINS], axis: usize) -> Option<Split> {
    let mut right = [(Bounds::EMPTY, 0); BINS + 1];
    for i in (0..BINS).rev() {
        right[i] = (right[i + 1].0.union(bins[i].0), right[i + 1].1 + bins[i].2);
    }
    let (mut left, mut count) = (Bounds::EMPTY, 0);
    let mut best: Option<Split> = None;
    for bin in 1..BINS {
        left = left.union(bins[bin - 1].0);
        count += bins[bin - 1].1;
        let (right, others) = right[bin];
        let cost = area(left) * count as f32 + area(right) * others as f32;
        if count > 0 && others > 0 && best.is_none_or(|b| cost < b.cost) {
            best = Some(Split { cost, axis, bin, children: [left, right] });
        }
    }
    best
}

/// The cheaper split; the first of equals.
fn cheaper(a: Option<Split>, b: Option<Split>) -> Option<Split> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.cost < a.cost { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Splits between parts, by their centres.
pub(super) struct Objects([Option<Axis>; 3]);

impl Objects {
    /// Bins around the centres of parts.
    pub fn of(parts: &[Part]) -> Self {
        let centre = |part: &Part| {
            let centre = part.bounds.centre();
            Bounds { min: centre, max: centre }
        };
        let Bounds { min, max } = Bounds::around(parts.iter().map(centre));
        Objects(std::array::from_fn(|axis| Axis::between(min[axis], max[axis])))
    }

    /// The cheapest; none if all centres coincide.
    pub fn cheapest(&self, parts: &[Part]) -> Option<Split> {
        (0..3).filter_map(|axis| self.along(axis, parts)).map(Some).fold(None, cheaper)
    }

    fn along(&self, axis: usize, parts: &[Part]) -> Option<Split> {
        let along = self.0[axis]?;
        let mut bins = [NOTHING; BINS];
        for part in parts {
            let bin = &mut bins[along.bin(part.bounds.centre()[axis])];
            *bin = (bin.0.union(part.bounds), bin.1 + 1, bin.2 + 1);
        }
        cheapest(&bins, axis)
    }

    /// Does a part belong to the left child?
    pub fn is_left(&self, split: &Split, part: &Part) -> bool {
        self.0[split.axis].is_some_and(|along| along.bin(part.bounds.centre()[split.axis]) < split.bin)
    }
}

/// The cheapest split through parts within `bounds`, and its plane.
pub(super) fn through(triangles: &[Primitive], parts: &[Part], bounds: Bounds) -> Option<(Split, f32)> {
    let along = |axis: usize| -> Option<(Split, f32)> {
        // Slabs thinner than padding would separate nothing.
        let extent = bounds.extent()[axis];
        let along = Axis::between(bounds.min[axis], bounds.max[axis]).filter(|_| extent > 8.0 * BOX_PADDING)?;
        let mut bins = [NOTHING; BINS];
        for part in parts {
            chop(&triangles[part.triangle as usize], *part, axis, along, &mut bins);
        }
        cheapest(&bins, axis).map(|split| (split, along.plane(split.bin)))
    };
    let better = |a: Option<(Split, f32)>, b: (Split, f32)| match a {
        Some(a) if a.0.cost <= b.0.cost => Some(a),
        _ => Some(b),
    };
    (0..3).filter_map(along).fold(None, better)
}

/// Puts a part into all bins that it overlaps, cut at their planes.
fn chop(triangle: &Primitive, part: Part, axis: usize, along: Axis, bins: &mut [Bin; BINS]) {
    let first = along.bin(part.bounds.min[axis]);
    let last = along.bin(part.bounds.max[axis]).max(first);
    let mut rest = Some(part);
    for (number, bin) in bins.iter_mut().enumerate().take(last).skip(first) {
        let Some(part) = rest else { break };
        let [left, right] = part.cut(triangle, axis, along.plane(number + 1));
        if let Some(left) = left {
            bin.0 = bin.0.union(left.bounds);
        }
        rest = right;
    }
    if let Some(rest) = rest {
        bins[last].0 = bins[last].0.union(rest.bounds);
    }
    bins[first].1 += 1;
    bins[last].2 += 1;
}
