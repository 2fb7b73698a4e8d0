//! The order in which a CPU follows rays: packets are fast where neighbours go the same way, as those of a camera do. Rays that start at one
//! place come to that by sorting.

use std::ops::Range;

use glam::DVec3;

use crate::batch::{Ray, Rays};

/// Fewer rays have no neighbours to speak of.
const LEAST: usize = 64;
/// Rays that are asked.
const ASKED: usize = 512;
/// How much nearer neighbours are to each other than any rays are.
const NEARER: f64 = 16.0;
/// Rays a surface that are sorted at once: more, and what lies between goes through memory instead of a cache; fewer, and neighbours meet
/// fewer of the same surfaces.
const DENSE: usize = 4;
/// The fewest and the most that are.
const SORTED: (usize, usize) = (1 << 17, 1 << 20);
/// Surfaces a ray, more of which leave neighbours with nothing in common.
const SPARSE: usize = 4;
/// How far apart places are that are one, in the scene's cube.
const ONE: f64 = 1.0 / 64.0;

/// In which order rays are best followed.
#[derive(Debug, PartialEq)]
pub(super) enum Order {
    /// As they come: neighbours go the same way.
    Neighbours,
    /// Sorted by their directions, so many at once: they start at one place.
    Sorted(usize),
    /// As they come: they have nothing in common.
    None,
}

impl Order {
    /// Of a block of rays through so many surfaces; `scale` is what one unit of theirs is in the scene's cube.
    pub fn of(rays: &impl Rays, block: Range<usize>, (surfaces, scale): (usize, f64)) -> Order {
        let count = block.len();
        if count < LEAST {
            return Order::None;
        }
        // Anywhere among them, at no steps that rows of a picture have, too.
        let pair = |asked: usize| {
            let first = block.start + asked.wrapping_mul(0x9e37_79b1) % (count - 1);
            [rays.ray(first), rays.ray(first + 1)]
        };
        let asked: Vec<[Ray; 2]> = (0..2 * ASKED).map(pair).collect();
        let most = (DENSE * surfaces).clamp(SORTED.0, SORTED.1);
        if are_coherent(&asked, scale) {
            Order::Neighbours
        } else if count >= SORTED.0 && SPARSE * count.min(most) >= surfaces && start_together(&asked, scale) {
            Order::Sorted(most)
        } else {
            Order::None
        }
    }
}

/// Do neighbours go the same way?
fn are_coherent(asked: &[[Ray; 2]], scale: f64) -> bool {
    let (pairs, others) = asked.split_at(ASKED);
    let is_beside = |([of, next], [other, _]): &(&[Ray; 2], &[Ray; 2])| {
        NEARER * distance(of, next, scale) <= distance(of, other, scale)
    };
    // Rows end, and some rays of any two go the same way.
    4 * pairs.iter().zip(others).filter(is_beside).count() >= 3 * ASKED
}

/// How differently two rays go: by where they start and by their directions.
fn distance(a: &Ray, b: &Ray, scale: f64) -> f64 {
    let along = |ray: &Ray| ray.direction.try_normalize().unwrap_or(DVec3::ZERO);
    (a.origin - b.origin).length() * scale + (along(a) - along(b)).length()
}

/// Do all start at one place?
fn start_together(asked: &[[Ray; 2]], scale: f64) -> bool {
    let nowhere = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let origins = asked.iter().flatten().map(|ray| ray.origin);
    let (least, greatest) = origins.fold(nowhere, |(a, b), p| (a.min(p), b.max(p)));
    // Where all are no places, the least is greater.
    (0.0..=ONE).contains(&((greatest - least).max_element() * scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_camera(i: usize) -> Ray {
        let at = |x: usize| x as f64 / 256.0 - 0.5;
        Ray::new(DVec3::ZERO, DVec3::new(at(i % 256), at(i / 256), -1.0))
    }

    #[test]
    fn those_of_a_camera_are_neighbours_and_come_to_that_if_they_are_shuffled() {
        let count = 1 << 17;
        let is = |order: Order, ray: &(dyn Fn(usize) -> Ray + Sync)| {
            assert_eq!(Order::of(&|i: usize| ray(i), 5..count + 5, (count, 1.0)), order);
        };
        let shuffled = |i: usize| of_camera(i * 40_503 % count);
        is(Order::Neighbours, &of_camera);
        is(Order::Sorted(4 * count), &shuffled);
        is(Order::None, &|i| Ray { origin: shuffled(i).direction, ..shuffled(i) });
        // All the same; and none at all.
        is(Order::Neighbours, &|_| Ray::new(DVec3::ONE, DVec3::X));
        is(Order::None, &|_| Ray::new(DVec3::NAN, DVec3::NAN));
        // Of a few rays, or of a scene that has many more surfaces.
        let few = |count, surfaces| Order::of(&shuffled, 0..count, (surfaces, 1.0));
        assert_eq!([few(3, 1), few(count - 1, 1), few(count, 5 * count)], [Order::None, Order::None, Order::None]);
        assert_eq!(few(count, 1), Order::Sorted(count));
    }
}
