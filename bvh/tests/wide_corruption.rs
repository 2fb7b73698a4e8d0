//! One corrupted wide tree for each rule of validation.

mod common;

use common::*;
use eyerays_bvh::{BuildError, MAX_WIDE_DEPTH, Quality, build, validate_wide};
use eyerays_shader::data::{Bounds, CwbvhNode, pack};
use glam::{UVec4, Vec3};

/// A valid tree, and the own boxes of its slots.
fn valid() -> (Vec<CwbvhNode>, Vec<Bounds>) {
    let mut bvh = build(&whole(&mixed()), Quality::Medium).unwrap();
    bvh.widen().unwrap();
    assert_eq!(validate_wide(&bvh.wide, &bvh.bounds), Ok(()));
    assert!(bvh.wide.len() > 10);
    (bvh.wide, bvh.bounds)
}

/// What validation says after a change.
fn after(change: impl FnOnce(&mut Vec<CwbvhNode>, &mut Vec<Bounds>)) -> BuildError {
    let (mut nodes, mut bounds) = valid();
    change(&mut nodes, &mut bounds);
    validate_wide(&nodes, &bounds).expect_err("a corrupted tree")
}

/// Bits of a child's triangles.
fn leaf(node: &CwbvhNode, slot: usize) -> u32 {
    node.children.z >> (3 * slot) & 7
}

fn set_leaf(node: &mut CwbvhNode, slot: usize, bits: u32) {
    node.children.z = node.children.z & !(7 << (3 * slot)) | bits << (3 * slot);
}

fn is_inner(node: &CwbvhNode, slot: usize) -> bool {
    node.grid.w >> (24 + slot) & 1 == 1
}

/// The first node and slot with a child that is asked for.
fn find(nodes: &[CwbvhNode], wanted: impl Fn(&CwbvhNode, usize) -> bool) -> (usize, usize) {
    let all = (0..nodes.len()).flat_map(|node| (0..8).map(move |slot| (node, slot)));
    all.into_iter().find(|&(node, slot)| wanted(&nodes[node], slot)).expect("hundreds of triangles have all kinds")
}

fn is_leaf(node: &CwbvhNode, slot: usize) -> bool {
    leaf(node, slot) != 0
}

#[test]
fn no_nodes() {
    let error = after(|nodes, _| nodes.clear());
    assert!(matches!(error, BuildError::WideNodeOutOfRange { nodes: 0, .. }));
    assert_eq!(validate_wide(&valid().0, &[]), Err(BuildError::NoPrimitives));
}

#[test]
fn cycle() {
    let error = after(|nodes, _| nodes[0].children.x = 0);
    assert_eq!(error, BuildError::WideNodeReachedTwice { node: 0 });
}

#[test]
fn node_with_two_parents() {
    let (nodes, _) = valid();
    let first = nodes[0].children.x;
    let error = after(|nodes, _| {
        let (node, _) = find(&nodes[1..], is_inner);
        nodes[1 + node].children.x = first;
    });
    assert!(matches!(error, BuildError::WideNodeReachedTwice { .. }), "{error}");
}

#[test]
fn node_out_of_range() {
    let count = valid().0.len() as u32;
    for child in [count, count + 1, u32::MAX] {
        let error = after(|nodes, _| {
            let (node, _) = find(nodes, is_inner);
            nodes[node].children.x = child;
        });
        assert!(matches!(error, BuildError::WideNodeOutOfRange { .. }), "{error}");
    }
}

#[test]
fn node_that_nothing_refers_to() {
    let count = valid().0.len() as u32;
    let error = after(|nodes, _| nodes.push(nodes[0]));
    assert_eq!(error, BuildError::WideNodeUnreached { node: count });
}

#[test]
fn leaf_out_of_range() {
    let error = after(|_, bounds| bounds.truncate(299));
    assert!(matches!(error, BuildError::WideLeafOutOfRange { primitives: 299, .. }));
    for first in [300, u32::MAX] {
        let error = after(|nodes, _| {
            let (node, _) = find(nodes, is_leaf);
            nodes[node].children.y = first;
        });
        assert!(matches!(error, BuildError::WideLeafOutOfRange { .. }));
    }
}

#[test]
fn triangle_in_no_leaf_and_in_two() {
    let error = after(|_, bounds| bounds.push(bounds[0]));
    assert_eq!(error, BuildError::PrimitiveLost { primitive: 300 });
    let error = after(|nodes, _| {
        let (node, slot) = find(nodes, is_leaf);
        let fewer = leaf(&nodes[node], slot) >> 1;
        set_leaf(&mut nodes[node], slot, fewer);
    });
    assert!(matches!(error, BuildError::PrimitiveLost { .. } | BuildError::WideNodeMalformed { .. }), "{error}");
    let error = after(|nodes, _| {
        let (node, _) = find(nodes, |n, slot| is_leaf(n, slot) && n.children.y > 0);
        nodes[node].children.y -= 1;
    });
    assert!(matches!(error, BuildError::PrimitiveTwice { .. }), "{error}");
}

