//! Bins along the axes, and the cheapest plane between them.

use eyerays_shader::data::BOX_PADDING;
use glam::Vec3A;

use crate::bounds::{Bounds, half_area};

/// The most bins an axis. With 16 between triangles, Conference's rays visit a quarter more nodes.
pub(super) const BINS: usize = 32;

/// A way to split a node, and its cost: the sum of the children's areas times references.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub cost: f32,
    pub axis: usize,
    /// The first bin on the right.
    pub bin: usize,
    /// The children's boxes.
    pub children: [Bounds; 2],
}

impl Split {
    /// The cheaper split; the first of equals.
    pub fn cheaper(a: Option<Split>, b: Option<Split>) -> Option<Split> {
        match (a, b) {
            (Some(a), Some(b)) => Some(if b.cost < a.cost { b } else { a }),
            (a, b) => a.or(b),
        }
    }
}

/// Half the surface area of a box with its padding, so that boxes without extent differ too.
pub(super) fn area(bounds: Bounds) -> f32 {
    if bounds.is_empty() { 0.0 } else { half_area(bounds.extent() + 2.0 * BOX_PADDING) }
}

/// Where the bins of every axis lie.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    start: Vec3A,
    width: Vec3A,
    /// Bins a length.
    density: Vec3A,
}

impl Grid {
    /// So many bins across a box. An axis without extent has all in its first bin.
    pub fn across(bounds: Bounds, count: usize) -> Self {
        let width = bounds.extent() / count as f32;
        let width = Vec3A::select(width.cmpgt(Vec3A::splat(LEAST)), width, Vec3A::ONE);
        Grid { start: bounds.min, width, density: width.recip() }
    }

    /// A place's bin along each axis.
    #[inline]
    pub fn bins(&self, place: Vec3A) -> [usize; 3] {
        let steps = ((place - self.start) * self.density).clamp(Vec3A::splat(FIRST), Vec3A::splat(LAST));
        (steps + WHOLE).to_array().map(bin)
    }

    /// A coordinate's bin along an axis.
    #[inline]
    pub fn bin(&self, axis: usize, coordinate: f32) -> usize {
        bin(((coordinate - self.start[axis]) * self.density[axis]).clamp(FIRST, LAST) + WHOLE)
    }

    /// Where a bin starts.
    pub fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.start[axis] + self.width[axis] * bin as f32
    }
}

/// The least width of a bin, whose inverse is finite.
const LEAST: f32 = f32::MIN_POSITIVE;
/// The middles of the first bin and of the last.
const FIRST: f32 = 0.5;
const LAST: f32 = BINS as f32 - 0.5;
/// Where a place in bins becomes a number without a fraction, whose last bits are its bin's: Rust's conversion to an integer takes
/// three times as long. The half makes rounding down of rounding to the nearest.
const WHOLE: f32 = (1u32 << 23) as f32 - 0.5;

/// The bin of a place in bins behind [`WHOLE`].
#[inline]
fn bin(place: f32) -> usize {
    place.to_bits() as usize % BINS
}

/// What is in a bin: the box around it, how many parts start here, and how many end.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    starts: u32,
    ends: u32,
}

impl Bin {
    const EMPTY: Bin = Bin { bounds: Bounds::EMPTY, starts: 0, ends: 0 };

    fn union(self, other: Bin) -> Bin {
        Bin {
            bounds: self.bounds.union(other.bounds),
            starts: self.starts + other.starts,
            ends: self.ends + other.ends,
        }
    }
}

/// The bins of an axis. Most nodes have few parts, so bins count only once something is in them.
#[derive(Clone, Copy)]
pub(super) struct Bins {
    /// A bit for each bin with something in it.
    occupied: u32,
    bins: [Bin; BINS],
    /// Room for the sums from the right, which takes longer to empty than to fill.
    right: [(usize, Bin); BINS],
}

impl Bins {
    pub const EMPTY: Bins = Bins { occupied: 0, bins: [Bin::EMPTY; BINS], right: [(0, Bin::EMPTY); BINS] };

    /// Empties all bins.
    pub fn clear(&mut self) {
        self.occupied = 0;
    }

    /// Puts a whole part into a bin.
    pub fn put(&mut self, bin: usize, bounds: Bounds) {
        self.add(bin, Bin { bounds, starts: 1, ends: 1 });
    }

