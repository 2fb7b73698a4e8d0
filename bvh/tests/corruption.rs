//! One corrupted tree for each rule of validation.

mod common;

use common::*;
use eyerays_bvh::{BuildError, MAX_DEPTH, Quality, build, validate};
use eyerays_shader::data::{Bounds, NodePair, NodeRef, pack};

/// A valid tree, and the own boxes of its slots.
fn valid() -> (Vec<NodePair>, Vec<Bounds>) {
    let bvh = build(&whole(&mixed()), Quality::Medium).unwrap();
    assert_eq!(validate(&bvh.nodes, &bvh.bounds), Ok(()));
    (bvh.nodes, bvh.bounds)
}

/// What validation says after a change.
fn after(change: impl FnOnce(&mut Vec<NodePair>, &mut Vec<Bounds>)) -> BuildError {
    let (mut nodes, mut bounds) = valid();
    change(&mut nodes, &mut bounds);
    validate(&nodes, &bounds).expect_err("a corrupted tree")
}

/// The first pair whose left child is of the kind asked for.
fn left(nodes: &[NodePair], leaf: bool) -> usize {
    let found = nodes.iter().position(|n| n.left().is_leaf() == leaf);
    found.expect("a tree of hundreds has both kinds")
}

#[test]
fn cycle() {
    let error = after(|nodes, _| {
        let last = nodes.len() - 1;
        nodes[last].left_min.w = NodeRef::ROOT.0;
    });
    assert!(matches!(error, BuildError::PairOutOfOrder { child: 0, .. }), "{error}");
}

#[test]
fn pair_with_two_parents() {
    let error = after(|nodes, _| {
        let pair = nodes[0];
        nodes[0] = NodePair { right_min: pair.left_min, right_max: pair.left_max, ..pair };
    });
    assert_eq!(error, BuildError::PairOutOfOrder { pair: 0, child: 1 });
}

#[test]
fn pair_out_of_range() {
    for past in [0, 1, 1 << 20] {
        let error = after(|nodes, _| {
            let child = NodeRef::inner(nodes.len() as u32 + past);
            let pair = left(nodes, false);
            nodes[pair].left_min.w = child.0;
        });
        assert!(matches!(error, BuildError::PairOutOfRange { .. }), "{error}");
    }
}

#[test]
fn no_pairs() {
    let error = after(|nodes, _| nodes.clear());
    assert!(matches!(error, BuildError::PairOutOfRange { pairs: 0, .. }));
}

#[test]
fn pair_that_nothing_refers_to() {
    let count = valid().0.len() as u32;
    let error = after(|nodes, _| nodes.push(nodes[0]));
    assert_eq!(error, BuildError::PairUnreached { pair: count });
}

#[test]
fn leaf_out_of_range() {
    let error = after(|_, bounds| bounds.truncate(299));
    assert!(matches!(error, BuildError::LeafOutOfRange { primitives: 299, .. }));
    for count in [6, 7] {
        let error = after(|nodes, _| {
            let pair = left(nodes, true);
            nodes[pair].left_min.w = NodeRef::leaf(0, count).0;
        });
        assert!(matches!(error, BuildError::LeafOutOfRange { first: 0, .. }));
    }
}

#[test]
fn triangle_in_no_leaf() {
    let error = after(|_, bounds| bounds.push(bounds[0]));
    assert_eq!(error, BuildError::PrimitiveLost { primitive: 300 });
    let error = after(|nodes, _| {
        let pair = nodes.iter().position(|n| n.left().count() > 1).unwrap();
        nodes[pair].left_min.w -= 1;
    });
    assert!(matches!(error, BuildError::PrimitiveLost { .. }));
}

