//! The cheapest plane through triangles, which cuts those that it crosses.

use eyerays_shader::data::{BOX_PADDING, Primitive};

use super::bins::{Bins, Grid, Split};
use super::many;
use super::part::{Edges, Part};
use crate::bounds::Bounds;

/// The cheapest split through parts within `bounds`, and its plane, if it costs less than `most`.
///
/// An axis is first given a cost that no plane across it goes below: that without the boxes of parts that planes cross.
/// Where that is too much already, nothing is cut along the axis.
pub(super) fn through(
    bins: &mut [Bins; 3],
    triangles: &[Primitive],
    parts: &[Part],
    bounds: Bounds,
    most: f32,
) -> Option<(Split, f32)> {
    let grid = Grid::across(bounds);
    many::sort_into(bins, parts, |bins, parts| put(bins, &grid, parts));
    // Slabs thinner than padding would separate nothing.
    let is_wide = |axis: &usize| bounds.extent()[*axis] > 8.0 * BOX_PADDING;
    let least = (0..3).filter(is_wide).filter_map(|axis| Some((bins[axis].cheapest(axis)?.cost, axis)));
    let mut least: Vec<(f32, usize)> = least.collect();
    least.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Option<Split> = None;
    for (cost, axis) in least {
        if best.map_or(cost >= most, |best| cost > best.cost) {
            break;
        }
        let bins = std::array::from_mut(&mut bins[axis]);
        many::grow(bins, parts, |bins, parts| chop(&mut bins[0], &grid, triangles, parts, axis));
        let split = bins[0].cheapest(axis);
        // Of equals, that of the first axis.
        best = match best {
            Some(best) if best.axis < axis => Split::cheaper(Some(best), split),
            best => Split::cheaper(split, best),
        };
    }
    best.map(|split| (split, grid.plane(split.axis, split.bin)))
}

/// Puts parts into the bins that they start and end in, those of one bin with their boxes.
fn put(bins: &mut [Bins; 3], grid: &Grid, parts: &[Part]) {
    for part in parts {
        let bounds = part.bounds();
        let ends = grid.bins(bounds.min).into_iter().zip(grid.bins(bounds.max));
        for (bins, (first, last)) in bins.iter_mut().zip(ends) {
            if first == last {
                bins.put(first, bounds);
            } else {
                bins.span(first, last);
            }
        }
    }
}

/// Grows the bins of parts that lie in several, by the parts cut at the bins' planes.
fn chop(bins: &mut Bins, grid: &Grid, triangles: &[Primitive], parts: &[Part], axis: usize) {
    for part in parts {
        let mut rest = part.bounds();
        let [first, last] = [rest.min, rest.max].map(|corner| grid.bin(axis, corner[axis]));
        if first == last {
            continue;
        }
        let triangle = &triangles[part.triangle() as usize];
        if !triangle.is_triangle() {
            (first..=last).for_each(|bin| bins.grow(bin, rest));
            continue;
        }
        let edges = Edges::of(triangle, axis);
        for bin in first..=last {
            if bin == last {
                bins.grow(bin, rest);
                break;
            }
            let [left, right] = edges.sides(rest, grid.plane(axis, bin + 1));
            if let Some(left) = left {
                bins.grow(bin, left);
            }
            let Some(right) = right else { break };
            rest = right;
        }
    }
}