    /// Counts a part that starts in one bin and ends in another.
    pub fn span(&mut self, first: usize, last: usize) {
        self.add(first, Bin { starts: 1, ..Bin::EMPTY });
        self.add(last, Bin { ends: 1, ..Bin::EMPTY });
    }

    /// Grows a bin's box, without a part, if there is anything to grow it by.
    pub fn grow(&mut self, bin: usize, bounds: Bounds) {
        if !bounds.is_empty() {
            self.add(bin, Bin { bounds, ..Bin::EMPTY });
        }
    }

    /// Adds all that is in other bins of the same axis.
    pub fn merge(&mut self, other: &Bins) {
        for bin in (0..BINS).filter(|bin| other.occupied >> bin & 1 == 1) {
            self.add(bin, other.bins[bin]);
        }
    }

    fn add(&mut self, bin: usize, what: Bin) {
        let bit = 1 << bin;
        let before = if self.occupied & bit == 0 { Bin::EMPTY } else { self.bins[bin] };
        self.occupied |= bit;
        self.bins[bin] = before.union(what);
    }

    /// The cheapest plane between bins along an axis.
    pub fn cheapest(&mut self, axis: usize) -> Option<Split> {
        if self.occupied & self.occupied.wrapping_sub(1) == 0 {
            return None;
        }
        let Bins { right, .. } = self;
        let (mut rest, mut count, mut sum) = (self.occupied, BINS, Bin::EMPTY);
        while rest != 0 {
            let bin = rest.ilog2() as usize;
            rest &= !(1 << bin);
            sum = sum.union(self.bins[bin]);
            count -= 1;
            right[count] = (bin, sum);
        }
        let (mut left, mut best): (Bin, Option<Split>) = (Bin::EMPTY, None);
        for pair in right[count..].windows(2) {
            let (bin, right) = (pair[0].0, pair[1].1);
            left = left.union(self.bins[bin]);
            let cost = area(left.bounds) * left.starts as f32 + area(right.bounds) * right.ends as f32;
            if left.starts > 0 && right.ends > 0 && best.is_none_or(|b| cost < b.cost) {
                best = Some(Split { cost, axis, bin: bin + 1, children: [left.bounds, right.bounds] });
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Boxes within [0, 32] with the bins along x that they start and end in, a bin wide each.
    fn boxes() -> impl Strategy<Value = Vec<Bounds>> {
        let corner = || prop::array::uniform3(0.0f32..32.0);
        let span = (corner(), corner()).prop_map(|(a, b)| Bounds::new(a, a).union(Bounds::new(b, b)));
        prop::collection::vec(span, 2..40)
    }

    /// What is on either side of the plane before a bin, box by box.
    fn sides(boxes: &[Bounds], plane: usize) -> [Vec<Bounds>; 2] {
        let bin = |place: f32| (place as usize).min(BINS - 1);
        let left = boxes.iter().filter(|b| bin(b.min.x) < plane);
        let right = boxes.iter().filter(|b| bin(b.max.x) >= plane);
        [left.copied().collect(), right.copied().collect()]
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        /// As trying every plane finds it, where boxes in several bins lie in each of these as far as they reach.
        #[test]
        fn the_cheapest_plane_costs_least_and_is_the_first_of_equals(boxes in boxes()) {
            let grid = Grid::across(Bounds::new([0.0; 3], [32.0; 3]), BINS);
            let mut bins = Bins::EMPTY;
            for b in &boxes {
                let (first, last) = (grid.bin(0, b.min.x), grid.bin(0, b.max.x));
                if first == last {
                    bins.put(first, *b);
                    continue;
                }
                bins.span(first, last);
                (first..=last).for_each(|bin| bins.grow(bin, *b));
            }
            let mut best: Option<(f32, usize)> = None;
            for plane in 1..BINS {
                let sides = sides(&boxes, plane);
                let cost: f32 = sides.iter().map(|side| area(Bounds::around(side.iter().copied())) * side.len() as f32).sum();
                if sides.iter().all(|side| !side.is_empty()) && best.is_none_or(|best| cost < best.0) {
                    best = Some((cost, plane));
                }
            }
            prop_assert_eq!(bins.cheapest(0).map(|split| (split.cost, split.bin)), best);
        }
    }
}
