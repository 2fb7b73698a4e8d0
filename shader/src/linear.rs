//! Hierarchies that a device builds (Karras, Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees, 2012): triangles
//! are sorted along a Morton curve, and each node finds by itself which of them are below it, from where their codes differ.
//!
//! The sort is by four bits at a time, each thread with a run of keys of its own: no thread waits for another, and the order is the
//! same on every device.

use crate::data::NodeRef;
use crate::refit::Block;
use bytemuck::{Pod, Zeroable};

/// What the kernels are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Linear {
    /// How many slots there are, at least 2.
    pub slots: u32,
    /// The lowest bit of the digit that is sorted by.
    pub shift: u32,
    /// The level of counts that is summed or spread.
    pub level: u32,
    /// Nothing: a record is a word of 16 bytes.
    pub unused: u32,
}

/// Keys that a thread counts and moves, and counts that it sums.
pub const RUN: u32 = 32;
/// Values of a digit.
pub const DIGITS: u32 = 16;
/// Bits of a digit.
pub const DIGIT: u32 = 4;
/// Bits of a code, ten an axis.
pub const CODE: u32 = 30;

/// How many runs keys lie in.
#[inline(always)]
pub fn runs(slots: u32) -> u32 {
    slots.div_ceil(RUN)
}

/// Where the count of a digit in a run lies: one digit's of all runs before the next digit's.
#[inline(always)]
pub fn place(slots: u32, run: u32, digit: u32) -> u32 {
    digit * runs(slots) + run
}

/// The digit of a key.
#[inline(always)]
pub fn digit(key: u32, shift: u32) -> u32 {
    (key >> shift) & (DIGITS - 1)
}

/// The first count of a level, where those of the digits are level 0 and each further one has the sums of [`RUN`] of the level below,
/// and how many it has.
#[inline(always)]
pub fn level(slots: u32, level: u32) -> (u32, u32) {
    let (mut first, mut count, mut below) = (0, DIGITS * runs(slots), 0);
    while below < level {
        first += count;
        count = count.div_ceil(RUN);
        below += 1;
    }
    (first, count)
}

/// How many levels there are until a single thread has all.
pub fn levels(slots: u32) -> u32 {
    let (mut count, mut levels) = (DIGITS * runs(slots), 1);
    while count > RUN {
        (count, levels) = (count.div_ceil(RUN), levels + 1);
    }
    levels
}

/// The Morton code of the middle of a box in [-1, 1].
#[inline(always)]
pub fn code(of: Block) -> u32 {
    let middle = of.least + of.greatest;
    let axis = |twice: f32| {
        // In cells of a 1024th, without what lies beyond.
        let cell = (twice + 2.0) * 256.0;
        let cell = if cell > 0.0 { cell } else { 0.0 };
        let cell = if cell < 1023.0 { cell } else { 1023.0 };
        spread(cell as u32)
    };
    axis(middle.x) << 2 | axis(middle.y) << 1 | axis(middle.z)
}

/// Ten bits with two zeros behind each.
#[inline(always)]
fn spread(x: u32) -> u32 {
    let x = (x | (x << 16)) & 0x0300_00ff;
    let x = (x | (x << 8)) & 0x0300_f00f;
    let x = (x | (x << 4)) & 0x030c_30c3;
    (x | (x << 2)) & 0x0924_9249
}

/// The sorted slots below a node: the first, the first of its right child, and the one after the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Below {
    /// Of its left child.
    pub first: u32,
    /// Of its right child.
    pub middle: u32,
    /// After all.
    pub end: u32,
}

/// How many bits from the highest on two sorted slots have in common, of their codes and then of their places; none with what is no slot.
#[inline(always)]
fn common(slots: u32, a: u32, b: u32, key: impl Fn(u32) -> u32) -> i32 {
    if b >= slots {
        return -1;
    }
    let (own, other) = (key(a), key(b));
    if own == other { 32 + (a ^ b).leading_zeros() as i32 } else { (own ^ other).leading_zeros() as i32 }
}

/// What is below node `node` of `slots - 1`, whose root is node 0 (Karras 2012, figure 4). `key` tells the code of a sorted slot.
#[inline(always)]
pub fn below(slots: u32, node: u32, key: impl Fn(u32) -> u32 + Copy) -> Below {
    let at = |a: u32, step: i32| common(slots, node, a.wrapping_add(step as u32), key);
    // Towards the neighbour that it has more in common with; before the first slot there is none.
    let direction = if at(node, 1) > at(node, -1) { 1 } else { -1 };
    let least = at(node, -direction);
    let mut reach = 2;
    while at(node, reach * direction) > least {
        reach *= 2;
    }
    let (mut length, mut step) = (0, reach / 2);
    while step >= 1 {
        if at(node, (length + step) * direction) > least {
            length += step;
        }
        step /= 2;
    }
    let other = node.wrapping_add((length * direction) as u32);
    let shared = common(slots, node, other, key);
    let (mut split, mut step) = (0, length);
    while step > 1 {
        step = (step + 1) / 2;
        if split + step < length && at(node, (split + step) * direction) > shared {
            split += step;
        }
    }
    let split = node.wrapping_add((split * direction) as u32);
    // The last slot of the left child.
    let split = if direction < 0 { split - 1 } else { split };
    let (first, last) = if direction < 0 { (other, node) } else { (node, other) };
    Below { first, middle: split + 1, end: last + 1 }
}

