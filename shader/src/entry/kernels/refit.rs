//! Hierarchies whose triangles move, see [`crate::refit`].

use crate::buffer::{read, write};
use crate::data::{Normals, Primitive};
use crate::launch::ROW;
use crate::linear::{self, Linear, RUN};
use crate::refit::{self, Block, Refit};
use glam::{UVec3, UVec4, Vec3};
use spirv_std::spirv;

/// The number of a thread, which may be in a further row.
#[inline(always)]
fn number(id: UVec3) -> u32 {
    id.y * ROW + id.x
}

#[inline(always)]
fn block(blocks: &[UVec4], number: u32) -> Block {
    refit::unpacked([read(blocks, 2 * number), read(blocks, 2 * number + 1)])
}

#[inline(always)]
fn keep(blocks: &mut [UVec4], number: u32, of: Block) {
    let [least, greatest] = refit::packed(of);
    write(blocks, 2 * number, least);
    write(blocks, 2 * number + 1, greatest);
}

#[inline(always)]
fn vector(numbers: &[u32], vertex: u32) -> Vec3 {
    let number = |axis| f32::from_bits(read(numbers, 3 * vertex + axis));
    Vec3::new(number(0), number(1), number(2))
}

/// Gathers the vertices of a slot's triangle, and finds its box.
#[spirv(compute(threads(64)))]
pub fn place(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Refit,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] corners: &[UVec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] positions: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] primitives: &mut [UVec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] blocks: &mut [UVec4],
) {
    let slot = number(id);
    if slot >= of.slots {
        return;
    }
    let UVec4 { x, y, z, .. } = read(corners, slot);
    let at = |word| read(primitives, 3 * slot + word);
    let before = Primitive { a: at(0), b: at(1), c: at(2) };
    let vertices = [vector(positions, x), vector(positions, y), vector(positions, z)];
    let triangle = refit::placed(before, vertices);
    write(primitives, 3 * slot, triangle.a);
    write(primitives, 3 * slot + 1, triangle.b);
    write(primitives, 3 * slot + 2, triangle.c);
    keep(blocks, slot, refit::of_triangle(&triangle));
}

/// Gathers the normals of a slot's vertices.
#[spirv(compute(threads(64)))]
pub fn turn(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Refit,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] corners: &[UVec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] vectors: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] normals: &mut [Normals],
) {
    let slot = number(id);
    if slot < of.slots {
        let UVec4 { x, y, z, .. } = read(corners, slot);
        write(normals, slot, refit::turned([vector(vectors, x), vector(vectors, y), vector(vectors, z)]));
    }
}

/// Finds the boxes of a level of blocks, each of two of the level below.
#[spirv(compute(threads(64)))]
pub fn merge(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Refit,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] blocks: &mut [UVec4],
) {
    let own = number(id);
    let ((below, had), (first, count)) = (refit::level(of.slots, of.level - 1), refit::level(of.slots, of.level));
    if own >= count {
        return;
    }
    let mut around = block(blocks, below + 2 * own);
    if 2 * own + 1 < had {
        around = around.around(block(blocks, below + 2 * own + 1));
    }
    keep(blocks, first + own, around);
}

/// Fits the boxes of a pair of nodes to the slots below.
#[spirv(compute(threads(64)))]
pub fn fit(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Refit,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] runs: &[UVec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] blocks: &[UVec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] nodes: &mut [UVec4],
) {
    let pair = number(id);
    if pair >= of.pairs {
        return;
    }
    let UVec4 { x: first, y: middle, z: end, .. } = read(runs, pair);
    let slots = of.slots;
    let left = refit::run(slots, (first, middle), |number| block(blocks, number));
    let (centre, half) = refit::centred(left, read(nodes, 4 * pair).w);
    write(nodes, 4 * pair, centre);
    write(nodes, 4 * pair + 1, half);
    // The right child of a single triangle's tree is nothing.
    if middle < end {
        let right = refit::run(slots, (middle, end), |number| block(blocks, number));
        let (centre, half) = refit::centred(right, read(nodes, 4 * pair + 2).w);
        write(nodes, 4 * pair + 2, centre);
        write(nodes, 4 * pair + 3, half);
    }
}

