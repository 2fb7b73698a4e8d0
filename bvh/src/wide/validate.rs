//! The proof that kernels may index a wide hierarchy without checks.

use eyerays_shader::data::{Bounds as BoundsRecord, CwbvhNode};

use super::{
    MAX_WIDE_DEPTH,
    record::{Child, Record},
};
use crate::{BuildError, bounds::Bounds, validate::Once};

/// Checks a wide hierarchy over the own boxes of slots: every node is well-formed and reached exactly
/// once from the root, every slot lies in exactly one leaf, every child's planes lie around what is
/// below it with [`CwbvhNode::MARGIN`] and [`CwbvhNode::SLACK`] to spare, and no path has more than [`MAX_WIDE_DEPTH`] nodes.
/// Takes linear time.
///
/// # Errors
///
/// The first rule broken in depth-first order; then nodes and slots that are never reached; then boxes.
pub fn validate_wide(nodes: &[CwbvhNode], bounds: &[BoundsRecord]) -> Result<(), BuildError> {
    if bounds.is_empty() {
        return Err(BuildError::NoPrimitives);
    }
    let mut walk =
        Walk { nodes, bounds, met: Once::new(nodes.len()), slots: Once::new(bounds.len()), order: Vec::new() };
    walk.all()?;
    walk.boxes()
}

/// A walk through the tree and what it has reached so far.
struct Walk<'a> {
    nodes: &'a [CwbvhNode],
    bounds: &'a [BoundsRecord],
    met: Once,
    slots: Once,
    /// Nodes in the order of the walk: parents before children.
    order: Vec<(u32, Record)>,
}

impl Walk<'_> {
    /// Visits every node and every slot.
    fn all(&mut self) -> Result<(), BuildError> {
        let mut open = vec![(0, 0, 0)];
        while let Some((parent, node, level)) = open.pop() {
            let record = self.enter(parent, node, level)?;
            let (mut child, mut primitive) = (record.first_child, u64::from(record.first_triangle));
            for (what, _) in record.children {
                match what {
                    Child::None => {}
                    Child::Inner => {
                        open.push((node, child, level + 1));
                        child = child.saturating_add(1);
                    }
                    Child::Leaf { count } => {
                        self.leaf(node, primitive, count)?;
                        primitive += u64::from(count);
                    }
                }
            }
        }
        if let Some(node) = self.met.missing() {
            return Err(BuildError::WideNodeUnreached { node });
        }
        match self.slots.missing() {
            Some(primitive) => Err(BuildError::PrimitiveLost { primitive }),
            None => Ok(()),
        }
    }

    /// Visits the node that `parent` refers to.
    fn enter(&mut self, parent: u32, node: u32, level: u32) -> Result<Record, BuildError> {
        let Some(found) = self.nodes.get(node as usize) else {
            return Err(BuildError::WideNodeOutOfRange { node: parent, child: node, nodes: self.nodes.len() });
        };
        if !self.met.meet(node) {
            return Err(BuildError::WideNodeReachedTwice { node });
        }
        if level >= MAX_WIDE_DEPTH {
            return Err(BuildError::WideNodeTooDeep { node });
        }
        let sound = |r: &Record| r.grid.is_sound() && r.children.iter().any(|c| c.0 != Child::None);
        let record = Record::decode(found).filter(sound).ok_or(BuildError::WideNodeMalformed { node })?;
        self.order.push((node, record));
        Ok(record)
    }

    /// Marks the slots of a leaf.
    fn leaf(&mut self, node: u32, first: u64, count: u32) -> Result<(), BuildError> {
        let primitives = self.bounds.len();
        if first + u64::from(count) > primitives as u64 {
            return Err(BuildError::WideLeafOutOfRange { node, first, count, primitives });
        }
        let first = first as u32;
        match (first..first + count).find(|&slot| !self.slots.meet(slot)) {
            Some(primitive) => Err(BuildError::PrimitiveTwice { primitive }),
            None => Ok(()),
        }
    }

    /// Computes what is below every child, from the leaves up, and compares.
    fn boxes(&self) -> Result<(), BuildError> {
        let mut around = vec![Bounds::EMPTY; self.nodes.len()];
        for (node, record) in self.order.iter().rev() {
            let (mut next, mut primitive) = (record.first_child as usize, record.first_triangle as usize);
            for (what, planes) in record.children {
                let below = match what {
                    Child::None => continue,
                    Child::Inner => {
                        next += 1;
                        around[next - 1]
                    }
                    Child::Leaf { count } => {
                        let first = primitive;
                        primitive += count as usize;
                        Bounds::around(self.bounds[first..primitive].iter().map(Bounds::read))
                    }
                };
                if !record.grid.contains(planes, below) {
                    return Err(BuildError::WideBoxTooSmall { node: *node });
                }
                around[*node as usize] = around[*node as usize].union(below);
            }
        }
        Ok(())
    }
}
