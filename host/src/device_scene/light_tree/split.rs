//! Where the hierarchy of lights parts them: by the area of their boxes, the solid angle of their cones and their intensity
//! (Conty Estevez and Kulla 2018).

use glam::DVec3;

use super::Bounded;

/// Slabs of an axis between which lights may be parted.
const SLABS: usize = 12;

/// A cut through one axis.
struct Cut {
    cost: f64,
    axis: usize,
    slab: usize,
}

/// Puts those lights first that one child has, which are at most `most` as those of the other are. Returns how many.
pub fn split(lights: &[Bounded], order: &mut [u32], most: u64) -> usize {
    let middle = |light: u32| lights[light as usize].middle();
    let least = order.iter().map(|&light| middle(light)).fold(DVec3::INFINITY, DVec3::min);
    let extent = order.iter().map(|&light| middle(light)).fold(DVec3::NEG_INFINITY, DVec3::max) - least;
    let slab = |axis: usize, light: u32| {
        let share = (middle(light)[axis] - least[axis]) / extent[axis];
        ((share * SLABS as f64) as usize).min(SLABS - 1)
    };
    let axes = (0..3).filter(|&axis| extent[axis] > 0.0);
    let cuts = axes.filter_map(|axis| best(lights, order, (axis, extent), |light| slab(axis, light)));
    let cut = cuts.reduce(|best, cut| if cut.cost < best.cost { cut } else { best });
    if let Some(Cut { axis, slab: last, .. }) = cut {
        // Stable, so that equal lights keep their order.
        order.sort_by_key(|&light| slab(axis, light) > last);
        let count = order.partition_point(|&light| slab(axis, light) <= last);
        if count.max(order.len() - count) as u64 <= most {
            return count;
        }
    }
    let axis = extent.max_position();
    order.sort_by(|&a, &b| middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(&b)));
    order.len() / 2
}

/// The cheapest cut through an axis that has lights on both sides.
fn best(lights: &[Bounded], order: &[u32], (axis, extent): (usize, DVec3), slab: impl Fn(u32) -> usize) -> Option<Cut> {
    let join = |all: Option<Bounded>, light: Option<Bounded>| match (all, light) {
        (Some(all), Some(light)) => Some(all.with(light)),
        (all, light) => all.or(light),
    };
    let mut slabs = [None; SLABS];
    for &light in order {
        let own = &mut slabs[slab(light)];
        *own = join(*own, Some(lights[light as usize]));
    }
    let mut above = [None; SLABS];
    for i in (0..SLABS - 1).rev() {
        above[i] = join(above[i + 1], slabs[i + 1]);
    }
    let mut below = None;
    let mut cuts = Vec::with_capacity(SLABS);
    for slab in 0..SLABS - 1 {
        below = join(below, slabs[slab]);
        if let (Some(below), Some(above)) = (below, above[slab]) {
            // Thin boxes are cut across.
            let cost = (cost(&below) + cost(&above)) * extent.max_element() / extent[axis];
            cuts.push(Cut { cost, axis, slab });
        }
    }
    cuts.into_iter().reduce(|best, cut| if cut.cost < best.cost { cut } else { best })
}

fn cost(part: &Bounded) -> f64 {
    let size = part.greatest - part.least;
    let area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
    part.intensity * part.cone.measure() * area
}
