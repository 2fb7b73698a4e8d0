//! Where a traversal stands, and its stack.

use super::resumable::Progress;
use crate::data::{CentredPair, NodeRef, STACK};

/// Nodes that wait. It is kept beside its [`Cursor`], since rust-gpu lets no pointer live in a struct
/// that crosses a loop. A packet's is replicated in every lane, which makes its hits right even where
/// a driver lets lanes part.
pub type Stack = [u32; STACK];

/// The node in hand.
#[derive(Clone, Copy)]
pub struct Cursor {
    /// Visited next, unless the traversal is done.
    pub node: NodeRef,
    /// Is nothing left to visit?
    pub done: bool,
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
        Cursor { node, done: false, depth: 0 }
    }

    /// How many nodes wait.
    #[inline(always)]
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Goes on to the nearer wanted child and lets the other wait, or pops if none is wanted.
    #[inline(always)]
    pub fn descend(&mut self, pair: &CentredPair, left: bool, right: bool, right_first: bool, stack: &mut Stack) {
        if left && right {
            let (near, far) = if right_first { (pair.right(), pair.left()) } else { (pair.left(), pair.right()) };
            // The mask holds for every valid tree; it spares a check that could return from the kernel.
            stack[self.depth as usize & (STACK - 1)] = far.0;
            self.depth += 1;
            self.node = near;
        } else if left {
            self.node = pair.left();
        } else if right {
            self.node = pair.right();
        } else {
            self.pop(stack);
        }
    }

    /// Takes the node that waits on top, or is done.
    #[inline(always)]
    pub fn pop(&mut self, stack: &Stack) {
        if self.depth == 0 {
            self.done = true;
        } else {
            self.depth -= 1;
            self.node = NodeRef(stack[self.depth as usize & (STACK - 1)]);
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
        Cursor { node: NodeRef::ROOT, done: true, depth: 0 }
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        self.done
    }
}

impl Default for Cursor {
    fn default() -> Self {
        Self::new()
    }
}
