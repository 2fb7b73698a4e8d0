//! Hierarchies whose triangles move (thesis 4.1.1): their vertices are gathered anew, and each node gets the box of what is below it.
//!
//! The slots below a node lie in a row, so its box is that of a run of boxes. Runs are put together of aligned blocks of 2^k slots, whose
//! boxes are found level by level: no thread waits for another, and every node is found by itself.

use crate::data::{CentredPair, Normals, Primitive, numbers, pack};
use crate::real::{Real, TINY};
use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

/// What the kernels are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Refit {
    /// How many slots there are.
    pub slots: u32,
    /// How many pairs of nodes.
    pub pairs: u32,
    /// The level of blocks that is made, from 1 on: of 2^level slots.
    pub level: u32,
    /// Nothing: a record is a word of 16 bytes.
    pub unused: u32,
}

/// A box: least and greatest corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// On each axis the least coordinate.
    pub least: Vec3,
    /// And the greatest.
    pub greatest: Vec3,
}

impl Block {
    /// Around nothing.
    pub const EMPTY: Block = Block { least: Vec3::splat(f32::MAX), greatest: Vec3::splat(-f32::MAX) };

    /// The least box around both.
    #[inline(always)]
    #[must_use]
    pub fn around(self, other: Block) -> Block {
        let least = |a: f32, b: f32| a.lesser(b);
        let greatest = |a: f32, b: f32| a.greater(b);
        let (a, b, c, d) = (self.least, other.least, self.greatest, other.greatest);
        Block {
            least: Vec3::new(least(a.x, b.x), least(a.y, b.y), least(a.z, b.z)),
            greatest: Vec3::new(greatest(c.x, d.x), greatest(c.y, d.y), greatest(c.z, d.z)),
        }
    }
}

/// The first block of a level, where the blocks of `slots` slots lie level after level, and how many it has.
#[inline(always)]
pub fn level(slots: u32, level: u32) -> (u32, u32) {
    let (mut first, mut count, mut below) = (0, slots, 0);
    while below < level {
        first += count;
        count = count.div_ceil(2);
        below += 1;
    }
    (first, count)
}

/// How many levels there are of so many slots, with that of the slots themselves.
pub fn levels(slots: u32) -> u32 {
    if slots < 2 { 1 } else { 33 - (slots - 1).leading_zeros() }
}

/// Blocks of all levels.
pub fn blocks(slots: u32) -> u32 {
    let (first, count) = level(slots, levels(slots) - 1);
    first + count
}

/// The box of the slots from `first` to before `end`; `block` tells that of a number.
#[inline(always)]
pub fn run(slots: u32, (first, end): (u32, u32), block: impl Fn(u32) -> Block) -> Block {
    let (mut left, mut right) = (first, end);
    let (mut start, mut count) = (0, slots);
    let mut around = Block::EMPTY;
    while left < right {
        if left & 1 != 0 {
            around = around.around(block(start + left));
            left += 1;
        }
        if right & 1 != 0 {
            right -= 1;
            around = around.around(block(start + right));
        }
        (left, right) = (left >> 1, right >> 1);
        start += count;
        count = count.div_ceil(2);
    }
    around
}

/// Centre and half the extent of a box as kernels test them, with the integer of the centre: wider by the margin, and by more than the
/// subtraction, the addition and the product round off.
#[inline(always)]
pub fn centred(of: Block, word: u32) -> (UVec4, UVec4) {
    const WIDER: f32 = 1.0 + 4.0 * f32::EPSILON;
    let (low, high) = (of.least, of.greatest);
    let centre = (low + high) * 0.5;
    let reach =
        |low: f32, high: f32, centre: f32| ((high - centre).greater(centre - low) + CentredPair::MARGIN) * WIDER;
    let half =
        Vec3::new(reach(low.x, high.x, centre.x), reach(low.y, high.y, centre.y), reach(low.z, high.z, centre.z));
    (pack(centre, word), pack(half, 0))
}