#[test]
fn child_that_is_both() {
    let error = after(|nodes, _| {
        let (node, slot) = find(nodes, is_leaf);
        nodes[node].grid.w |= 1 << (24 + slot);
    });
    assert!(matches!(error, BuildError::WideNodeMalformed { .. }), "{error}");
    let error = after(|nodes, _| {
        let (node, slot) = find(nodes, is_inner);
        set_leaf(&mut nodes[node], slot, 1);
    });
    assert!(matches!(error, BuildError::WideNodeMalformed { .. }), "{error}");
}

#[test]
fn bits_of_a_leaf_with_a_gap_and_of_no_child() {
    for bits in [0b010, 0b100, 0b101, 0b110] {
        let error = after(|nodes, _| {
            let (node, slot) = find(nodes, is_leaf);
            set_leaf(&mut nodes[node], slot, bits);
        });
        assert!(matches!(error, BuildError::WideNodeMalformed { .. }), "{bits}: {error}");
    }
    let error = after(|nodes, _| nodes[0].children.z |= 1 << 24);
    assert_eq!(error, BuildError::WideNodeMalformed { node: 0 });
}

#[test]
fn node_without_children() {
    let error = after(|nodes, _| {
        let node = nodes.len() - 1;
        nodes[node].children.z = 0;
        nodes[node].grid.w &= 0xff_ffff;
    });
    assert!(matches!(error, BuildError::WideNodeMalformed { .. }), "{error}");
}

#[test]
fn grid_that_no_box_test_can_scale() {
    for origin in [f32::NAN, f32::INFINITY, 3.0, 1e-20] {
        let error = after(|nodes, _| nodes[3].grid.y = origin.to_bits());
        assert_eq!(error, BuildError::WideNodeMalformed { node: 3 });
    }
    for exponent in [0, 135 - 31, 136, 255] {
        let error = after(|nodes, _| nodes[3].grid.w = nodes[3].grid.w & 0xffff_00ff | exponent << 8);
        assert_eq!(error, BuildError::WideNodeMalformed { node: 3 });
    }
}

/// The word and the byte of a plane: six of eight bytes each.
fn plane(node: &mut CwbvhNode, side: usize, slot: usize) -> (&mut u32, usize) {
    let words = [&mut node.low_x_low_y, &mut node.low_z_high_x, &mut node.high_y_high_z];
    let place = side * 2 + slot / 4;
    let [a, b, c] = words;
    let word = match place / 4 {
        0 => &mut a[place % 4],
        1 => &mut b[place % 4],
        _ => &mut c[place % 4],
    };
    (word, slot % 4)
}

#[test]
fn any_plane_of_any_child_one_step_inwards() {
    let (nodes, bounds) = valid();
    let mut moved = 0;
    for node in 0..nodes.len() {
        for (slot, side) in (0..8).flat_map(|slot| (0..6).map(move |side| (slot, side))) {
            if !is_leaf(&nodes[node], slot) && !is_inner(&nodes[node], slot) {
                continue;
            }
            let mut nodes = nodes.clone();
            let (word, byte) = plane(&mut nodes[node], side, slot);
            let mut planes = word.rotate_right(CwbvhNode::TURN).to_le_bytes();
            planes[byte] = if side < 3 { planes[byte].wrapping_add(1) } else { planes[byte].wrapping_sub(1) };
            *word = u32::from_le_bytes(planes).rotate_left(CwbvhNode::TURN);
            let error = BuildError::WideBoxTooSmall { node: node as u32 };
            assert_eq!(validate_wide(&nodes, &bounds), Err(error), "side {side}");
            moved += 1;
        }
    }
    assert!(moved > 500);
}

#[test]
fn own_box_larger_than_the_margin_lets_it_be() {
    let error = after(|_, bounds| {
        let x = f32::from_bits(bounds[150].least.x);
        bounds[150].least.x = (x - 1.0 / 16.0).to_bits();
    });
    assert!(matches!(error, BuildError::WideBoxTooSmall { .. }));
}

/// A path of nodes, each with a leaf of one triangle in slot 0 and the next node in slot 1.
fn chain(length: u32) -> (Vec<CwbvhNode>, Vec<Bounds>) {
    let (least, greatest) = duplicates(1)[0].bounds();
    let own = Bounds { least: pack(least, 0), greatest: pack(greatest, 0) };
    let node = |i: u32| {
        let last = i + 1 == length;
        let (mask, other) = if last { (0, 1) } else { (2, 0) };
        CwbvhNode {
            grid: pack(Vec3::NEG_ONE, 129 << 16 | 129 << 8 | 129 | mask << 24),
            children: UVec4::new(i + 1, i, 1 | other << 3, 0),
            low_x_low_y: UVec4::ZERO,
            low_z_high_x: UVec4::new(0, 0, u32::MAX, u32::MAX),
            high_y_high_z: UVec4::splat(u32::MAX),
        }
    };
    ((0..length).map(node).collect(), vec![own; length as usize + 1])
}

#[test]
fn too_deep_by_one() {
    let (nodes, bounds) = chain(MAX_WIDE_DEPTH);
    assert_eq!(validate_wide(&nodes, &bounds), Ok(()));
    let (nodes, bounds) = chain(MAX_WIDE_DEPTH + 1);
    let error = BuildError::WideNodeTooDeep { node: MAX_WIDE_DEPTH };
    assert_eq!(validate_wide(&nodes, &bounds), Err(error));
}