/// The Morton code of each slot's triangle.
#[spirv(compute(threads(64)))]
pub fn code(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Linear,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] primitives: &[UVec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &mut [u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] values: &mut [u32],
) {
    let slot = number(id);
    if slot < of.slots {
        let at = |word| read(primitives, 3 * slot + word);
        let triangle = Primitive { a: at(0), b: at(1), c: at(2) };
        write(keys, slot, linear::code(refit::of_triangle(&triangle)));
        write(values, slot, slot);
    }
}

/// How often each digit is in a run of keys.
#[spirv(compute(threads(64)))]
pub fn count(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Linear,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] keys: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] counts: &mut [u32],
) {
    let run = number(id);
    if run >= linear::runs(of.slots) {
        return;
    }
    let mut digit = 0;
    while digit < linear::DIGITS {
        write(counts, linear::place(of.slots, run, digit), 0);
        digit += 1;
    }
    let mut slot = run * RUN;
    while slot < run * RUN + RUN && slot < of.slots {
        let place = linear::place(of.slots, run, linear::digit(read(keys, slot), of.shift));
        let before = read(counts, place);
        write(counts, place, before + 1);
        slot += 1;
    }
}

/// Sums counts of the level below.
#[spirv(compute(threads(64)))]
pub fn sum(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Linear,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] counts: &mut [u32],
) {
    let own = number(id);
    let (below, had) = linear::level(of.slots, of.level - 1);
    let (first, count) = linear::level(of.slots, of.level);
    if own >= count {
        return;
    }
    let (mut sum, mut place) = (0, own * RUN);
    while place < own * RUN + RUN && place < had {
        sum += read(counts, below + place);
        place += 1;
    }
    write(counts, first + own, sum);
}

/// Turns a level of counts into what is before each, given that of the level above.
#[spirv(compute(threads(64)))]
pub fn spread(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Linear,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] counts: &mut [u32],
) {
    let own = number(id);
    let (first, count) = linear::level(of.slots, of.level);
    if own >= count.div_ceil(RUN) {
        return;
    }
    let mut sum = 0;
    if count > RUN {
        sum = read(counts, first + count + own);
    }
    let mut place = own * RUN;
    while place < own * RUN + RUN && place < count {
        let before = read(counts, first + place);
        write(counts, first + place, sum);
        sum += before;
        place += 1;
    }
}

/// Moves a run of keys to where their digits have them.
#[spirv(compute(threads(64)))]
pub fn scatter(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Linear,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] keys: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] values: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] counts: &mut [u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] moved_keys: &mut [u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] moved_values: &mut [u32],
) {
    let run = number(id);
    let mut slot = run * RUN;
    while slot < run * RUN + RUN && slot < of.slots {
        let key = read(keys, slot);
        let place = linear::place(of.slots, run, linear::digit(key, of.shift));
        let to = read(counts, place);
        write(counts, place, to + 1);
        write(moved_keys, to, key);
        write(moved_values, to, read(values, slot));
        slot += 1;
    }
}

/// Which sorted slots are below each node, and its children.
#[spirv(compute(threads(64)))]
pub fn tree(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Linear,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] keys: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] values: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] runs: &mut [UVec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] nodes: &mut [UVec4],
) {
    let node = number(id);
    if node + 1 >= of.slots {
        return;
    }
    let below = linear::below(of.slots, node, |slot| read(keys, slot));
    let (left, right) = linear::children(below, |slot| read(values, slot));
    write(runs, node, UVec4::new(below.first, below.middle, below.end, 0));
    write(nodes, 4 * node, UVec4::new(0, 0, 0, left.0));
    write(nodes, 4 * node + 2, UVec4::new(0, 0, 0, right.0));
}

/// The boxes of sorted slots.
#[spirv(compute(threads(64)))]
pub fn leaves(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Linear,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] values: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] primitives: &[UVec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] blocks: &mut [UVec4],
) {
    let slot = number(id);
    if slot < of.slots {
        let first = 3 * read(values, slot);
        let at = |word| read(primitives, first + word);
        let triangle = Primitive { a: at(0), b: at(1), c: at(2) };
        keep(blocks, slot, refit::of_triangle(&triangle));
    }
}
