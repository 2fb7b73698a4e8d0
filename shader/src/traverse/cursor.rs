//! The state of a traversal over node pairs.

use super::resumable::Progress;
use crate::data::{CentredPair, Effects, NodeRef, STACK};
use crate::ray::Hit;
use crate::scene::Hierarchy;

/// Nodes still to visit. Kept beside its [`Cursor`], since rust-gpu allows no pointer in a struct that
/// lives across a loop: that the two belong together is the promise of who calls. A packet's stack is replicated in every lane, so its hits are right even where a
/// driver lets the lanes diverge.
pub type Stack = super::stack::Stack<NodeRef, STACK>;

/// The current node.
#[derive(Clone, Copy)]
pub struct Cursor {
    /// The node to visit next; [`NodeRef::NONE`] if nothing is left to visit.
    pub node: NodeRef,
    /// The copy of a mesh that it is in; [`Hit::NOTHING`] for none.
    pub instance: u32,
    depth: u32,
    /// How many nodes on the stack are in no copy.
    outside: u32,
}

impl Cursor {
    /// At the root.
    #[inline(always)]
    pub fn new() -> Self {
        Self::at(NodeRef::ROOT, Hit::<f32>::NOTHING)
    }

    /// At a node of a copy of a mesh or of none, with an empty stack.
    #[inline(always)]
    pub fn at(node: NodeRef, instance: u32) -> Self {
        Cursor { node, instance, depth: 0, outside: 0 }
    }

    /// The child pair of the current node, which is inner, at the time of a ray. What is on the stack when it leads to a copy is
    /// outside of that.
    #[inline(always)]
    pub fn open(&mut self, hierarchy: &Hierarchy<'_>, time: f32) -> CentredPair {
        let (pair, instance) = hierarchy.opened(self.node, self.instance, time);
        if hierarchy.base.spec.effects.has(Effects::INSTANCED) {
            let enters = self.instance == Hit::<f32>::NOTHING && instance != Hit::<f32>::NOTHING;
            self.outside = if enters { self.depth } else { self.outside };
            self.instance = instance;
        }
        pair
    }

    /// How many nodes are on the stack.
    #[inline(always)]
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Ends the traversal.
    #[inline(always)]
    pub fn finish(&mut self) {
        *self = Self::at(NodeRef::NONE, Hit::<f32>::NOTHING);
    }

    /// Goes to the nearer child that is hit and pushes the other if it is hit too; pops if none is hit.
    ///
    /// # Safety
    /// That of [`Cursor::pop`].
    #[inline(always)]
    pub unsafe fn descend(
        &mut self,
        pair: &CentredPair,
        left: bool,
        right: bool,
        right_first: bool,
        stack: &mut Stack,
    ) {
        let (left_child, right_child) = (pair.left(), pair.right());
        if cfg!(target_arch = "spirv") {
            // Few and short branches, since lanes of a subgroup that take different ones wait for each other.
            let turned = right & (right_first | !left);
            let near = if turned { right_child } else { left_child };
            let far = if turned { left_child } else { right_child };
            if left & right {
                self.push(far, stack);
            }
            if left | right {
                self.node = near;
            } else {
                // SAFETY: the caller's.
                unsafe { self.pop(stack) };
            }
        } else if left && right {
            // A CPU predicts branches, and continues before the box tests are done.
            let (near, far) = if right_first { (right_child, left_child) } else { (left_child, right_child) };
            self.push(far, stack);
            self.node = near;
        } else if left {
            self.node = left_child;
        } else if right {
            self.node = right_child;
        } else {
            // SAFETY: the caller's.
            unsafe { self.pop(stack) };
        }
    }

    /// Pushes a node.
    #[inline(always)]
    fn push(&mut self, node: NodeRef, stack: &mut Stack) {
        stack.put(self.depth, node);
        self.depth += 1;
    }

    /// Pops the next node; ends the traversal if there is none.
    ///
    /// # Safety
    /// The stack is the one that this cursor has pushed to, or one that has all that is on it.
    #[inline(always)]
    pub unsafe fn pop(&mut self, stack: &Stack) {
        if self.depth == 0 {
            self.node = NodeRef::NONE;
        } else {
            self.depth -= 1;
            // SAFETY: every index below the depth has been set, in this stack by the caller's promise.
            self.node = unsafe { stack.get(self.depth) };
            // Without copies it never is in one, which a compiler knows.
            self.instance = if self.depth < self.outside { Hit::<f32>::NOTHING } else { self.instance };
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
        Self::at(NodeRef::NONE, Hit::<f32>::NOTHING)
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
