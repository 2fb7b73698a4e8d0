//! Median splits, which always halve.

use crate::bounds::{Bounds, longest};
use eyerays_shader::data::MAX_LEAF;

/// Levels of node pairs that median splits need below a subtree's root: 0 for a leaf.
pub(crate) fn height(primitives: u32) -> u32 {
    let leaves = primitives.div_ceil(MAX_LEAF).max(1);
    leaves.next_power_of_two().ilog2()
}

/// Orders items so that the first half lies on one side of the median along the longest axis, and returns the half's
/// length. `own` tells an item's box, `number` its number.
///
/// Where all centres coincide, extents tell items apart; where these are equal too, numbers do.
pub(crate) fn split<T>(items: &mut [T], own: impl Fn(&T) -> Bounds, number: impl Fn(&T) -> u32) -> usize {
    let middle = items.len() / 2;
    let centres = Bounds::around(items.iter().map(|item| Bounds::point(own(item).centre())));
    let axis = longest(centres.extent());
    if centres.extent()[axis] > 0.0 {
        halve(items, |item| (own(item).centre()[axis], number(item)));
    } else {
        let axis = longest(Bounds::around(items.iter().map(&own)).extent());
        halve(items, |item| (own(item).extent()[axis], number(item)));
    }
    middle
}

/// Moves the half of least keys to the front.
fn halve<T>(items: &mut [T], key: impl Fn(&T) -> (f32, u32)) {
    items.select_nth_unstable_by(items.len() / 2, |a, b| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(centre: [f32; 3], half: f32) -> Bounds {
        Bounds::new(centre.map(|c| c - half), centre.map(|c| c + half))
    }

    fn halves(numbers: &mut [u32], boxes: &[Bounds]) -> usize {
        split(numbers, |&number| boxes[number as usize], |&number| number)
    }

    #[test]
    fn height_is_that_of_repeated_halving() {
        fn halved(n: u32) -> u32 {
            if n <= MAX_LEAF { 0 } else { 1 + halved(n.div_ceil(2)) }
        }
        for n in (0..5000).chain([1 << 29, (1 << 29) - 1, 5 << 20, (5 << 20) + 1]) {
            assert_eq!(height(n), halved(n), "{n} primitives");
        }
    }

    #[test]
    fn halves_along_the_longest_axis() {
        let boxes: Vec<Bounds> = [4.0, 1.0, 3.0, 2.0, 0.0].map(|y| cube([-y / 8.0, y, 0.5], 0.1)).into();
        let mut primitives = vec![0, 1, 2, 3, 4];
        assert_eq!(halves(&mut primitives, &boxes), 2);
        primitives[..2].sort();
        primitives[2..].sort();
        assert_eq!(primitives, [1, 4, 0, 2, 3]);
    }

    #[test]
    fn concentric_boxes_are_halved_by_size_and_equal_ones_by_number() {
        let boxes: Vec<Bounds> = [0.3, 0.1, 0.4, 0.2].map(|half| cube([0.0; 3], half)).into();
        let mut primitives = vec![0, 1, 2, 3];
        assert_eq!(halves(&mut primitives, &boxes), 2);
        primitives[..2].sort();
        assert_eq!(primitives[..2], [1, 3]);

        let mut primitives = vec![3, 1, 0, 2];
        assert_eq!(halves(&mut primitives, &[cube([0.5; 3], 0.1); 4]), 2);
        primitives[..2].sort();
        assert_eq!(primitives[..2], [0, 1]);
    }
}
