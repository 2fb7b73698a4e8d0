//! From a topology to node pairs: runs are split, pairs numbered, boxes computed.

use eyerays_shader::data::{MAX_LEAF, NodePair, NodeRef};

use crate::{
    bounds::Bounds,
    median,
    topology::{Kind, Topology},
};

/// A subtree that is still to be laid out.
enum Subtree {
    /// A node of the topology.
    Node(u32),
    /// Slots from a first one on, and their number.
    Run(u32, u32),
}

/// Lays out a topology of at least two primitives as node pairs in depth-first order, the root
/// first. Reorders `topology.order` within runs. `bounds` are those of all primitives.
pub(crate) fn pairs(topology: &mut Topology, bounds: &[Bounds]) -> Vec<NodePair> {
    let references = number(topology, bounds);
    boxes(&references, &topology.order, bounds)
}

/// The only pair of a tree of one primitive.
pub(crate) fn single(bounds: Bounds) -> NodePair {
    NodePair::new(bounds.child(NodeRef::leaf(0, 1)), NodePair::EMPTY)
}

/// The references of every pair.
fn number(topology: &mut Topology, bounds: &[Bounds]) -> Vec<[NodeRef; 2]> {
    let mut pairs: Vec<[NodeRef; 2]> = Vec::with_capacity(topology.nodes.len() / 2 + 1);
    let mut open: Vec<(Subtree, Option<(usize, usize)>)> = vec![(Subtree::Node(0), None)];
    while let Some((subtree, parent)) = open.pop() {
        let (first, count, children) = resolve(subtree, topology);
        let is_leaf = children.is_none() && count <= MAX_LEAF && parent.is_some();
        let reference = if is_leaf { NodeRef::leaf(first, count) } else { NodeRef::inner(pairs.len() as u32) };
        if let Some((pair, side)) = parent {
            pairs[pair][side] = reference;
        }
        if is_leaf {
            continue;
        }
        let [left, right] = children.unwrap_or_else(|| {
            let slots = first as usize..(first + count) as usize;
            let half = median::split(&mut topology.order[slots], bounds) as u32;
            [Subtree::Run(first, half), Subtree::Run(first + half, count - half)]
        });
        let pair = pairs.len();
        pairs.push([NodeRef::ROOT; 2]);
        open.push((right, Some((pair, 1))));
        open.push((left, Some((pair, 0))));
    }
    pairs
}

/// A subtree's first slot, its number of slots, and its children, if the topology gives them.
fn resolve(subtree: Subtree, topology: &Topology) -> (u32, u32, Option<[Subtree; 2]>) {
    match subtree {
        Subtree::Run(first, count) => (first, count, None),
        Subtree::Node(number) => {
            let node = topology.nodes[number as usize];
            let children = match node.kind {
                Kind::Run => None,
                Kind::Inner(left, right) => Some([Subtree::Node(left), Subtree::Node(right)]),
            };
            (node.first, node.count, children)
        }
    }
}

/// The pairs with their boxes. Children come after their parents, so one sweep from the end computes
/// theirs first.
fn boxes(references: &[[NodeRef; 2]], order: &[u32], bounds: &[Bounds]) -> Vec<NodePair> {
    let mut around = vec![Bounds::EMPTY; references.len()];
    let mut pairs = vec![NodePair::new(NodePair::EMPTY, NodePair::EMPTY); references.len()];
    for i in (0..references.len()).rev() {
        let child = |reference: NodeRef| {
            let first = reference.index() as usize;
            if !reference.is_leaf() {
                return around[first];
            }
            let slots = &order[first..first + reference.count() as usize];
            Bounds::around(slots.iter().map(|&t| bounds[t as usize]))
        };
        let [left, right] = references[i].map(child);
        pairs[i] = NodePair::new(left.child(references[i][0]), right.child(references[i][1]));
        around[i] = left.union(right);
    }
    pairs
}