/// A triangle with other vertices.
#[inline(always)]
pub fn placed(triangle: Primitive, vertices: [Vec3; 3]) -> Primitive {
    let place = |place: Vec3, word: UVec4| pack(flushed(place), word.w);
    let [a, b, c] = vertices;
    Primitive { a: place(a, triangle.a), b: place(b, triangle.b), c: place(c, triangle.c) }
}

/// Normals of a triangle's vertices.
#[inline(always)]
pub fn turned(normals: [Vec3; 3]) -> Normals {
    let [a, b, c] = normals;
    Normals { a: pack(flushed(a), 0), b: pack(flushed(b), 0), c: pack(flushed(c), 0) }
}

/// As kernels take coordinates.
#[inline(always)]
fn flushed(v: Vec3) -> Vec3 {
    Vec3::new(v.x.flush(TINY), v.y.flush(TINY), v.z.flush(TINY))
}

/// The padded box of a triangle.
#[inline(always)]
pub fn of_triangle(triangle: &Primitive) -> Block {
    let (least, greatest) = triangle.triangle_bounds();
    Block { least, greatest }
}

/// A block as it lies in memory.
#[inline(always)]
pub fn packed(block: Block) -> [UVec4; 2] {
    [pack(block.least, 0), pack(block.greatest, 0)]
}

/// As it was before.
#[inline(always)]
pub fn unpacked([least, greatest]: [UVec4; 2]) -> Block {
    Block { least: numbers(least), greatest: numbers(greatest) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(slot: u32) -> Block {
        let at = Vec3::new(slot as f32, -(slot as f32), ((slot * 7919) % 101) as f32);
        Block { least: at, greatest: at + 0.5 }
    }

    /// All levels of so many slots, as the kernels make them.
    fn made(slots: u32) -> Vec<Block> {
        let mut all: Vec<Block> = (0..slots).map(block).collect();
        for number in 1..levels(slots) {
            let ((below, had), (first, count)) = (level(slots, number - 1), level(slots, number));
            assert_eq!(first as usize, all.len());
            for i in 0..count {
                let left = all[(below + 2 * i) as usize];
                let right = if 2 * i + 1 < had { all[(below + 2 * i + 1) as usize] } else { Block::EMPTY };
                all.push(left.around(right));
            }
        }
        assert_eq!(all.len() as u32, blocks(slots));
        all
    }

    #[test]
    fn the_box_of_any_run_is_that_of_its_slots() {
        for slots in [1, 2, 3, 5, 8, 13, 64, 100] {
            let all = made(slots);
            assert_eq!(level(slots, levels(slots) - 1).1, 1);
            for (first, end) in (0..slots).flat_map(|first| (first + 1..=slots).map(move |end| (first, end))) {
                let want = (first..end).map(block).fold(Block::EMPTY, Block::around);
                assert_eq!(
                    run(slots, (first, end), |number| all[number as usize]),
                    want,
                    "{first} to {end} of {slots}"
                );
            }
        }
    }

    #[test]
    fn nodes_are_wider_than_what_they_hold() {
        let mut rng = fastrand::Rng::with_seed(3);
        for _ in 0..100_000 {
            let mut place = || Vec3::new(rng.f32(), rng.f32(), rng.f32()) * 2.0 - 1.0;
            let (a, b) = (place(), place() * 1e-3f32.powi(rng.i32(0..3)));
            let of = Block { least: a.min(a + b), greatest: a.max(a + b) };
            let (centre, half) = centred(of, 7);
            let (middle, reach) = (numbers(centre).as_dvec3(), numbers(half).as_dvec3());
            let margin = glam::DVec3::splat(f64::from(CentredPair::MARGIN));
            assert!((middle - reach).cmple(of.least.as_dvec3() - margin).all(), "{of:?}");
            assert!((middle + reach).cmpge(of.greatest.as_dvec3() + margin).all(), "{of:?}");
            assert_eq!(centre.w, 7);
        }
    }
}
