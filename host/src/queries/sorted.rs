//! Rays in the order of their directions.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use eyerays_kernels_cpu::Isa;
use eyerays_shader::real::{SimdIsa, Task};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::batch::{BLOCK, Ray, RayBlock, Rays};

/// Cells along either side of the square of all directions.
const CELLS: f64 = 2048.0;

/// The numbers of rays in their block, sorted by the Morton codes of their directions' cells.
pub(super) fn by_direction(rays: &impl Rays, block: Range<usize>) -> Vec<u32> {
    let mut keys = vec![0; block.len()];
    keys.par_chunks_mut(TASK).enumerate().for_each(|(task, keys)| {
        Isa::best().run(Coding { rays, start: block.start, first: TASK * task, keys });
    });
    keys.par_sort_unstable();
    keys.into_par_iter().map(|key| key as u32).collect()
}

/// Rays that a thread codes at once.
const TASK: usize = 64 * BLOCK;

/// Writes the codes of rays' directions, each before its ray's number in the block.
struct Coding<'a, R> {
    rays: &'a R,
    /// Where the block starts, and the first ray in it.
    start: usize,
    first: usize,
    keys: &'a mut [u64],
}

impl<R: Rays> Task<f32> for Coding<'_, R> {
    #[inline(always)]
    fn run<V: SimdIsa<f32>>(self) {
        let mut made = RayBlock::default();
        for (number, keys) in self.keys.chunks_mut(BLOCK).enumerate() {
            let first = self.first + BLOCK * number;
            // Not ray by ray: whoever gives them may look in a block for such that are none.
            self.rays.fill(self.start + first..self.start + first + keys.len(), &mut made);
            for (row, key) in keys.iter_mut().enumerate() {
                *key = u64::from(code(made.ray(row).direction)) << 32 | (first + row) as u64;
            }
        }
    }
}

/// A direction's place on an octahedron that is unfolded, from 0 to 1 on two axes.
#[inline(always)]
fn unfolded(direction: DVec3) -> DVec2 {
    let along = direction * (1.0 / (direction.x.abs() + direction.y.abs() + direction.z.abs()));
    let (x, y) = (along.x, along.y);
    let lower = DVec2::new((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y));
    let is_lower = along.z < 0.0;
    DVec2::new(if is_lower { lower.x } else { x }, if is_lower { lower.y } else { y }) * 0.5 + 0.5
}

#[inline(always)]
fn code(direction: DVec3) -> u32 {
    let place = unfolded(direction) * CELLS;
    // What is no direction may be anywhere.
    let cell = |x: f64| spread(x.clamp(0.0, CELLS - 1.0) as u32);
    cell(place.x) | cell(place.y) << 1
}

/// The bits of a number, each at twice its place.
#[inline(always)]
fn spread(x: u32) -> u32 {
    let x = (x | x << 8) & 0x00ff_00ff;
    let x = (x | x << 4) & 0x0f0f_0f0f;
    let x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

/// Where in an order each number is.
pub(super) struct Places(Vec<AtomicU32>);

impl Places {
    /// Of an order that has every number once.
    pub fn of(order: &[u32]) -> Self {
        // Atomic only so that many threads may write.
        let places: Vec<AtomicU32> = order.par_iter().map(|_| AtomicU32::new(0)).collect();
        let tasks = order.par_chunks(TASK).enumerate();
        tasks.for_each(|(task, order)| {
            for (place, &number) in (TASK * task..).zip(order) {
                places[number as usize].store(place as u32, Ordering::Relaxed);
            }
        });
        Places(places)
    }

    /// The places of some numbers.
    pub fn part(&self, range: Range<usize>) -> impl Iterator<Item = usize> {
        self.0[range].iter().map(|place| place.load(Ordering::Relaxed) as usize)
    }
}

/// Rays of a block in an order.
pub(super) struct Ordered<'a, R> {
    rays: &'a R,
    start: usize,
    order: Option<&'a [u32]>,
}

impl<'a, R> Ordered<'a, R> {
    /// As they come, from number `start` on.
    pub fn in_turn(rays: &'a R, start: usize) -> Self {
        Ordered { rays, start, order: None }
    }

    /// By their numbers from `start` on.
    pub fn by(rays: &'a R, start: usize, order: &'a [u32]) -> Self {
        Ordered { rays, start, order: Some(order) }
    }
}

impl<R: Rays> Rays for Ordered<'_, R> {
    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        self.rays.ray(self.start + self.order.map_or(number, |order| order[number] as usize))
    }

    #[inline(always)]
    fn fill(&self, range: Range<usize>, block: &mut RayBlock) {
        match self.order {
            None => self.rays.fill(self.start + range.start..self.start + range.end, block),
            Some(_) => range.enumerate().for_each(|(row, number)| block.set(row, &self.ray(number))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A direction of each of many cells of a ball, with what is none among them.
    fn direction(i: usize) -> DVec3 {
        let (a, b) = (i as f64 * 2.399_963, 1.0 - (i % 997) as f64 / 498.5);
        if i % 101 == 7 { DVec3::NAN } else { DVec3::new(a.cos(), a.sin(), b) * (1.0 + i as f64) }
    }

    #[test]
    fn an_order_has_every_ray_once_and_neighbours_go_the_same_way() {
        let count = 20_000;
        let rays = |i: usize| Ray::new(DVec3::ZERO, direction(i));
        let order = by_direction(&rays, 3..count + 3);
        let places = Places::of(&order);
        assert!(places.part(0..count).enumerate().all(|(number, place)| order[place] as usize == number));
        let ordered = Ordered::by(&rays, 3, &order);
        let along: Vec<DVec3> =
            (0..count).map(|i| ordered.ray(i).direction.normalize()).filter(|d| d.is_finite()).collect();
        let apart = |step: usize| along.windows(step + 1).map(|of| of[0].distance(of[step])).sum::<f64>();
        assert!(apart(1) < 0.05 * apart(count / 2), "{} and {}", apart(1), apart(count / 2));
    }

    #[test]
    fn opposite_directions_are_at_opposite_ends_and_neighbours_beside_each_other() {
        for i in (0..5000).filter(|i| i % 101 != 7) {
            let here = unfolded(direction(i));
            assert!(here.min_element() >= 0.0 && here.max_element() <= 1.0);
            let beside = unfolded(direction(i).normalize() + DVec3::splat(1e-9));
            // Where the octahedron is cut, a side continues at another place of the same side.
            let is_cut = here.min_element() < 1e-6 || here.max_element() > 1.0 - 1e-6;
            assert!(is_cut || here.distance(beside) < 1e-7, "{here} and {beside}");
        }
        assert_eq!(unfolded(DVec3::Z), DVec2::splat(0.5));
        assert_eq!(unfolded(DVec3::NEG_Z), DVec2::ONE);
    }
}