#[test]
fn triangle_in_two_leaves() {
    let error = after(|nodes, _| {
        let pair = nodes.iter().position(|n| n.left().is_leaf() && n.right().is_leaf()).unwrap();
        nodes[pair].right_min = nodes[pair].left_min;
        nodes[pair].right_max = nodes[pair].left_max;
    });
    assert!(matches!(error, BuildError::PrimitiveLost { .. }), "what the right leaf had: {error}");
    let mut bvh = build(&whole(&duplicates(12)), Quality::Medium).unwrap();
    let pair = bvh.nodes.iter().position(|n| n.left().is_leaf() && n.right().is_leaf()).unwrap();
    bvh.nodes[pair].left_min.w += 1;
    let twice = bvh.nodes[pair].right().index();
    let error = validate(&bvh.nodes, &bvh.bounds).unwrap_err();
    assert_eq!(error, BuildError::PrimitiveTwice { primitive: twice });
}

/// Moves one face of one box inwards by the least step there is.
fn shrink(nodes: &mut [NodePair], pair: usize, face: usize) {
    let node = &mut nodes[pair];
    let (word, axis) = (face / 3, face % 3);
    let word = match word {
        0 => &mut node.left_min,
        1 => &mut node.left_max,
        2 => &mut node.right_min,
        _ => &mut node.right_max,
    };
    let coordinate = f32::from_bits(word[axis]);
    let least = matches!(face / 3, 0 | 2);
    let inwards = if least { coordinate.next_up() } else { coordinate.next_down() };
    word[axis] = inwards.to_bits();
}

#[test]
fn any_face_of_any_box_too_small_by_the_least_step() {
    let (nodes, bounds) = valid();
    for pair in 0..nodes.len() {
        for face in 0..12 {
            let mut nodes = nodes.clone();
            shrink(&mut nodes, pair, face);
            let error = BuildError::BoxTooSmall { pair: pair as u32 };
            assert_eq!(validate(&nodes, &bounds), Err(error), "face {face}");
        }
    }
}

#[test]
fn box_of_nan() {
    let error = after(|nodes, _| nodes[3].left_max.y = f32::NAN.to_bits());
    assert_eq!(error, BuildError::BoxTooSmall { pair: 3 });
}

/// A path of `pairs`, each with a leaf of one triangle on the left.
fn chain(pairs: u32) -> (Vec<NodePair>, Vec<Bounds>) {
    let (min, max) = duplicates(1)[0].bounds();
    let bounds = vec![Bounds { least: pack(min, 0), greatest: pack(max, 0) }; pairs as usize + 1];
    let node = |i: u32| {
        let next = if i + 1 < pairs { NodeRef::inner(i + 1) } else { NodeRef::leaf(pairs, 1) };
        NodePair::new((min, max, NodeRef::leaf(i, 1)), (min, max, next))
    };
    ((0..pairs).map(node).collect(), bounds)
}

#[test]
fn too_deep_by_one() {
    let (nodes, bounds) = chain(MAX_DEPTH);
    assert_eq!(validate(&nodes, &bounds), Ok(()));
    let (nodes, bounds) = chain(MAX_DEPTH + 1);
    let error = BuildError::TooDeep { pair: MAX_DEPTH };
    assert_eq!(validate(&nodes, &bounds), Err(error));
}

#[test]
fn empty_sibling_belongs_to_one_triangle_only() {
    let both = scattered(2, 31);
    let one = build(&whole(&both[..1]), Quality::Medium).unwrap();
    let bounds = [one.bounds[0], one.bounds[0]];
    assert_eq!(validate(&one.nodes, &bounds[..1]), Ok(()));
    // With a second slot, it is a leaf that lies elsewhere.
    assert_eq!(validate(&one.nodes, &bounds), Err(BuildError::BoxTooSmall { pair: 0 }));

    let mut moved = one.nodes.clone();
    moved[0].right_max.x = 1.0f32.to_bits();
    assert_eq!(validate(&moved, &bounds[..1]), Err(BuildError::BoxTooSmall { pair: 0 }));
    let mut doubled = one.nodes.clone();
    (doubled[0].right_min, doubled[0].right_max) = (doubled[0].left_min, doubled[0].left_max);
    assert_eq!(validate(&doubled, &bounds[..1]), Err(BuildError::PrimitiveTwice { primitive: 0 }));
    assert_eq!(validate(&one.nodes, &[]), Err(BuildError::NoPrimitives));
}
