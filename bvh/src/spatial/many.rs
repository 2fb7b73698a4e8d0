//! What is done to all parts of a node: at once where they are few, by all threads where they are many. The results are the
//! same, since boxes and counts do not depend on the order in which they are put together.

use rayon::prelude::*;

use super::bins::{Bins, area};
use super::part::Part;
use crate::bounds::Bounds;

/// Parts that a thread takes at a time.
const CHUNK: usize = 1 << 13;
/// From this many parts on, several threads share them.
const MANY: usize = 1 << 16;

/// The box around all, each as something else.
pub(super) fn around(parts: &[Part], of: impl Fn(&Part) -> Bounds + Sync) -> Bounds {
    let around = |parts: &[Part]| Bounds::around(parts.iter().map(&of));
    if parts.len() < MANY {
        return around(parts);
    }
    parts.par_chunks(CHUNK).map(around).reduce(|| Bounds::EMPTY, Bounds::union)
}

/// Empties bins and puts all parts in.
pub(super) fn sort_into<const N: usize>(
    bins: &mut [Bins; N],
    parts: &[Part],
    put: impl Fn(&mut [Bins; N], &[Part]) + Sync,
) {
    bins.iter_mut().for_each(Bins::clear);
    grow(bins, parts, put);
}

/// Puts more of all parts into bins.
pub(super) fn grow<const N: usize>(bins: &mut [Bins; N], parts: &[Part], put: impl Fn(&mut [Bins; N], &[Part]) + Sync) {
    if parts.len() < MANY {
        return put(bins, parts);
    }
    let some = |parts: &[Part]| {
        let mut bins = Box::new([Bins::EMPTY; N]);
        put(&mut bins, parts);
        bins
    };
    let merged = parts.par_chunks(CHUNK).map(some).reduce_with(|mut a, b| {
        a.iter_mut().zip(b.iter()).for_each(|(a, b)| a.merge(b));
        a
    });
    for (bins, merged) in bins.iter_mut().zip(merged.iter().flat_map(|bins| bins.iter())) {
        bins.merge(merged);
    }
}

/// The sum of all parts' areas.
pub(super) fn total_area(parts: &[Part]) -> f64 {
    let sum = |parts: &[Part]| parts.iter().map(|part| f64::from(area(part.bounds()))).sum::<f64>();
    if parts.len() < MANY {
        return parts.chunks(CHUNK).map(sum).sum();
    }
    parts.par_chunks(CHUNK).map(sum).collect::<Vec<_>>().into_iter().sum()
}

/// Moves what belongs to the left to the front, all in their order, and returns how many these are. `space` is for any use.
pub(super) fn partition(parts: &mut [Part], space: &mut Vec<Part>, is_left: impl Fn(&Part) -> bool + Sync) -> usize {
    if parts.len() < MANY {
        return partition_some(parts, space, is_left);
    }
    let counts: Vec<usize> =
        parts.par_chunks_mut(CHUNK).map_init(Vec::new, |space, parts| partition_some(parts, space, &is_left)).collect();
    let left = counts.iter().sum();
    space.resize(parts.len(), Part::NONE);
    let (mut lefts, mut rights) = space.split_at_mut(left);
    let places: Vec<[&mut [Part]; 2]> = parts
        .chunks(CHUNK)
        .zip(&counts)
        .map(|(parts, &left)| {
            [lefts.split_off_mut(..left), rights.split_off_mut(..parts.len() - left)]
                .map(|side| side.expect("as counted"))
        })
        .collect();
    parts.par_chunks(CHUNK).zip(counts).zip(places).for_each(|((parts, left), places)| {
        places[0].copy_from_slice(&parts[..left]);
        places[1].copy_from_slice(&parts[left..]);
    });
    parts.par_chunks_mut(CHUNK).zip(space.par_chunks(CHUNK)).for_each(|(parts, sorted)| parts.copy_from_slice(sorted));
    left
}

/// Without a branch that depends on a part, which a processor would guess wrong every other time.
fn partition_some(parts: &mut [Part], space: &mut Vec<Part>, is_left: impl Fn(&Part) -> bool) -> usize {
    if space.len() < parts.len() {
        space.resize(parts.len(), Part::NONE);
    }
    let (mut left, rights) = (0, &mut space[..parts.len()]);
    for i in 0..parts.len() {
        let part = parts[i];
        let is_left = is_left(&part);
        parts[left] = part;
        rights[i - left] = part;
        left += usize::from(is_left);
    }
    let right = parts.len() - left;
    parts[left..].copy_from_slice(&rights[..right]);
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::bins::{BINS, Grid};
    use eyerays_shader::data::Primitive;
    use glam::{Vec3, Vec3A};

    /// More than several threads share, whose places look drawn at random.
    fn parts() -> Vec<Part> {
        let triangle = |i: u32| {
            let corner = |k: u32| {
                let x = (i * 3 + k).wrapping_mul(2_654_435_761);
                Vec3::new((x & 1023) as f32, (x >> 10 & 1023) as f32, (x >> 20 & 1023) as f32) / 1024.0
            };
            Primitive::triangle([corner(0), corner(1), corner(2)], 0, i, 0)
        };
        (0..3 * MANY as u32 / 2).map(|i| Part::whole(i, &triangle(i))).collect()
    }

    #[test]
    fn many_threads_find_what_one_does() {
        let parts = parts();
        let all = around(&parts, Part::bounds);
        assert_eq!(all, Bounds::around(parts.iter().map(Part::bounds)));
        assert_eq!(total_area(&parts), parts.chunks(CHUNK).map(total_area).sum::<f64>());

        let grid = Grid::across(all, BINS);
        let put = |bins: &mut [Bins; 1], parts: &[Part]| {
            parts.iter().for_each(|part| bins[0].put(grid.bin(0, part.bounds().min.x), part.bounds()));
        };
        let (mut some, mut one) = ([Bins::EMPTY], [Bins::EMPTY]);
        sort_into(&mut some, &parts, put);
        put(&mut one, &parts);
        let found = |bins: &mut [Bins; 1]| bins[0].cheapest(0).map(|split| (split.cost, split.bin, split.children));
        assert_eq!(found(&mut some), found(&mut one));
    }

    #[test]
    fn many_parts_keep_their_order_on_either_side() {
        let is_left = |part: &Part| part.bounds().centre().cmplt(Vec3A::ONE).any();
        let (mut all, mut space) = (parts(), Vec::new());
        let numbers = |parts: &[Part]| parts.iter().map(Part::triangle).collect::<Vec<_>>();
        let (left, right): (Vec<Part>, Vec<Part>) = all.iter().partition(|part| is_left(part));
        assert_eq!(partition(&mut all, &mut space, is_left), left.len());
        assert_eq!(numbers(&all), [numbers(&left), numbers(&right)].concat());
    }
}
