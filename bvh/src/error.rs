//! Errors of building and validating hierarchies.

use eyerays_shader::data::{MAX_LEAF, NodeRef};

use crate::{MAX_DEPTH, MAX_WIDE_DEPTH};

/// Why [`split`](crate::split()), [`build`](crate::build()), [`validate`](crate::validate()) or
/// [`validate_wide`](crate::validate_wide()) refuses. The first three are faults of the input; the
/// others mean that a hierarchy must not be traversed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// There are no primitives to build a tree over.
    #[error("the scene has no primitives: add a mesh, or skip tracing and draw the background")]
    NoPrimitives,
    /// A node reference cannot number so many primitives.
    #[error(
        "the scene has {count} primitives or parts of them, but a node reference holds {most}: split the scene or simplify its meshes",
        most = NodeRef::MAX_INDEX
    )]
    TooManyPrimitives {
        /// Primitives or references given.
        count: usize,
    },
    /// A coordinate is NaN, infinite or outside the normalised scene.
    #[error(
        "primitive {primitive} has a vertex coordinate that is not a number in [-1, 1]: remove the primitive or normalise the scene"
    )]
    Coordinate {
        /// The primitive's number in the scene.
        primitive: u32,
    },
    /// A reference leads past the end of the node pairs.
    #[error("pair {pair} refers to pair {child} of {pairs}: rebuild the hierarchy")]
    PairOutOfRange {
        /// The pair that holds the reference.
        pair: u32,
        /// The pair referred to.
        child: u32,
        /// Pairs there are.
        pairs: usize,
    },
    /// A pair does not follow its parent or what is below its sibling.
    #[error("pair {pair} refers to pair {child}, which is out of depth-first order: rebuild the hierarchy")]
    PairOutOfOrder {
        /// The pair that holds the reference.
        pair: u32,
        /// The pair referred to.
        child: u32,
    },
    /// A pair is part of no path from the root.
    #[error("pair {pair} is never reached from the root: rebuild the hierarchy")]
    PairUnreached {
        /// The least such pair.
        pair: u32,
    },
    /// A leaf's run is too long or leads past the end of the primitives.
    #[error(
        "pair {pair} has a leaf of {count} primitives from {first} on, but there are {primitives} and a leaf holds {most}: rebuild the hierarchy",
        most = MAX_LEAF
    )]
    LeafOutOfRange {
        /// The pair that holds the leaf.
        pair: u32,
        /// First slot of the run.
        first: u32,
        /// Length of the run.
        count: u32,
        /// Primitives there are.
        primitives: usize,
    },
    /// A hierarchy that was kept has leaves whose slots are not from left to right.
    #[error("the leaves' slots are not from left to right: rebuild the hierarchy")]
    SlotOrder,
    /// There are not as many own boxes as slots.
    #[error("there are {order} slots and {bounds} boxes of them: rebuild the hierarchy")]
    Slots {
        /// Slots.
        order: usize,
        /// Boxes.
        bounds: usize,
    },
    /// A slot has no primitive, or a box that is none of its primitive's.
    #[error("slot {slot} has another box than its primitive: rebuild the hierarchy")]
    BoxElsewhere {
        /// The slot.
        slot: u32,
    },
    /// A box reaches farther than what is below it.
    #[error("pair {pair} has a box larger than what is below it: rebuild the hierarchy")]
    BoxTooLarge {
        /// The pair.
        pair: u32,
    },
    /// Two leaves share a slot, or two slots a primitive.
    #[error("primitive {primitive} sits in two places: rebuild the hierarchy")]
    PrimitiveTwice {
        /// The slot, or the primitive.
        primitive: u32,
    },
    /// No leaf holds a slot, or no slot a primitive.
    #[error("primitive {primitive} sits in no leaf: rebuild the hierarchy")]
    PrimitiveLost {
        /// The least such slot or primitive.
        primitive: u32,
    },
    /// A box does not contain its primitives or its children.
    #[error("a box of pair {pair} does not contain what is below it: rebuild the hierarchy")]
    BoxTooSmall {
        /// The pair.
        pair: u32,
    },
    /// A traversal stack could overflow.
    #[error("pair {pair} lies deeper than {most} levels: rebuild the hierarchy", most = MAX_DEPTH)]
    TooDeep {
        /// The first such pair on the way down.
        pair: u32,
    },
    /// A wide node's bytes are invalid: its grid, a child's byte, or the mask of inner children.
    #[error("wide node {node} is malformed: rebuild the hierarchy")]
    WideNodeMalformed {
        /// The node.
        node: u32,
    },
    /// A wide node's inner child lies past the end of the nodes.
    #[error("wide node {node} refers to node {child} of {nodes}: rebuild the hierarchy")]
    WideNodeOutOfRange {
        /// The node that has the child.
        node: u32,
        /// The node referred to.
        child: u32,
        /// Nodes there are.
        nodes: usize,
    },
    /// A wide node has two parents, or is its own ancestor.
    #[error("wide node {node} is reached twice, so this is no tree: rebuild the hierarchy")]
    WideNodeReachedTwice {
        /// The node.
        node: u32,
    },
    /// A wide node is part of no path from the root.
    #[error("wide node {node} is never reached from the root: rebuild the hierarchy")]
    WideNodeUnreached {
        /// The least such node.
        node: u32,
    },
    /// A wide node's leaf leads past the end of the primitives.
    #[error(
        "wide node {node} has a leaf of {count} primitives from {first} on, but there are {primitives}: rebuild the hierarchy"
    )]
    WideLeafOutOfRange {
        /// The node that has the leaf.
        node: u32,
        /// First slot of the run.
        first: u64,
        /// Length of the run.
        count: u32,
        /// Primitives there are.
        primitives: usize,
    },
    /// A child's quantised box does not contain what is below it with the margin it must have.
    #[error("a box of wide node {node} does not contain what is below it by the margin: rebuild the hierarchy")]
    WideBoxTooSmall {
        /// The node.
        node: u32,
    },
    /// A traversal stack could overflow.
    #[error("wide node {node} lies deeper than {most} levels: rebuild the hierarchy", most = MAX_WIDE_DEPTH)]
    WideNodeTooDeep {
        /// The first such node on the way down.
        node: u32,
    },
}