/// The references to a node's children; `slot` tells where the triangle of a sorted slot lies.
#[inline(always)]
pub fn children(of: Below, slot: impl Fn(u32) -> u32) -> (NodeRef, NodeRef) {
    let child = |first: u32, end: u32, node: u32| {
        if end - first == 1 { NodeRef::leaf(slot(first), 1) } else { NodeRef::inner(node) }
    };
    (child(of.first, of.middle, of.middle - 1), child(of.middle, of.end, of.middle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// The corner of all scenes.
    const CUBE: Vec3 = Vec3::ONE;

    /// Sorts as the kernels do, thread after thread.
    fn sorted(keys: &[u32]) -> (Vec<u32>, Vec<u32>) {
        let slots = keys.len() as u32;
        let (mut keys, mut values) = (keys.to_vec(), (0..slots).collect::<Vec<_>>());
        for shift in (0..CODE).step_by(DIGIT as usize) {
            let (top, _) = level(slots, levels(slots) - 1);
            let mut counts = vec![0u32; (top + RUN) as usize];
            let in_run = |run: u32| run * RUN..(run * RUN + RUN).min(slots);
            for run in 0..runs(slots) {
                for slot in in_run(run) {
                    counts[place(slots, run, digit(keys[slot as usize], shift)) as usize] += 1;
                }
            }
            for number in 1..levels(slots) {
                let ((below, had), (first, count)) = (level(slots, number - 1), level(slots, number));
                for i in 0..count {
                    let of = (i * RUN..(i * RUN + RUN).min(had)).map(|j| counts[(below + j) as usize]);
                    counts[(first + i) as usize] = of.sum();
                }
            }
            for number in (0..levels(slots)).rev() {
                let (first, count) = level(slots, number);
                for i in 0..count.div_ceil(RUN) {
                    let above = level(slots, number + 1).0;
                    let mut sum = if number + 1 < levels(slots) { counts[(above + i) as usize] } else { 0 };
                    for j in i * RUN..(i * RUN + RUN).min(count) {
                        let own = std::mem::replace(&mut counts[(first + j) as usize], sum);
                        sum += own;
                    }
                }
            }
            let (mut next_keys, mut next_values) = (keys.clone(), values.clone());
            for run in 0..runs(slots) {
                for slot in in_run(run) {
                    let key = keys[slot as usize];
                    let count = &mut counts[place(slots, run, digit(key, shift)) as usize];
                    (next_keys[*count as usize], next_values[*count as usize]) = (key, values[slot as usize]);
                    *count += 1;
                }
            }
            (keys, values) = (next_keys, next_values);
        }
        (keys, values)
    }

    #[test]
    fn keys_are_sorted_and_equal_ones_stay_in_their_order() {
        let mut rng = fastrand::Rng::with_seed(1);
        for (count, most) in [(2, 4), (31, 1 << 30), (33, 3), (1000, 1 << 30), (5000, 50), (70_000, 1 << 30)] {
            let keys: Vec<u32> = (0..count).map(|_| rng.u32(0..most)).collect();
            let mut want: Vec<(u32, u32)> = keys.iter().copied().zip(0..).collect();
            want.sort();
            let (got, values) = sorted(&keys);
            assert_eq!(got.into_iter().zip(values).collect::<Vec<_>>(), want, "{count} of {most}");
        }
    }

    /// Each node splits its slots where the highest bit of their codes changes, and each slot is in one leaf.
    #[test]
    fn nodes_are_a_tree_of_all_slots() {
        let mut rng = fastrand::Rng::with_seed(2);
        for (slots, most) in [(2u32, 1u32 << 30), (3, 2), (5, 1), (100, 8), (1000, 1 << 30), (4096, 1)] {
            let mut keys: Vec<u32> = (0..slots).map(|_| rng.u32(0..most)).collect();
            keys.sort_unstable();
            let mut open = vec![(0, 0, slots, 0)];
            let mut met = 0;
            while let Some((node, first, end, depth)) = open.pop() {
                let of = below(slots, node, |slot| keys[slot as usize]);
                assert_eq!((of.first, of.end), (first, end), "node {node} of {slots}");
                assert!(first < of.middle && of.middle < end && depth < 62);
                let differs = |slot: u32| {
                    (u64::from(keys[slot as usize]) << 32 | u64::from(slot))
                        ^ (u64::from(keys[first as usize]) << 32 | u64::from(first))
                };
                assert_eq!(64 - differs(end - 1).leading_zeros(), 64 - differs(of.middle).leading_zeros());
                assert!(differs(of.middle - 1).leading_zeros() > differs(of.middle).leading_zeros());
                let (left, right) = children(of, |slot| slot);
                for (child, first, end) in [(left, first, of.middle), (right, of.middle, end)] {
                    if child.is_leaf() {
                        assert_eq!((child.index(), child.count(), end), (first, 1, first + 1));
                        met += 1;
                    } else {
                        open.push((child.index(), first, end, depth + 1));
                    }
                }
            }
            assert_eq!(met, slots);
        }
    }

    #[test]
    fn codes_follow_the_curve() {
        let at = |place: Vec3| code(Block { least: place, greatest: place });
        assert_eq!([at(-CUBE), at(CUBE), at(CUBE * 9.0), at(CUBE * -9.0)], [0, (1 << 30) - 1, (1 << 30) - 1, 0]);
        assert_eq!([at(Vec3::new(0.0, -1.0, -1.0)), at(Vec3::new(-1.0, 0.0, -1.0))], [1 << 29, 1 << 28]);
        assert_eq!(at(Vec3::new(-1.0, -1.0, -1.0 + 1.0 / 512.0)), 1);
        assert_eq!(at(Vec3::NAN), 0, "no device makes anything else of it");
    }
}
