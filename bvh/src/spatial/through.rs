//! The cheapest plane through triangles, which cuts those that it crosses.

use eyerays_shader::data::{BOX_PADDING, Primitive};
use glam::Vec3A;

use super::bins::{Bins, Grid, Split};
use super::many;
use super::part::Part;
use crate::bounds::{Bounds, longest};

/// Bins between planes through triangles. With 32, trees cost as much and take a tenth longer to grow.
const BINS: usize = 16;

/// The cheapest split through parts within `bounds` and across their longest axis, and its plane. Across the axis with the least bound of
/// costs instead, trees cost as much (Conference and Sibenik, within 1 %) and take a fifth longer to grow.
pub(super) fn through(
    bins: &mut [Bins; 3],
    triangles: &[Primitive],
    parts: &[Part],
    bounds: Bounds,
) -> Option<(Split, f32)> {
    let axis = longest(bounds.extent());
    // Slabs thinner than padding would separate nothing.
    if bounds.extent()[axis] <= 8.0 * BOX_PADDING {
        return None;
    }
    let (grid, bins) = (Grid::across(bounds, BINS), std::array::from_mut(&mut bins[axis]));
    many::sort_into(bins, parts, |bins, parts| chop(&mut bins[0], &grid, triangles, parts, axis));
    bins[0].cheapest(axis).map(|split| (split, grid.plane(axis, split.bin)))
}

/// Puts parts into bins, those of several cut at the planes between.
fn chop(bins: &mut Bins, grid: &Grid, triangles: &[Primitive], parts: &[Part], axis: usize) {
    for part in parts {
        let bounds = part.bounds();
        let [first, last] = [bounds.min, bounds.max].map(|corner| grid.bin(axis, corner[axis]));
        if first == last {
            bins.put(first, bounds);
            continue;
        }
        bins.span(first, last);
        if !part.is_triangle() {
            (first..=last).for_each(|bin| bins.grow(bin, bounds));
            continue;
        }
        let mut slabs = Slabs::of(&triangles[part.triangle() as usize], axis);
        for bin in first..last {
            bins.grow(bin, slabs.up_to(grid.plane(axis, bin + 1)).intersection(bounds));
        }
        bins.grow(last, slabs.rest().intersection(bounds));
    }
}

/// A triangle between planes across an axis, one after the other. In single precision, which is enough to choose one of them: what is
/// cut then is cut by [`Part::cut`].
struct Slabs {
    axis: usize,
    /// The corners that are still to come, ascending along the axis.
    corners: [Vec3A; 3],
    met: usize,
    /// Where the last plane cut the triangle.
    last: Bounds,
    /// From the first corner to the second, from the second to the third, and from the first to the third.
    edges: [Edge; 3],
}

/// An edge: where it starts, and how far it goes a length along the axis.
struct Edge {
    from: Vec3A,
    along: Vec3A,
}

impl Slabs {
    fn of(triangle: &Primitive, axis: usize) -> Self {
        let mut corners = triangle.vertices().map(Vec3A::from);
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if corners[j][axis] < corners[i][axis] {
                corners.swap(i, j);
            }
        }
        let edge = |(from, to): (usize, usize)| {
            let (from, along) = (corners[from], corners[to] - corners[from]);
            Edge { from, along: along / along[axis].max(f32::MIN_POSITIVE) }
        };
        Slabs { axis, corners, met: 0, last: Bounds::EMPTY, edges: [(0, 1), (1, 2), (0, 2)].map(edge) }
    }

    /// What lies between the last plane and the next one.
    fn up_to(&mut self, plane: f32) -> Bounds {
        let mut slab = self.last;
        while self.met < 3 && self.corners[self.met][self.axis] <= plane {
            slab = slab.union(Bounds::point(self.corners[self.met]));
            self.met += 1;
        }
        self.last = Bounds::EMPTY;
        if let 1 | 2 = self.met {
            let [a, b] = [self.met - 1, 2].map(|edge| self.edges[edge].at(self.axis, plane));
            self.last = Bounds::new(a.min(b), a.max(b));
        }
        slab.union(self.last)
    }

    /// What lies behind the last plane.
    fn rest(&self) -> Bounds {
        self.corners[self.met..].iter().fold(self.last, |rest, &corner| rest.union(Bounds::point(corner)))
    }
}

impl Edge {
    fn at(&self, axis: usize, plane: f32) -> Vec3A {
        self.from + self.along * (plane - self.from[axis])
    }
}
