//! Where a traversal stands.

use super::resumable::Progress;
use crate::data::{CentredPair, NodeRef, STACK};

/// Nodes that wait. It is kept beside its [`Cursor`], since rust-gpu lets no pointer live in a struct
/// that crosses a loop. A packet's is replicated in every lane, which makes its hits right even where
/// a driver lets lanes part.
pub type Stack = super::stack::Stack<NodeRef, STACK>;

/// The node in hand.
#[derive(Clone, Copy)]
pub struct Cursor {
    /// Visited next; [`NodeRef::NONE`] if nothing is left to visit.
    pub node: NodeRef,
    depth: u32,
}

impl Cursor {
    /// At the root.
    #[inline(always)]
    pub fn new() -> Self {
        Self::at(NodeRef::ROOT)
    }

    /// At a node, with nothing waiting.
    #[inline(always)]
    pub fn at(node: NodeRef) -> Self {
        Cursor { node, depth: 0 }
    }

    /// How many nodes wait.
    #[inline(always)]
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Nothing is to be visited any more.
    #[inline(always)]
    pub fn finish(&mut self) {
        *self = Self::at(NodeRef::NONE);
    }

    /// Goes on to the nearer wanted child and lets the other wait, or pops if none is wanted.
    #[inline(always)]
    pub fn descend(&mut self, pair: &CentredPair, left: bool, right: bool, right_first: bool, stack: &mut Stack) {
        let (left_child, right_child) = (pair.left(), pair.right());
        if cfg!(target_arch = "spirv") {
            // Few and short branches: lanes of a subgroup that take different ones wait for each other.
            let turned = right & (right_first | !left);
            let near = if turned { right_child } else { left_child };
            let far = if turned { left_child } else { right_child };
            if left & right {
                self.wait(far, stack);
            }
            if left | right {
                self.node = near;
            } else {
                self.pop(stack);
            }
        } else if left && right {
            // A CPU foresees branches, and goes on before it knows the boxes.
            let (near, far) = if right_first { (right_child, left_child) } else { (left_child, right_child) };
            self.wait(far, stack);
            self.node = near;
        } else if left {
            self.node = left_child;
        } else if right {
            self.node = right_child;
        } else {
            self.pop(stack);
        }
    }

    /// Lets a node wait.
    #[inline(always)]
    fn wait(&mut self, node: NodeRef, stack: &mut Stack) {
        stack.put(self.depth, node);
        self.depth += 1;
    }

    /// Takes the node that waits on top, or is done.
    #[inline(always)]
    pub fn pop(&mut self, stack: &Stack) {
        if self.depth == 0 {
            self.node = NodeRef::NONE;
        } else {
            self.depth -= 1;
            // SAFETY: below the depth all has been put.
            self.node = unsafe { stack.get(self.depth) };
        }
    }
}

impl Progress for Cursor {
    #[inline(always)]
    fn start() -> Self {
        Self::new()
    }

    #[inline(always)]
    fn finished() -> Self {
        Self::at(NodeRef::NONE)
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        self.node == NodeRef::NONE
    }
}

impl Default for Cursor {
    fn default() -> Self {
        Self::new()
    }
}
