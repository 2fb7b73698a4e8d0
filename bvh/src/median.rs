//! Median splits, which always halve.

use eyerays_shader::data::MAX_LEAF;
use glam::Vec3A;

use crate::bounds::Bounds;

/// Levels of node pairs that median splits need below a subtree's root: 0 for a leaf.
pub(crate) fn height(primitives: u32) -> u32 {
    let leaves = primitives.div_ceil(MAX_LEAF).max(1);
    leaves.next_power_of_two().ilog2()
}

/// Orders primitive numbers so that the first half lies on one side of the median along the longest
/// axis, and returns the half's length. `bounds` are those of all primitives.
///
/// Where all centres coincide, extents tell primitives apart; where these are equal too, numbers do.
pub(crate) fn split(primitives: &mut [u32], bounds: &[Bounds]) -> usize {
    let middle = primitives.len() / 2;
    let all = primitives.iter().map(|&t| bounds[t as usize]);
    let centres = Bounds::around(all.clone().map(|b| Bounds::point(b.centre())));
    let axis = longest(centres.extent());
    if centres.extent()[axis] > 0.0 {
        halve(primitives, middle, |t| bounds[t as usize].centre()[axis]);
    } else {
        let axis = longest(Bounds::around(all).extent());
        halve(primitives, middle, |t| bounds[t as usize].extent()[axis]);
    }
    middle
}

/// Moves the `middle` primitives of least key to the front.
fn halve(primitives: &mut [u32], middle: usize, key: impl Fn(u32) -> f32) {
    primitives.select_nth_unstable_by(middle, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
}

/// The axis of the greatest extent; the first of equals.
fn longest(extent: Vec3A) -> usize {
    let longer = |a: usize, b: usize| if extent[b] > extent[a] { b } else { a };
    longer(longer(0, 1), 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(centre: [f32; 3], half: f32) -> Bounds {
        Bounds::new(centre.map(|c| c - half), centre.map(|c| c + half))
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
        assert_eq!(split(&mut primitives, &boxes), 2);
        primitives[..2].sort();
        primitives[2..].sort();
        assert_eq!(primitives, [1, 4, 0, 2, 3]);
    }

    #[test]
    fn concentric_boxes_are_halved_by_size_and_equal_ones_by_number() {
        let boxes: Vec<Bounds> = [0.3, 0.1, 0.4, 0.2].map(|half| cube([0.0; 3], half)).into();
        let mut primitives = vec![0, 1, 2, 3];
        assert_eq!(split(&mut primitives, &boxes), 2);
        primitives[..2].sort();
        assert_eq!(primitives[..2], [1, 3]);

        let mut primitives = vec![3, 1, 0, 2];
        assert_eq!(split(&mut primitives, &[cube([0.5; 3], 0.1); 4]), 2);
        primitives[..2].sort();
        assert_eq!(primitives[..2], [0, 1]);
    }
}
